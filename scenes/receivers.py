"""The part of a scene that a light can light, and a camera can see."""

from __future__ import annotations

import numpy as np

from scenes.convex import box_planes, corners
from scenes.frusta import Reach
from scenes.scene import Array

# Relative to the largest side: a flat scene has a box without volume, which has no corners to find.
PADDING = 1e-3


def receiver_corners(bounds: Array, within: Reach, view_planes: Array | None = None) -> Array:
    """(n, 3) float64 corners of a convex body that holds every receiver; none if there can be none.

    Args:
        bounds: (2, 3) float64 box of all geometry.
        within: The light's reach, in the same space.
        view_planes: (p, 4) inward planes of a camera, to keep only what it may see.
    """
    margin = PADDING * max(float((bounds[1] - bounds[0]).max()), float(np.finfo(np.float32).tiny))
    low = np.maximum(bounds[0] - margin, within.centre - within.range_m)
    high = np.minimum(bounds[1] + margin, within.centre + within.range_m)
    if (low >= high).any():
        return np.zeros((0, 3))
    planes = [box_planes(low, high), within.planes]
    if view_planes is not None:
        planes.append(view_planes)
    return corners(np.vstack(planes))
