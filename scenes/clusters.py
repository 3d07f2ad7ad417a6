"""Neighbouring triangles in clusters with boxes, so that what a light cannot reach is skipped cheaply."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.scene import Array, Positions, Triangles

Runs = npt.NDArray[np.int64]

FACES_PER_CLUSTER = 64


@dataclass(frozen=True)
class Clusters:
    """Triangles along a Morton curve, cut into runs of `FACES_PER_CLUSTER`.

    Attributes:
        order: (t,) int64: triangle indices in cluster order.
        low, high: (c, 3) float64 boxes, metres.
    """

    order: npt.NDArray[np.int64]
    low: Array
    high: Array

    @classmethod
    def of(cls, positions: Positions, triangles: Triangles) -> Clusters:
        """Clusters of (t, 3) triangles."""
        corners = positions.astype(np.float64)[triangles]
        order = np.argsort(_morton(corners.mean(axis=1)), kind="stable")
        starts = np.arange(0, len(order), FACES_PER_CLUSTER)
        if not len(starts):
            return cls(order, np.zeros((0, 3)), np.zeros((0, 3)))
        return cls(
            order,
            np.minimum.reduceat(corners.min(axis=1)[order], starts),
            np.maximum.reduceat(corners.max(axis=1)[order], starts),
        )

    def runs(self, kept: npt.NDArray[np.bool_]) -> Runs:
        """(r, 2) int64: first face and count of each maximal run of the kept (c,) clusters."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]]).astype(np.int8)))
        first, stop = edges[::2] * FACES_PER_CLUSTER, edges[1::2] * FACES_PER_CLUSTER
        return np.stack([first, np.minimum(stop, len(self.order)) - first], axis=1)


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
