"""Maps of a light that are drawn after a camera's perspective, so that what is near the eye gets more texels.

Perspective shadow maps (Stamminger and Drettakis 2002). Wherever the light stands after that perspective,
inverted behind the eye or at infinity, the result is the ordinary map of the same light with its image plane
warped by a homography: x, y and w of clip-from-scene vanish at the light, so each ray from it keeps its place
on the map, and w changes along no ray but by its distance. So there are no special cases: one sign makes w
positive on all receivers, and then on all that may shadow them, behind the eye too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.scene import Array
from scenes.virtual_camera import VirtualCameras

# Of the homogeneous light after the camera's perspective: nearer to zero its w is rounding.
AT_INFINITY = 1e-9
# The axis need not be the best: another only turns the map's plane a little.
CONE_STEPS = 12
# Of the distance of the farthest corner.
APEX = 1e-6
# Of the far distance; a receiver that is nearer to its light counts as lit.
NEAREST = 1e-3
DEPTH_MARGIN = 0.02
NARROWEST = 1e-12


@dataclass(frozen=True)
class Warps:
    """Maps of one light, one for each virtual camera.

    Attributes:
        rows: (k, 3, 4) float64 x, y and w of clip from scene: receivers within -1 .. 1, w positive.
        half_angles: (k,) float64 radians, of the cone in which the light sees the receivers after the
            camera's perspective; 0 where it then stands at infinity.
        camera_depths: (k, 4) float64 a row that over w grows along the light's rays: the depth that a map
            drawn after the camera's perspective would store.
        inverted: (k,) bool: the light is behind the virtual camera.
    """

    rows: Array
    half_angles: Array
    camera_depths: Array
    inverted: Array


def warps(cameras: VirtualCameras, light: Array, shrink: float) -> Warps:
    """The maps that see each virtual camera's receivers from `light`, (4,) float64 homogeneous, scene space.

    `shrink` is the share of a map's side that is left between its guard texels.
    """
    clip, corners = cameras.clip_from_scene, cameras.projected
    there = clip @ light
    size = np.linalg.norm(there[:, :3], axis=1)
    at_infinity = np.abs(there[:, 3]) <= AT_INFINITY * size
    place = np.where(at_infinity[:, None], 0, there[:, :3] / np.where(at_infinity, 1, there[:, 3])[:, None])
    directions = corners - place[:, None]
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    axis = np.where(at_infinity[:, None], -there[:, :3] / size[:, None], _cone_axes(directions))
    half = np.arccos(np.clip(np.einsum("kc,knc->kn", axis, directions).min(axis=1), -1, 1))
    basis = np.stack([*_across(axis), axis], axis=1)
    # Coordinates along right, up and axis from the light's place, times the virtual camera's w.
    local = basis @ (clip[:, :3] - place[:, :, None] * clip[:, 3:])
    depths = np.where(at_infinity[:, None], local[:, 2], -np.sign(there[:, 3:]) * clip[:, 3])
    local[:, 2] = np.where(at_infinity[:, None], clip[:, 3], local[:, 2])
    return Warps(
        rows=fitted(local, cameras.corners, shrink),
        half_angles=np.where(at_infinity, 0.0, half),
        camera_depths=depths,
        inverted=~at_infinity & (there[:, 3] < 0),
    )


def _cone_axes(directions: Array) -> Array:
    """(k, 3) axes of nearly the smallest cones that hold (k, n, 3) unit directions.

    Badoiu and Clarkson 2003, "Smaller core-sets for balls": step towards the worst, ever shorter.
    """
    axis = directions.mean(axis=1)
    rows = np.arange(len(axis))
    for step in range(CONE_STEPS):
        worst = np.einsum("kc,knc->kn", axis, directions).argmin(axis=1)
        axis = axis + (directions[rows, worst] - axis) / (step + 2)
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    found: Array = axis
    return found


def _across(axis: Array) -> tuple[Array, Array]:
    """Two (k, 3) unit vectors across each axis; the second leans towards the view's depth where it can."""
    helper = np.where(np.abs(axis[:, 2:]) > 0.9, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
    right = np.cross(axis, helper)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    return right, np.cross(right, axis)


def fitted(rows: Array, corners: Array, shrink: float) -> Array:
    """(k, 3, 4) rows x, y and w, x and y scaled and moved so that (k, n, 3) corners fill a map's side."""
    q = np.einsum("krc,knc->knr", rows[..., :3], corners) + rows[:, None, :, 3]
    ratios = q[..., :2] / q[..., 2:]
    low, high = ratios.min(axis=1), ratios.max(axis=1)
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, NARROWEST)
    across = shrink * (rows[:, :2] - middle[..., None] * rows[:, 2:]) / half[..., None]
    # Shaders take squares of squares: w of up to 1 keeps them from overflowing.
    scaled: Array = np.concatenate([across, rows[:, 2:]], axis=1) / q[..., 2].max(axis=1)[:, None, None]
    return scaled


def ahead_of(light: Array, corners: Array) -> Array:
    """Those of (n, 3) corners that are not the light itself, which may be a corner of its own body.

    From there every direction is one of those to the other corners.
    """
    if light[3] == 0:
        return corners
    distances = np.linalg.norm(corners - light[:3], axis=1)
    others: Array = corners[distances > APEX * distances.max()]
    return others


def with_depth(rows: Array, along: Array, light: Array, corners: Array, *, inverted: bool = False) -> Array:
    """(4, 4) float64 clip from scene: rows x, y and w, and a depth that falls from 1 to 0 along each ray.

    Args:
        rows: (3, 4) x, y and w, positive on the receivers.
        along: (4,) a row that over w grows along the light's rays. Any will do: the depth row of a map is
            free but for that, and with depth clamp it need not reach back to the casters.
        light: (4,) homogeneous.
        corners: (n, 3) of the receivers. Where a light has a place, depth begins a thousandth of the way.
        inverted: Whether casters behind the eye have the other sign (Kozlov 2004): near is then as far
            below zero as far is above it.
    """
    if light[3] != 0:
        corners = np.vstack([corners, light[:3] + NEAREST * (corners - light[:3])])
    growth = (corners @ along[:3] + along[3]) / (corners @ rows[2, :3] + rows[2, 3])
    near, far = float(growth.min()), float(growth.max())
    span = max(far - near, float(np.finfo(np.float32).tiny))
    near, far = (end + sign * DEPTH_MARGIN * min(span, abs(end)) for end, sign in ((near, -1), (far, 1)))
    if inverted:
        near = -far
    return np.stack([rows[0], rows[1], (far * rows[2] - along) / (far - near), rows[2]])


def universal_depth(light: Array, corners: Array) -> Array:
    """(4,) float64 row that over w grows along the rays of any light: the distance from a middle plane.

    Directional: along the rays. Point and spot: along the axis through the middle; any row that is not
    zero at the light would do, such as -1, but with this one a surface across the axis has nearly the same
    depth on the whole map, so that the polygon offset does not lift its shadow.
    """
    middle = corners.mean(axis=0)
    axis = middle - light[:3] if light[3] else -light[:3]
    axis = axis / np.linalg.norm(axis)
    return np.array([*axis, -axis @ middle])
