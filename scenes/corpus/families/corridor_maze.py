"""Corridor maze: walls under a ceiling, where most of what could cast is out of every light's sight."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, rods
from scenes.corpus.draws import Draws
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.ray_caster import Bools
from scenes.scene import LightKind, Mesh
from scenes.solids import Shell, cells, joined, placed

SUMMARY = (
    "Narrow corridors with beams, pillars and rubble: closed rooms, lights that see little of the whole."
)
INDOOR = True
TRIANGLES = (600, 1_000_000)
KINDS = (LightKind.POINT, LightKind.SPOT)

_CELL, _WALL, _TALL = 3.0, 0.5, 3.0


def build(plan: Plan) -> Stage:
    """A perfect maze with some walls knocked through; triangles go into beams, lamps and rubble."""
    cells_a_side = max(min(round(plan.by_grain(5, 13)), int(np.sqrt(plan.triangles / 45))), 3)
    open_way = _maze(plan.draws("maze"), cells_a_side, plan.by_crowding(0.3, 0.04))
    planes = _planes(cells_a_side)
    width = planes[-1] - planes[0]
    walls = cells(planes, [-0.125, _TALL], planes, ~open_way[:, None])
    floors = [2, cells_a_side**2 * 4]
    meshes = [
        ground(width, width, (0.30, 0.28, 0.26), min(plan.triangles / 20, floors[1])),
        placed("walls", walls, (0.46, 0.42, 0.37)),
        placed(
            "ceiling",
            boxes([(planes[0], _TALL - 0.0625, planes[0])], [(planes[-1], _TALL + 0.25, planes[-1])]),
            (0.40, 0.39, 0.38),
        ),
    ]
    used = sum(mesh.triangle_count for mesh in meshes)
    meshes += _fittings(plan, open_way, planes, max(plan.triangles - used, 72))
    path = _longest(open_way)
    (eye_x, eye_z), (end_x, end_z) = (
        (float((planes[i] + planes[i + 1]) / 2), float((planes[k] + planes[k + 1]) / 2)) for i, k in path
    )
    vistas = (
        ((eye_x, 1.6875, eye_z), (eye_x + 0.55 * (end_x - eye_x), 0.75, eye_z + 0.55 * (end_z - eye_z))),
        ((end_x, 2.0, end_z), (end_x + 0.4 * (eye_x - end_x), 0.5, end_z + 0.4 * (eye_z - end_z))),
    )
    room = ((planes[0], 0.375, planes[0]), (planes[-1], _TALL - 0.375, planes[-1]))
    return Stage(tuple(meshes), start=(eye_x, 1.6875, eye_z), room=room, vistas=vistas)


def _planes(side: int) -> list[float]:
    """Where walls begin and end, along either axis."""
    planes = [0.0]
    for number in range(2 * side + 1):
        planes.append(planes[-1] + (_WALL if number % 2 == 0 else _CELL))
    return [one - planes[-1] / 2 for one in planes]


def _maze(draws: Draws, side: int, knocked_through: float) -> Bools:
    """(2 side + 1, 2 side + 1) bool: what is open. A random walk that backs up where it is stuck."""
    is_open = np.zeros((2 * side + 1,) * 2, dtype=bool)
    trail = [(0, 0)]
    is_open[1, 1] = True
    choices = iter(draws.below(8 * side * side, 12).tolist())
    while trail:
        i, k = trail[-1]
        ways = [
            (i + di, k + dk)
            for di, dk in ((1, 0), (0, 1), (-1, 0), (0, -1))
            if 0 <= i + di < side and 0 <= k + dk < side and not is_open[2 * (i + di) + 1, 2 * (k + dk) + 1]
        ]
        if not ways:
            trail.pop()
            continue
        there = ways[next(choices) % len(ways)]
        is_open[i + there[0] + 1, k + there[1] + 1] = True
        is_open[2 * there[0] + 1, 2 * there[1] + 1] = True
        trail.append(there)
    through = draws.numbers(is_open.size).reshape(is_open.shape) < knocked_through
    inner, parity = np.zeros_like(is_open), np.add.outer(np.arange(2 * side + 1), np.arange(2 * side + 1)) % 2
    inner[1:-1, 1:-1] = True
    opened: Bools = is_open | (through & inner & (parity == 1))
    return opened


def _longest(open_way: Bools) -> tuple[tuple[int, int], tuple[int, int]]:
    """First and last cell of the longest straight corridor."""
    best, ends = 0, ((1, 1), (1, 1))
    for axis, lanes in enumerate((open_way, open_way.T)):
        for lane in range(1, len(lanes), 2):
            closed = np.flatnonzero(np.concatenate([[True], ~lanes[lane], [True]]))
            spans = np.diff(closed) - 1
            number = int(np.argmax(spans))
            if spans[number] > best:
                best = int(spans[number])
                first, last = int(closed[number]), int(closed[number + 1]) - 2
                pair = ((lane, first), (lane, last))
                ends = pair if axis == 0 else ((first, lane), (last, lane))
    return ends


def _fittings(plan: Plan, open_way: Bools, planes: list[float], triangles: int) -> Iterator[Mesh]:
    edges = np.array(planes)
    free = np.argwhere(open_way)
    draws = plan.draws("fittings")
    low, high = edges[free], edges[free + 1]
    beams = boxes(
        np.stack([low[:, 0], np.full(len(free), _TALL - 0.3), (low[:, 1] + high[:, 1]) / 2 - 0.1], axis=1),
        np.stack([high[:, 0], np.full(len(free), _TALL), (low[:, 1] + high[:, 1]) / 2 + 0.1], axis=1),
    )
    keep = max(min(len(free), triangles // 36), 1)
    yield placed(
        "beams", Shell(beams.positions[: 8 * keep], beams.triangles[: 12 * keep]), (0.24, 0.17, 0.11)
    )
    rest = max(triangles - 12 * keep, 24)
    pipes = max(min(len(free), rest // 60), 1)
    corner = np.stack([low[:pipes, 0], np.full(pipes, _TALL - 0.5), low[:pipes, 1] + 0.15], axis=1)
    end = corner + np.stack([(high - low)[:pipes, 0], np.zeros(pipes), np.zeros(pipes)], axis=1)
    yield placed(
        "pipes",
        joined(
            [
                rods(corner, end, 0.06, None, 6),
                rods(corner + [0, 0, 0.16], end + [0, 0, 0.16], 0.035, None, 6),
            ]
        ),
        (0.36, 0.22, 0.14),
    )
    count = max((rest - 40 * pipes) // 12, 2)
    owner = draws.below(count, len(free))
    size = plan.by_grain(0.4, 0.12) * draws.numbers(count, 0.3, 1.0) * min(1.0, np.sqrt(600.0 / count) + 0.15)
    middle = low[owner] + draws.points(count, (0.15, 0.15), (0.85, 0.85)) * (high - low)[owner]
    # Rubble lies along the walls.
    offset = middle - (low + high)[owner] / 2
    middle = (low + high)[owner] / 2 + offset * 1.1
    flat = (
        np.stack([size, size * draws.numbers(count, 0.4, 1.2), size * draws.numbers(count, 0.5, 1.0)], axis=1)
        / 2
    )
    at = np.stack([middle[:, 0], flat[:, 1], middle[:, 1]], axis=1)
    yield placed("rubble", boxes(at - flat, at + flat), (0.38, 0.34, 0.30))
