"""What stands in the thesis' room."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from scenes.scene import Mesh
from scenes.solids import Color, Point, Shell, box, cells, joined, moved, placed, turned
from scenes.thesis.skinned_solids import bar, hoop, rod, turned_solid

OAK: Color = (0.38, 0.22, 0.10)
WALNUT: Color = (0.20, 0.11, 0.06)
MARBLE: Color = (0.72, 0.70, 0.66)
CHINA: Color = (0.60, 0.66, 0.72)
BRASS: Color = (0.50, 0.36, 0.12)
CLOTH: Color = (0.36, 0.07, 0.07)

_TABLE: Point = (-0.5, 0.0, -0.75)
# Each chair: where it stands, and the cosine and sine of its turn. Unturned, its back is towards -Z.
_CHAIRS: tuple[tuple[float, float, float, float], ...] = (
    (-1.5, -1.75, 1.0, 0.0),
    (-0.375, -1.8125, 1.0, 0.0),
    (0.75, -1.6875, 0.96, 0.28),
    (-1.4375, 0.3125, -1.0, 0.0),
    (0.625, 0.25, -1.0, 0.0),
    (-2.75, -0.5625, 0.28, 0.96),
)
_BOOK_COLORS: tuple[Color, ...] = ((0.30, 0.08, 0.06), (0.08, 0.16, 0.24), (0.10, 0.20, 0.10))
_SHELF_TOPS_M = (0.1875, 0.6875, 1.1875, 1.6875, 2.1875)
_BOOKS_PER_SHELF = 30


def furniture() -> Iterator[Mesh]:
    """Everything but the walls."""
    yield placed("dining table", joined(_table()), OAK)
    for number, (x, z, cosine, sine) in enumerate(_CHAIRS, start=1):
        yield placed(f"chair {number}", moved(turned(joined(_chair()), cosine, sine), (x, 0.0, z)), WALNUT)
    yield placed("tableware", moved(joined(_tableware()), (_TABLE[0], 0.78125, _TABLE[2])), CHINA)
    yield placed("chandelier", joined(_chandelier()), BRASS)
    yield placed("columns", joined(_columns()), MARBLE)
    yield placed("bookcases", joined(_bookcases()), WALNUT)
    for number, color in enumerate(_BOOK_COLORS):
        yield placed(f"books {number + 1}", joined(_books(number)), color)
    yield placed("screen", joined(_screen()), WALNUT)
    yield placed("armchair", moved(turned(joined(_armchair()), 0.6, 0.8), (-4.25, 0.0, 0.25)), CLOTH)
    yield placed("rug", box((-3.5, -0.03125, -2.75), (2.5, 0.015625, 1.25)), CLOTH)
    yield placed("side table", moved(joined(_side_table()), (-2.25, 0.0, 2.25)), OAK)
    yield placed("wardrobe", joined(_wardrobe()), WALNUT)
    yield placed("curtain rods", joined(_curtain_rods()), BRASS)
    yield placed("pictures", joined(_pictures()), BRASS)


def _turned_leg(height: float, radius: float, sides: int) -> Shell:
    """A leg as turners make it: foot, vase, ring, square-looking head."""
    outline = [(0.5, 0.0), (0.75, 0.03), (0.625, 0.1), (1.0, 0.3), (0.875, 0.5), (0.5, 0.625)]
    outline += [(0.9375, 0.6875), (0.5, 0.75), (1.0, 0.8125), (1.0, 1.0)]
    return turned_solid([(radius * wide, height * high) for wide, high in outline], sides)


def _table() -> Iterator[Shell]:
    x, _, z = _TABLE
    yield box((x - 1.625, 0.71875, z - 0.6875), (x + 1.625, 0.78125, z + 0.6875))
    yield box((x - 1.4375, 0.59375, z - 0.5), (x + 1.4375, 0.734375, z + 0.5))
    for right in (-1.375, 1.375):
        for out in (-0.4375, 0.4375):
            yield moved(_turned_leg(0.671875, 0.078125, 20), (x + right, 0.0, z + out))


def _chair() -> Iterator[Shell]:
    """Seat, turned front legs, raked back posts, spindles and a top rail; its front is towards +Z."""
    yield box((-0.21875, 0.4375, -0.21875), (0.21875, 0.484375, 0.25))
    for x in (-0.171875, 0.171875):
        yield moved(_turned_leg(0.453125, 0.03125, 12), (x, 0.0, 0.1875))
        yield rod((x, 0.0, -0.25), (x, 0.46875, -0.1875), 0.0234375, 0.0234375, 10)
        yield rod((x, 0.453125, -0.1875), (x, 0.953125, -0.28125), 0.0234375, 0.015625, 10)
        yield rod((x, 0.15625, -0.21875), (x, 0.15625, 0.1875), 0.015625, 0.015625, 8)
    for x in np.linspace(-0.109375, 0.109375, 4).tolist():
        yield rod((x, 0.46875, -0.1875), (x, 0.9375, -0.28125), 0.01171875, 0.01171875, 8)
    yield bar((-0.21875, 0.953125, -0.28125), (0.21875, 0.953125, -0.28125), 0.03125, 0.125)
    yield rod((-0.171875, 0.21875, 0.0), (0.171875, 0.21875, 0.0), 0.015625, 0.015625, 8)


def _tableware() -> Iterator[Shell]:
    """A vase, a hollow bowl, and a plate and a cup at every place."""
    vase = [(0.0625, -0.015625), (0.09375, 0.015625), (0.125, 0.125), (0.109375, 0.21875)]
    yield turned_solid([*vase, (0.046875, 0.296875), (0.0625, 0.34375), (0.03125, 0.328125)], 24, (0, 0, 0))
    bowl = [(0.078125, -0.015625), (0.078125, 0.015625), (0.171875, 0.09375), (0.203125, 0.140625)]
    yield turned_solid([*bowl, (0.1875, 0.140625), (0.15625, 0.09375), (0.0625, 0.03125)], 24, (0.625, 0, 0))
    plate = [(0.078125, -0.015625), (0.140625, 0.015625), (0.125, 0.0234375), (0.0625, 0.0078125)]
    cup = [(0.03125, 0.0), (0.046875, 0.078125), (0.0390625, 0.078125), (0.0234375, 0.015625)]
    for x in (-1.0, 0.0, 1.125):
        for z in (-0.4375, 0.4375):
            yield turned_solid(plate, 20, (x, 0.0, z))
            yield turned_solid(cup, 16, (x + 0.21875, -0.0078125, z))


def _chandelier() -> Iterator[Shell]:
    """A wheel on four rods with eight candles."""
    x, _, z = _TABLE
    yield rod((x, 2.75, z), (x, 3.5625, z), 0.015625, 0.015625, 8)
    yield hoop((x, 2.125, z), 0.5, 0.0234375, 32, 6)
    for right, out in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        yield rod(
            (x + 0.5 * right, 2.125, z + 0.5 * out),
            (x + 0.03125 * right, 2.78125, z + 0.03125 * out),
            0.01171875,
            0.01171875,
            6,
        )
    for right, out in ((4, 3), (3, 4), (-4, 3), (-3, 4), (4, -3), (3, -4), (-4, -3), (-3, -4)):
        foot = (x + 0.1 * right, 2.125, z + 0.1 * out)
        yield turned_solid(
            [(0.046875, 0.0), (0.046875, 0.03125), (0.0234375, 0.0390625), (0.0234375, 0.1875)], 10, foot
        )


def _columns() -> Iterator[Shell]:
    """Two columns with a slight swelling."""
    base = [(0.3125, -0.0625), (0.3125, 0.125), (0.28125, 0.1875), (0.21875, 0.21875)]
    shaft = [(0.21875, 1.125), (0.203125, 2.0), (0.1875, 3.0)]
    head = [(0.1875, 3.03125), (0.234375, 3.09375), (0.28125, 3.21875), (0.3125, 3.25), (0.3125, 3.5625)]
    for x, z in ((2.5, -2.5), (-3.5, -2.5)):
        yield turned_solid([*base, *shaft, *head], 32, (x, 0.0, z))


def _bookcases() -> Iterator[Shell]:
    """Two cases against the right wall, each a closed block with five hollows."""
    for z in (-3.75, -1.5):
        shelves = [height for top in _SHELF_TOPS_M for height in (top, top + 0.4375)]
        y = [-0.0625, *shelves, 2.75]
        filled = np.ones((2, len(y) - 1, 3), dtype=bool)
        filled[0, 1::2, 1] = False
        yield cells([5.5625, 5.9375, 5.96875], y, [z - 0.0625, z, z + 1.875, z + 1.9375], filled)


def _books(color: int) -> Iterator[Shell]:
    """Every third book on the shelves, each of another height and thickness."""
    # Raw words of the generator, because only they are promised to stay the same in every NumPy.
    words = np.random.PCG64(2005).random_raw(2 * len(_SHELF_TOPS_M) * _BOOKS_PER_SHELF)
    for number, word in enumerate(words.tolist()):
        if number % len(_BOOK_COLORS) != color:
            continue
        case, shelf = divmod(number // _BOOKS_PER_SHELF, len(_SHELF_TOPS_M))
        z = (-3.75, -1.5)[case] + 0.0078125 + 0.0625 * (number % _BOOKS_PER_SHELF)
        thick, high, deep = 0.0390625 + (word >> 8 & 3) / 128, (word >> 16 & 31) / 256, (word >> 24 & 7) / 128
        foot = _SHELF_TOPS_M[shelf] - 0.0078125
        yield box((5.640625 + deep, foot, z), (5.90625, foot + 0.28125 + high, z + thick))


def _screen() -> Iterator[Shell]:
    """A folding screen of three latticed panels between the lamp and the room."""
    corners: list[tuple[float, float]] = [(3.0, 3.5), (3.5, 2.75), (3.25, 1.875), (3.8125, 1.25)]
    for (x, z), (far_x, far_z) in pairwise(corners):
        for share in (0.03125, 0.96875):
            post = (x + share * (far_x - x), z + share * (far_z - z))
            yield bar((post[0], 0.0, post[1]), (post[0], 1.75, post[1]), 0.046875)
        for height in np.linspace(0.125, 1.6875, 11).tolist():
            yield bar((x, height, z), (far_x, height, far_z), 0.0234375, 0.0234375)
        for share in np.linspace(0.125, 0.875, 7).tolist():
            slat = (x + share * (far_x - x), z + share * (far_z - z))
            yield bar((slat[0], 0.109375, slat[1]), (slat[0], 1.703125, slat[1]), 0.015625)


def _armchair() -> Iterator[Shell]:
    yield box((-0.375, 0.125, -0.375), (0.375, 0.4375, 0.4375))
    yield box((-0.5, 0.0, -0.5), (0.5, 0.984375, -0.34375))
    for side in (-0.4375, 0.4375):
        yield box((side - 0.09375, 0.015625, -0.40625), (side + 0.09375, 0.65625, 0.421875))


def _side_table() -> Iterator[Shell]:
    """A round top on a turned pillar, with a hollow pot on it."""
    yield turned_solid([(0.3125, 0.65625), (0.34375, 0.671875), (0.34375, 0.703125), (0.3125, 0.71875)], 40)
    yield _turned_leg(0.671875, 0.09375, 24)
    pot = [(0.09375, 0.703125), (0.15625, 0.9375), (0.140625, 0.9375), (0.078125, 0.75)]
    yield turned_solid(pot, 36)


def _wardrobe() -> Iterator[Shell]:
    """A tall case with two doors; its shadow is the large one."""
    yield box((2.625, 0.0625, 0.25), (4.25, 2.25, 0.9375))
    yield box((2.5625, -0.03125, 0.1875), (4.3125, 0.125, 1.0))
    yield box((2.5625, 2.1875, 0.1875), (4.3125, 2.3125, 1.0))
    knob = [(0.015625, 0.0), (0.03125, 0.03125), (0.015625, 0.0625)]
    for x in (2.6875, 3.46875):
        yield box((x, 0.1875, 0.21875), (x + 0.71875, 2.125, 0.28125))
        yield turned_solid(knob, 8, (3.4375 + 0.125 * (x - 3.078125), 1.0625, 0.203125))


def _curtain_rods() -> Iterator[Shell]:
    for x in (-3.5, 0.0, 3.5):
        yield rod((x - 1.0, 2.875, -4.375), (x + 1.0, 2.875, -4.375), 0.015625, 0.015625, 12)


def _pictures() -> Iterator[Shell]:
    for x, half in ((-1.75, 0.5), (1.75, 0.5), (5.0, 0.3125), (-5.0, 0.3125)):
        yield box((x - half, 1.5, -4.53125), (x + half, 1.5 + 1.5 * half, -4.4375))
