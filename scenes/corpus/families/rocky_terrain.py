"""Rocky terrain: hills with boulders strewn over them, many closed casters on uneven ground."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import placements
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, placed
from scenes.thesis.skinned_solids import stone

SUMMARY = "Hills with crags and boulders: uneven receivers, closed casters from house-sized to pebbles."
INDOOR = False
TRIANGLES = (200, 1_000_000)
KINDS = (LightKind.DIRECTIONAL, LightKind.SPOT, LightKind.POINT)

_SIDE_M = 160.0
_KINDS = 5
_STONES: tuple[Color, ...] = (
    (0.40, 0.37, 0.33),
    (0.46, 0.40, 0.32),
    (0.34, 0.33, 0.32),
    (0.42, 0.36, 0.30),
    (0.38, 0.38, 0.36),
)


def build(plan: Plan) -> Stage:
    """A third of the triangles for the hills, the rest for stones."""
    quads = max(int(np.sqrt(plan.triangles / 6)), 5)
    x, z = square_points(_SIDE_M, quads)
    meshes = [hills(_SIDE_M, quads, _height(plan, x, z), (0.34, 0.30, 0.20))]
    meshes += _stones(plan, int(0.6 * plan.triangles))
    eyes = np.array([(-34.0, 0.0, 44.0), (26.0, 0.0, 38.0), (-10.0, 0.0, 18.0)])
    heights = _height(plan, eyes[:, 0], eyes[:, 2]) + [14.0, 6.0, 4.0]
    middle = float(_height(plan, np.zeros(1), np.zeros(1))[0])
    vistas = tuple(
        ((float(x), float(y), float(z)), (0.0, middle + 1.0, -4.0))
        for x, y, z in zip(eyes[:, 0], heights, eyes[:, 2], strict=True)
    )
    return Stage(tuple(meshes), vistas=vistas)


def _height(plan: Plan, x: Array, z: Array) -> Array:
    rolling = 9.0 * noise(x / 60.0 + 9.0, z / 60.0 + 9.0, plan.draws("hills"), 5)
    ridge = noise(x / 40.0 + 20.0, z / 40.0 + 5.0, plan.draws("crags"), 3)
    crag = np.maximum(ridge - 0.1, 0.0)
    heights: Array = rolling + 40.0 * crag * np.sqrt(crag) * plan.by_crowding(0.5, 2.0)
    return heights


def _stones(plan: Plan, triangles: int) -> Iterator[Mesh]:
    count = max(min(round(plan.by_grain(8, 4000)), triangles // 12), 5)
    faces = max(int(np.sqrt(triangles / count / 12)), 1)
    divisions = min(faces, 60)
    draws = plan.draws("stones")
    share = draws.numbers(count)
    # Few are large, as in a scree.
    sizes = plan.by_grain(6.0, 0.9) * (0.25 + 1.5 * share * share * share)
    places = draws.points(count, (-0.42 * _SIDE_M,) * 2, (0.42 * _SIDE_M,) * 2)
    heights = _height(plan, places[:, 0], places[:, 1])
    at = np.stack([places[:, 0], heights + 0.2 * sizes, places[:, 1]], axis=1)
    turns = draws.turns(count)
    for kind in range(min(_KINDS, count)):
        wide, deep = draws.number(0.7, 1.2), draws.number(0.6, 1.0)
        shape = stone(
            (divisions,) * 3, (wide, draws.number(0.5, 0.9), deep), 0.25, seed=plan.spec.seed * 16 + kind
        )
        mine = slice(kind, None, _KINDS)
        yield placed(
            f"stones {kind + 1}", shape, _STONES[kind], placements(at[mine], turns[mine], sizes[mine])
        )
