"""Where cameras and lights look from: view and projection matrices, and what lies in a light's reach.

Column vectors; right-handed eye space looking down -z; clip depth in [0, 1].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.scene import Array, Camera, Light, LightKind


def look_along(eye: npt.ArrayLike, forward: npt.ArrayLike, up: npt.ArrayLike) -> Array:
    """(4, 4) float64 view matrix; `up` need not be orthogonal to `forward` but must not be parallel."""
    back = -np.asarray(forward, float) / np.linalg.norm(forward)
    right = np.cross(np.asarray(up, float), back)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(back, right), back])
    view = np.eye(4)
    view[:3, :3] = rotation
    view[:3, 3] = -rotation @ np.asarray(eye, float)
    return view


def any_up(forward: npt.ArrayLike) -> Array:
    """(3,) float64 unit axis that is far from parallel to `forward`: Y, or Z when looking up or down."""
    return np.array([0.0, 1.0, 0.0] if abs(np.asarray(forward, float)[1]) < 0.9 else [0.0, 0.0, 1.0])


def camera_view(camera: Camera) -> Array:
    """(4, 4) float64 eye-from-world matrix."""
    return look_along(camera.position, camera.forward, camera.up)


def reversed_infinite(yfov_rad: float, aspect: float, near: float) -> Array:
    """(4, 4) float64 projection with depth near / distance: 1 at the near plane, 0 at infinity."""
    y = 1 / np.tan(yfov_rad / 2)
    return np.array([[y / aspect, 0, 0, 0], [0, y, 0, 0], [0, 0, 0, near], [0, 0, -1, 0]])


@dataclass(frozen=True)
class Reach:
    """A convex body that holds all that a light can light: half-spaces and, for lights with a range, a ball.

    Attributes:
        planes: (p, 4) float64; a point x is inside where planes @ (x, 1) >= 0.
        centre: (3,) float64, metres; the light's position, or zeros for a directional light.
        range_m: Radius of the ball, `inf` for none.
        has_place: Whether the light is at `centre`; a directional light is nowhere.
    """

    planes: Array
    centre: Array
    range_m: float
    has_place: bool = True

    def touches(self, low: Array, high: Array) -> npt.NDArray[np.bool_]:
        """(n,) bool: whether each box (n, 3) .. (n, 3) may hold a point of the body; never wrongly False."""
        nearest = np.clip(self.centre, low, high)
        kept: npt.NDArray[np.bool_] = np.linalg.norm(nearest - self.centre, axis=1) <= self.range_m
        return kept & boxes_inside(self.planes, low, high)


def boxes_inside(planes: Array, low: Array, high: Array) -> npt.NDArray[np.bool_]:
    """(n,) bool: whether each box has, for every plane by itself, a corner on its inner side."""
    kept = np.ones(len(low), bool)
    for plane in planes:
        farthest = np.where(plane[:3] >= 0, high, low)
        kept &= farthest @ plane[:3] + plane[3] >= 0
    return kept


def light_axes(light: Light) -> Array:
    """(3, 3) float64 rows right, up, forward of a light that has a direction."""
    forward = np.asarray(light.direction, float) / np.linalg.norm(light.direction)
    view = look_along(np.zeros(3), forward, any_up(forward))
    return np.stack([view[0, :3], view[1, :3], forward])


def reach(light: Light, origin: Array) -> Reach:
    """What `light` can light, in scene space (world minus `origin`).

    A spot's cone is bounded by the pyramid around it; nothing behind the light is in reach.
    """
    centre = np.asarray(light.position, float) - origin
    if light.kind is LightKind.DIRECTIONAL:
        return Reach(np.zeros((0, 4)), np.zeros(3), float("inf"), has_place=False)
    if light.kind is LightKind.POINT:
        return Reach(np.zeros((0, 4)), centre, light.range_m)
    right, up, forward = light_axes(light)
    cosine, sine = np.cos(light.outer_cone_rad), np.sin(light.outer_cone_rad)
    normals = np.array([sine * forward + cosine * side for side in (right, -right, up, -up)] + [forward])
    return Reach(np.hstack([normals, -(normals @ centre)[:, None]]), centre, light.range_m)
