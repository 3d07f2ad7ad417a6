"""Lattice ceiling: light from above through crossing bars and leaves, a floor full of shadow edges."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, rods
from scenes.corpus.parts_ground import ground
from scenes.corpus.parts_trees import leaf_cards
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind, Mesh
from scenes.solids import Color, Shell, cells, joined, placed

SUMMARY = "A courtyard under a pergola in layers: light through a complex ceiling, shadow edges everywhere."
INDOOR = True
TRIANGLES = (800, 1_000_000)
KINDS = (LightKind.DIRECTIONAL, LightKind.SPOT, LightKind.POINT)

_HALF, _TALL = 9.0, 5.0
_OAK: Color = (0.36, 0.22, 0.12)


def build(plan: Plan) -> Stage:
    """Layers of bars in two directions, as many and as fine as there are triangles."""
    layers = max(round(plan.by_crowding(1, 5)), 1)
    vines = max(int(0.2 * plan.triangles) // 2, 6)
    bars = max(int(0.55 * plan.triangles) // (12 * 2 * layers), 2)
    bars = min(bars, round(plan.by_grain(12, 260)))
    meshes = [
        ground(2 * _HALF + 4, 2 * _HALF + 4, (0.52, 0.47, 0.40), plan.triangles / 12),
        placed("walls", _walls(), (0.64, 0.56, 0.44)),
        placed("lattice", joined(_lattice(plan, layers, bars)), _OAK),
        placed("posts", joined(_posts()), _OAK),
        placed("basin", joined(_basin()), (0.50, 0.49, 0.46)),
    ]
    meshes += _benches_and_vines(plan, vines)
    vistas = (
        ((-7.5, 2.5, 7.5), (1.0, 0.75, -1.0)),
        ((7.0, 1.75, 7.5), (-2.0, 0.5, -1.0)),
        ((0.0, 3.5, 8.25), (0.0, 0.0, 0.0)),
    )
    room = ((-_HALF + 0.25, 0.25, -_HALF + 0.25), (_HALF - 0.25, _TALL - 0.5, _HALF - 0.25))
    lamps = ((-0.6 * _HALF, _TALL + 3.0, -0.6 * _HALF), (0.6 * _HALF, _TALL + 14.0, 0.6 * _HALF))
    return Stage(tuple(meshes), start=(-7.5, 2.5, 7.5), room=room, lamps=lamps, vistas=vistas)


def _walls() -> Shell:
    x = [-_HALF - 0.5, -_HALF, -3.0, 3.0, _HALF, _HALF + 0.5]
    filled = np.ones((5, 3, 5), dtype=bool)
    filled[1:-1, :, 1:-1] = False
    filled[2, 1, 0] = filled[2, 0, 0] = False
    filled[0, 1, 2] = filled[-1, 1, 2] = False
    return cells(x, [-0.25, 1.25, 3.25, _TALL], x, filled)


def _lattice(plan: Plan, layers: int, bars: int) -> Iterator[Shell]:
    pitch = 2 * (_HALF + 0.5) / bars
    half = min(0.2 * pitch / layers, 0.09)
    deep = min(2.0 * half, 0.15)
    at = (np.arange(bars) + 0.5) * pitch - _HALF - 0.5
    draws = plan.draws("lattice")
    for layer in range(layers):
        shift = draws.number(-0.4, 0.4) * pitch
        low = _TALL - 0.375 + 0.45 * layer
        for axis in (0, 2):
            first = np.full((bars, 3), -_HALF - 0.5)
            last = np.full((bars, 3), _HALF + 0.5)
            first[:, axis], last[:, axis] = at + shift - half, at + shift + half
            first[:, 1] = low + (0.17 if axis else 0.0)
            last[:, 1] = first[:, 1] + deep
            yield boxes(first, last)


def _posts() -> Iterator[Shell]:
    feet = np.array([(x, 0.0, z) for x in (-4.5, 4.5) for z in (-4.5, 0.0, 4.5)])
    yield boxes(feet - [0.15, 0.125, 0.15], feet + [0.15, _TALL - 0.375, 0.15])
    yield boxes(
        [(x - 0.12, _TALL - 0.65, -_HALF - 0.25) for x in (-4.5, 4.5)],
        [(x + 0.12, _TALL - 0.375, _HALF + 0.25) for x in (-4.5, 4.5)],
    )


def _basin() -> Iterator[Shell]:
    x = [-1.75, -1.5, 1.5, 1.75]
    filled = np.ones((3, 2, 3), dtype=bool)
    filled[1, 1, 1] = False
    yield cells(x, [-0.125, 0.125, 0.5], x, filled)
    yield boxes([(-0.25, 0.0, -0.25), (-0.5, 1.0, -0.5)], [(0.25, 1.125, 0.25), (0.5, 1.25, 0.5)])


def _benches_and_vines(plan: Plan, leaves: int) -> Iterator[Mesh]:
    low = np.array([(-7.0, 0.4, -4.0), (6.0, 0.4, -4.0), (-4.0, 0.4, -7.5)])
    size = np.array([(1.0, 0.1, 5.0), (1.0, 0.1, 5.0), (8.0, 0.1, 1.0)])
    yield placed(
        "benches",
        joined(
            [
                boxes(low, low + size),
                boxes(low + 0.1 * size - [0.0, 0.41, 0.0], low + 0.9 * size - [0.0, 0.05, 0.0]),
            ]
        ),
        _OAK,
    )
    draws = plan.draws("vines")
    feet = np.array([(x, 0.0, z) for x in (-4.5, 4.5) for z in (-4.5, 4.5)])
    heads = feet + [0.2, _TALL, 0.2]
    yield placed("stems", rods(feet + 0.18, heads, 0.04, 0.02, 4), (0.16, 0.12, 0.06))
    tips = np.concatenate([heads + [0.0, 0.25, 0.0], heads * 0.6 + [0.0, 2.25, 0.0], heads - [0.0, 1.5, 0.0]])
    yield placed("vines", leaf_cards(draws, tips, leaves, 2.0, 14.0), (0.14, 0.28, 0.06))
