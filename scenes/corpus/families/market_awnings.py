"""Market stalls under awnings: open cloth over tables of wares, narrow lanes, strings of lamps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies, rods, sheet
from scenes.corpus.draws import Draws
from scenes.corpus.parts_arches import chain, sagging
from scenes.corpus.parts_figures import figure
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, cards, joined, placed

SUMMARY = (
    "Stalls with crates of fruit under sagging awnings, lanes between: open cloth over many small solids."
)
INDOOR = False
TRIANGLES = (1_200, 1_000_000)
KINDS = (LightKind.POINT, LightKind.DIRECTIONAL, LightKind.SPOT)

_CLOTHS: tuple[Color, ...] = ((0.62, 0.12, 0.08), (0.70, 0.66, 0.56), (0.10, 0.28, 0.36), (0.64, 0.42, 0.08))
_WARES: tuple[Color, ...] = ((0.62, 0.24, 0.04), (0.22, 0.36, 0.06), (0.50, 0.06, 0.06))
_WOOD: Color = (0.34, 0.22, 0.12)


def build(plan: Plan) -> Stage:
    """Stalls in rows that face one another across lanes; wares until the triangles are used up."""
    stalls = max(min(round(plan.by_crowding(6, 40)), plan.triangles // 220), 4)
    columns = max(int(np.sqrt(1.6 * stalls)), 2)
    number = np.arange(stalls)
    row = number // columns
    draws = plan.draws("stalls")
    x = (number % columns - (columns - 1) / 2) * 3.6 + draws.numbers(stalls, -0.25, 0.25)
    z = (
        (row - (row.max() / 2)) * 4.6
        + np.where(row % 2 == 0, -0.55, 0.55)
        + draws.numbers(stalls, -0.15, 0.15)
    )
    places = np.stack([x, 0.0 * x, z], axis=1)
    turns = np.stack([np.where(row % 2 == 0, 1.0, -1.0), 0.0 * x], axis=1)
    folds = max(min(int(np.sqrt(plan.triangles / stalls / 12)), 24), 2)
    half = np.array([float(np.abs(x).max()) + 6.0, float(np.abs(z).max()) + 6.0])
    meshes = [
        ground(2 * half[0] + 8, 2 * half[1] + 8, (0.42, 0.38, 0.33), plan.triangles / 20),
        placed("tables", copies(joined(_stall()), places, turns), _WOOD),
        placed("fronts", _fronts(half), (0.56, 0.46, 0.34)),
    ]
    for cloth, color in enumerate(_CLOTHS):
        mine = slice(cloth, None, len(_CLOTHS))
        if len(places[mine]):
            meshes.append(
                placed(f"awnings {cloth + 1}", copies(_awning(folds), places[mine], turns[mine]), color)
            )
    left = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    meshes += _people(plan, half, max(int(0.15 * left), 0))
    meshes.append(placed("lamp strings", _strings(half, max(min(left // 400, 24), 4)), (0.08, 0.08, 0.08)))
    meshes += _wares(plan, places, turns, max(int(0.75 * left), 12 * 3 * stalls // 4))
    lane = (
        float(np.unique(z).mean()) if row.max() == 0 else float((z[row == 0].mean() + z[row == 1].mean()) / 2)
    )
    vistas = (
        ((float(x.min()) - 3.0, 2.2, lane + 0.2), (0.5, 1.2, lane)),
        ((-half[0] + 1.0, 5.5, half[1] - 0.5), (0.5, 0.5, -0.5)),
        ((float(x.max()) + 2.5, 1.75, lane + 0.3), (float(x.max()) - 3.0, 0.9, lane - 1.4)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _stall() -> Iterator[Shell]:
    """Four poles, a slanting table, a shelf and crates under it; it faces +Z."""
    poles = np.array([(-1.4, -0.05, -0.9), (1.4, -0.05, -0.9), (-1.4, -0.05, 1.0), (1.4, -0.05, 1.0)])
    tops = poles + np.array([(0, 2.75, 0), (0, 2.75, 0), (0, 2.25, 0), (0, 2.25, 0)])
    yield rods(poles, tops, 0.04, None, 4)
    yield boxes(
        [(-1.35, 0.76, -0.2), (-1.35, 0.3, -0.7), (-1.0, 0.0, -0.3), (0.2, 0.0, -0.4)],
        [(1.35, 0.82, 0.9), (1.35, 0.35, 0.3), (-0.3, 0.29, 0.2), (0.9, 0.29, 0.25)],
    )


def _awning(folds: int) -> Shell:
    """Cloth that sags between its poles, with a scalloped edge hanging in front."""
    share = np.arange(folds + 1) / folds
    u, v = np.meshgrid(share, share, indexing="ij")
    sag = 0.7 * u * (1.0 - u) * (0.3 + v * (1.0 - v))
    top = np.stack([3.0 * u - 1.5, 2.75 - 0.5 * v - sag, 2.3 * v - 1.05], axis=2)
    cloth = sheet(top[:, ::-1])
    corner = top[:-1, -1]
    way = top[1:, -1] - top[:-1, -1]
    drop = np.where((np.arange(folds) % 2 == 0)[:, None], [0.0, -0.28, 0.0], [0.0, -0.2, 0.0])
    return joined([cloth, cards(corner, drop, way)])


def _fronts(half: Array) -> Shell:
    """Houses behind the market: three plain fronts with a cornice."""
    x, z = half.tolist()
    low = [(-x, -0.2, -z - 3.5), (-x - 3.5, -0.2, -z), (-x, 6.4, -z - 3.7), (-0.2 * x, -0.2, -z - 3.4)]
    high = [(x, 6.5, -z), (-x, 5.0, 0.4 * z), (x, 6.8, -z + 0.3), (0.5 * x, 8.5, -z + 0.15)]
    return boxes(low, high)


def _strings(half: Array, pieces: int) -> Shell:
    x, z = half.tolist()
    starts = np.array([(-x + 0.5, 4.6, at * z) for at in (-0.6, 0.0, 0.6)])
    ends = starts * [-1.0, 1.0, 1.0]
    paths = sagging(starts, ends, 1.1, pieces)
    bulbs = paths[:, 1:-1].reshape(-1, 3)
    return joined([chain(paths, 0.012), boxes(bulbs - [0.06, 0.2, 0.06], bulbs + [0.06, 0.02, 0.06])])


def _people(plan: Plan, half: Array, triangles: int) -> Iterator[Mesh]:
    count = min(triangles // 90, 60)
    if count < 3:
        return
    sides = 4 if triangles / count < 300 else min(int(triangles / count / 56), 24)
    draws = plan.draws("people")
    at = draws.points(count, (-half[0] + 1.5, 0.0, -half[1] + 2.5), (half[0] - 1.5, 0.0, half[1] - 1.0))
    shape = figure(plan.draws("figure"), sides)
    yield placed(
        "people", copies(shape, at, draws.turns(count), draws.numbers(count, 0.85, 1.05)), (0.14, 0.15, 0.24)
    )


def _wares(plan: Plan, places: Array, turns: Array, triangles: int) -> Iterator[Mesh]:
    """Fruit in heaps on the tables: octahedra, as many as there are triangles for."""
    count = max(min(triangles // 8, round(plan.by_grain(600, 200_000))), 3 * len(places))
    size = float(min(0.14, 1.2 * np.sqrt(len(places) / count))) + 0.012
    heap = Draws("market", plan.spec.seed, "heaps")
    per_color = -(-count // len(_WARES))
    for number, color in enumerate(_WARES):
        draws = heap.of(number)
        owner = draws.below(per_color, len(places))
        lane = number * 0.85 - 1.25
        u, w = draws.numbers(per_color, 0.0, 0.8), draws.numbers(per_color)
        bump = u * (0.8 - u) * w * (1.0 - w) * 4.0
        local = np.stack(
            [lane + u, 0.82 + 0.5 * size + bump * draws.numbers(per_color), 1.0 * w - 0.15], axis=1
        )
        cosine = turns[owner, 0]
        at = places[owner] + local * np.stack([cosine, np.ones(per_color), cosine], axis=1)
        sizes = size * draws.numbers(per_color, 0.8, 1.2)
        yield placed(f"wares {number + 1}", copies(_octahedron(), at, None, sizes), color)


def _octahedron() -> Shell:
    points = np.array([(1.0, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]) * 0.5
    faces = [(0, 2, 4), (4, 2, 1), (1, 2, 5), (5, 2, 0), (4, 3, 0), (1, 3, 4), (5, 3, 1), (0, 3, 5)]
    return Shell(points, np.array(faces, dtype=np.int64))
