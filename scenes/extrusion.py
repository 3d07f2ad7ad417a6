"""Where shadow volumes may end: a plane beyond everything that can be seen, or infinity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.frusta import light_axes
from scenes.scene import Array, Light, LightKind

# Relative to the scene's size: far enough behind the last receiver that depths cannot be confused.
MARGIN = 0.01
# A ray must approach the plane at least this fast; slower ones would end far outside the scene.
SLOWEST = 0.02


@dataclass(frozen=True)
class EndPlane:
    """The plane normal @ x = distance on which every extruded vertex comes to rest.

    A volume stays closed if the place where a vertex ends depends on that vertex alone, and stays right if
    the flat caps between those places touch no receiver: both hold for one plane beyond all receivers.
    """

    normal: Array
    distance: float


def end_plane(light: Light, position: Array, bounds: Array, low: Array, high: Array) -> EndPlane | None:
    """The plane that ends volumes soonest; None where some ray reaches none, and volumes run to infinity.

    Args:
        light: The light.
        position: (3,) float64 its position in scene space.
        bounds: (2, 3) float64 box of everything visible, scene space.
        low: (c, 3) float64 lowest corners of boxes that hold all casters, scene space.
        high: (c, 3) float64 their highest corners.
    """
    size = float((bounds[1] - bounds[0]).max())
    if not len(low) or not size > 0:
        return None
    best, least = None, np.inf
    for normal in _outward_normals(light):
        distance = float(np.where(normal > 0, bounds[1], bounds[0]) @ normal) + MARGIN * size
        if light.kind is LightKind.DIRECTIONAL:
            slowest = float(normal @ light.direction)
            length = (distance - (low + high) @ normal / 2) / max(slowest, SLOWEST)
        else:
            nearest = np.where(normal > 0, low, high)
            slowest = float(((nearest - position) @ normal).min()) / size
            middle = (low + high) / 2 - position
            along = np.maximum(middle @ normal, SLOWEST * size)
            length = np.linalg.norm(middle, axis=1) * ((distance - position @ normal) / along - 1)
        if slowest > SLOWEST and length.mean() < least:
            best, least = EndPlane(normal, distance), float(length.mean())
    return best


def _outward_normals(light: Light) -> Array:
    normals = np.vstack([np.eye(3), -np.eye(3)])
    if light.kind is LightKind.POINT:
        return normals
    return np.vstack([normals, light_axes(light)[2]])
