"""From Quake's space into the scene's: Z up and 32 units to the metre, against Y up and metres.

A player is 56 units tall: 1.75 m at 32 units to the metre, which is the scale that glTF exports of maps have.
"""

from __future__ import annotations

import math

import numpy as np

from scenes.scene import Array
from scenes.vectors import Vector, unit, vector

UNITS_PER_M = 32.0
_GRID = 2.0**40


def metres(points: Array) -> Array:
    """(..., 3) float64 points in units, x east, y north, z up, as metres with Y up: (x, z, -y) / 32."""
    turned = np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)
    return turned / UNITS_PER_M


def place(x: float, y: float, z: float) -> Vector:
    """The same for one point."""
    return vector(metres(np.array([x, y, z])))


def heading(yaw_deg: float, pitch_deg: float) -> Vector:
    """Unit vector: yaw turns from east to north, pitch rises; in the scene's axes.

    Multiples of 90 degrees are exact: most angles in maps are such.
    """
    (east, north), (level, up) = _turn(yaw_deg), _turn(pitch_deg)
    # A product of grid numbers has length 1 to 1e-12 only.
    direction = unit((east * level, up, -north * level))
    assert direction
    return direction


def _turn(degrees: float) -> tuple[float, float]:
    quarter = degrees % 360.0 / 90.0
    if quarter.is_integer():
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter) % 4]
    # On a grid, where the last bits of the system's sine do not matter.
    return (
        round(math.cos(math.radians(degrees)) * _GRID) / _GRID,
        round(math.sin(math.radians(degrees)) * _GRID) / _GRID,
    )
