from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.corner_blocks import TRIANGLES_AT_ONCE, corner_blocks, face_crosses, lengths


@pytest.mark.parametrize("count", [0, 1, TRIANGLES_AT_ONCE, 2 * TRIANGLES_AT_ONCE + 3])
def test_blocks_hold_the_corners_of_all_triangles_in_order(count: int) -> None:
    random = np.random.default_rng(count)
    positions = random.normal(size=(50, 3)).astype(np.float32)
    triangles = random.integers(0, 50, (count, 3)).astype(np.int32)
    found = np.zeros((3, 3, count))
    filled = 0
    for part, corners in corner_blocks(positions, triangles):
        assert part.start == filled
        found[:, :, part] = corners
        filled = part.stop
    assert filled == count
    assert np.array_equal(found.transpose(2, 0, 1), positions[triangles].astype(np.float64))


@given(st.integers(0, 10**6))
def test_crosses_and_lengths_are_bit_for_bit_those_of_numpy(seed: int) -> None:
    corners = np.random.default_rng(seed).normal(size=(20, 3, 3))
    wanted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    crosses = face_crosses(corners.transpose(1, 2, 0))
    assert np.array_equal(crosses.T, wanted)
    assert np.array_equal(lengths(crosses), np.linalg.norm(wanted, axis=1))
