"""The part of a scene that a light can light, and a camera can see."""

from __future__ import annotations

import numpy as np

from scenes.convex import NOTHING, Body, box_planes
from scenes.frusta import Reach, boxes_inside
from scenes.scene import Array

# Relative to the largest side: a flat scene has a box without volume, which has no corners to find.
PADDING = 1e-3


def receiver_body(low: Array, high: Array, within: Reach, view_planes: Array | None = None) -> Body:
    """A convex body that holds every receiver; empty if there can be none.

    Args:
        low: (n, 3) float64 lowest corners of boxes that hold all geometry.
        high: (n, 3) float64 highest corners.
        within: The light's reach, in the same space.
        view_planes: (5, 4) inward planes of a camera, to keep only what it may see. The last one looks
            along the view: the body also lies between the nearest and the farthest box that is kept.
    """
    kept = within.touches(low, high)
    if view_planes is not None:
        kept &= boxes_inside(view_planes, low, high)
    if not kept.any():
        return NOTHING
    low, high = low[kept], high[kept]
    if not (high.max(axis=0) > low.min(axis=0)).any():
        return NOTHING
    margin = _margin(low.min(axis=0), high.max(axis=0))
    box_low = np.maximum(low.min(axis=0) - margin, within.centre - within.range_m)
    box_high = np.minimum(high.max(axis=0) + margin, within.centre + within.range_m)
    if (box_low >= box_high).any():
        return NOTHING
    body = Body(np.vstack([box_planes(box_low, box_high), within.planes]))
    if view_planes is None:
        return body
    return body.cut(view_planes).cut(_slab(view_planes[-1], low - margin, high + margin))


def _margin(low: Array, high: Array) -> float:
    return PADDING * max(float((high - low).max()), float(np.finfo(np.float32).tiny))


def _slab(plane: Array, low: Array, high: Array) -> Array:
    """(2, 4) planes parallel to `plane`, one on each side of all boxes."""
    normal = plane[:3]
    nearest = np.where(normal >= 0, low, high) @ normal
    farthest = np.where(normal >= 0, high, low) @ normal
    return np.array([[*normal, -nearest.min()], [*-normal, farthest.max()]])
