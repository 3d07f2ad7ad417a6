"""What a camera shows of a light, traced on the processor: pictures of views where there is no GPU."""

from __future__ import annotations

import numpy as np

from scenes.lit_view import in_reach, view_rays
from scenes.ray_caster import Indices, RayCaster
from scenes.scene import Array, Camera, Light, Scene

AMBIENT = 0.12
"""Share of a surface's color that is seen without light, so that one sees where one is."""
HEADLIGHT = 0.1
"""The same, of a surface that faces the eye: what is in shadow keeps its edges."""
LIT = 0.7
"""The same, of what is lit squarely, so that white walls stay apart from what burns out."""
SKY = (0.10, 0.13, 0.19)
"""Linear RGB where no surface is."""

# Of the extent: what is struck lies off its surface by so much, as float32 rounds.
_ROUNDING = 1e-6


class RayTracer:
    """A scene, ready to be looked at.

    Args:
        scene: Its meshes with their colors.
        surfaces: All of them, to spare building it again.
    """

    def __init__(self, scene: Scene, surfaces: RayCaster | None = None) -> None:
        self._surfaces = surfaces or RayCaster(scene, casters_only=False)
        every = all(mesh.casts for mesh in scene.meshes)
        self._casters = self._surfaces if every else RayCaster(scene)
        colors = [np.tile(mesh.base_color, (mesh.triangle_count, 1)) for mesh in scene.meshes]
        self._colors = np.concatenate([np.zeros((0, 3)), *colors])

    def picture(self, camera: Camera, light: Light, width: int, height: int) -> Array:
        """(h, w, 3) float64 linear RGB, top row first: surfaces lit by one light without fall-off.

        Args:
            camera: The view, shown at 16 to 9.
            light: Cone, range and shadows count; its color and intensity do not.
            width: Pixels across.
            height: Pixels down.
        """
        rays = view_rays(camera, width, height)
        eye = np.asarray(camera.position, float)
        distances, triangles = self._surfaces.hits(np.broadcast_to(eye, rays.shape), rays)
        struck = triangles >= 0
        picture = np.tile(np.asarray(SKY), (len(rays), 1))
        picture[struck] = self._shaded(
            eye + distances[struck, None] * rays[struck], rays[struck], triangles[struck], light
        )
        return picture.reshape(height, width, 3)

    def _shaded(self, points: Array, rays: Array, triangles: Indices, light: Light) -> Array:
        corners = self._surfaces.corners(triangles)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
        facing = np.einsum("ij,ij->i", normals, rays)
        normals *= np.where(facing > 0, -1.0, 1.0)[:, None]
        to_light = light.homogeneous[:3] - light.homogeneous[3] * points
        to_light /= np.maximum(np.linalg.norm(to_light, axis=1), np.finfo(float).tiny)[:, None]
        reached = np.flatnonzero(in_reach(points, light))
        error = _ROUNDING * self._surfaces.extent
        lit = np.zeros(len(points), bool)
        lit[reached] = self._casters.lit(points[reached], normals[reached], light, position_error=error)
        brightness = AMBIENT + HEADLIGHT * np.abs(facing)
        brightness += LIT * lit * np.einsum("ij,ij->i", normals, to_light)
        shaded: Array = self._colors[triangles] * brightness[:, None]
        return shaded
