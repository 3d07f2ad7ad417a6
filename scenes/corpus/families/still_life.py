"""Still life: a few things on a slab, as small as a light test and as smooth as one likes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies
from scenes.corpus.parts_furniture import vase
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, placed
from scenes.thesis.skinned_solids import turned_solid

SUMMARY = (
    "Bottles, bowls, fruit and books on a slab: all closed, a metre or two wide, from two boxes upwards."
)
INDOOR = False
TRIANGLES = (24, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.POINT, LightKind.DIRECTIONAL)

_WARES: tuple[Color, ...] = ((0.14, 0.30, 0.16), (0.24, 0.34, 0.46), (0.60, 0.56, 0.48), (0.56, 0.22, 0.05))
_PROFILES = (
    ((0.06, 0.0), (0.07, 0.01), (0.07, 0.2), (0.05, 0.26), (0.022, 0.29), (0.02, 0.38), (0.028, 0.385)),
    None,
    ((0.05, 0.0), (0.06, 0.012), (0.15, 0.09), (0.17, 0.14), (0.155, 0.14), (0.12, 0.08), (0.03, 0.03)),
    ((0.03, 0.0), (0.05, 0.015), (0.068, 0.06), (0.055, 0.11), (0.035, 0.125), (0.025, 0.115)),
)
_WIDEST_M = 0.35


def build(plan: Plan) -> Stage:
    """Things in cells of a grid; with few triangles they are books and boxes only."""
    wide = 0.55 * plan.by_crowding(1.6, 0.9)
    # No thing gets so many triangles that they are smaller than the grid of positions.
    wanted = max(round(plan.by_grain(2, 60)), plan.triangles // 6_000)
    count = max(min(wanted, (plan.triangles - 12) // 40), 0)
    side = max(int(np.ceil(np.sqrt(count + 1))), 2)
    half = side * _WIDEST_M * wide
    slab = boxes([(-half - 0.2, -0.06, -half - 0.2)], [(half + 0.2, 0.0, half + 0.2)])
    books = max(min((plan.triangles - 12 - 40 * count) // 12, 3), 1)
    meshes = [
        placed("slab", slab, (0.46, 0.34, 0.22)),
        placed("books", _books(plan, books, half), (0.34, 0.09, 0.08)),
    ]
    left = plan.triangles - 12 - 12 * books
    meshes += _things(plan, count, side, half, left)
    reach = half + 0.2
    vistas = (
        ((0.9 * reach, 0.9 * reach, 1.7 * reach), (0.0, 0.08, 0.0)),
        ((-1.2 * reach, 0.4, 1.1 * reach), (0.0, 0.1, 0.0)),
        ((0.3 * reach, 0.3, 1.2 * reach), (0.0, 0.08, 0.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _books(plan: Plan, count: int, half: float) -> Shell:
    """A pile of books on the last cell."""
    size = np.array([0.11, 0.02, 0.15])
    shift = plan.draws("books").points(count, (-0.02, 0.0, -0.02), (0.02, 0.0, 0.02))
    corner = half - 0.6 * _WIDEST_M
    middle = np.array([corner, 0.021, corner]) + shift
    middle[:, 1] += 0.041 * np.arange(count)
    return boxes(middle - size, middle + size)


def _things(plan: Plan, count: int, side: int, half: float, triangles: int) -> Iterator[Mesh]:
    if not count:
        return
    each = max(triangles // count, 24)
    draws = plan.draws("things")
    cell = draws.order(side * side - 1)[:count]
    row, column = cell // side, cell % side
    at = np.stack([row, column], axis=1) + 0.5 + draws.points(count, (-0.15, -0.15), (0.15, 0.15))
    x, z = (2 * half * at / side - half).T
    kind = draws.below(count, len(_PROFILES))
    for number, profile in enumerate(_PROFILES):
        mine = kind == number
        if mine.any():
            places = np.stack([x[mine], 0.0 * x[mine], z[mine]], axis=1)
            sizes = draws.of(number).numbers(int(mine.sum()), 0.8, 1.1)
            yield placed(
                f"things {number + 1}", copies(_turned(profile, each), places, None, sizes), _WARES[number]
            )


def _turned(profile: tuple[tuple[float, float], ...] | None, triangles: int) -> Shell:
    """Rounder around and along with more triangles: 2 rings sides of them."""
    if profile is None:
        rings = max(min(int(np.sqrt(triangles / 3)), 40), 3)
        return vase(max(min(triangles // (2 * rings), 96), 4), rings)
    corners = np.array(profile)
    between = max(min(int(np.sqrt(triangles) / 10), 6), 1)
    dense = _subdivided(corners, between) if triangles > 60 else corners[[0, 2, 4, -1]]
    return turned_solid(dense, max(min(triangles // (2 * len(dense)), 96), 4))


def _subdivided(corners: Array, between: int) -> Array:
    share = (np.arange(between) / between)[:, None]
    lines = corners[:-1, None] + share * (corners[1:] - corners[:-1])[:, None]
    return np.concatenate([lines.reshape(-1, 2), corners[-1:]])
