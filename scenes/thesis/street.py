"""Street: plain houses on either side of a street, as few triangles as shadow volumes could wish for."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians

import numpy as np

from scenes.scene import Mesh, Scene
from scenes.solids import Color, Point, Shell, box, joined, loft, moved, placed, turned
from scenes.thesis.staging import camera, floor, spot

_EAVES_M = 0.375
_SUNK_M = 0.0625
_FRONT_M = 7.0
_STONE: Color = (0.42, 0.40, 0.36)
_TILES: Color = (0.42, 0.13, 0.06)
_SLATE: Color = (0.13, 0.14, 0.18)
_LAMPS: tuple[Point, ...] = ((-12.0, 0.0, 4.25), (4.0, 0.0, 4.25), (-4.0, 0.0, -4.25), (12.0, 0.0, -4.25))
# x, side of the street, width, depth, height of the walls, rise of the roof, colours of walls and roof
_HOUSES: tuple[tuple[float, int, float, float, float, float, Color, Color], ...] = (
    (-15.0, 1, 8.0, 7.0, 5.5, 2.5, (0.72, 0.60, 0.42), _TILES),
    (-5.5, 1, 7.5, 8.0, 3.5, 3.0, (0.38, 0.15, 0.10), _SLATE),
    (5.0, 1, 9.0, 7.0, 6.0, 2.5, (0.74, 0.71, 0.64), _TILES),
    (15.5, 1, 7.5, 7.5, 4.0, 3.0, (0.30, 0.36, 0.42), _SLATE),
    (-14.0, -1, 7.0, 7.5, 3.5, 2.75, (0.40, 0.44, 0.32), _SLATE),
    (-4.5, -1, 8.5, 7.0, 6.0, 2.5, (0.60, 0.32, 0.20), _TILES),
    (5.5, -1, 7.0, 8.0, 4.0, 3.25, (0.74, 0.68, 0.54), _SLATE),
    (15.0, -1, 8.0, 7.0, 5.5, 2.5, (0.55, 0.34, 0.14), _TILES),
)


def street() -> Scene:
    """400 triangles: eight houses of 32, pavements, lamp posts and garden walls of 12 a part.

    The light stands high over the roofs of one side, so that they cast across the street. The cut-off of 45
    degrees holds the street; the thesis gives neither.
    """
    light = spot("Spot over the roofs", (-6.0, 20.0, 25.0), (0.0, 0.0, -1.0), radians(45.0))
    view = camera("Along the street", (-24.0, 6.5, -1.5), (0.0, 1.0, -1.0))
    meshes = (floor(50.0, 50.0, (0.20, 0.20, 0.21)), *_meshes())
    return Scene("Street", meshes, (light,), (view,))


def _meshes() -> Iterator[Mesh]:
    for number, (x, side, width, depth, height, rise, wall, roof) in enumerate(_HOUSES, start=1):
        place = (x, 0.0, side * _FRONT_M)
        half = width / 2
        walls = box((-half, -_SUNK_M, 0.0), (half, height, depth))
        chimney = box((half / 2, height, 0.625 * depth), (half / 2 + 0.75, height + rise + 0.5, 0.75 * depth))
        for part, shell, color in (
            ("walls", walls, wall),
            ("roof", _roof(width, depth, height, rise), roof),
            ("chimney", chimney, _STONE),
        ):
            yield placed(f"house {number} {part}", moved(turned(shell, float(side), 0.0), place), color)
    pavements = [
        box((-20.0, -_SUNK_M, 3.75), (20.0, 0.125, 6.875)),
        box((-20.0, -_SUNK_M, -6.875), (20.0, 0.125, -3.75)),
    ]
    yield placed("pavements", joined(pavements), (0.48, 0.46, 0.42))
    yield placed("lamp posts", joined(_lamp_posts()), (0.06, 0.07, 0.07))
    garden = [
        box((9.875, -_SUNK_M, 7.25), (11.375, 1.25, 7.5)),
        box((-10.0, -_SUNK_M, -7.5), (-9.25, 1.25, -7.25)),
    ]
    yield placed("garden walls", joined(garden), _STONE)


def _roof(width: float, depth: float, height: float, rise: float) -> Shell:
    """A prism over the walls, its ridge along the street: 8 triangles."""
    slope = rise / (depth / 2)
    eaves = height + _SUNK_M - slope * _EAVES_M
    gable = [(-_EAVES_M, eaves), (depth / 2, height + rise), (depth + _EAVES_M, eaves)]
    ends = [[(x, y, z) for z, y in gable] for x in (-width / 2 - 0.25, width / 2 + 0.25)]
    return loft(np.array(ends[0]), np.array(ends[1]))


def _lamp_posts() -> Iterator[Shell]:
    for x, _, z in _LAMPS:
        inwards = -1.0 if z > 0 else 1.0
        yield box((x - 0.09375, -_SUNK_M, z - 0.09375), (x + 0.09375, 5.0, z + 0.09375))
        reach = sorted((z - 0.1875 * inwards, z + 1.75 * inwards))
        yield box((x - 0.1875, 4.9375, reach[0]), (x + 0.1875, 5.125, reach[1]))
