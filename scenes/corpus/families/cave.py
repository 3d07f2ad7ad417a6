"""Cave: a winding vault of rock with stalactites and stalagmites, all receivers rough, light close by."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import placements, sheet
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, placed
from scenes.thesis.skinned_solids import stone, turned_solid

SUMMARY = "A hall of rock with stalactites, stalagmites and boulders: rough receivers, light from within."
INDOOR = True
TRIANGLES = (600, 1_000_000)
KINDS = (LightKind.POINT, LightKind.SPOT)

_SIDE_M, _TALL_M = 36.0, 8.0
_ROCK: Color = (0.42, 0.36, 0.29)
_DRIP: Color = (0.52, 0.45, 0.35)


def build(plan: Plan) -> Stage:
    """Floor and roof are hills that meet at the walls; dripstones hang and stand in groups."""
    quads = max(int(np.sqrt(plan.triangles / 9)), 6)
    x, z = square_points(_SIDE_M, quads)
    floor, roof = _floor(plan, x, z), _roof(plan, x, z)
    overhead = np.stack([x, roof, z], axis=2)
    meshes = [
        hills(_SIDE_M, quads, floor, _ROCK, "floor"),
        placed("roof", sheet(overhead), (0.36, 0.31, 0.26)),
    ]
    meshes += _dripstones(plan, int(0.55 * plan.triangles))
    meshes += _boulders(plan, int(0.1 * plan.triangles))
    eye = _above(plan, -9.0, 9.5, 1.9)
    other = _above(plan, 9.0, 8.0, 2.2)
    middle = _above(plan, 0.0, 0.0, 1.0)
    vistas = ((eye, middle), (other, _above(plan, -2.0, -2.0, 1.2)))
    half = 0.42 * _SIDE_M
    return Stage(
        tuple(meshes), start=middle, room=((-half, -2.0, -half), (half, _TALL_M, half)), vistas=vistas
    )


def _walls(x: Array, z: Array) -> Array:
    """0 in the hall, 1 where floor and roof meet."""
    u, w = 2 * x / _SIDE_M, 2 * z / _SIDE_M
    out = u * u * (u * u) + w * w * (w * w)
    return np.minimum(out * out * 1.2, 1.0)


def _floor(plan: Plan, x: Array, z: Array) -> Array:
    bumps = 1.5 * noise(x / 12.0 + 9.0, z / 12.0 + 9.0, plan.draws("floor"), 5)
    return bumps + 4.5 * _walls(x, z)


def _roof(plan: Plan, x: Array, z: Array) -> Array:
    bumps = 2.4 * noise(x / 10.0 + 9.0, z / 10.0 + 9.0, plan.draws("roof"), 5)
    return _TALL_M + bumps - 5.5 * _walls(x, z)


def _above(plan: Plan, x: float, z: float, height: float) -> tuple[float, float, float]:
    at = np.array([x]), np.array([z])
    return x, float(_floor(plan, *at)[0]) + height, z


def _places(plan: Plan, name: str, count: int) -> Array:
    """Places in groups, away from where the eyes stand."""
    draws = plan.draws(name)
    groups = draws.points(7, (-13.0, -13.0), (13.0, 13.0))
    at = groups[draws.below(count, 7)] + draws.points(count, (-3.5, -3.5), (3.5, 3.5))
    for eye in ((-9.0, 9.5), (9.0, 8.0), (0.0, 0.0)):
        way = at - eye
        near = np.sqrt(way[:, 0] * way[:, 0] + way[:, 1] * way[:, 1])
        at = np.where((near < 2.0)[:, None], at + np.array([3.0, -3.5]), at)
    return np.clip(at, -15.0, 15.0)


def _dripstones(plan: Plan, triangles: int) -> Iterator[Mesh]:
    count = max(min(round(plan.by_grain(12, 700) * plan.by_crowding(0.6, 1.6)), triangles // 40), 4)
    each = triangles / count
    sides = max(min(int(np.sqrt(each / 3)), 40), 4)
    rings = max(min(int(each / (2 * sides)), 60), 3)
    size = plan.by_grain(1.5, 0.45)
    for name, hanging in (("stalagmites", False), ("stalactites", True)):
        half = max(count // 2, 1)
        places = _places(plan, name, half)
        draws = plan.draws(name, "sizes")
        height = (_roof if hanging else _floor)(plan, places[:, 0], places[:, 1])
        tall = size * draws.numbers(half, 0.5, 2.2)
        at = np.stack([places[:, 0], height + (0.25 if hanging else -0.25), places[:, 1]], axis=1)
        share = np.arange(rings) / (rings - 1)
        knobs = 1.0 + 0.16 * draws.of("knobs").numbers(rings, -1.0, 1.0)
        radius = (0.27 * (1.0 - share) * (1.0 - 0.5 * share) + 0.02) * knobs
        drop = share * (2.0 if hanging else 1.4)
        if hanging:
            profile = np.stack([radius[::-1], -drop[::-1]], axis=1)
        else:
            profile = np.stack([radius * 1.4, drop], axis=1)
        yield placed(name, turned_solid(profile, sides), _DRIP, placements(at, draws.turns(half), tall))


def _boulders(plan: Plan, triangles: int) -> Iterator[Mesh]:
    count = max(min(60, triangles // 48), 1)
    faces = max(min(int(np.sqrt(triangles / count / 12)), 40), 1)
    draws = plan.draws("boulders")
    places = _places(plan, "boulder places", count)
    height = _floor(plan, places[:, 0], places[:, 1])
    at = np.stack([places[:, 0], height + 0.15, places[:, 1]], axis=1)
    shape = stone((faces, faces, faces), (0.8, 0.55, 0.65), 0.25, seed=plan.spec.seed)
    yield placed("boulders", shape, _ROCK, placements(at, draws.turns(count), draws.numbers(count, 0.3, 1.3)))
