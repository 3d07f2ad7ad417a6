"""Crowd: many people in a square around a monument, every one a closed caster with thin limbs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, placements, rods
from scenes.corpus.parts_figures import figure
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind, Mesh
from scenes.solids import Color, Shell, joined, placed
from scenes.thesis.skinned_solids import turned_solid

SUMMARY = "People in a square around a monument: hundreds of closed figures with thin limbs, instanced."
INDOOR = False
TRIANGLES = (800, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.POINT, LightKind.DIRECTIONAL)

_POSTURES = 6
_COATS: tuple[Color, ...] = (
    (0.10, 0.14, 0.28),
    (0.42, 0.10, 0.08),
    (0.30, 0.27, 0.22),
    (0.08, 0.22, 0.14),
    (0.50, 0.40, 0.16),
    (0.14, 0.12, 0.12),
)


def build(plan: Plan) -> Stage:
    """As many people as there are triangles for; fewer are rounder."""
    people = max(min(round(plan.by_grain(20, 900) * plan.by_crowding(0.5, 2.0)), plan.triangles // 90), 6)
    each = 0.85 * plan.triangles / people
    sides = 4 if each < 260 else min(int(each / 56), 40)
    half = plan.by_crowding(1.6, 0.8) * np.sqrt(people) * 0.75 + 5.0
    steps = boxes(
        [(-2.5, -0.1, -2.5), (-1.75, 0.3, -1.75), (-1.0, 0.6, -1.0)],
        [(2.5, 0.35, 2.5), (1.75, 0.65, 1.75), (1.0, 2.5, 1.0)],
    )
    column = [(0.8, 2.375), (0.7, 2.75), (0.5, 3.0), (0.42, 7.5), (0.7, 8.0), (0.7, 8.375)]
    rounds = max(min(plan.triangles // 400, 40), 6)
    statue = figure(plan.draws("statue"), 4 if plan.triangles < 4000 else 16)
    meshes = [
        ground(2 * half + 24, 2 * half + 24, (0.44, 0.41, 0.37), plan.triangles / 25),
        placed("monument", joined([steps, turned_solid(column, rounds)]), (0.56, 0.53, 0.47)),
        placed("statue", statue, (0.20, 0.34, 0.28), placements([(0.0, 8.3, 0.0)], [(1.0, 0.0)], 1.6)),
        placed("lamps", _lamps(half), (0.08, 0.08, 0.09)),
    ]
    meshes += _people(plan, people, sides, half)
    vistas = (
        ((0.35 * half, 3.4, half + 2.5), (0.0, 1.5, 0.0)),
        ((-half - 3.0, 7.0, 0.8 * half), (0.0, 1.0, 0.0)),
        ((-0.5 * half, 1.75, half + 1.0), (0.0, 1.5, 1.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _lamps(half: float) -> Shell:
    feet = np.array([(x, -0.1, z) for x in (-half, half) for z in (-half, half)])
    heads = feet + [0.0, 4.5, 0.0]
    return joined(
        [rods(feet, heads, 0.08, 0.05, 6), boxes(heads - [0.2, 0.05, 0.2], heads + [0.2, 0.45, 0.2])]
    )


def _people(plan: Plan, count: int, sides: int, half: float) -> Iterator[Mesh]:
    """Each in a cell of a grid, so that nobody stands in another; the monument's cells stay free."""
    side = int(np.sqrt(1.4 * count)) + 4
    row, column = (part.ravel() for part in np.indices((side, side)))
    draws = plan.draws("people")
    x = (row + 0.5 + draws.numbers(len(row), -0.25, 0.25)) / side * 2 * half - half
    z = (column + 0.5 + draws.numbers(len(row), -0.25, 0.25)) / side * 2 * half - half
    taken = (np.abs(x) < 3.2) & (np.abs(z) < 3.2)
    order = draws.order(len(row))
    chosen = order[np.argsort(taken[order], kind="stable")][:count]
    places = np.stack([x[chosen], np.zeros(count), z[chosen]], axis=1)
    turns, sizes = draws.turns(count), draws.numbers(count, 0.86, 1.06)
    for posture in range(min(_POSTURES, count)):
        mine = slice(posture, None, _POSTURES)
        shape = figure(plan.draws("posture", posture), sides)
        yield placed(
            f"people {posture + 1}",
            shape,
            _COATS[posture],
            placements(places[mine], turns[mine], sizes[mine]),
        )
