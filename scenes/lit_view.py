"""Whether a camera shows anything that a light lights: elsewhere nothing of its shadows can be judged."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from scenes.ray_caster import RayCaster
from scenes.scene import Array, Camera, Light, LightKind

ACROSS, DOWN = 48, 27
ASPECT = 16 / 9
# Of 1296 rays: less is no more than a glimpse.
LEAST_LIT = 8


def shows_light(camera: Camera, light: Light, surfaces: RayCaster, casters: RayCaster) -> bool:
    """Whether a grid of rays from `camera` finds places that `light` lights.

    Args:
        camera: The view.
        light: The light.
        surfaces: All of the scene.
        casters: What casts shadows.
    """
    rays = view_rays(camera, ACROSS, DOWN)
    eye = np.asarray(camera.position, float)
    distances, triangles = surfaces.hits(np.broadcast_to(eye, rays.shape), rays)
    struck = np.isfinite(distances)
    points = eye + distances[struck, None] * rays[struck]
    corners = surfaces.corners(triangles[struck])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    faced = lengths > 0
    points, normals = points[faced], normals[faced] / lengths[faced, None]
    normals *= np.where(np.einsum("ij,ij->i", normals, rays[struck][faced]) > 0, -1.0, 1.0)[:, None]
    reached = in_reach(points, light)
    return int(np.count_nonzero(casters.lit(points[reached], normals[reached], light))) >= LEAST_LIT


def view_rays(camera: Camera, across: int, down: int) -> Array:
    """(down * across, 3) unit directions, evenly spread over a view of 16 to 9, top row first."""
    forward, up = np.asarray(camera.forward, float), np.asarray(camera.up, float)
    right = np.cross(forward, up)
    half = np.tan(camera.yfov_rad / 2)
    x = (np.arange(across) + 0.5) / across * 2 - 1
    y = 1 - (np.arange(down) + 0.5) / down * 2
    aside, above = (one.ravel() for one in np.meshgrid(x * half * ASPECT, y * half))
    rays = forward + aside[:, None] * right + above[:, None] * up
    unit: Array = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return unit


def in_reach(points: Array, light: Light) -> npt.NDArray[np.bool_]:
    """(n,) bool: within range and cone."""
    if light.kind is LightKind.DIRECTIONAL:
        return np.ones(len(points), bool)
    offsets = points - np.asarray(light.position)
    distances = np.linalg.norm(offsets, axis=1)
    within: npt.NDArray[np.bool_] = distances <= light.range_m
    if light.kind is LightKind.SPOT:
        within &= offsets @ np.asarray(light.direction) >= np.cos(light.outer_cone_rad) * distances
    return within
