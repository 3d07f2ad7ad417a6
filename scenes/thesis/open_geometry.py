"""Open geometry over a floor: a tree of leaf cards (figure 57), a fence, a Moebius strip.

Volumes of closed meshes only (Crow 1977, as in the thesis) are wrong on these.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import radians

import numpy as np

from scenes.scene import Array, Scene
from scenes.solids import Color, Point, Shell, box, cards, joined, placed
from scenes.thesis.skinned_solids import bar, circle, rod, skinned
from scenes.thesis.staging import camera, floor, spot

GRASS: Color = (0.34, 0.36, 0.16)
BARK: Color = (0.20, 0.13, 0.08)
LEAVES: Color = (0.14, 0.28, 0.06)
PAINT: Color = (0.70, 0.68, 0.62)

_LEAVES_PER_TWIG = 96
_LIMBS: tuple[tuple[Point, Point], ...] = (
    ((0.125, 2.5, 0.0), (2.25, 4.25, 0.5)),
    ((0.125, 2.875, 0.0), (-1.75, 4.75, 0.875)),
    ((0.125, 3.25, -0.0625), (0.75, 5.0, -2.0)),
    ((0.125, 3.5, -0.0625), (-1.125, 5.5, -1.375)),
    ((0.125, 3.75, -0.0625), (1.25, 5.75, 1.25)),
    ((0.0625, 4.25, -0.125), (-0.125, 6.5, 0.0)),
)
_STRIP_QUADS = (96, 8)


def tree() -> Scene:
    """A tree of mixed geometry, as in figure 57: a closed trunk, closed limbs, open leaf cards."""
    meshes = (
        floor(25.0, 25.0, GRASS),
        placed("trunk", _trunk(), BARK),
        placed("limbs", joined(_limbs()), BARK),
        placed("leaves", _leaves(), LEAVES),
    )
    light = spot("Spot", (-7.0, 14.0, 6.0), (0.5, 2.5, -0.5), radians(35.0))
    return Scene("Tree", meshes, (light,), (camera("Tree and shadow", (6.5, 5.5, 15.0), (2.0, 2.5, -0.5)),))


def fence() -> Scene:
    """A fence of closed posts, rails and wires, and pickets that are single sheets."""
    meshes = (
        floor(25.0, 25.0, GRASS),
        placed("posts", joined(_posts()), BARK),
        placed("rails", joined(_rails()), PAINT),
        placed("pickets", _pickets(), PAINT),
        placed("wires", joined(_wires()), (0.10, 0.11, 0.12)),
    )
    light = spot("Spot", (-5.0, 7.0, -8.0), (0.0, 0.5, 0.5), radians(40.0))
    return Scene("Fence", meshes, (light,), (camera("Fence and shadow", (3.5, 3.0, 7.5), (0.0, 0.25, 0.5)),))


def moebius() -> Scene:
    """A strip with one side and one edge, standing: no winding is consistent on it."""
    light = spot("Spot", (-5.0, 9.0, 5.0), (0.25, 2.0, -0.25), radians(35.0))
    view = camera("Strip and shadow", (4.0, 4.0, 9.0), (0.75, 1.25, -0.5))
    strip = placed("moebius strip", _strip((0.0, 2.75, 0.0), 1.75, 1.25), (0.55, 0.20, 0.10))
    return Scene("Moebius strip", (floor(25.0, 25.0, (0.60, 0.60, 0.58)), strip), (light,), (view,))


def _trunk() -> Shell:
    outline = np.stack([circle(12)[:, 0], np.zeros(12), -circle(12)[:, 1]], axis=1)
    stations = [(0.5, 0.0, -0.125), (0.375, 0.0, 0.25), (0.3125, 0.0625, 1.25), (0.28125, 0.125, 2.5)]
    stations += [(0.21875, 0.125, 3.5), (0.125, 0.0625, 4.375)]
    return skinned([radius * outline + np.array((x, y, -0.25 * x)) for radius, x, y in stations])


def _limbs() -> Iterator[Shell]:
    for start, end in _LIMBS:
        yield rod(start, end, 0.125, 0.046875)
        for number, twig in enumerate(_twigs(start, end)):
            # Each a little further inside the limb: the ends of rods that meet would share edges.
            share = (number + 1) / 32
            x, y, z = (there + share * (here - there) for here, there in zip(start, end, strict=True))
            yield rod((x, y, z), twig, 0.046875, 0.015625, 6)


def _twigs(start: Point, end: Point) -> list[Point]:
    """Where the three twigs of a limb end: onwards, and to either side."""
    x, y, z = (there - here for here, there in zip(start, end, strict=True))
    ways = [(0.5 * x, 0.25 * y, 0.5 * z), (0.25 * x - 0.375 * z, 0.5, 0.25 * z + 0.375 * x)]
    ways += [(0.25 * x + 0.375 * z, 0.375, 0.25 * z - 0.375 * x)]
    return [(end[0] + right, end[1] + up, end[2] + out) for right, up, out in ways]


def _leaves() -> Shell:
    """Cards in every direction, in a ball around the end of each twig."""
    tips = np.array([twig for start, end in _LIMBS for twig in _twigs(start, end)])
    middles = np.repeat(tips, _LEAVES_PER_TWIG, axis=0)
    count = len(middles)
    # Raw words of the generator, because only they are promised to stay the same in every NumPy.
    words = np.random.PCG64(57).random_raw(3 * 3 * 4 * count)
    numbers = (words >> 11) * 2.0**-52 - 1.0
    offset, along, other = (_inside_ball(part.reshape(-1, 3))[:count] for part in np.split(numbers, 3))
    across = _unit(np.cross(along, other)) * 0.1875
    along = _unit(along) * 0.28125
    return cards(middles + 1.0625 * offset - (along + across) / 2, along, across)


def _inside_ball(points: Array) -> Array:
    inside: Array = points[(points * points).sum(axis=1) < 1.0]
    return inside


def _unit(vectors: Array) -> Array:
    unit: Array = vectors / np.sqrt((vectors * vectors).sum(axis=1, keepdims=True))
    return unit


def _posts() -> Iterator[Shell]:
    for x in (-6.0, -3.0, 0.0, 3.0, 6.0):
        yield box((x - 0.0625, -0.125, -0.0625), (x + 0.0625, 1.5, 0.0625))


def _rails() -> Iterator[Shell]:
    for height in (0.3125, 1.0):
        yield bar((-6.25, height, -0.09375), (6.25, height, -0.09375), 0.0625, 0.09375)


def _pickets() -> Shell:
    """Quads that face away from the light, where backs must cast as fronts do, and a few the other way."""
    x = np.arange(-6.0, 6.125, 0.1875)
    corner = np.stack([x, np.full_like(x, 0.125), np.full_like(x, 0.078125)], axis=1)
    turned = (np.arange(len(x)) % 4 == 3)[:, None]
    along = np.where(turned, [-0.09375, 0.0, 0.0], [0.09375, 0.0, 0.0])
    return cards(corner - np.minimum(along, 0.0), along, np.tile([0.0, 1.125, 0.0], (len(x), 1)))


def _wires() -> Iterator[Shell]:
    for height in (1.375, 1.46875):
        yield rod((-6.0, height, 0.0), (6.0, height, 0.0), 0.0078125, 0.0078125, 6)


def _strip(centre: Point, radius_m: float, width_m: float) -> Shell:
    """The strip around the Z axis. Its last column of quads joins the first upside down."""
    around, across = _STRIP_QUADS
    x, y = (turn[:, None] for turn in circle(around).T)
    out, aside = (turn[:around, None] for turn in circle(2 * around).T)
    offset = width_m * (np.arange(across + 1) / across - 0.5)
    reach = radius_m + offset * out
    points = np.stack([reach * x, reach * y, offset * aside], axis=2).reshape(-1, 3) + np.array(centre)
    columns = np.arange(around * (across + 1)).reshape(around, across + 1)
    columns = np.vstack([columns, columns[:1, ::-1]])
    corners = np.stack([columns[:-1, :-1], columns[1:, :-1], columns[1:, 1:], columns[:-1, 1:]], axis=2)
    return Shell(points, corners.reshape(-1, 4)[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))
