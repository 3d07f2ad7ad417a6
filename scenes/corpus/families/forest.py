"""Forest: trees of closed wood and open leaf cards, thousands of small casters over one another."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import placements
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.parts_trees import BARK, LEAVES, leaf_cards, needle_tiers, trunk_and_limbs
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import placed

SUMMARY = "Leaf trees and firs on a forest floor: open cards, very many small overlapping casters."
INDOOR = False
TRIANGLES = (300, 1_000_000)
KINDS = (LightKind.DIRECTIONAL, LightKind.SPOT, LightKind.POINT)

_SIDE_M = 56.0
_KINDS = 4


def build(plan: Plan) -> Stage:
    """A clearing among trees: four kinds of them, each many times, turned and sized."""
    most = max(plan.triangles // 60, 3)
    count = min(round(plan.by_crowding(9, 90)), most)
    kinds = min(_KINDS, count)
    quads = max(int(np.sqrt(plan.triangles / 20)), 2)
    x, z = square_points(1.5 * _SIDE_M, quads)
    heights = 0.7 * noise(x / 18.0 + 8.0, z / 18.0 + 8.0, plan.draws("ground"), 3)
    meshes = [hills(1.5 * _SIDE_M, quads, heights, (0.24, 0.21, 0.10))]
    each = int(0.9 * plan.triangles / count)
    places = _places(plan, count)
    turns = plan.draws("turns").turns(count)
    sizes = plan.draws("sizes").numbers(count, 0.75, 1.3)
    for kind in range(kinds):
        mine = slice(kind, None, kinds)
        matrices = placements(places[mine], turns[mine], sizes[mine])
        meshes += _tree(plan, kind, each, matrices)
    vistas = (
        ((1.0, 2.25, 21.0), (0.0, 3.0, 0.0)),
        ((-27.0, 10.0, 33.0), (0.0, 2.0, -2.0)),
        ((4.0, 1.75, 8.0), (-3.0, 2.5, -8.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _places(plan: Plan, count: int) -> Array:
    """Places far from one another and off the path down the middle, where the eyes are."""
    side = int(np.sqrt(3 * count)) + 2
    row, column = (index.ravel() for index in np.indices((side, side)))
    draws = plan.draws("places")
    x = (row + 0.25 + draws.numbers(len(row), 0.0, 0.5)) / side - 0.5
    z = (column + 0.25 + draws.numbers(len(row), 0.0, 0.5)) / side - 0.5
    clear = (np.abs(x) * _SIDE_M < 2.5) & (z > -0.1)
    order = draws.order(len(row))
    order = order[np.argsort(clear[order], kind="stable")][:count]
    return np.stack([_SIDE_M * x[order], np.full(count, -0.5), _SIDE_M * z[order]], axis=1)


def _tree(plan: Plan, kind: int, triangles: int, matrices: Array) -> Iterator[Mesh]:
    draws = plan.draws("kind", kind)
    height = draws.number(8.0, 12.0)
    if kind == 3:
        sides = 5 if triangles < 200 else 8 if triangles < 2000 else 16
        tiers = max(min((triangles - 50) // (4 * sides - 4), 400), 3)
        wood, _ = trunk_and_limbs(draws, height, 0, 4)
        yield placed("fir trunks", wood, BARK, matrices)
        yield placed("firs", needle_tiers(height, tiers, sides), LEAVES[2], matrices)
        return
    limbs = max(min((triangles - 50) // 60, 40), 2)
    wood, tips = trunk_and_limbs(draws, height, limbs, 4 if triangles < 500 else 8)
    leaves = max((triangles - len(wood.triangles)) // 2, 4)
    area = 0.5 * height * height * plan.by_grain(0.6, 1.6)
    yield placed(f"wood {kind + 1}", wood, BARK, matrices)
    crown = leaf_cards(draws.of("leaves"), tips, leaves, 0.16 * height, area)
    yield placed(f"leaves {kind + 1}", crown, LEAVES[kind], matrices)
