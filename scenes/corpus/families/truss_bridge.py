"""Truss bridge: a river between banks, crossed on trusses whose bars cast nets of thin shadows."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from scenes.corpus.copies import boxes, rods
from scenes.corpus.parts_frames import plane_truss
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind
from scenes.solids import Color, Shell, joined, placed
from scenes.thesis.skinned_solids import turned_solid

SUMMARY = "A railway bridge of trusses over a valley: nets of thin bars, shadows far below what casts them."
INDOOR = False
TRIANGLES = (1_500, 1_000_000)
KINDS = (LightKind.DIRECTIONAL, LightKind.SPOT, LightKind.POINT)

_HALF_M, _DECK_M, _WIDE_M, _TALL_M = 48.0, 16.0, 6.0, 8.0
_RED: Color = (0.42, 0.12, 0.07)
_STONE: Color = (0.48, 0.45, 0.40)
_WOOD: Color = (0.24, 0.17, 0.11)


def build(plan: Plan) -> Stage:
    """Spans between piers; more triangles make more panels, lacing, sleepers and rivets."""
    spans = round(plan.by_crowding(2, 5))
    quads = max(int(np.sqrt(plan.triangles / 10)), 8)
    x, z = square_points(150.0, quads)
    meshes = [
        hills(150.0, quads, _valley(plan, x, z), (0.30, 0.32, 0.16)),
        placed("piers", joined(_piers(spans, plan.triangles)), _STONE),
        placed("deck", joined(_deck()), _WOOD),
    ]
    left = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    panels = max(min(left // (spans * 160), round(plan.by_grain(6, 40))), 3)
    trusses = joined(_trusses(spans, panels))
    meshes.append(placed("trusses", trusses, _RED))
    left -= len(trusses.triangles)
    if left > 1200:
        meshes.append(placed("sleepers and rails", joined(_track(max(min(left // 24, 220), 20))), _WOOD))
        left -= 24 * 220
    if left > 4000:
        meshes.append(placed("lacing", _lacing(left), _RED))
    vistas = (
        ((-26.0, 7.0, 34.0), (4.0, 11.0, 0.0)),
        ((-44.0, _DECK_M + 2.8, 0.5), (0.0, _DECK_M + 1.0, -0.25)),
        ((20.0, 34.0, 40.0), (0.0, 6.0, -4.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _valley(plan: Plan, x: Array, z: Array) -> Array:
    """Banks that the deck ends on, and a river bed between them."""
    share = np.minimum(np.abs(x) / 52.0, 1.0)
    slope = share * share * share * (4.0 - 3.0 * share)
    bumps = noise(x / 26.0 + 9.0, z / 26.0 + 9.0, plan.draws("valley"), 4)
    rough = np.minimum(np.abs(z) / 12.0 + 0.15, 1.0)
    return slope * (_DECK_M - 1.25) + 3.0 * bumps * rough * (0.35 + 0.65 * (1.0 - share))


def _piers(spans: int, triangles: int) -> Iterator[Shell]:
    sides = 8 if triangles < 20_000 else 24
    for number in range(1, spans):
        x = (2 * number / spans - 1) * _HALF_M
        for z in (-0.5 * _WIDE_M, 0.5 * _WIDE_M):
            yield turned_solid(
                [(2.2, -6.0), (1.5, 4.0), (1.25, _DECK_M - 2.0), (1.7, _DECK_M - 1.5), (1.7, _DECK_M - 0.75)],
                sides,
                (x, 0.0, z),
            )
        yield boxes([(x - 1.0, _DECK_M - 4.0, -0.5 * _WIDE_M)], [(x + 1.0, _DECK_M - 2.0, 0.5 * _WIDE_M)])
    for side in (-1.0, 1.0):
        low, high = sorted((side * (_HALF_M - 1.5), side * (_HALF_M + 12.0)))
        yield boxes([(low, -2.0, -0.65 * _WIDE_M)], [(high, _DECK_M - 0.75, 0.65 * _WIDE_M)])


def _deck() -> Iterator[Shell]:
    for z in (-0.4 * _WIDE_M, 0.4 * _WIDE_M):
        yield boxes([(-_HALF_M - 10, _DECK_M - 0.75, z - 0.3)], [(_HALF_M + 10, _DECK_M - 0.25, z + 0.3)])


def _trusses(spans: int, panels: int) -> Iterator[Shell]:
    edges = (np.arange(spans + 1) / spans * 2 - 1) * _HALF_M
    for z in (-0.5 * _WIDE_M, 0.5 * _WIDE_M):
        starts = np.stack([edges[:-1] + 0.5, np.full(spans, _DECK_M - 0.75), np.full(spans, z)], axis=1)
        ends = np.stack([edges[1:] - 0.5, np.full(spans, _DECK_M - 0.75), np.full(spans, z)], axis=1)
        yield plane_truss(starts, ends, _TALL_M, panels, 0.22)
    x = np.concatenate(
        [
            low + 0.5 + (np.arange(panels + 1) / panels) * (high - low - 1.0)
            for low, high in pairwise(edges.tolist())
        ]
    )
    for height in (_DECK_M - 0.75, _DECK_M - 0.75 + _TALL_M):
        here = np.stack([x, np.full_like(x, height), np.full_like(x, -0.5 * _WIDE_M)], axis=1)
        yield rods(here, here + [0.0, 0.0, _WIDE_M], 0.14, None, 4)
    cross = here.reshape(spans, panels + 1, 3)
    yield rods(
        cross[:, :-1].reshape(-1, 3), (cross[:, 1:] + [0.0, 0.0, _WIDE_M]).reshape(-1, 3), 0.08, None, 4
    )


def _track(sleepers: int) -> Iterator[Shell]:
    x = (np.arange(sleepers) + 0.5) / sleepers * 2 * (_HALF_M + 9) - _HALF_M - 9
    low = np.stack([x - 0.12, np.full_like(x, _DECK_M - 0.25), np.full_like(x, -1.6)], axis=1)
    yield boxes(low, low + [0.24, 0.2, 3.2])
    yield boxes(
        [(-_HALF_M - 9, _DECK_M - 0.06, z - 0.04) for z in (-0.75, 0.75)],
        [(_HALF_M + 9, _DECK_M + 0.12, z + 0.04) for z in (-0.75, 0.75)],
    )


def _lacing(triangles: int) -> Shell:
    """Zigzags of flat bars along the chords, as on old bridges."""
    count = max(triangles // 12 // 4, 8)
    share = np.arange(count + 1) / count
    x = (share * 2 - 1) * (_HALF_M - 0.75)
    up = np.where(np.arange(count + 1) % 2 == 0, 0.3, 0.7)
    parts = []
    for height in (_DECK_M - 0.75, _DECK_M - 0.75 + _TALL_M - 1.0):
        for z in (-0.5 * _WIDE_M, 0.5 * _WIDE_M):
            line = np.stack([x, height + up, np.full_like(x, z)], axis=1)
            parts.append(rods(line[:-1], line[1:], min(0.04, 12.0 / count), None, 4))
    return joined(parts)
