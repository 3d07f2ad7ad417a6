"""Convex bodies given by half-spaces, and their corners."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations

import numpy as np
import numpy.typing as npt

from scenes.scene import Array

# Relative to the body's size: a corner that three planes share is inside the others up to this rounding.
INSIDE = 1e-9
PARALLEL = 1e-9
SECOND, THIRD = [1, 2, 0], [2, 0, 1]


@dataclass(frozen=True)
class Body:
    """The points x where planes @ (x, 1) >= 0 for all planes; nothing where there are none.

    Attributes:
        planes: (p, 4) float64 inward planes.
    """

    planes: Array

    @cached_property
    def corners(self) -> Array:
        """(n, 3) float64; none if the body is empty. It must be bounded."""
        return corners(self.planes) if len(self.planes) else np.zeros((0, 3))

    def cut(self, planes: Array) -> Body:
        """The part of it on the inner side of (q, 4) more planes."""
        return Body(np.vstack([self.planes, planes])) if len(self.planes) else self


NOTHING = Body(np.zeros((0, 4)))


def corners(planes: Array) -> Array:
    """(n, 3) float64 corners of the body where planes (p, 4) @ (x, 1) >= 0 for all; none if it is empty.

    Every corner is the meeting point of three planes that satisfies the others: all triples at once, which
    for the dozen planes of a light, a camera and a box is quicker than clipping polygons one by one.
    """
    unit = planes / np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    triples = _triples(len(unit))
    x, y, z, offsets = np.moveaxis(unit[triples], 2, 0)
    # Cross products of the other two normals; numpy's own cross costs three times as much here.
    crosses = np.stack(
        [a[:, SECOND] * b[:, THIRD] - b[:, SECOND] * a[:, THIRD] for a, b in ((y, z), (z, x), (x, y))], axis=2
    )
    determinants = x[:, 0] * crosses[:, 0, 0] + y[:, 0] * crosses[:, 0, 1] + z[:, 0] * crosses[:, 0, 2]
    meeting = np.abs(determinants) > PARALLEL
    points = -(offsets[meeting, :, None] * crosses[meeting]).sum(axis=1) / determinants[meeting, None]
    size = np.abs(unit[:, 3]).max() + np.finfo(np.float64).tiny
    inside = (points @ unit[:, :3].T + unit[:, 3] >= -INSIDE * (size + np.abs(points).max(1)[:, None])).all(1)
    found: Array = points[inside]
    return found


@cache
def _triples(count: int) -> npt.NDArray[np.int64]:
    return np.array(list(combinations(range(count), 3)), np.int64).reshape(-1, 3)


def box_planes(low: Array, high: Array) -> Array:
    """(6, 4) float64 inward planes of an axis-aligned box."""
    normals = np.vstack([np.eye(3), -np.eye(3)])
    return np.hstack([normals, np.concatenate([-low, high])[:, None]])


def clip_planes(clip_from_space: Array) -> Array:
    """(5, 4) float64 inward planes of a camera: left, right, bottom, top, and in front of the eye."""
    x, y, _, w = clip_from_space
    return np.stack([w + x, w - x, w + y, w - y, w])
