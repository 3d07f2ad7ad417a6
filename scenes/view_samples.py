"""What a coarse grid of a view's pixels shows, by rays instead of a rasteriser."""

from __future__ import annotations

from dataclasses import dataclass
from math import tan

import numpy as np

from scenes.ray_caster import Bools, RayCaster
from scenes.scene import Array, View


@dataclass(frozen=True)
class ViewSamples:
    """Surfaces behind the cells of a grid over a view.

    Attributes:
        shown: (m,) bool: which cells, row by row from the top left, show a surface.
        points: (m, 3) float64 world, metres; zeros where nothing is shown.
        normals: (m, 3) float64 unit, towards the eye; zeros where nothing is shown, or a triangle is empty.
        distances: (m,) float64 from the eye, metres; zero where nothing is shown.
    """

    shown: Bools
    points: Array
    normals: Array
    distances: Array

    @classmethod
    def of(
        cls, caster: RayCaster, view: View, grid: tuple[int, int], shift: tuple[float, float] = (0.0, 0.0)
    ) -> ViewSamples:
        """The middle of each cell of `grid` (across, down).

        Args:
            caster: Of all meshes.
            view: Its pixels' shape counts, not their number.
            grid: Cells across and down.
            shift: How far, in heights of the view, all samples are moved to the right and down.
        """
        rays = _rays(view, grid, shift)
        eye = np.asarray(view.camera.position, float)
        distances, triangles = caster.hits(np.broadcast_to(eye, rays.shape), rays)
        shown = np.isfinite(distances)
        distances = np.where(shown, distances, 0.0)
        points, normals = np.zeros(rays.shape), np.zeros(rays.shape)
        points[shown] = eye + distances[shown, None] * rays[shown]
        corners = caster.corners(triangles[shown])
        crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(crosses, axis=1)
        crosses /= np.where(lengths > 0, lengths, 1.0)[:, None]
        away = np.einsum("ij,ij->i", crosses, rays[shown]) > 0
        normals[shown] = np.where(away[:, None], -crosses, crosses)
        return cls(shown, points, normals, distances)


def _rays(view: View, grid: tuple[int, int], shift: tuple[float, float]) -> Array:
    """(m, 3) unit directions through the middles of the cells."""
    forward, up = np.asarray(view.camera.forward, float), np.asarray(view.camera.up, float)
    high = tan(view.camera.yfov_rad / 2)
    wide = high * view.width / view.height
    across = ((np.arange(grid[0]) + 0.5) / grid[0] * 2 - 1) * wide + 2 * high * shift[0]
    down = (1 - (np.arange(grid[1]) + 0.5) / grid[1] * 2) * high - 2 * high * shift[1]
    y, x = np.meshgrid(down, across, indexing="ij")
    rays = forward + x.reshape(-1, 1) * np.cross(forward, up) + y.reshape(-1, 1) * up
    unit: Array = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return unit
