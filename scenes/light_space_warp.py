"""Maps of a light warped within the light's own space (Wimmer, Scherzer and Purgathofer 2004).

The perspective stands across the light's rays, along the view: no light is ever inverted by it. Written here
for every light as a homography of its ordinary map, t being the coordinate along the view's projection:
x and y over w (t - t0 + n), with the free parameter n of the paper's section 4.
"""

from __future__ import annotations

import numpy as np

from scenes.perspective_warp import fitted
from scenes.scene import Array

# Of the length of the view direction across the light's rays: the view runs along them, nothing to warp.
PARALLEL = 1e-6


def light_space_warps(
    light: Array, corners: Array, forward: Array, parameters: Array, shrink: float
) -> Array:
    """(k, 3, 4) float64 rows x, y and w of clip from scene, one for each free parameter.

    Args:
        light: (4,) float64 homogeneous, scene space.
        corners: (n, 3) float64 of the receivers.
        forward: (3,) float64 unit view direction.
        parameters: (k,) float64: n over the receivers' extent along the view. Large ones do not warp.
        shrink: Share of a map's side that is left between its guard texels.
    """
    plane = _plane(light, corners, forward)
    t, w = (corners @ row[:3] + row[3] for row in plane[1:])
    along = t / w
    near, extent = along.min(), max(np.ptp(along), 1e-12)
    start = near - parameters[:, None] * extent
    rows = np.broadcast_to(plane, (len(parameters), 3, 4)).copy()
    rows[:, 2] = plane[1] - start * plane[2]
    return fitted(rows, np.broadcast_to(corners, (len(parameters), *corners.shape)), shrink)


def _plane(light: Array, corners: Array, forward: Array) -> Array:
    """(3, 4) rows of the light's ordinary map: across the view, along its projection, and w."""
    middle = corners.mean(axis=0)
    axis = middle - light[:3] if light[3] else -light[:3]
    axis = axis / np.linalg.norm(axis)
    along = forward - (forward @ axis) * axis
    if np.linalg.norm(along) < PARALLEL:
        along = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    along /= np.linalg.norm(along)
    basis = np.stack([np.cross(axis, along), along, axis])
    origin = light[:3] if light[3] else np.zeros(3)
    rows = np.hstack([basis, -(basis @ origin)[:, None]])
    if not light[3]:
        rows[2] = [0, 0, 0, 1]
    return rows
