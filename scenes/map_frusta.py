"""How a shadow map looks at its receivers: one matrix for each face of the map.

Near and far planes fit the receivers, not the casters: a caster nearer than the near plane is flattened onto
it by depth clamp and still casts. Guard texels around each face keep comparisons inside it.

Depth is 1 at the near plane and 0 at the far plane. The other way round, z and w of a distant point are
nearly equal and round apart: a floor a thousand times wider than the light is high then shadows itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.convex import box_planes, corners
from scenes.frusta import Reach, light_axes
from scenes.scene import Array, Light, LightKind

# The normal offset moves a place on a cube's edge by up to 0.71 texels, and 2x2 reads half a texel further.
GUARD_TEXELS = 2
DEPTH_MARGIN = 0.02
# Of the far distance. A caster that is nearer still casts.
NEAREST = 1e-3
# Beyond, a single perspective map wastes most texels on the rim; six faces do better.
WIDEST_SINGLE_RAD = np.radians(75.0)
# A cone without width still needs a map that has one.
NARROWEST_RAD = 1e-6


@dataclass(frozen=True)
class MapFit:
    """Faces of a map.

    Attributes:
        faces: (k, 4, 4) float64 clip from scene; one, or six in the order +X -X +Y -Y +Z -Z.
    """

    faces: Array


def faces_of(light: Light) -> int:
    """How many faces a map for `light` has: 6 for a point light or a very wide spot, else 1."""
    wide = light.kind is LightKind.SPOT and light.outer_cone_rad > WIDEST_SINGLE_RAD
    return 6 if wide or light.kind is LightKind.POINT else 1


def fit_map(
    light: Light, within: Reach, bounds: Array, side: int, view_planes: Array | None = None
) -> MapFit:
    """The faces of a map of `side` texels that cover what `light` can light.

    Args:
        light: The light.
        within: Its reach, scene space.
        bounds: (2, 3) float64 box of all receivers, scene space.
        side: Texels along a face.
        view_planes: (p, 4) planes of a camera; given, the map covers only what that camera sees.
    """
    if not (bounds[1] > bounds[0]).any():
        return MapFit(np.zeros((0, 4, 4)))
    planes = [box_planes(*_pad(bounds)), within.planes]
    if np.isfinite(within.range_m):
        planes.append(box_planes(within.centre - within.range_m, within.centre + within.range_m))
    if view_planes is not None:
        planes.append(view_planes)
    receivers = corners(np.vstack(planes))
    if not len(receivers):
        return MapFit(np.zeros((0, 4, 4)))
    shrink = 1 - 2 * GUARD_TEXELS / side
    if light.kind is LightKind.DIRECTIONAL:
        return MapFit(_orthographic(light_axes(light), receivers, shrink)[None])
    if faces_of(light) == 6:
        return MapFit(_cube(within.centre, receivers, shrink))
    return MapFit(_spot(light, within.centre, receivers, shrink, focus=view_planes is not None)[None])


def _pad(bounds: Array) -> Array:
    # A flat scene has a box without volume, which has no corners to find.
    margin = 1e-3 * max(float((bounds[1] - bounds[0]).max()), float(np.finfo(np.float32).tiny))
    padded: Array = bounds + np.array([[-margin], [margin]])
    return padded


def _orthographic(axes: Array, receivers: Array, shrink: float) -> Array:
    local = receivers @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    margin = DEPTH_MARGIN * (high[2] - low[2])
    near, far = low[2] - margin, high[2] + margin
    face = np.zeros((4, 4))
    for axis in (0, 1):
        scale = 2 * shrink / (high[axis] - low[axis])
        face[axis, :3] = scale * axes[axis]
        face[axis, 3] = -scale * (high[axis] + low[axis]) / 2
    face[2, :3] = -axes[2] / (far - near)
    face[2, 3] = far / (far - near)
    face[3, 3] = 1
    return face


def _spot(light: Light, centre: Array, receivers: Array, shrink: float, *, focus: bool) -> Array:
    axes = light_axes(light)
    slope = np.tan(max(light.outer_cone_rad, NARROWEST_RAD))
    window = np.array([[-slope, -slope], [slope, slope]])
    local = (receivers - centre) @ axes.T
    far = float(local[:, 2].max())
    ahead = local[local[:, 2] > 1e-6 * far]
    if focus and len(ahead):
        ratios = ahead[:, :2] / ahead[:, 2:]
        window = np.clip(np.stack([ratios.min(axis=0), ratios.max(axis=0)]), *window)
    return _perspective(axes, centre, window, (float(local[:, 2].min()), float(far)), shrink)


def _cube(centre: Array, receivers: Array, shrink: float) -> Array:
    low, high = (receivers - centre).min(axis=0), (receivers - centre).max(axis=0)
    window = np.array([[-1.0, -1.0], [1.0, 1.0]])
    faces = np.zeros((6, 4, 4))
    for face in range(6):
        axis, sign = face // 2, 1 - 2 * (face % 2)
        forward = np.eye(3)[axis] * sign
        axes = np.stack([np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3], forward])
        far = high[axis] if sign > 0 else -low[axis]
        if far > 0:
            faces[face] = _perspective(axes, centre, window, (0.0, far), shrink)
    return faces


def _perspective(
    axes: Array, centre: Array, window: Array, depths: tuple[float, float], shrink: float
) -> Array:
    """Off-centre perspective; `window` is (2, 2): lowest and highest (x, y) at distance 1."""
    far = depths[1] * (1 + DEPTH_MARGIN)
    near = max(depths[0] * (1 - DEPTH_MARGIN), NEAREST * far)
    local = np.hstack([axes, -(axes @ centre)[:, None]])
    middle, half = (window[0] + window[1]) / 2, (window[1] - window[0]) / 2
    face = np.zeros((4, 4))
    for axis in (0, 1):
        face[axis] = shrink / half[axis] * (local[axis] - middle[axis] * local[2])
    face[2] = -local[2] * near / (far - near)
    face[2, 3] += near * far / (far - near)
    face[3] = local[2]
    return face
