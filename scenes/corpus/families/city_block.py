"""City block: towers over streets, few large shadows that reach far across one another."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, joined, placed

SUMMARY = "Towers with ledges and set-backs along streets: few large casters, long overlapping shadows."
INDOOR = False
TRIANGLES = (100, 1_000_000)
KINDS = (LightKind.DIRECTIONAL, LightKind.SPOT, LightKind.POINT)

_SIDE_M = 128.0
_STOREY_M = 3.5
_PAINTS: tuple[Color, ...] = ((0.60, 0.52, 0.42), (0.42, 0.20, 0.14), (0.36, 0.40, 0.44), (0.66, 0.64, 0.58))


def build(plan: Plan) -> Stage:
    """Lots in a square grid, streets between them, a tower on each."""
    side = min(round(plan.by_grain(2, 11)), max(int(np.sqrt(plan.triangles / 40)), 2))
    towers = _towers(plan, side)
    meshes = [ground(1.4 * _SIDE_M, 1.4 * _SIDE_M, (0.17, 0.17, 0.18), plan.triangles / 50)]
    meshes += _pavements(side)
    used = 12 * 3 * len(towers) + 14 * side * side
    details = _details(plan, towers, max((plan.triangles - used) // 12, 0))
    for number, paint in enumerate(_PAINTS):
        mine = towers[number :: len(_PAINTS)]
        if len(mine):
            meshes.append(placed(f"towers {number + 1}", joined(_tiers(mine)), paint))
    if len(details):
        meshes.append(placed("ledges and piers", boxes(details[:, 0], details[:, 1]), (0.50, 0.47, 0.42)))
    pitch = _SIDE_M / side
    low = -pitch / 2 if side % 2 == 0 else 0.0
    street = round(low / pitch) * pitch if side % 2 == 0 else pitch / 2
    vistas = (
        ((street - 0.7 * _SIDE_M, 34.0, street + 0.55 * _SIDE_M), (0.0, 6.0, 0.0)),
        ((street + 0.62 * _SIDE_M, 24.0, street + 0.62 * _SIDE_M), (0.0, 10.0, 0.0)),
        ((-0.75 * _SIDE_M, 52.0, -0.35 * _SIDE_M), (4.0, 0.0, 0.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _towers(plan: Plan, side: int) -> Array:
    """(n, 5) middle x and z, half width and depth, height."""
    pitch = _SIDE_M / side
    row, column = (index.ravel() for index in np.indices((side, side)))
    count = side * side
    draws = plan.draws("towers")
    share = plan.by_crowding(0.22, 0.36)
    half = pitch * draws.numbers(2 * count, 0.85 * share, 1.15 * share).reshape(count, 2)
    tall = draws.numbers(count)
    storeys = np.floor(3 + plan.by_crowding(6, 16) * tall * tall * (1 + pitch / 40))
    x, z = ((index - (side - 1) / 2) * pitch for index in (row, column))
    return np.stack([x, z, half[:, 0], half[:, 1], storeys * _STOREY_M], axis=1)


def _tiers(towers: Array) -> Iterator[Shell]:
    x, z, wide, deep, high = towers.T
    for low, top, inset in ((-0.25, 0.62, 0.0), (0.60, 0.9, 0.14), (0.88, 1.0, 0.3)):
        keep = 1.0 - inset
        first = np.stack([x - keep * wide, low * np.where(low < 0, 1.0, high), z - keep * deep], axis=1)
        last = np.stack([x + keep * wide, top * high, z + keep * deep], axis=1)
        yield boxes(first, last)


def _details(plan: Plan, towers: Array, count: int) -> Array:
    """(k, 2, 3) corners of at most `count` boxes: a ledge at each storey, then piers between windows."""
    found = [_ledges(towers)]
    if count > len(found[0]):
        found.append(_piers(plan, towers, count - len(found[0])))
    return np.concatenate(found)[:count]


def _ledges(towers: Array) -> Array:
    storeys = np.floor(0.6 * towers[:, 4] / _STOREY_M).astype(np.int64)
    owner = np.repeat(np.arange(len(towers)), storeys)
    level = np.arange(len(owner)) - np.repeat(np.cumsum(storeys) - storeys, storeys)
    x, z, wide, deep, _ = towers[owner].T
    height = (level + 1) * _STOREY_M
    low = np.stack([x - wide - 0.25, height - 0.1875, z - deep - 0.25], axis=1)
    high = np.stack([x + wide + 0.25, height + 0.1875, z + deep + 0.25], axis=1)
    return np.stack([low, high], axis=1)


def _piers(plan: Plan, towers: Array, count: int) -> Array:
    """Upright piers, one storey high each, spread over the four fronts of all towers by their area."""
    x, z, wide, deep, high = towers.T
    storeys = np.floor(0.6 * high / _STOREY_M)
    fronts = np.stack([wide, wide, deep, deep], axis=1) * storeys[:, None]
    steps = np.round(fronts.ravel() * 64).astype(np.int64)
    per_storey = np.maximum(count * steps // steps.sum() // np.repeat(storeys, 4).astype(np.int64), 1)
    per_front = per_storey * np.repeat(storeys, 4).astype(np.int64)
    front = np.repeat(np.arange(len(steps)), per_front)
    number = np.arange(len(front)) - np.repeat(np.cumsum(per_front) - per_front, per_front)
    level, place = number // per_storey[front], number % per_storey[front]
    tower, facing = front // 4, front % 4
    along = (2.0 * (place + 0.5) / per_storey[front]) - 1.0
    sideways = facing >= 2
    out = np.where(facing % 2 == 0, 1.0, -1.0)
    thick = np.minimum(0.1875, 0.3 * np.where(sideways, deep[tower], wide[tower]) / per_storey[front])
    middle_x = x[tower] + np.where(sideways, out, along) * wide[tower]
    middle_z = z[tower] + np.where(sideways, along, out) * deep[tower]
    half_x, half_z = np.where(sideways, 0.1875, thick), np.where(sideways, thick, 0.1875)
    low = np.stack([middle_x - half_x, level * _STOREY_M + 0.1875, middle_z - half_z], axis=1)
    high_corner = np.stack([middle_x + half_x, (level + 1) * _STOREY_M - 0.1875, middle_z + half_z], axis=1)
    order = plan.draws("piers").order(len(low))
    return np.stack([low, high_corner], axis=1)[order]


def _pavements(side: int) -> Iterator[Mesh]:
    pitch = _SIDE_M / side
    row, column = (index.ravel() for index in np.indices((side, side)))
    x, z = ((index - (side - 1) / 2) * pitch for index in (row, column))
    reach = 0.44 * pitch
    low = np.stack([x - reach, np.full_like(x, -0.125), z - reach], axis=1)
    high = np.stack([x + reach, np.full_like(x, 0.1875), z + reach], axis=1)
    yield placed("pavements", boxes(low, high), (0.40, 0.38, 0.35))
