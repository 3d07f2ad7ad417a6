"""Stadium: rings of seats under a roof on masts, thousands of like casters around an open field."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies, rods, sheet
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind
from scenes.solids import Color, Shell, joined, placed
from scenes.thesis.skinned_solids import circle

SUMMARY = "Stands of seats around a field, a roof on raking masts, floodlights: like casters in rows."
INDOOR = False
TRIANGLES = (1_500, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.DIRECTIONAL, LightKind.POINT)

_FIELD = (34.0, 24.0)
_ROW_M, _RISE_M = 0.9, 0.45
_CONCRETE: Color = (0.50, 0.49, 0.47)
_STEEL: Color = (0.62, 0.63, 0.64)
_SEAT: Color = (0.08, 0.18, 0.46)


def build(plan: Plan) -> Stage:
    """Rows by crowding, sectors by grain; seats take what triangles are left."""
    sectors = 24 if plan.triangles < 4000 else 48 if plan.triangles < 40_000 else 96
    rows = max(min(round(plan.by_crowding(6, 22)), plan.triangles // (sectors * 8)), 3)
    masts = 12 if plan.triangles < 6000 else 24
    reach = rows * _ROW_M + 3.0
    meshes = [
        ground(120.0, 100.0, (0.26, 0.25, 0.24), plan.triangles / 60),
        placed("field", boxes([(-22.0, -0.1, -14.0)], [(22.0, 0.03, 14.0)]), (0.16, 0.34, 0.10)),
        placed("stands", _stands(rows, sectors), _CONCRETE),
        placed("masts", _masts(masts, rows, reach), _STEEL),
        placed("roof", _roof(sectors, rows, reach), (0.72, 0.71, 0.68)),
        placed("goals and floodlights", joined(_goals(reach)), (0.75, 0.75, 0.74)),
    ]
    left = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    if left > 400:
        meshes.append(placed("seats", _seats(plan, rows, left), _SEAT))
    tall = rows * _RISE_M
    vistas = (
        ((-30.0, 0.6 * tall + 3.0, 5.0), (6.0, 0.0, -2.0)),
        ((-12.0, 1.8, 8.0), (14.0, 0.5 * tall, -18.0)),
        ((46.0, tall + 26.0, 44.0), (0.0, 0.0, -4.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _ring(sectors: int, out: float, height: float) -> Array:
    """(sectors + 1, 3) points of an oval `out` metres from the field's edge."""
    x, z = circle(sectors)[np.arange(sectors + 1) % sectors].T
    return np.stack([(_FIELD[0] + out) * x, np.full_like(x, height), -(_FIELD[1] + out) * z], axis=1)


def _stands(rows: int, sectors: int) -> Shell:
    """Steps as one sheet, and the wall behind them."""
    profile = [(0.0, 0.0), (0.0, 1.2)]
    for row in range(rows):
        profile += [
            ((row + 1) * _ROW_M, 1.2 + row * _RISE_M),
            ((row + 1) * _ROW_M, 1.2 + (row + 1) * _RISE_M),
        ]
    back = rows * _ROW_M
    profile += [(back + 2.0, 1.2 + rows * _RISE_M), (back + 2.5, 0.0)]
    return sheet(np.stack([_ring(sectors, out - 4.0, height) for out, height in profile], axis=1))


def _masts(count: int, rows: int, reach: float) -> Shell:
    tall = rows * _RISE_M
    feet = _ring(count, reach - 1.0, -0.2)[:-1]
    heads = _ring(count, reach + 1.5, tall + 11.0)[:-1]
    rim = _ring(count, 0.25 * reach - 4.0, tall + 6.5)[:-1]
    back = _ring(count, reach - 1.5, tall + 5.0)[:-1]
    return joined(
        [
            rods(feet, heads, 0.3, 0.15, 6),
            rods(heads - [0.0, 0.3, 0.0], rim, 0.06, None, 4),
            rods(back, rim, 0.15, None, 4),
        ]
    )


def _roof(sectors: int, rows: int, reach: float) -> Shell:
    """Every other sector between the masts is a pane: strips of light on the stands."""
    tall = rows * _RISE_M
    whole = sheet(
        np.stack(
            [
                _ring(sectors, out, tall + up)
                for out, up in ((0.25 * reach - 4.0, 6.7), (0.6 * reach, 6.0), (reach, 5.1))
            ],
            axis=1,
        )
    )
    return Shell(
        whole.positions, whole.triangles.reshape(sectors, -1, 3)[np.arange(sectors) % 4 != 3].reshape(-1, 3)
    )


def _goals(reach: float) -> Iterator[Shell]:
    for side in (-1.0, 1.0):
        x = side * 20.5
        yield boxes(
            [(x - 0.06, 0.0, -3.66), (x - 0.06, 0.0, 3.54), (x - 0.06, 2.44, -3.66)],
            [(x + 0.06, 2.44, -3.54), (x + 0.06, 2.44, 3.66), (x + 0.06, 2.56, 3.66)],
        )
    for x in (-1.0, 1.0):
        for z in (-1.0, 1.0):
            foot = np.array([(x * (_FIELD[0] + 0.8 * reach), -0.2, z * (_FIELD[1] + 0.8 * reach))])
            yield rods(foot, foot + [0.0, 30.0, 0.0], 0.5, 0.25, 6)
            yield boxes(foot + [-2.5, 29.5, -0.4], foot + [2.5, 33.0, 0.4])


def _seats(plan: Plan, rows: int, triangles: int) -> Shell:
    """Seats of two boxes, spread evenly over the rows; some are folded up."""
    count = max(triangles // 24, 12)
    row = np.arange(count) % rows
    place = (np.arange(count) // rows + 0.5) / (count // rows + 1)
    turn = place * 256.0
    whole = np.floor(turn).astype(np.int64)
    part = (turn - whole)[:, None]
    table = circle(256)
    way = table[whole % 256] * (1 - part) + table[(whole + 1) % 256] * part
    out = (row + 0.62) * _ROW_M - 4.0
    x, z = (_FIELD[0] + out) * way[:, 0], -(_FIELD[1] + out) * way[:, 1]
    height = 1.2 + row * _RISE_M
    width = min(0.44, 150.0 * rows / count)
    size = max(width / 0.44, 0.25)
    one = boxes([(-0.18, 0.32, -0.2), (0.14, 0.34, -0.2)], [(0.14, 0.38, 0.2), (0.2, 0.8, 0.2)])
    keep = plan.draws("seats").numbers(count) < plan.by_grain(0.8, 0.98)
    sizes = np.stack([np.ones(count), np.ones(count), np.full(count, size)], axis=1)[keep]
    return copies(
        one, np.stack([x, height, z], axis=1)[keep], np.stack([way[:, 0], way[:, 1]], axis=1)[keep], sizes
    )
