"""Plain street: the thesis' Street, houses of a few dozen triangles, as shadow volumes like them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies, rods
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, joined, loft, placed

SUMMARY = "The thesis' Street: plain houses on either side, few triangles and large closed casters."
INDOOR = False
TRIANGLES = (200, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.DIRECTIONAL, LightKind.POINT)

_WALLS: tuple[Color, ...] = ((0.72, 0.60, 0.42), (0.38, 0.15, 0.10), (0.74, 0.71, 0.64), (0.30, 0.36, 0.42))
_ROOFS: tuple[Color, ...] = ((0.42, 0.13, 0.06), (0.13, 0.14, 0.18))
_PITCH_M = 10.0


def build(plan: Plan) -> Stage:
    """Houses of 32 triangles; what is left over goes into windows, fences and cobbles."""
    houses = max(min(round(plan.by_grain(4, 24)), plan.triangles // 60), 2)
    houses += houses % 2
    length = _PITCH_M * houses / 2
    homes = _homes(plan, houses, length)
    meshes = [
        ground(length + 30.0, 60.0, (0.20, 0.20, 0.21), plan.triangles / 10),
        placed(
            "pavements",
            boxes(
                [(-length / 2, -0.06, 3.75), (-length / 2, -0.06, -6.9)],
                [(length / 2, 0.125, 6.9), (length / 2, 0.125, -3.75)],
            ),
            (0.48, 0.46, 0.42),
        ),
    ]
    for number, color in enumerate(_WALLS):
        if len(mine := homes[number :: len(_WALLS)]):
            meshes.append(placed(f"houses {number + 1}", _bodies(mine), color))
    for number, color in enumerate(_ROOFS):
        if len(mine := homes[number :: len(_ROOFS)]):
            meshes.append(placed(f"roofs {number + 1}", _roofs(mine), color))
    rest = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    meshes += _trimmings(plan, homes, length, max(rest // 12, 4))
    vistas = (
        ((-0.42 * length - 6.0, 6.5, -1.5), (0.1 * length, 0.5, -0.5)),
        ((-0.3 * length, 1.6875, 1.5), (0.2 * length, 1.0, -3.5)),
        ((0.3 * length + 6.0, 11.0, 16.0), (0.0, 0.0, -1.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _homes(plan: Plan, count: int, length: float) -> Array:
    """(n, 6): x of the middle, side of the street, width, depth, height of the walls, rise of the roof."""
    draws = plan.draws("homes")
    number = np.arange(count)
    x = (number // 2 + 0.5) * _PITCH_M - length / 2
    side = np.where(number % 2 == 0, 1.0, -1.0)
    wide = draws.numbers(count, 6.5, plan.by_crowding(7.0, 9.8))
    deep, high = (
        draws.numbers(count, 6.0, 9.0),
        3.0 + 2.75 * draws.below(count, 1 + plan.spec.crowding).astype(float) + 0.5,
    )
    return np.stack([x, side, wide, deep, np.minimum(high, 11.75), draws.numbers(count, 2.0, 3.5)], axis=1)


def _bodies(homes: Array) -> Shell:
    x, side, wide, deep, high, rise = homes.T
    middle = side * (7.0 + deep / 2)
    low = np.stack([x - wide / 2, np.full(len(x), -0.0625), middle - deep / 2], axis=1)
    top = np.stack([x + wide / 2, high, middle + deep / 2], axis=1)
    stack = np.stack([x + wide / 4, high - 0.25, middle + side * deep / 4], axis=1)
    chimneys = boxes(
        stack - [0.375, 0.0, 0.375],
        stack + [0.375, 0.0, 0.375] + np.stack([0 * x, rise + 0.75, 0 * x], axis=1),
    )
    return joined([boxes(low, top), chimneys])


def _roofs(homes: Array) -> Shell:
    """Prisms with their ridges along the street."""
    x, side, wide, deep, high, rise = homes.T
    ends = [[(half, 0.0, -0.55), (half, 1.0, 0.0), (half, 0.0, 0.55)] for half in (-0.53, 0.53)]
    places = np.stack([x, high - 0.1, side * (7.0 + deep / 2)], axis=1)
    return copies(
        loft(np.array(ends[0]), np.array(ends[1])), places, None, np.stack([wide, rise + 0.1, deep], axis=1)
    )


def _trimmings(plan: Plan, homes: Array, length: float, count: int) -> Iterator[Mesh]:
    """Lamp posts, then shutters and sills on the fronts, then cobbles."""
    lamps = max(min(count // 4, len(homes)), 1)
    x = (np.arange(lamps) + 0.5) / lamps * length - length / 2
    side = np.where(np.arange(lamps) % 2 == 0, 1.0, -1.0)
    foot = np.stack([x + 2.0, np.full(lamps, -0.06), 4.25 * side], axis=1)
    arm = foot + np.stack([0 * x, np.full(lamps, 5.0), 0 * x], axis=1)
    reach = arm - np.stack([0 * x, 0 * x, 1.5 * side], axis=1)
    posts = joined([rods(foot, arm + [0.0, 0.06, 0.0], 0.09, 0.06, 4), rods(arm, reach, 0.05, None, 4)])
    yield placed("lamp posts", posts, (0.06, 0.07, 0.07))
    left = count - 2 * lamps
    if left < len(homes):
        return
    per_house = min(left // len(homes), 40)
    owner = np.repeat(np.arange(len(homes)), per_house)
    number = np.tile(np.arange(per_house), len(homes))
    at, facing, wide, _, high, _ = homes[owner].T
    columns = 4
    along = at + ((number % columns + 0.5) / columns - 0.5) * wide * 0.9
    storey = number // columns
    up = 1.0 + (high - 1.5) * (storey % 5) / 5 + 0.15 * (storey // 5)
    corner = np.stack([along - 0.5, up, facing * 7.0 - 0.15], axis=1)
    yield placed("sills", boxes(corner, corner + [1.0, 0.1, 0.3]), (0.55, 0.50, 0.42))
    cobbles = left - per_house * len(homes)
    if cobbles > 500:
        side_count = int(np.sqrt(cobbles * length / 7.0))
        across = max(cobbles // side_count, 2)
        i, k = (part.ravel() for part in np.indices((side_count, across)))
        pitch = np.array([length / side_count, 0.0, 7.0 / across])
        middle = np.stack([i + 0.5, 0.0 * i, k + 0.5], axis=1) * pitch - [length / 2, 0.0, 3.5]
        half = 0.42 * pitch + [0.0, 0.04, 0.0]
        half = half * np.stack(
            [np.ones(len(i)), plan.draws("cobbles").numbers(len(i), 0.3, 1.0), np.ones(len(i))], axis=1
        )
        yield placed("cobbles", boxes(middle - half, middle + half), (0.27, 0.26, 0.25))
