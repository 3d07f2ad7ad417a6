"""Floors, spot lights and cameras for the thesis' scenes, from points rather than directions."""

from __future__ import annotations

from math import sqrt

import numpy as np

from scenes.scene import Camera, Light, LightKind, Mesh
from scenes.solids import Color, Point, Shell, placed

FLOOR_QUADS = 100
WARM: Color = (1.0, 0.94, 0.82)

_FALL_OFF = 0.875


def floor(width_m: float, depth_m: float, color: Color) -> Mesh:
    """The floor of every scene: 20,000 triangles in the plane y = 0, seen from above.

    It casts like everything else: on itself that changes no shadow.
    """
    steps = np.arange(FLOOR_QUADS + 1) / FLOOR_QUADS - 0.5
    x, z = np.meshgrid(width_m * steps, depth_m * steps, indexing="ij")
    points = np.stack([x, np.zeros_like(x), z], axis=2).reshape(-1, 3)
    row = FLOOR_QUADS + 1
    first = (row * np.arange(FLOOR_QUADS)[:, None] + np.arange(FLOOR_QUADS)).reshape(-1, 1)
    corners = first + np.array([[0, 1, row + 1, row]])
    return placed("floor", Shell(points, corners[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)), color)


def spot(name: str, position: Point, target: Point, cut_off_rad: float, color: Color = WARM) -> Light:
    """A spot light that shines from one point towards another, without a range, as OpenGL 1's did."""
    return Light(
        name=name,
        kind=LightKind.SPOT,
        position=position,
        direction=unit_from(position, target),
        inner_cone_rad=_FALL_OFF * cut_off_rad,
        outer_cone_rad=cut_off_rad,
        intensity=1000.0,
        color=color,
    )


def camera(name: str, eye: Point, target: Point, yfov_rad: float = 0.75) -> Camera:
    """A camera that looks from one point at another, upright; 0.75 rad are 43 degrees."""
    x, y, z = unit_from(eye, target)
    across = sqrt(x * x + z * z)
    return Camera(
        name=name,
        position=eye,
        forward=(x, y, z),
        up=(-x * y / across, across, -z * y / across),
        yfov_rad=yfov_rad,
        near_m=0.125,
    )


def unit_from(start: Point, end: Point) -> Point:
    """The unit vector from one point to another. Square roots and quotients only."""
    x, y, z = (there - here for here, there in zip(start, end, strict=True))
    length = sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length)
