"""Water Tower: a wooden tank on braced legs; large shadows and thin ones."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians

import numpy as np

from scenes.scene import Mesh, Scene
from scenes.solids import Color, Point, Shell, box, joined, placed, turned
from scenes.thesis.skinned_solids import bar, circle, hoop, rod, skinned, turned_solid
from scenes.thesis.staging import camera, floor, spot

IRON: Color = (0.10, 0.11, 0.12)
WOOD: Color = (0.36, 0.22, 0.12)

_LEGS = 6
_STAVES = 72
_LEVELS = ((-0.0625, 3.5), (3.0, 3.1875), (6.0, 2.875), (9.0, 2.5625))
_DECK_M = 9.0
_TANK_M = (9.5, 14.0)
_TANK_RADIUS_M = 2.75
_DECK_RADIUS_M = 3.75
_RAILINGS = 48
_RUNGS = 45
_KNEES = 24


def water_tower() -> Scene:
    """12,500 triangles: tank, roof, deck with a railing, six legs, cross-braces and a ladder.

    The light stands high enough that the whole shadow falls on the floor. The cut-off of 22.5 degrees
    holds the tower and lights the ground around its shadow; `set_ups` has narrower and wider ones.
    """
    light = spot("Spot", (-24.0, 38.0, 10.0), (2.0, 5.0, -1.0), radians(22.5))
    cameras = (
        camera("Tower and shadow", (14.0, 15.0, 28.0), (5.5, 5.5, -1.5)),
        camera("Shadow", (10.5, 6.5, 10.0), (5.5, 0.0, -2.5)),
    )
    return Scene("Water tower", (floor(50.0, 50.0, (0.46, 0.42, 0.30)), *tower()), (light,), cameras)


def tower() -> Iterator[Mesh]:
    """The tower without its floor."""
    yield placed("tank", joined(_tank()), WOOD)
    yield placed("hoops", joined(_hoops()), IRON)
    yield placed("roof", joined(_roof()), (0.34, 0.10, 0.06))
    yield placed("deck", joined(_deck()), (0.28, 0.20, 0.13))
    yield placed("railing", joined(_railing()), IRON)
    yield placed("legs", joined(_legs()), IRON)
    yield placed("riser", _riser(), (0.20, 0.21, 0.22))
    yield placed("braces", joined(_braces()), IRON)
    yield placed("ladder", joined(_ladder()), IRON)


def _tank() -> Iterator[Shell]:
    """Staves around a drum that closes the gaps between them."""
    low, high = _TANK_M
    yield turned_solid([(2.625, low + 0.125), (2.625, high)], 36)
    stave = box((_TANK_RADIUS_M - 0.0625, low, -0.1015625), (_TANK_RADIUS_M + 0.0625, high, 0.1015625))
    for cosine, sine in circle(_STAVES).tolist():
        yield turned(stave, cosine, sine)


def _hoops() -> Iterator[Shell]:
    for height in (9.8125, 10.375, 11.0625, 11.8125, 12.6875, 13.625):
        yield hoop((0.0, height, 0.0), _TANK_RADIUS_M + 0.078125, 0.03125, 72, 4)


def _roof() -> Iterator[Shell]:
    """A cone in overlapping courses, and a finial on it."""
    courses = [(3.125, 13.9375), (3.125, 14.0), (2.125, 14.6875), (2.1875, 14.75)]
    courses += [(1.125, 15.4375), (1.1875, 15.5), (0.125, 16.1875)]
    yield turned_solid(courses, 80)
    ball = [(0.046875, 16.125), (0.046875, 16.5), (0.125, 16.5625), (0.15625, 16.6875), (0.125, 16.8125)]
    yield turned_solid([*ball, (0.03125, 16.875)], 12)


def _deck() -> Iterator[Shell]:
    yield turned_solid([(_DECK_RADIUS_M, _DECK_M), (_DECK_RADIUS_M, _DECK_M + 0.125)], 36)
    for x in np.arange(-2.5, 2.75, 0.625).tolist():
        yield box((x - 0.125, _DECK_M + 0.0625, -2.3125), (x + 0.125, _TANK_M[0] + 0.0625, 2.3125))
    for x, z in circle(_KNEES).tolist():
        foot, head = (2.0 * x, _DECK_M - 1.0, 2.0 * z), (3.625 * x, _DECK_M + 0.0625, 3.625 * z)
        yield bar(foot, head, 0.0625)


def _railing() -> Iterator[Shell]:
    radius = _DECK_RADIUS_M - 0.125
    for x, z in (radius * circle(_RAILINGS)).tolist():
        yield rod((x, _DECK_M + 0.0625, z), (x, _DECK_M + 1.125, z), 0.03125, 0.03125, 6)
    for height in (0.4375, 0.78125, 1.125):
        yield hoop((0.0, _DECK_M + height, 0.0), radius, 0.03125, 96, 4)


def _corners(level: int) -> list[Point]:
    height, radius = _LEVELS[level]
    return [(x, height, z) for x, z in (radius * circle(_LEGS)).tolist()]


def _legs() -> Iterator[Shell]:
    outline = np.stack([circle(8)[:, 0], np.zeros(8), -circle(8)[:, 1]], axis=1) * 0.15625
    levels = [_corners(level) for level in range(len(_LEVELS))]
    for number in range(_LEGS):
        yield skinned([outline + np.array(level[number]) for level in levels])
        x, _, z = levels[0][number]
        yield box((x - 0.375, -0.125, z - 0.375), (x + 0.375, 0.25, z + 0.375))
        for joints in levels[1:]:
            x, y, z = joints[number]
            yield box((x - 0.1875, y - 0.25, z - 0.1875), (x + 0.1875, y + 0.125, z + 0.1875))


def _riser() -> Shell:
    """The pipe up to the tank, with two flanges."""
    pipe, flange = 0.25, 0.375
    profile = [(flange, -0.125), (flange, 0.1875), (pipe, 0.25), (pipe, 4.5), (flange, 4.5625)]
    return turned_solid([*profile, (flange, 4.6875), (pipe, 4.75), (pipe, _TANK_M[0] + 0.1875)], 24)


def _braces() -> Iterator[Shell]:
    """Level rods between the legs, and a crossed pair of thin ones in each panel."""
    for level in (1, 2):
        corners = _corners(level)
        for here, there in zip(corners, corners[1:] + corners[:1], strict=True):
            yield rod(here, there, 0.078125, 0.078125, 6)
    for lower, upper in ((0, 1), (1, 2), (2, 3)):
        feet, heads = _corners(lower), _corners(upper)
        for number in range(_LEGS):
            ahead = (number + 1) % _LEGS
            yield rod(feet[number], heads[ahead], 0.0234375, 0.0234375, 6)
            yield rod(feet[ahead], heads[number], 0.0234375, 0.0234375, 6)


def _ladder() -> Iterator[Shell]:
    """Two rails and rungs, upright on the side of the first camera, held by the deck and the ground."""
    z = _DECK_RADIUS_M + 0.25
    for x in (-0.25, 0.25):
        yield bar((x, -0.0625, z), (x, _DECK_M + 1.125, z), 0.0625)
        for height in (0.5, 8.9375, 9.5):
            yield bar((x, height, z), (x, height, z - 0.5), 0.0625)
    for number in range(_RUNGS):
        height = 0.25 + 0.21875 * number
        yield rod((-0.28125, height, z), (0.28125, height, z), 0.015625, 0.015625, 6)
