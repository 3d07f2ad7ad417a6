"""Box grid: the thesis' boxes in a three-dimensional grid, as many and as close as a spec asks for."""

from __future__ import annotations

import numpy as np

from scenes.corpus.copies import boxes
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind
from scenes.solids import placed

SUMMARY = "The thesis' BoxGrid: boxes in a grid over a floor, shadow volumes behind shadow volumes."
INDOOR = False
TRIANGLES = (150, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.POINT, LightKind.DIRECTIONAL)

_SPAN_M, _HOVER_M = 10.0, 1.5


def build(plan: Plan) -> Stage:
    """Boxes in cells of equal size; the seed moves each a little and leaves some out."""
    most = max(int(0.75 * plan.triangles) // 12, 8)
    wanted = min(round(plan.by_grain(27, 60_000)), most)
    side = 2
    while (side + 1) ** 3 <= wanted:
        side += 1
    layers = max(min(round(side * plan.by_crowding(0.25, 1.5)), wanted // side**2), 1)
    x, y, z = (part.ravel() for part in np.indices((side, layers, side)))
    draws = plan.draws("boxes")
    pitch = _SPAN_M / side
    middles = (
        np.stack([x, y, z], axis=1) * pitch
        + (0.5 + 0.1 * draws.points(len(x), (-1.0,) * 3, (1.0,) * 3)) * pitch
    )
    half = pitch * draws.numbers(len(x), 0.13, 0.22)[:, None]
    kept = draws.numbers(len(x)) < 0.9
    kept[0] = True
    low = middles[kept] - half[kept] + [-_SPAN_M / 2, _HOVER_M, -_SPAN_M / 2]
    meshes = (
        ground(50.0, 50.0, (0.62, 0.60, 0.55), plan.triangles / 5),
        placed("box grid", boxes(low, low + 2 * half[kept]), (0.70, 0.22, 0.10)),
    )
    vistas = (
        ((17.0, 10.0, 9.0), (3.0, 1.5, -3.0)),
        ((20.0, 17.0, 24.0), (1.0, 2.0, -1.0)),
        ((-14.0, 6.0, 15.0), (0.0, 1.5, 0.0)),
    )
    return Stage(meshes, vistas=vistas)
