"""Spiral staircase: a tower's stairs around a newel, steps over steps, balusters before balusters."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, rods, sheet
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind
from scenes.solids import Color, Shell, joined, placed
from scenes.thesis.skinned_solids import circle, turned_solid

SUMMARY = "Stairs that wind up a tower around a newel: steps over steps, thin balusters, light down a shaft."
INDOOR = True
TRIANGLES = (800, 1_000_000)
KINDS = (LightKind.POINT, LightKind.SPOT, LightKind.DIRECTIONAL)

_INNER, _OUTER, _WALL = 0.9, 3.0, 5.0
_RISE_M = 0.1875
_STONE: Color = (0.52, 0.48, 0.41)
_IRON: Color = (0.10, 0.10, 0.11)


def build(plan: Plan) -> Stage:
    """Up to four turns of stairs; with more triangles finer balusters and rounder walls."""
    a_turn = 24 if plan.triangles > 3000 else 12
    turns = max(min(round(plan.by_crowding(1, 4)), plan.triangles // (a_turn * 30)), 1)
    steps = a_turn * turns
    rise = _RISE_M * 24 / a_turn
    tall = steps * rise + 2.5
    rounds = max(min(int(np.sqrt(plan.triangles / 8)), 96), 12)
    left = plan.triangles - 12 * steps - 8 * rounds * 6
    balusters = max(min(left // (steps * 20), round(plan.by_grain(1, 12))), 1)
    sides = max(min(left // (steps * balusters * 8), 24), 3)
    meshes = [
        ground(2 * _WALL, 2 * _WALL, (0.36, 0.33, 0.29), plan.triangles / 60),
        placed("steps", _steps(a_turn, steps, rise), _STONE),
        placed(
            "newel",
            turned_solid([(0.55, -0.1), (0.3, 0.25), (0.28, tall - 1.5), (0.45, tall - 1.25)], rounds),
            _STONE,
        ),
        placed("tower", joined(_tower(rounds, tall)), (0.58, 0.53, 0.45)),
        placed("crates", _crates(plan), (0.40, 0.27, 0.15)),
        placed("balustrade", joined(_balustrade(a_turn, steps, rise, balusters, sides)), _IRON),
    ]
    vistas = (
        ((3.9, 1.75, 2.4), (-0.5, 0.42 * tall, -0.6)),
        ((-3.9, 0.7 * tall, 2.2), (0.5, 0.3 * tall, -0.5)),
        ((-2.9, 3.25, 3.4), (0.0, 0.75, 0.0)),
    )
    room = ((-3.3, 0.5, -3.3), (3.3, tall - 0.5, 3.3))
    lamps = ((-3.4, tall - 1.0, -3.4), (3.4, tall + 4.0, 3.4))
    return Stage(tuple(meshes), start=(3.9, 1.75, 2.4), room=room, lamps=lamps, vistas=vistas)


def _steps(a_turn: int, count: int, rise: float) -> Shell:
    """Treads as wedges with level tops, one above the other's back edge."""
    ring = circle(a_turn)
    index = np.arange(count)
    here, there = ring[index % a_turn], ring[(index + 1) % a_turn]
    low, high = index * rise, index * rise + 1.1 * rise
    corners = [
        np.stack([radius * way[:, 0], height, -radius * way[:, 1]], axis=1)
        for height in (low, high)
        for radius, way in ((_INNER * 0.25, here), (_OUTER, here), (_OUTER, there), (_INNER * 0.25, there))
    ]
    positions = np.stack(corners, axis=1)
    quads = np.array([(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])
    faces = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    indices = faces + 8 * np.arange(count)[:, None, None]
    return Shell(positions.reshape(-1, 3), indices.reshape(-1, 3))


def _crates(plan: Plan) -> Shell:
    """What is kept at the foot of the stairs, along the wall."""
    draws = plan.draws("crates")
    ways = circle(64)[30 + draws.below(9, 26)]
    half = draws.numbers(9, 0.15, 0.4)[:, None]
    at = np.stack([4.1 * ways[:, 0], half[:, 0] - 0.02, -4.1 * ways[:, 1]], axis=1)
    return boxes(at - half, at + half)


def _tower(rounds: int, tall: float) -> Iterator[Shell]:
    """The wall as a sheet, with slits left out, and a ring on top."""
    ways = circle(rounds)[np.arange(rounds + 1) % rounds]
    rows = max(int(tall), 4)
    heights = np.arange(rows + 1) / rows * tall
    around = np.stack([_WALL * ways[:, 0], -_WALL * ways[:, 1]], axis=1)
    points = np.zeros((rounds + 1, rows + 1, 3))
    points[..., 0], points[..., 2] = around[:, :1], around[:, 1:]
    points[..., 1] = heights
    wall = sheet(points[:, :, :])
    quads = np.arange(rounds * rows).reshape(rounds, rows)
    slits = (
        ((quads // rows) % max(rounds // 6, 2) == 0) & ((quads % rows) % 3 == 2) & (quads % rows < rows - 1)
    )
    kept = np.repeat(~slits.ravel(), 2)
    yield Shell(wall.positions, wall.triangles[kept])
    yield boxes(
        [(-_WALL - 0.3, tall - 0.1, -0.2), (-0.2, tall + 0.15, -_WALL - 0.3)],
        [(_WALL + 0.3, tall + 0.2, 0.2), (0.2, tall + 0.45, _WALL + 0.3)],
    )


def _balustrade(a_turn: int, steps: int, rise: float, each: int, sides: int) -> Iterator[Shell]:
    share = (np.arange(steps * each) + 0.5) / each
    foot = _helix(share, a_turn, rise, 0.0)
    foot[:, 1] = (np.floor(share) + 1.0) * rise
    top = _helix(share, a_turn, rise, 1.0)
    yield rods(foot, top, 0.02, None, max(sides, 3))
    line = _helix(np.arange(steps + 1).astype(np.float64), a_turn, rise, 1.0)
    yield rods(line[:-1], line[1:], 0.05, None, max(min(sides, 8), 4))


def _helix(share: Array, a_turn: int, rise: float, above: float) -> Array:
    """Points along the outer edge of the stairs, between whole steps on straight lines."""
    ring = circle(a_turn)
    whole = np.floor(share).astype(np.int64)
    part = (share - whole)[:, None]
    ways = ring[whole % a_turn] * (1 - part) + ring[(whole + 1) % a_turn] * part
    radius = _OUTER - 0.125
    return np.stack([radius * ways[:, 0], (share + 1.0) * rise + above, -radius * ways[:, 1]], axis=1)
