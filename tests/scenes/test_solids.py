"""Solids have the volume that geometry books give them, and closed surfaces."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from scenes.solids import GRID_M, Shell, box, cells, joined, loft, moved, post, snapped, turned, wheel
from tests.tolerances import VOLUME_ROUNDING

OCTAGON_AREA = 2 * np.sqrt(2)
HOLLOW = np.ones((3, 2, 3), dtype=bool)
HOLLOW[1, 1, 1] = False
CHECKERED = np.indices((2, 2, 2)).sum(axis=0) % 2 == 0


def volume(shell: Shell) -> float:
    corners = shell.positions[shell.triangles]
    return float((np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]).sum() / 6)


@pytest.mark.parametrize(
    ("shell", "cubic_metres"),
    [
        (box((-1, -2, -3), (1, 2, 3)), 48.0),
        (cells([0, 1, 2, 3], [0, 1, 2], [0, 1, 2, 3], HOLLOW), 17.0),
        (cells([0, 1, 2], [0, 1, 2], [0, 1, 2], CHECKERED), 4.0),
        (post((0, 0, 0), (0.5, 3, 0), 1, 1), 3 * OCTAGON_AREA),
        (wheel((1, 2, 3), 2, 0.5), 2 * OCTAGON_AREA),
        (loft([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 0, 2), (1, 0, 2), (0, 1, 2)]), 1.0),
        (turned(moved(box((0, 0, 0), (1, 1, 1)), (5, 0, 0)), 0.6, 0.8), 1.0),
        (joined([box((0, 0, 0), (1, 1, 1)), box((3, 0, 0), (4, 1, 1))]), 2.0),
    ],
)
def test_solids_are_closed_and_face_outwards(shell: Shell, cubic_metres: float) -> None:
    edges = [
        (a, b)
        for triangle in shell.triangles.tolist()
        for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True)
    ]
    assert Counter(edges) == Counter((b, a) for a, b in edges)
    assert volume(shell) == pytest.approx(cubic_metres, rel=VOLUME_ROUNDING)


def test_cells_share_their_corners() -> None:
    # 4 x 3 x 4 grid corners: every one lies on the surface.
    assert len(cells([0, 1, 2, 3], [0, 1, 2], [0, 1, 2, 3], HOLLOW).positions) == 48


def test_a_quarter_turn_takes_x_to_minus_z() -> None:
    shell = turned(moved(box((0, 0, 0), (1, 1, 1)), (5, 0, 0)), 0.0, 1.0)
    np.testing.assert_array_equal(shell.positions.max(axis=0), [1, 1, -5])


def test_snapping_hides_the_last_bits() -> None:
    exact = np.array([[1.0, 1 / 3, -1e3]])
    np.testing.assert_array_equal(snapped(exact), snapped(exact * (1 + 2e-16)))
    np.testing.assert_array_less(np.abs(snapped(exact) - exact), GRID_M)
