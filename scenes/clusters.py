"""Neighbouring triangles in clusters with boxes, so that what a light cannot reach is skipped cheaply."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.scene import Array, Positions, Triangles

Faces = npt.NDArray[np.int64]
Runs = npt.NDArray[np.int64]

FACES_PER_CLUSTER = 64
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
        corners = positions.astype(np.float64)[triangles]
        order = np.argsort(_morton(corners.mean(axis=1)), kind="stable")
        starts = np.arange(0, len(order), FACES_PER_CLUSTER)
        if not len(starts):
            return cls(order, np.zeros(1, np.int64), np.zeros((0, 3)), np.zeros((0, 3)))
        return cls(
            order,
            np.append(starts, len(order)),
            np.minimum.reduceat(corners.min(axis=1)[order], starts),
            np.maximum.reduceat(corners.max(axis=1)[order], starts),
        )

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


def _morton(points: Array) -> npt.NDArray[np.uint64]:
    if not len(points):
        return np.zeros(0, np.uint64)
    low = points.min(axis=0)
    extent = max(float((points.max(axis=0) - low).max()), np.finfo(np.float64).tiny)
    cells = np.clip((points - low) / extent * 1023, 0, 1023).astype(np.uint64)
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cells = (cells | cells << np.uint64(shift)) & np.uint64(mask)
    keys: npt.NDArray[np.uint64] = cells[:, 0] | cells[:, 1] << np.uint64(1) | cells[:, 2] << np.uint64(2)
    return keys
