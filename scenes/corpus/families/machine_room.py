"""Machine room: boilers, turbines and layer upon layer of pipes under gratings and lamps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies, rods
from scenes.corpus.parts_frames import railing
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, joined, placed
from scenes.thesis.skinned_solids import turned_solid

SUMMARY = (
    "Boilers and turbines among pipes in layers, a gangway of gratings: thin casters close to the light."
)
INDOOR = True
TRIANGLES = (4_000, 1_000_000)
KINDS = (LightKind.POINT, LightKind.SPOT)

_X, _Y, _Z = 12.0, 6.5, 8.0
_GREY: Color = (0.34, 0.36, 0.36)
_COPPER: Color = (0.52, 0.26, 0.12)
_GREEN: Color = (0.14, 0.28, 0.22)
_YELLOW: Color = (0.60, 0.42, 0.06)


def build(plan: Plan) -> Stage:
    """Machines on the floor, pipes under the ceiling and along the walls until the triangles are used up."""
    sides = 8 if plan.triangles < 6000 else 16 if plan.triangles < 60_000 else 32
    bars = max(min(round(plan.by_grain(12, 220)), plan.triangles // 120), 6)
    meshes = [
        ground(2 * _X, 2 * _Z, (0.28, 0.29, 0.30), plan.triangles / 40),
        placed("walls", _walls(), (0.46, 0.47, 0.44)),
        placed("boilers", _boilers(sides), _GREEN),
        placed("turbines", joined(_turbines(sides)), _GREY),
        placed("gangway", joined(_gangway(bars)), _YELLOW),
    ]
    left = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    meshes += _pipes(plan, max(left, 400), sides)
    vistas = (
        ((-10.8, 3.0, 6.6), (1.0, 1.4, -1.0)),
        ((10.5, 1.8, 6.8), (-2.0, 1.8, -1.0)),
        ((-3.0, 4.9, 6.9), (2.0, 0.8, -2.0)),
    )
    room = ((-_X + 0.4, 0.3, -_Z + 0.4), (_X - 0.4, 5.2, _Z - 0.4))
    return Stage(tuple(meshes), start=(-10.8, 3.0, 6.6), room=room, vistas=vistas)


def _walls() -> Shell:
    """Four walls and a ceiling with beams, as boxes that meet inside one another."""
    low = [
        (-_X - 0.3, -0.2, -_Z - 0.3),
        (_X, -0.2, -_Z - 0.3),
        (-_X, -0.2, -_Z - 0.3),
        (-_X, -0.2, _Z),
        (-_X - 0.3, _Y, -_Z - 0.3),
    ]
    high = [
        (-_X, _Y, _Z + 0.3),
        (_X + 0.3, _Y, _Z + 0.3),
        (_X, _Y, -_Z),
        (_X, _Y, _Z + 0.3),
        (_X + 0.3, _Y + 0.3, _Z + 0.3),
    ]
    beams = np.arange(-9.0, 10.0, 6.0)
    low += [(x - 0.15, _Y - 0.35, -_Z) for x in beams.tolist()]
    high += [(x + 0.15, _Y + 0.1, _Z) for x in beams.tolist()]
    return boxes(low, high)


def _boilers(sides: int) -> Shell:
    """Upright boilers in a row at the back, with domes, flanges and a stub."""
    profile = [
        (1.25, -0.1),
        (1.25, 0.25),
        (1.0, 0.35),
        (1.0, 1.6),
        (1.1, 1.65),
        (1.1, 1.8),
        (1.0, 1.85),
        (1.0, 3.2),
        (0.75, 3.6),
        (0.25, 3.8),
        (0.2, 4.4),
        (0.3, 4.45),
        (0.3, 4.55),
    ]
    spots = [(x, 0.0, -5.6) for x in (-8.5, -4.5, -0.5, 3.5, 7.5)]
    return copies(turned_solid(profile, 2 * sides), spots)


def _turbines(sides: int) -> Iterator[Shell]:
    """Two lying drums with rims on plinths, a control desk."""
    drum = turned_solid(
        [
            (0.25, -2.2),
            (0.3, -1.7),
            (0.9, -1.5),
            (0.95, -0.4),
            (1.15, -0.35),
            (1.15, 0.1),
            (0.95, 0.15),
            (0.8, 1.4),
            (0.3, 1.6),
            (0.25, 2.3),
        ],
        2 * sides,
    )
    x, y, z = drum.positions.T
    lying = Shell(np.stack([y, -x, z], axis=1), drum.triangles)
    yield copies(lying, [(-3.5, 1.35, 0.6), (4.5, 1.35, 0.6)])
    yield boxes(
        [(-5.4, -0.1, -0.2), (2.6, -0.1, -0.2), (-9.6, -0.1, 1.0), (-9.4, 0.95, 1.2)],
        [(-1.6, 0.6, 1.4), (6.4, 0.6, 1.4), (-8.8, 0.95, 3.6), (-9.2, 1.5, 3.4)],
    )


def _gangway(bars: int) -> Iterator[Shell]:
    """A grating along the boilers, on posts, with railings and stairs down."""
    z0, z1, height = -3.6, -2.4, 2.75
    x = (np.arange(bars) + 0.5) / bars * 21.0 - 10.5
    half = min(0.03, 0.3 * 21.0 / bars)
    low = np.stack([x - half, np.full_like(x, height - 0.04), np.full_like(x, z0)], axis=1)
    yield boxes(low, low + [2 * half, 0.04, z1 - z0])
    yield boxes(
        [(-10.6, height - 0.15, z - 0.04) for z in (z0, z1)],
        [(10.6, height + 0.02, z + 0.04) for z in (z0, z1)],
    )
    posts = np.arange(-10.0, 10.5, 4.0)
    feet = np.array([(at, -0.1, z) for at in posts.tolist() for z in (z0, z1)])
    yield boxes(feet - [0.06, 0.0, 0.06], feet + [0.06, height, 0.06])
    line = np.stack([np.linspace(-10.5, 10.5, 15), np.full(15, height), np.full(15, z1)], axis=1)
    yield railing(line, 1.0, 15, 2, 0.03)
    steps = np.arange(12)
    tread = np.stack(
        [10.6 + 0.0 * steps, (steps + 0.8) * height / 12, z1 + 0.2 + (11 - steps) * 0.25], axis=1
    )
    yield boxes(tread - [0.9, 0.03, 0.13], tread + [0.0, 0.03, 0.13])


def _pipes(plan: Plan, triangles: int, sides: int) -> Iterator[Mesh]:
    """Runs of three legs each, with flanges: up a wall, along under the ceiling, out over the machines."""
    per_run = 3 * (4 * sides - 4) + 4 * (4 * sides - 4)
    runs = max(triangles // per_run, 2)
    runs = min(runs, round(plan.by_grain(24, 600) * plan.by_crowding(0.6, 2.0)))
    draws = plan.draws("pipes")
    x0 = draws.numbers(runs, -11.5, 11.5)
    x1 = np.clip(x0 + draws.numbers(runs, -5.0, 5.0), -11.4, 11.4)
    x1 = np.where(np.abs(x1 - x0) < 0.4, x0 + np.where(x0 > 0, -0.5, 0.5), x1)
    level = _Y - 0.5 - 0.35 * draws.below(runs, 5)
    back = np.where(draws.below(runs, 3) == 0, _Z - 0.3, -_Z + 0.3) + draws.numbers(runs, -0.12, 0.12)
    z1 = np.where(back > 0, draws.numbers(runs, 3.0, 6.0), draws.numbers(runs, -6.6, -4.4))
    radius = plan.by_grain(0.16, 0.06) * draws.numbers(runs, 0.4, 1.2)
    path = np.stack(
        [
            np.stack([x0, np.zeros(runs), back], axis=1),
            np.stack([x0, level, back], axis=1),
            np.stack([x1, level, back], axis=1),
            np.stack([x1, level, z1], axis=1),
        ],
        axis=1,
    )
    for number, color in enumerate((_COPPER, _GREY, _YELLOW)):
        mine = slice(number, None, 3)
        if len(path[mine]):
            yield placed(f"pipes {number + 1}", _runs(path[mine], radius[mine], sides), color)


def _runs(path: Array, radius: Array, sides: int) -> Shell:
    starts, ends = path[:, :-1].reshape(-1, 3), path[:, 1:].reshape(-1, 3)
    thick = np.repeat(radius, path.shape[1] - 1)
    way = ends - starts
    squared = way * way
    unit = way / np.sqrt((squared[:, 0] + squared[:, 1]) + squared[:, 2])[:, None]
    pipes = rods(starts - 0.9 * thick[:, None] * unit, ends + 0.9 * thick[:, None] * unit, thick, None, sides)
    joints = np.concatenate([starts + 0.2 * way, starts + 0.75 * way])[: 4 * len(path)]
    along, wide = np.tile(unit, (2, 1))[: len(joints)], np.tile(thick, 2)[: len(joints)]
    flanges = rods(joints, joints + 0.06 * along, 1.5 * wide, None, sides)
    return joined([pipes, flanges])
