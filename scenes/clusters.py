"""Neighbouring triangles in clusters with boxes, so that what a light cannot reach is skipped cheaply."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.corner_blocks import TRIANGLES_AT_ONCE, corner_blocks
from scenes.scene import Array, Positions, Triangles

Faces = npt.NDArray[np.int64]
Runs = npt.NDArray[np.int64]

FACES_PER_CLUSTER = 64
assert TRIANGLES_AT_ONCE % FACES_PER_CLUSTER == 0
# Of the size of a scene and of its distance from zero.
BESIDE = 1e-3
ROUNDED = 4e-7


@dataclass(frozen=True)
class Clusters:
    """Triangles along a Morton curve, cut into runs of `FACES_PER_CLUSTER`.

    Attributes:
        order: (t,) int64: triangle indices in cluster order.
        starts: (c + 1,) int64: cluster i holds places starts[i] .. starts[i + 1] of that order.
        low: (c, 3) float64 lowest corner of each cluster's box, metres.
        high: (c, 3) float64 highest corner.
    """

    order: Faces
    starts: Faces
    low: Array
    high: Array

    @classmethod
    def of(cls, positions: Positions, triangles: Triangles) -> Clusters:
        """Clusters of (t, 3) triangles."""
        middles = np.zeros((3, len(triangles)))
        for part, corners in corner_blocks(positions, triangles):
            middles[:, part] = (corners[0] + corners[1] + corners[2]) / 3
        order = np.argsort(_morton(middles), kind="stable")
        low, high = _boxes(positions, np.take(triangles, order, axis=0))
        starts = np.minimum(np.arange(len(low) + 1) * FACES_PER_CLUSTER, len(order))
        return cls(order, starts, low, high)

    def runs(self, kept: npt.NDArray[np.bool_]) -> Runs:
        """(r, 2) int64: first face and count of each maximal run of the kept (c,) clusters."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]]).astype(np.int8)))
        first, stop = self.starts[edges[::2]], self.starts[edges[1::2]]
        return np.stack([first, stop - first], axis=1)

    def edge_on(self, positions: Positions, triangles: Triangles, place: Array) -> Faces:
        """Faces beside a light at `place`, (3,) float64, whose planes hold it to within rounding.

        They cast no shadow. Drawn from there, float32 would lift them off the light to one side, and they
        would cover half of all it lights.

        Args:
            positions: (v, 3) float32.
            triangles: (t, 3), in cluster order.
            place: In the same space.
        """
        if not len(self.low):
            return np.zeros(0, np.int64)
        size = float(np.linalg.norm(self.high.max(axis=0) - self.low.min(axis=0)) + np.abs(place).max())
        margin = BESIDE * size
        beside = ((self.low - margin <= place) & (place <= self.high + margin)).all(axis=1)
        faces = _members(self.runs(np.asarray(beside)))
        corners = positions[triangles[faces]].astype(np.float64) - place
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        heights = np.abs(np.einsum("ij,ij->i", normals, corners[:, 0]))
        near = ((corners.min(axis=1) <= margin) & (corners.max(axis=1) >= -margin)).all(axis=1)
        found: Faces = faces[near & (heights <= ROUNDED * size * np.linalg.norm(normals, axis=1))]
        return found

    def followed_by(self, other: Clusters) -> Clusters:
        """These clusters, and behind them those of `other`, whose triangles come after these."""
        return Clusters(
            np.concatenate([self.order, other.order + len(self.order)]),
            np.concatenate([self.starts, other.starts[1:] + len(self.order)]),
            np.concatenate([self.low, other.low]),
            np.concatenate([self.high, other.high]),
        )


def without(runs: Runs, faces: Faces) -> Runs:
    """(r, 2) runs of faces, ascending, cut around those in `faces`."""
    if not len(faces):
        return runs
    left = np.setdiff1d(_members(runs), faces, assume_unique=True)
    starts = np.flatnonzero(np.diff(left, prepend=-2) != 1)
    return np.stack([left[starts], np.diff(np.append(starts, len(left)))], axis=1)


def _members(runs: Runs) -> Faces:
    """(n,) int64: every face of (r, 2) runs."""
    first, counts = runs[:, 0], runs[:, 1]
    ends = np.cumsum(counts)
    members: Faces = np.arange(ends[-1] if len(ends) else 0) + np.repeat(first - (ends - counts), counts)
    return members


def _boxes(positions: Positions, triangles: Triangles) -> tuple[Array, Array]:
    """(c, 3) float64 lowest and highest corners of clusters of (t, 3) triangles in cluster order."""
    low, high = np.zeros((2, -(-len(triangles) // FACES_PER_CLUSTER), 3))
    for part, corners in corner_blocks(positions, triangles):
        starts = np.arange(0, part.stop - part.start, FACES_PER_CLUSTER)
        first = part.start // FACES_PER_CLUSTER
        clusters = slice(first, first + len(starts))
        low[clusters] = np.minimum.reduceat(corners.min(axis=0), starts, axis=1).T
        high[clusters] = np.maximum.reduceat(corners.max(axis=0), starts, axis=1).T
    return low, high


def _morton(points: Array) -> npt.NDArray[np.uint32]:
    """(n,) uint32 places of (3, n) points along the curve, ten bits for each axis."""
    keys = np.zeros(points.shape[1], np.uint32)
    if not len(keys):
        return keys
    low = points.min(axis=1)
    extent = max(float((points.max(axis=1) - low).max()), np.finfo(np.float64).tiny)
    for axis in range(3):
        cells = np.clip((points[axis] - low[axis]) / extent * 1023, 0, 1023).astype(np.uint32)
        for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
            cells = (cells | cells << np.uint32(shift)) & np.uint32(mask)
        keys |= cells << np.uint32(axis)
    return keys
