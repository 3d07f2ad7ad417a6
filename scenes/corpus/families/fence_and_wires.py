"""Fence and wires: posts, pickets, chain link and overhead lines, thinner than a texel."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, rods
from scenes.corpus.parts_arches import chain, sagging
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind, Mesh
from scenes.solids import Color, Shell, cards, joined, placed

SUMMARY = "A yard behind pickets and chain link, under overhead lines: casters thinner than a texel."
INDOOR = False
TRIANGLES = (1_200, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.POINT, LightKind.DIRECTIONAL)

_HALF_M = 12.0
_POLES_X = (-15.0, 0.0, 15.0)
_STEEL: Color = (0.14, 0.15, 0.16)
_TIMBER: Color = (0.30, 0.20, 0.12)
_PAINT: Color = (0.70, 0.68, 0.62)


def build(plan: Plan) -> Stage:
    """Three rows of poles with lines; a picket fence in front, a chain-link fence around the rest."""
    pieces = max(min(plan.triangles // 400, 24), 3)
    lines = min(round(plan.by_crowding(3, 24)), max(plan.triangles // (60 * pieces), 1))
    rest = plan.triangles - 12 * 2 * pieces * lines - 300
    pickets = max(min(rest // 12, round(plan.by_grain(60, 400))), 12)
    meshes = [
        ground(44.0, 34.0, (0.33, 0.30, 0.20), plan.triangles / 40),
        placed("poles", joined(_poles()), _TIMBER),
        placed("lines", _lines(plan, lines, pieces), _STEEL),
        placed("pickets", _pickets(plan, pickets), _PAINT),
        placed("rails", _rails(), _PAINT),
        placed("shed", joined(_shed()), (0.42, 0.18, 0.12)),
    ]
    meshes += _chain_link(max(rest - 6 * pickets, 96))
    vistas = (
        ((7.0, 3.25, 17.0), (-1.0, 1.0, 4.0)),
        ((-9.0, 2.0, 14.0), (1.0, 0.75, 7.0)),
        ((17.0, 8.0, 15.0), (0.0, 1.0, 0.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _poles() -> Iterator[Shell]:
    for z in (-3.0, 10.5):
        foot = np.array([(x, -0.25, z) for x in _POLES_X])
        yield rods(foot, foot + [0.0, 7.5, 0.0], 0.14, 0.09, 8)
        for height in (6.25, 7.0):
            yield boxes(foot + [-0.06, height, -1.25], foot + [0.06, height + 0.125, 1.25])


def _lines(plan: Plan, count: int, pieces: int) -> Shell:
    x = np.array(_POLES_X)
    number = np.arange(count)
    row = np.array([-3.0, 10.5])[number % 2]
    z = row + (number // 2 % 5 - 2) * 0.5
    y = np.array([6.5, 7.25])[number // 10 % 2] + 0.0625 * (number // 20)
    start = np.stack([np.repeat(x[:-1], count), np.tile(y, 2), np.tile(z, 2)], axis=1)
    end = start + [x[1] - x[0], 0.0, 0.0]
    sag = plan.draws("sag").numbers(2 * count, 0.4, 0.9)
    return chain(sagging(start, end, sag, pieces), 0.015625)


def _pickets(plan: Plan, count: int) -> Shell:
    """Half of them boards with a thickness, half single sheets."""
    solid = count // 2
    x = (np.arange(count) + 0.5) / count * 2 * _HALF_M - _HALF_M
    wide = np.minimum(0.09, 0.32 * 2 * _HALF_M / count)
    tall = 1.0 + 0.25 * plan.draws("pickets").numbers(count)
    z = np.full(count, 9.0)
    low = np.stack([x - wide, np.full(count, 0.0625), z - 0.0156], axis=1)
    high = np.stack([x + wide, tall, z + 0.0156], axis=1)
    corner = np.stack([x - wide, np.full(count, 0.0625), z], axis=1)[solid:]
    along = np.broadcast_to([2 * wide, 0.0, 0.0], corner.shape)
    up = np.stack([0 * x, tall - 0.0625, 0 * x], axis=1)[solid:]
    return joined([boxes(low[:solid], high[:solid]), cards(corner, along, up)])


def _rails() -> Shell:
    low = np.array([(-_HALF_M, 0.3, 8.9), (-_HALF_M, 0.85, 8.9)])
    return boxes(low, low + [2 * _HALF_M, 0.08, 0.07])


def _chain_link(triangles: int) -> Iterator[Mesh]:
    """Crossing wires in panels along three sides."""
    posts = np.array(
        [(x, -0.125, -10.0) for x in np.arange(-12.0, 12.5, 3.0)]
        + [(x, -0.125, z) for x in (-12.0, 12.0) for z in np.arange(-7.0, 9.0, 3.0)]
    )
    yield placed("steel posts", rods(posts, posts + [0.0, 2.5, 0.0], 0.04, None, 5), _STEEL)
    count = max(triangles // 24 // 3, 4)
    tall = 2.125
    for name, corner, way in (
        ("back", (-12.0, 0.125, -10.0), (24.0, 0.0, 0.0)),
        ("left", (-12.0, 0.125, -10.0), (0.0, 0.0, 18.0)),
        ("right", (12.0, 0.125, -10.0), (0.0, 0.0, 18.0)),
    ):
        length = max(way)
        begin = (np.arange(count) + 0.5) / count * (length + tall) - tall
        first, last = np.maximum(begin, 0.0), np.minimum(begin + tall, length)
        level = np.array(way) / length
        foot, head = (np.array(corner) + along[:, None] * level for along in (first, last))
        up = [0.0, 1.0, 0.0] * (first - begin)[:, None], [0.0, 1.0, 0.0] * (last - begin)[:, None]
        top = np.array([0.0, tall, 0.0])
        starts = np.concatenate([foot + up[0], foot + top - up[0]])
        ends = np.concatenate([head + up[1], head + top - up[1]])
        yield placed(f"chain link {name}", rods(starts, ends, 0.0078125, None, 4), _STEEL)


def _shed() -> Iterator[Shell]:
    yield boxes([(-6.0, -0.125, -6.0)], [(-1.0, 2.5, -2.5)])
    yield boxes([(-6.25, 2.5, -6.25)], [(-0.75, 2.6875, -2.25)])
    yield boxes(
        [(3.0, -0.125, -5.0), (4.0, -0.125, -4.0), (5.5, -0.125, -5.5)],
        [(3.9, 0.9, -4.1), (5.0, 0.9, -3.0), (6.6, 1.2, -4.4)],
    )
