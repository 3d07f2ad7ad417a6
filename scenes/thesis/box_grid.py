"""BoxGrid: boxes in a three-dimensional grid over a floor, for many overlapping shadow volumes."""

from __future__ import annotations

from math import radians

import numpy as np

from scenes.scene import Scene
from scenes.solids import Shell, box, placed
from scenes.thesis.staging import camera, floor, spot

SPAN_M = 10.0
HOVER_M = 1.5
_STEPS_PER_M = 512.0


def box_grid(boxes: int = 1000) -> Scene:
    """The thesis' 12,000 triangles, or any number of boxes of 12 triangles each in the same 10 m.

    The grid is as many boxes wide, high and deep as are needed, filled from the lowest layer upwards; light
    and cameras stay. 20,833 boxes are 249,996 triangles.

    The first camera looks at the shadowed floor, as in figure 46a, the second at the whole. The cut-off of
    30 degrees holds the grid and its shadow; the thesis gives no number.
    """
    light = spot("Spot", (-9.0, 24.0, 7.0), (0.5, 0.0, -0.5), radians(30.0))
    cameras = (
        camera("Shadowed floor", (16.5, 10.0, 5.5), (5.5, 0.0, -6.0)),
        camera("Overview", (20.0, 17.0, 24.0), (1.0, 3.0, -1.0)),
    )
    meshes = (floor(50.0, 50.0, (0.62, 0.60, 0.55)), placed("box grid", _grid(boxes), (0.70, 0.22, 0.10)))
    return Scene("Box grid", meshes, (light,), cameras)


def _grid(boxes: int) -> Shell:
    per_side = 1
    while per_side**3 < boxes:
        per_side += 1
    pitch = np.floor(SPAN_M / per_side * _STEPS_PER_M) / _STEPS_PER_M
    # Thin enough that light comes through ten layers here and there.
    half = 5 / 32 * pitch
    y, z, x = np.unravel_index(np.arange(boxes), (per_side,) * 3)
    middles = np.stack([x, y, z], axis=1) * pitch + half
    middles += [-SPAN_M / 2, HOVER_M, -SPAN_M / 2]
    one = box((-half, -half, -half), (half, half, half))
    positions = middles[:, None] + one.positions
    triangles = 8 * np.arange(boxes)[:, None, None] + one.triangles
    return Shell(positions.reshape(-1, 3), triangles.reshape(-1, 3))
