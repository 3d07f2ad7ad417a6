"""Room: a closed, furnished room lit by one lamp; detailed shadows beside large ones."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians

import numpy as np

from scenes.scene import Mesh, Scene
from scenes.solids import Color, Shell, box, cells, joined, placed
from scenes.thesis.room_furniture import furniture
from scenes.thesis.skinned_solids import bar
from scenes.thesis.staging import camera, floor, spot

PLASTER: Color = (0.74, 0.68, 0.56)
PAINT: Color = (0.85, 0.83, 0.78)

_WALL_M = 0.25
_HALF_X_M, _HALF_Z_M, _HEIGHT_M = 6.0, 4.5, 3.5
_WINDOWS = (-3.5, 0.0, 3.5)
_WINDOW_M = (1.5, 1.0, 2.75)


def room() -> Scene:
    """19,000 triangles: walls and ceiling around two tables, six chairs, shelves with books, columns.

    The light hangs under the ceiling in the corner to the viewer's right, behind a lattice screen. The
    cut-off of 55 degrees lights what the viewer sees of the floor; the thesis gives neither.
    """
    light = spot("Spot under the ceiling", (5.0, 3.0, 3.25), (-1.0, 0.0, -0.5), radians(55.0))
    view = camera("From the door", (-5.25, 2.125, 4.0), (0.5, 0.75, -1.0), 0.9375)
    meshes = (floor(12.5, 9.375, (0.42, 0.27, 0.15)), *_shell(), *furniture())
    return Scene("Room", meshes, (light,), (view,))


def _shell() -> Iterator[Mesh]:
    yield placed("walls and ceiling", _walls(), PLASTER)
    yield placed("window frames", joined(_frames()), PAINT)
    yield placed("skirting", joined(_skirting()), PAINT)


def _walls() -> Shell:
    """A box without a bottom, with three windows in the far wall and a door in the left one."""
    wide, low, high = _WINDOW_M
    edges = np.array(_WINDOWS)[:, None] + [-wide / 2, wide / 2]
    x = [-_HALF_X_M - _WALL_M, -_HALF_X_M, *edges.ravel().tolist(), _HALF_X_M, _HALF_X_M + _WALL_M]
    y = [-0.125, low, 2.25, high, _HEIGHT_M, _HEIGHT_M + _WALL_M]
    z = [-_HALF_Z_M - _WALL_M, -_HALF_Z_M, 0.75, 1.875, _HALF_Z_M, _HALF_Z_M + _WALL_M]
    filled = np.ones((len(x) - 1, len(y) - 1, len(z) - 1), dtype=bool)
    filled[1:-1, :-1, 1:-1] = False
    filled[2:-2:2, 1:3, 0] = False
    filled[0, :2, 2] = False
    return cells(x, y, z, filled)


def _frames() -> Iterator[Shell]:
    """Sill, frame and glazing bars of every window."""
    wide, low, high = _WINDOW_M
    z = -_HALF_Z_M - _WALL_M / 2
    for middle in _WINDOWS:
        yield box(
            (middle - wide / 2 - 0.125, low - 0.03125, -_HALF_Z_M - 0.0625),
            (middle + wide / 2 + 0.125, low + 0.03125, -_HALF_Z_M + 0.1875),
        )
        for x in np.linspace(-wide / 2, wide / 2, 5).tolist():
            yield bar((middle + x, low - 0.015625, z), (middle + x, high + 0.015625, z), 0.0625)
        for y in np.linspace(low, high, 5).tolist():
            ends = (middle - wide / 2 - 0.015625, middle + wide / 2 + 0.015625)
            yield bar((ends[0], y, z), (ends[1], y, z), 0.046875)


def _skirting() -> Iterator[Shell]:
    for side in (-1, 1):
        z = sorted((side * (_HALF_Z_M - 0.03125), side * (_HALF_Z_M + 0.0625)))
        yield box((-_HALF_X_M - 0.0625, -0.0625, z[0]), (_HALF_X_M + 0.0625, 0.15625, z[1]))
