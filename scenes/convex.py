"""Corners of convex bodies given by half-spaces."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from scenes.scene import Array

# Relative to the body's size: a corner that three planes share is inside the others up to this rounding.
INSIDE = 1e-9
PARALLEL = 1e-9


def corners(planes: Array) -> Array:
    """(n, 3) float64 corners of the body where planes (p, 4) @ (x, 1) >= 0 for all; none if it is empty.

    Every corner is the meeting point of three planes that satisfies the others: all triples at once, which
    for the dozen planes of a light, a camera and a box is quicker than clipping polygons one by one.
    """
    unit = planes / np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    triples = np.array(list(combinations(range(len(unit)), 3)))
    normals, offsets = unit[triples, :3], unit[triples, 3]
    crosses = np.stack([np.cross(normals[:, (i + 1) % 3], normals[:, (i + 2) % 3]) for i in range(3)], axis=1)
    determinants = np.einsum("ij,ij->i", normals[:, 0], crosses[:, 0])
    meeting = np.abs(determinants) > PARALLEL
    points = -np.einsum("ij,ijk->ik", offsets[meeting], crosses[meeting]) / determinants[meeting, None]
    size = np.abs(unit[:, 3]).max() + np.finfo(np.float64).tiny
    inside = (points @ unit[:, :3].T + unit[:, 3] >= -INSIDE * (size + np.abs(points).max(1)[:, None])).all(1)
    found: Array = points[inside]
    return found


def box_planes(low: Array, high: Array) -> Array:
    """(6, 4) float64 inward planes of an axis-aligned box."""
    normals = np.vstack([np.eye(3), -np.eye(3)])
    return np.hstack([normals, np.concatenate([-low, high])[:, None]])


def clip_planes(clip_from_space: Array) -> Array:
    """(5, 4) float64 inward planes of a camera: left, right, bottom, top, and in front of the eye."""
    x, y, _, w = clip_from_space
    return np.stack([w + x, w - x, w + y, w - y, w])
