"""Whether z-pass counts right: no shadow volume may hold a point of the near rectangle."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from renderers.frame import Frame
from scenes.frusta import boxes_inside
from scenes.scene import Array

# Of the scene's size: what float32 may leave of a vertex's place, a few times over.
MARGIN = 1e-6
# Of the near rectangle's size: nearer to its plane a light spans no pyramid with it.
FLAT = 1e-6


def near_rectangle_is_lit(frame: Frame) -> bool:
    """Whether no casting triangle reaches into the hull of the near rectangle and the light.

    A point of the rectangle is in a volume where a triangle cuts its way to the light, and all those ways
    fill that hull. Never wrongly True; a triangle is cleared by one plane, the hull's or its own, so that one
    which passes an edge of the hull may count as inside. The near-rectangle test of McGuire (GPU Gems 3,
    chapter 11).
    """
    world = frame.world
    right, up, forward = frame.camera.near_m * frame.rays
    rectangle = frame.eye + forward + np.array([right + up, up - right, -right - up, right - up])
    light = frame.light.homogeneous
    light[:3] -= light[3] * world.origin
    margin = MARGIN * float(np.abs(world.scene.bounds - world.origin).max())
    planes = _hull(rectangle, forward, light, margin)
    if planes is None:
        return False
    near = boxes_inside(planes, world.clusters.low, world.clusters.high)
    faces = np.repeat(near, np.diff(world.clusters.starts))
    corners = world.positions.astype(np.float64)[world.triangles[: world.caster_count][faces]]
    heights = corners @ planes[:, :3].T + planes[:, 3]
    beyond_hull = (heights.max(axis=1) < 0).any(axis=1)
    return bool((beyond_hull | _hull_beyond(corners, rectangle, light, margin)).all())


def _hull(rectangle: Array, forward: Array, light: Array, margin: float) -> Array | None:
    """(5, 4) inward planes, unit normals, `margin` farther out; None for a light in the near plane."""
    middle = rectangle.mean(axis=0)
    height = float(forward @ (light[:3] - light[3] * middle))
    if abs(height) <= FLAT * float(forward @ forward if light[3] else np.linalg.norm(forward)):
        return None
    along = np.roll(rectangle, -1, axis=0) - rectangle
    sides = np.cross(along, light[:3] - light[3] * rectangle)
    inwards = np.where(np.einsum("ij,ij->i", sides, middle - rectangle) < 0, -1.0, 1.0)
    normals = np.vstack([sides * inwards[:, None], np.sign(height) * forward])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    offsets = -np.einsum("ij,ij->i", normals, np.vstack([rectangle, middle]))
    return np.hstack([normals, offsets[:, None] + margin])


def _hull_beyond(corners: Array, rectangle: Array, light: Array, margin: float) -> npt.NDArray[np.bool_]:
    """(t,) bool: whether rectangle and light lie on one side of each triangle's plane."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    points = np.vstack([np.hstack([rectangle, np.ones((4, 1))]), light])
    offsets = np.einsum("ij,ij->i", normals, corners[:, 0])
    heights = normals @ points[:, :3].T - offsets[:, None] * points[:, 3]
    least = margin * np.linalg.norm(normals, axis=1, keepdims=True)
    beyond: npt.NDArray[np.bool_] = (heights > least).all(axis=1) | (heights < -least).all(axis=1)
    return beyond
