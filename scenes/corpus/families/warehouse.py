"""Warehouse: aisles of racks full of crates under a trussed roof with skylights."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, rods
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, cells, joined, placed

SUMMARY = "A hall of racks and crates under trusses and skylights: indoor, boxes behind boxes."
INDOOR = True
TRIANGLES = (1_000, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.POINT, LightKind.DIRECTIONAL)

_HALF_X, _HALF_Z, _EAVES = 20.0, 14.0, 8.0
_CARTONS: tuple[Color, ...] = ((0.48, 0.34, 0.20), (0.56, 0.42, 0.26), (0.40, 0.27, 0.15))
_STEEL: Color = (0.30, 0.32, 0.34)
_RACK: Color = (0.06, 0.16, 0.40)
_BEAM: Color = (0.62, 0.26, 0.05)


def build(plan: Plan) -> Stage:
    """Racks along the hall, aisles between them, crates on every shelf until the triangles are used up."""
    aisles = max(min(round(plan.by_crowding(2, 5)), plan.triangles // 400 + 1), 1)
    bays = max(min(round(plan.by_grain(4, 14)), plan.triangles // 600), 2)
    levels = max(min(4, plan.triangles // (aisles * bays * 80)), 2)
    rows = (np.arange(aisles + 1) / aisles * 2 - 1) * (_HALF_Z - 2.0)
    racks = joined(_racks(rows, bays, levels))
    beams = joined(_shelves(rows, levels))
    trusses = _trusses(max(min(plan.triangles // 2500, 9), 2))
    meshes = [
        ground(2 * _HALF_X, 2 * _HALF_Z, (0.36, 0.36, 0.35), plan.triangles / 40),
        placed("walls", _walls(), (0.55, 0.56, 0.54)),
        placed("roof", _roof(), (0.42, 0.45, 0.46)),
        placed("trusses", trusses, _STEEL),
        placed("uprights", racks, _RACK),
        placed("shelves", beams, _BEAM),
    ]
    used = sum(mesh.triangle_count for mesh in meshes)
    meshes += _crates(plan, rows, levels, max((plan.triangles - used) // 12, 12))
    gap = float(rows[0] + rows[1]) / 2
    vistas = (
        ((-18.5, 5.5, gap + 0.5), (0.0, 1.5, gap + 1.5)),
        ((-18.5, 2.0, gap), (6.0, 1.5, gap)),
        ((18.0, 1.75, gap + 0.5), (0.0, 2.0, gap)),
    )
    room = ((-_HALF_X + 0.5, 0.25, -_HALF_Z + 0.5), (_HALF_X - 0.5, 7.0, _HALF_Z - 0.5))
    return Stage(tuple(meshes), start=(-_HALF_X + 1.0, 7.25, gap), room=room, vistas=vistas)


def _walls() -> Shell:
    x = [-_HALF_X - 0.25, -_HALF_X, _HALF_X, _HALF_X + 0.25]
    z = [-_HALF_Z - 0.25, -_HALF_Z, -3.0, 3.0, _HALF_Z, _HALF_Z + 0.25]
    filled = np.ones((3, 2, 5), dtype=bool)
    filled[1, :, 1:-1] = False
    filled[2, 0, 2] = False
    return cells(x, [-0.25, 4.5, _EAVES], z, filled)


def _roof() -> Shell:
    """A flat roof with three rows of skylights."""
    x = [-_HALF_X - 0.5, *(np.array([-13.5, -10.5, -1.5, 1.5, 10.5, 13.5]) + 0.0).tolist(), _HALF_X + 0.5]
    z = [-_HALF_Z - 0.5, -9.0, -5.0, -2.0, 2.0, 5.0, 9.0, _HALF_Z + 0.5]
    filled = np.ones((7, 1, 7), dtype=bool)
    filled[1::2, 0, 1::2] = False
    return cells(x, [_EAVES, _EAVES + 0.25], z, filled)


def _trusses(count: int) -> Shell:
    x = (np.arange(count) + 0.5) / count * 2 * _HALF_X - _HALF_X
    z = np.arange(-12, 14, 4.0)
    low, high = _EAVES - 1.25, _EAVES - 0.125
    starts, ends = [], []
    for here, there in ((low, low), (high, high)):
        starts.append(_grid(x, np.array([-_HALF_Z]), here))
        ends.append(_grid(x, np.array([_HALF_Z]), there))
    starts += [_grid(x, z[:-1], low), _grid(x, z[:-1] + 2, high)]
    ends += [_grid(x, z[:-1] + 2, high), _grid(x, z[1:], low)]
    return rods(np.concatenate(starts), np.concatenate(ends), 0.0625, None, 4)


def _grid(x: Array, z: Array, y: float) -> Array:
    first, second = (part.ravel() for part in np.meshgrid(x, z, indexing="ij"))
    return np.stack([first, np.full_like(first, y), second], axis=1)


def _racks(rows: Array, bays: int, levels: int) -> Iterator[Shell]:
    x = (np.arange(bays + 1) / bays * 2 - 1) * (_HALF_X - 4.0)
    for side in (-0.5, 0.5):
        feet = _grid(x, rows + side, 0.0)
        yield boxes(feet - [0.06, 0.0, 0.06], feet + [0.06, levels * 1.75 + 0.25, 0.06])


def _shelves(rows: Array, levels: int) -> Iterator[Shell]:
    for level in range(levels):
        middle = _grid(np.zeros(1), rows, 0.125 + 1.75 * level)
        yield boxes(middle - [_HALF_X - 3.9, 0.06, 0.55], middle + [_HALF_X - 3.9, 0.06, 0.55])


def _crates(plan: Plan, rows: Array, levels: int, count: int) -> Iterator[Mesh]:
    """Crates side by side on every shelf, of random sizes, and a few that are missing."""
    shelves = len(rows) * levels
    along = max(count // shelves, 1)
    deep = max(int(np.sqrt(along / 40)), 1)
    along = max(along // deep, 1)
    row, level, place, behind = (part.ravel() for part in np.indices((len(rows), levels, along, deep)))
    draws = plan.draws("crates")
    pitch, depth = 2 * (_HALF_X - 4.0) / along, 1.0 / deep
    half_x = np.minimum(pitch * draws.numbers(len(row), 0.3, 0.48), 1.0)
    half_z = depth * draws.numbers(len(row), 0.36, 0.48)
    tall = np.minimum(draws.numbers(len(row), 0.5, 1.4), 4.0 * half_x + 0.25)
    x = (place + 0.5) * pitch - (_HALF_X - 4.0)
    z = rows[row] + (behind + 0.5) * depth - 0.5
    y = 0.1875 + 1.75 * level
    kept = draws.numbers(len(row)) < plan.by_crowding(0.6, 0.95)
    low = np.stack([x - half_x, y, z - half_z], axis=1)[kept]
    high = np.stack([x + half_x, y + tall, z + half_z], axis=1)[kept]
    for number, color in enumerate(_CARTONS):
        if len(low[number :: len(_CARTONS)]):
            shell = boxes(low[number :: len(_CARTONS)], high[number :: len(_CARTONS)])
            yield placed(f"crates {number + 1}", shell, color)
