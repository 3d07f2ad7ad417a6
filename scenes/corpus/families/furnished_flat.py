"""Furnished flat: four rooms with doors between them, seen into from one another."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies
from scenes.corpus.parts_furniture import bed, books, chair, shelf, sofa, table, vase
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind, Mesh
from scenes.solids import Color, Shell, cells, joined, moved, placed, turned

SUMMARY = "A flat of four furnished rooms with windows and open doors: light that passes through doorways."
INDOOR = True
TRIANGLES = (2_000, 1_000_000)
KINDS = (LightKind.POINT, LightKind.SPOT, LightKind.DIRECTIONAL)

_X = (-6.2, -6.0, -4.4, -2.4, -0.1, 0.1, 2.2, 4.2, 6.0, 6.2)
_Z = (-4.7, -4.5, -3.0, -2.1, -0.1, 0.1, 1.6, 2.5, 4.5, 4.7)
_OAK: Color = (0.36, 0.22, 0.12)
_CLOTH: Color = (0.16, 0.22, 0.30)
_WHITE: Color = (0.68, 0.66, 0.62)


def build(plan: Plan) -> Stage:
    """Walls and furniture; what is left goes into books, crockery and vases."""
    meshes = [
        ground(12.4, 9.4, (0.40, 0.28, 0.17), plan.triangles / 25),
        placed("walls", _walls(), (0.70, 0.66, 0.58)),
        placed("ceiling", boxes([(-6.2, 2.6, -4.7)], [(6.2, 2.8, 4.7)]), (0.72, 0.71, 0.68)),
        placed("window bars", _window_bars(round(plan.by_grain(1, 6))), _WHITE),
        placed("beds and sofas", joined(_soft()), _CLOTH),
        placed("tables and cupboards", joined(_tables()), _OAK),
        placed("chairs", _chairs(plan), _OAK),
        placed("shelves", joined(_shelves()), (0.28, 0.16, 0.09)),
    ]
    left = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    meshes += _small_things(plan, max(left, 120))
    vistas = (
        ((-0.5, 2.05, 4.1), (-3.6, 0.6, 0.9)),
        ((0.6, 1.7, -4.0), (4.0, 0.5, -1.6)),
        ((5.6, 2.1, 4.1), (1.6, 0.5, 1.4)),
    )
    room = ((-5.9, 0.2, -4.4), (5.9, 2.45, 4.4))
    return Stage(tuple(meshes), start=(-0.5, 2.05, 4.1), room=room, vistas=vistas)


def _walls() -> Shell:
    """Outer walls with windows, a cross of inner walls with doors."""
    x, z, y = list(_X), list(_Z), [-0.1, 0.9, 2.1, 2.65]
    filled = np.zeros((9, 3, 9), dtype=bool)
    filled[[0, -1]] = True
    filled[:, :, [0, -1]] = True
    filled[4], filled[:, :, 4] = True, True
    for i, k in ((2, 0), (6, 0), (2, -1), (6, -1)):
        filled[i, 1, k] = False
    filled[0, 1, 6] = filled[-1, 1, 2] = False
    for i, k in ((4, 2), (4, 6), (2, 4), (6, 4)):
        filled[i, :2, k] = False
    return cells(x, y, z, filled)


def _window_bars(bars: int) -> Shell:
    low, high = [], []
    for left, right in ((-4.4, -2.4), (2.2, 4.2)):
        for z in (-4.6, 4.6):
            for number in range(bars):
                x = left + (right - left) * (number + 1) / (bars + 1)
                low.append((x - 0.02, 0.9, z - 0.02))
                high.append((x + 0.02, 2.1, z + 0.02))
            low.append((left, 1.62, z - 0.02))
            high.append((right, 1.66, z + 0.02))
    return boxes(low, high)


def _soft() -> Iterator[Shell]:
    yield moved(bed(1.6), (4.4, 0.0, -3.2))
    yield moved(bed(0.9), (-5.2, 0.0, -3.2))
    yield moved(turned(sofa(1.9), -1.0, 0.0), (-3.4, 0.0, 3.9))
    yield moved(turned(sofa(0.8), 0.6, 0.8), (-5.2, 0.0, 1.6))
    yield boxes([(-4.6, -0.02, 1.2), (3.0, -0.02, -2.0)], [(-2.2, 0.015, 3.2), (5.6, 0.015, -0.8)])


def _tables() -> Iterator[Shell]:
    yield moved(table(1.0, 0.6, 0.42), (-3.4, 0.0, 2.2))
    yield moved(table(1.7, 0.9, 0.75), (3.2, 0.0, 2.2))
    yield moved(table(1.2, 0.6, 0.74), (-2.2, 0.0, -4.0))
    yield boxes(
        [(0.2, 0.0, 3.9), (5.0, 0.0, 4.0), (0.5, 1.4, 4.15)],
        [(1.9, 0.9, 4.45), (5.9, 2.0, 4.45), (1.9, 2.0, 4.45)],
    )
    yield boxes(
        [(2.9, 0.0, -4.3), (5.35, 0.0, -4.3), (0.15, 0.0, -2.0)],
        [(3.4, 0.5, -3.8), (5.85, 0.5, -3.8), (0.75, 2.1, -0.4)],
    )


def _chairs(plan: Plan) -> Shell:
    spots = np.array(
        [
            (2.7, 0, 1.5),
            (3.7, 0, 1.5),
            (2.7, 0, 2.95),
            (3.7, 0, 2.95),
            (2.0, 0, 2.2),
            (4.4, 0, 2.2),
            (-2.2, 0, -3.4),
        ]
    )
    turns = np.array([(1.0, 0), (1.0, 0), (-1.0, 0), (-1.0, 0), (0, 1.0), (0, -1.0), (-0.96, 0.28)])
    shift = plan.draws("chairs").points(len(spots), (-0.1, 0.0, -0.1), (0.1, 0.0, 0.1))
    return copies(chair(), spots + shift, turns)


def _shelves() -> Iterator[Shell]:
    yield moved(turned(shelf(1.6, 2.0, 6), 0.0, -1.0), (-0.3, 0.0, 3.6))
    yield moved(turned(shelf(1.2, 2.0, 6), 0.0, 1.0), (-5.8, 0.0, -1.2))
    yield moved(shelf(1.2, 1.1, 4), (-1.2, 0.0, -4.3))


def _small_things(plan: Plan, triangles: int) -> Iterator[Mesh]:
    each = max(min(round(0.6 * triangles / (12 * 11)), round(plan.by_grain(60, 400))), 2)
    levels = [0.03 + number * 1.97 / 5 for number in range(4)]
    draws = plan.draws("books")
    one = moved(turned(books(draws, 1.5, levels, each), 0.0, -1.0), (-0.3, 0.0, 3.6))
    other = moved(turned(books(draws, 1.1, levels, each), 0.0, 1.0), (-5.8, 0.0, -1.2))
    yield placed("books", joined([one, other]), (0.34, 0.10, 0.08))
    left = max(triangles - 12 * 8 * each, 60)
    count = round(plan.by_crowding(3, 14))
    sides = max(min(int(np.sqrt(left / count / 3)), 64), 5)
    rings = max(min(int(left / count / (2 * sides)), 64), 4)
    tops = np.array(
        [
            (-3.7, 0.42, 2.2),
            (2.9, 0.75, 2.2),
            (3.5, 0.75, 2.1),
            (-2.5, 0.74, -4.1),
            (0.6, 0.9, 4.2),
            (1.4, 0.9, 4.1),
            (3.15, 0.5, -4.05),
            (5.6, 0.5, -4.05),
            (-3.1, 0.42, 2.3),
            (3.2, 0.75, 1.9),
            (2.5, 0.75, 2.4),
            (-1.9, 0.74, -4.0),
            (5.3, 2.0, 4.2),
            (-1.2, 1.1, -4.3),
        ]
    )
    yield placed(
        "vases",
        copies(vase(sides, rings), tops[:count], None, plan.draws("vases").numbers(count, 0.4, 0.9)),
        (0.22, 0.36, 0.46),
    )
