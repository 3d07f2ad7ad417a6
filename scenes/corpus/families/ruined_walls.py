"""Ruined walls: what is left of an abbey, broken masonry, arches without roofs, fallen blocks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies
from scenes.corpus.parts_arches import chain, round_arch
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, placed
from scenes.thesis.skinned_solids import turned_solid

SUMMARY = (
    "Roofless walls of single blocks with ragged tops and arches, rubble around: blocks touching blocks."
)
INDOOR = False
TRIANGLES = (1_500, 1_000_000)
KINDS = (LightKind.DIRECTIONAL, LightKind.SPOT, LightKind.POINT)

_STONE: Color = (0.50, 0.46, 0.38)
_PALE: Color = (0.58, 0.54, 0.46)
_LONG, _WIDE, _TALL = 26.0, 12.0, 8.0
# Where each wall begins, and its way; its height as a share of the whole.
_WALLS = (
    ((-13.0, -6.0), (26.0, 0.0), 1.0),
    ((13.0, -6.0), (0.0, 12.0), 1.0),
    ((-13.0, 6.0), (18.0, 0.0), 0.55),
    ((-13.0, -6.0), (0.0, 12.0), 0.7),
    ((0.0, -16.0), (0.0, 10.0), 0.5),
    ((13.0, 6.0), (9.0, 0.0), 0.35),
)


def build(plan: Plan) -> Stage:
    """Blocks by grain; where the noise is high the wall is gone."""
    quads = max(int(np.sqrt(plan.triangles / 16)), 6)
    x, z = square_points(80.0, quads)
    heights = 0.35 * noise(x / 12.0 + 9.0, z / 12.0 + 9.0, plan.draws("lawn"), 3)
    meshes = [hills(80.0, quads, heights, (0.28, 0.32, 0.14))]
    segments = max(min(plan.triangles // 900, 24), 5)
    columns = max(min(plan.triangles // 900, 32), 6)
    meshes.append(placed("columns", _columns(plan, columns), _PALE))
    meshes.append(placed("arches", _arches(plan, segments), _PALE))
    left = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    rubble = max(int(0.15 * left) // 12, 6)
    meshes += _masonry(plan, max(left // 12 - rubble, 40))
    meshes.append(placed("rubble", _rubble(plan, rubble), _STONE))
    vistas = (
        ((-17.0, 4.5, 16.0), (0.0, 1.5, -1.0)),
        ((-9.5, 1.8, 4.0), (6.0, 2.0, -2.5)),
        ((18.0, 11.0, 20.0), (0.0, 1.0, -1.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _masonry(plan: Plan, blocks: int) -> Iterator[Mesh]:
    """Courses of blocks, every other one shifted by half a block."""
    area = sum((abs(way[0]) + abs(way[1])) * _TALL * 0.7 * share for _, way, share in _WALLS)
    block = float(np.sqrt(area / min(blocks, round(plan.by_grain(250, 60_000))) / 2.0)) * 0.92
    rows = max(int(_TALL / block), 3)
    tall = _TALL / rows
    for number, (start, way, share) in enumerate(_WALLS):
        length = abs(way[0]) + abs(way[1])
        across = max(int(length / (2 * block)), 3)
        row, place = (part.ravel() for part in np.indices((rows, across)))
        wide = length / across
        first = np.maximum((place - 0.5 * (row % 2)) * wide, 0.0)
        last = np.minimum((place - 0.5 * (row % 2) + 1.0) * wide, length)
        middle = (first + last) / 2
        draws = plan.draws("wall", number)
        ragged = noise(middle / 6.0 + 5.0, 0.0 * middle + 3.5, draws, 4)
        top = share * _TALL * (0.78 + plan.by_crowding(0.9, 0.35) * ragged)
        bays = np.abs(middle / 4.4 - np.floor(middle / 4.4) - 0.5) * 4.4
        height = (row + 0.5) * tall
        window = (bays < 0.75) & (height > 0.22 * _TALL) & (height < 0.6 * _TALL) & (length > 11.0)
        kept = (height < top) & ~window
        loose = 0.04 * draws.of("loose").numbers(len(row), -1.0, 1.0)
        blocks_of = _blocks(
            start, way, first[kept], last[kept], row[kept].astype(np.float64) * tall, tall, loose[kept]
        )
        if kept.any():
            yield placed(f"wall {number + 1}", boxes(*blocks_of), _STONE)


def _blocks(
    start: tuple[float, float],
    way: tuple[float, float],
    first: Array,
    last: Array,
    low: Array,
    tall: float,
    loose: Array,
) -> tuple[Array, Array]:
    along = way[0] != 0.0
    joint = 0.012
    u0, u1 = first + joint, last - joint
    v0, v1 = np.full_like(u0, -0.4) + loose, np.full_like(u0, 0.4) + loose
    x0, x1, z0, z1 = (u0, u1, v0, v1) if along else (v0, v1, u0, u1)
    bottom = np.where(low == 0.0, -0.4, low + joint)
    return (
        np.stack([start[0] + x0, bottom, start[1] + z0], axis=1),
        np.stack([start[0] + x1, low + tall - joint, start[1] + z1], axis=1),
    )


def _columns(plan: Plan, sides: int) -> Shell:
    """Two rows of columns, broken off at random heights."""
    spots = np.array([(x, -0.3, z) for x in (-9.0, -4.6, -0.2, 4.2, 8.6) for z in (-2.2, 2.2)])
    profile = [(0.62, 0.0), (0.62, 0.5), (0.42, 0.65), (0.4, 4.6), (0.6, 4.9), (0.6, 5.1)]
    height = plan.draws("columns").numbers(len(spots), 0.2, 1.3)
    sizes = np.stack([np.ones(len(spots)), np.minimum(height, 1.0), np.ones(len(spots))], axis=1)
    return copies(turned_solid(profile, sides), spots, None, sizes)


def _arches(plan: Plan, segments: int) -> Shell:
    """Arches that still stand: along the nave, and one great one across it."""
    feet = np.array([(-9.0, 4.7, -2.2), (-0.2, 4.7, -2.2), (4.2, 4.7, 2.2)])
    keep = plan.draws("arches").order(3)[: 1 + plan.spec.seed % 3]
    small = round_arch(feet[keep], (4.4, 0.0, 0.0), 2.2, segments)
    great = round_arch([(12.4, 3.5, -4.5)], (0.0, 0.0, 9.0), 4.5, segments)
    parts = np.concatenate([small, great])
    return chain(parts, 0.3)


def _rubble(plan: Plan, count: int) -> Shell:
    draws = plan.draws("rubble")
    wall = draws.below(count, len(_WALLS))
    starts = np.array([start for start, _, _ in _WALLS])[wall]
    ways = np.array([way for _, way, _ in _WALLS])[wall]
    share, out = draws.numbers(count)[:, None], draws.points(count, (-1.0, -1.0), (1.0, 1.0))
    at = starts + share * ways + 2.6 * out * np.abs(out)
    size = (
        0.45 * draws.numbers(count, 0.25, 1.0) * min(1.0, float(np.sqrt(np.sqrt(120.0 / (count + 1)))) + 0.2)
    )
    cube = boxes([(-0.5, -0.35, -0.4)], [(0.5, 0.35, 0.4)])
    places = np.stack([at[:, 0], 0.2 * size, at[:, 1]], axis=1)
    return copies(cube, places, draws.turns(count), size)
