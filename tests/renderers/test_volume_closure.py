from __future__ import annotations

import numpy as np
import pytest

from renderers.volume_closure import closure
from scenes.scene import Mesh
from tests.solids import box, placed


def test_the_boxes_of_placements_hold_what_is_drawn_however_few_are_expanded_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stray = box((0, 1, 0), (1, 2, 1))
    positions = np.vstack([stray.positions, [[90, 90, 90]]])
    placements = np.stack([placed(offset=(5.0 * step, 0, step)) for step in range(7)])
    mesh = Mesh("row, and a vertex of no face", positions, stray.triangles, placements)
    monkeypatch.setattr("renderers.volume_closure.EXPANDED_AT_ONCE", 17)
    found, drawn = closure(mesh), mesh.world_positions()[:, :-1]
    assert np.array_equal(found.low, drawn.min(axis=1))
    assert np.array_equal(found.high, drawn.max(axis=1))
