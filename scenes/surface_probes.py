"""Places on a scene's surfaces that stand for all of them, chosen once for every light and camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.clusters import Clusters
from scenes.corner_blocks import corner_blocks, face_crosses, lengths
from scenes.frusta import Reach, boxes_inside
from scenes.scene import Array, Positions, Triangles

PROBES = 4096
LEAST_PER_CLUSTER = 2
# Multiples of the inverse powers of the plastic number fill a square evenly (Roberts 2018, "The unreasonable
# effectiveness of quasirandom sequences").
PLASTIC = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True)
class SurfaceProbes:
    """Points spread over triangles by area, at least a few in each cluster.

    Attributes:
        clusters: The clusters of the triangles.
        starts: (c + 1,) int64: cluster i has probes starts[i] .. starts[i + 1].
        points: (n, 3) float64 scene space.
        normals: (n, 3) float64 unit, of either side.
        areas: (n,) float64: the part of the surface that a probe stands for, square metres.
    """

    clusters: Clusters
    starts: npt.NDArray[np.int64]
    points: Array
    normals: Array
    areas: Array

    @classmethod
    def of(cls, positions: Positions, triangles: Triangles, clusters: Clusters) -> SurfaceProbes:
        """Probes on (t, 3) triangles that stand in cluster order."""
        areas = np.zeros(len(triangles))
        for part, corners in corner_blocks(positions, triangles):
            areas[part] = lengths(face_crosses(corners)) / 2
        totals = np.concatenate([[0.0], np.cumsum(areas)])
        low, high = totals[clusters.starts[:-1]], totals[clusters.starts[1:]]
        counts = np.maximum(LEAST_PER_CLUSTER, np.ceil(PROBES * (high - low) / max(totals[-1], 1e-300)))
        counts = np.where(high > low, counts, 0).astype(np.int64)
        starts = np.concatenate([[0], np.cumsum(counts)])
        owner = np.repeat(np.arange(len(counts)), counts)
        index = np.arange(len(owner)) - starts[owner]
        place = low[owner] + (high - low)[owner] * ((index + 0.5) / counts[owner])
        face = np.clip(np.searchsorted(totals, place, side="right") - 1, 0, max(len(areas) - 1, 0))
        chosen = positions[triangles[face]].astype(np.float64)
        crosses = np.cross(chosen[:, 1] - chosen[:, 0], chosen[:, 2] - chosen[:, 0])
        weights = _barycentric(len(owner))
        return cls(
            clusters=clusters,
            starts=starts,
            points=np.einsum("nk,nkc->nc", weights, chosen),
            normals=crosses / np.maximum(2 * areas[face, None], 1e-300),
            areas=(high - low)[owner] / np.maximum(counts[owner], 1),
        )

    def seen(self, within: Reach, view_planes: Array, eye: Array, light: Array) -> tuple[Array, Array, Array]:
        """Points (n, 3), normals (n, 3) and weights (n,) of what a light may light and a camera may see.

        Args:
            within: The light's reach.
            view_planes: (p, 4) inward planes of the camera.
            eye: (3,) its position.
            light: (4,) the light, homogeneous, scene space.

        A weight is the share of the view that a probe's part of the surface fills, occlusion aside.
        """
        low, high = self.clusters.low, self.clusters.high
        kept = np.repeat(
            within.touches(low, high) & boxes_inside(view_planes, low, high), np.diff(self.starts)
        )
        points, normals = self.points[kept], self.normals[kept]
        to_eye, to_light = eye - points, light[:3] - light[3] * points
        planes = np.vstack([view_planes, within.planes])
        inside = (points @ planes[:, :3].T + planes[:, 3] > 0).all(axis=1)
        inside &= ~(light[3] * np.linalg.norm(to_light, axis=1) > within.range_m)
        towards_eye = np.einsum("ij,ij->i", normals, to_eye)
        # Both on one side of the surface: what faces away from the light is dark whatever a map says.
        inside &= towards_eye * np.einsum("ij,ij->i", normals, to_light) > 0
        distances = np.linalg.norm(to_eye, axis=1)
        weights = self.areas[kept] * np.abs(towards_eye) / np.maximum(distances, 1e-300) ** 3
        return points[inside], normals[inside], weights[inside]


def _barycentric(count: int) -> Array:
    """(n, 3) float64 evenly spread barycentric coordinates."""
    index = np.arange(1, count + 1)
    u, v = (index * step % 1.0 for step in PLASTIC)
    root = np.sqrt(u)
    weights: Array = np.stack([1 - root, root * (1 - v), root * v], axis=1)
    return weights
