"""Stone circles: the thesis' Rocks, uprights and lintels of many triangles whose shadows hardly overlap."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import placements
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Point, placed
from scenes.thesis.skinned_solids import circle, stone

SUMMARY = "The thesis' Rocks: circles of rough stones with lintels, many triangles, hardly an overlap."
INDOOR = False
TRIANGLES = (500, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.DIRECTIONAL, LightKind.POINT)

_RADIUS_M = 4.5
_SIDE_M = 70.0
_UPRIGHT: Point = (0.5625, 1.5, 0.3125)
_LINTEL: Point = (1.375, 0.25, 0.375)
_COLORS: tuple[Color, ...] = ((0.46, 0.44, 0.40), (0.44, 0.43, 0.41), (0.48, 0.45, 0.39))


def build(plan: Plan) -> Stage:
    """Circles far apart; three shapes of upright and two of lintel, each many times."""
    circles = max(min(round(plan.by_grain(1, 12)), plan.triangles // 350), 1)
    uprights = min(round(plan.by_crowding(7, 16)), 16)
    centres = _centres(plan, circles)
    stones = circles * (2 * uprights - 2) + 12
    each = 0.8 * plan.triangles / stones
    quads = max(int(np.sqrt(plan.triangles / 12)), 4)
    x, z = square_points(1.6 * _SIDE_M, quads)
    lawn = 0.15 * noise(x / 12.0 + 8.0, z / 12.0 + 8.0, plan.draws("lawn"), 2)
    meshes = [hills(1.6 * _SIDE_M, quads, lawn, (0.30, 0.31, 0.13))]
    meshes += _standing(plan, centres, uprights, each)
    meshes += _fallen(plan, each)
    vistas = (
        ((3.0, 5.0, 15.0), (0.0, 0.75, 0.0)),
        ((-8.0, 2.0, 10.0), (1.0, 0.75, 0.0)),
        ((14.0, 9.0, 24.0), (-1.0, 0.0, -2.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _centres(plan: Plan, count: int) -> Array:
    """The first in the middle, the others around it, apart."""
    spots = np.array(
        [
            (0, 0),
            (1, 0),
            (-1, -1),
            (0, -1),
            (-1, 0),
            (1, -1),
            (2, 0),
            (-2, 0),
            (-2, -1),
            (2, -1),
            (0, -2),
            (1, -2),
        ]
    )
    shift = plan.draws("centres").points(count, (-1.5, -1.5), (1.5, 1.5)) * (np.arange(count) > 0)[:, None]
    return spots[:count] * 14.0 + shift


def _standing(plan: Plan, centres: Array, uprights: int, each: float) -> Iterator[Mesh]:
    draws = plan.draws("stones")
    spokes = circle(2 * uprights)
    for name, half, shapes, height, spoke in (
        ("uprights", _UPRIGHT, 3, 1.3125, spokes[::2]),
        ("lintels", _LINTEL, 2, 2.9375, spokes[1::2]),
    ):
        at = np.repeat(centres, uprights, axis=0)
        ways = np.tile(spoke, (len(centres), 1))
        kept = draws.numbers(len(at)) < (1.0 if name == "uprights" else 0.7)
        kept[:shapes] = True
        places = np.stack(
            [at[:, 0] + _RADIUS_M * ways[:, 0], np.full(len(at), height), at[:, 1] + _RADIUS_M * ways[:, 1]],
            axis=1,
        )[kept]
        turns = np.stack([ways[:, 1], ways[:, 0]], axis=1)[kept]
        size = draws.numbers(len(places), 0.94, 1.03) if name == "uprights" else np.ones(len(places))
        for shape in range(shapes):
            mine = slice(shape, None, shapes)
            solid = stone(
                _divisions(half, each), half, 0.15625, seed=16 * plan.spec.seed + 4 * len(name) + shape
            )
            yield placed(
                f"{name} {shape + 1}",
                solid,
                _COLORS[shape],
                placements(places[mine], turns[mine], size[mine]),
            )


def _fallen(plan: Plan, each: float) -> Iterator[Mesh]:
    draws = plan.draws("fallen")
    places = draws.points(11, (-9.0, 0.1, -9.0), (9.0, 0.25, 9.0))
    places[0] = (0.0, 0.2, 0.0)
    matrices = placements(places, draws.turns(11), draws.numbers(11, 0.4, 0.9))
    yield placed(
        "fallen stones",
        stone(_divisions((1.25, 0.6, 0.8), each), (1.25, 0.6, 0.8), 0.2, seed=16 * plan.spec.seed + 15),
        _COLORS[1],
        matrices,
    )


def _divisions(half: Point, each: float) -> tuple[int, int, int]:
    """Faces along each side so that they are about square, and about `each` triangles."""
    a, b, c = half
    scale = np.sqrt(max(each, 12.0) / (4 * (a * b + b * c + c * a)))
    x, y, z = (max(int(scale * side), 1) for side in half)
    return x, y, z
