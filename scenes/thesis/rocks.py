"""Rocks: five stone circles with lintels, many triangles whose shadows hardly overlap."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians

from scenes.scene import Array, Mesh, Scene
from scenes.solids import Color, Point, Shell, joined, moved, placed, turned
from scenes.thesis.skinned_solids import circle, stone
from scenes.thesis.staging import camera, floor, spot

GRASS: Color = (0.30, 0.31, 0.13)
UPRIGHTS = 10
LINTELS = (0, 1, 2, 4, 5, 7, 8)

_RADIUS_M = 3.75
_UPRIGHT_M: Point = (0.5625, 1.5, 0.3125)
_LINTEL_M: Point = (1.28125, 0.25, 0.375)
# Each copy: where it stands, and the cosine and sine of its turn, from right-angled triangles.
_COPIES: tuple[tuple[Point, float, float, Color], ...] = (
    ((-5.0, 0.0, 7.0), 1.0, 0.0, (0.46, 0.44, 0.40)),
    ((7.0, 0.0, 0.0), 0.6, 0.8, (0.44, 0.43, 0.41)),
    ((-1.0, 0.0, -15.0), 0.8, -0.6, (0.48, 0.45, 0.39)),
    ((17.0, 0.0, 29.0), -5 / 13, 12 / 13, (0.45, 0.44, 0.42)),
    ((-22.0, 0.0, 14.0), -12 / 13, -5 / 13, (0.43, 0.42, 0.40)),
)


def rocks() -> Scene:
    """63,000 triangles: five copies of 12,600.

    As in figure 46b three of them are in view and the light is to the right. The cut-off of 40 degrees holds
    those three; the thesis gives no number.
    """
    light = spot("Spot to the right", (28.0, 11.0, 9.0), (-2.0, 0.0, -2.0), radians(40.0))
    view = camera("Three circles", (1.0, 8.0, 22.5), (-0.75, 0.0, 1.0), 0.875)
    return Scene("Rocks", (floor(75.0, 75.0, GRASS), *_circles()), (light,), (view,))


def _circles() -> Iterator[Mesh]:
    shape = joined([*_standing(), *_lying()])
    for number, (place, cosine, sine, color) in enumerate(_COPIES, start=1):
        yield placed(f"stones {number}", moved(turned(shape, cosine, sine), place), color)


def _standing() -> Iterator[Shell]:
    """Uprights around the circle, and lintels on some pairs of them."""
    spokes = circle(2 * UPRIGHTS)
    for number in range(UPRIGHTS):
        upright = stone((5, 13, 4), _UPRIGHT_M, 0.15625, seed=10 * number)
        yield _around(upright, spokes[2 * number], _RADIUS_M, 1.3125)
    for number in LINTELS:
        lintel = stone((14, 4, 5), _LINTEL_M, 0.125, seed=200 + 10 * number)
        yield _around(lintel, spokes[2 * number + 1], 0.953125 * _RADIUS_M, 2.9375)


def _lying() -> Iterator[Shell]:
    """An altar, two lintels that fell, and boulders."""
    yield moved(stone((9, 3, 6), (1.0, 0.25, 0.5), 0.125, seed=300), (0.0, 0.125, 0.0))
    lintel = stone((14, 4, 5), _LINTEL_M, 0.125, seed=310)
    yield moved(turned(lintel, 0.28, 0.96), (2.0, 0.125, 1.75))
    lintel = stone((14, 4, 5), _LINTEL_M, 0.125, seed=320)
    yield moved(turned(lintel, 0.8, 0.6), (-4.75, 0.125, 2.75))
    boulders: tuple[tuple[tuple[int, int, int], float, Point], ...] = (
        ((6, 4, 4), 0.3125, (-1.5, 0.125, 1.75)),
        ((6, 6, 6), 0.4375, (4.75, 0.25, 3.25)),
        ((7, 7, 7), 0.5625, (-4.25, 0.25, -4.0)),
        ((4, 4, 4), 0.25, (0.75, 0.125, 4.5)),
    )
    for number, (divisions, size, place) in enumerate(boulders):
        half = (1.25 * size, 0.875 * size, size)
        yield moved(stone(divisions, half, 0.5 * size, seed=400 + 10 * number), place)


def _around(part: Shell, spoke: Array, radius: float, height: float) -> Shell:
    """The part, its x side along the circle, on one of its spokes."""
    cosine, sine = spoke.tolist()
    return moved(turned(part, sine, cosine), (radius * cosine, height, radius * sine))
