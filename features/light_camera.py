"""Features of how light and camera stand to each other and to what is seen."""

from __future__ import annotations

from math import degrees, log2

import numpy as np

from features.light_cut_off import FARTHEST
from features.light_view import LightView
from scenes.scene import Array, LightKind

RIGHT_ANGLE_DEG = 90.0
SMALLEST_TEXEL_PX = 1 / 64
"""A texel that looks smaller, or none at all, makes no difference any more."""


def view_light_angle(one: LightView) -> float:
    """Mean angle between the view's axis and the light's rays at what is seen: 0 for a light in the back.

    Unit: degrees; 90 where nothing is seen. Range: 0 to 180. Source: Stamminger and Drettakis 2002,
    section 3: warps lose their gain towards 180, the duelling frusta.
    """
    found = one.receivers
    cosines = -found.ways[found.asked] @ np.asarray(one.view.camera.forward)
    angles = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    return float(angles.mean()) if len(angles) else RIGHT_ANGLE_DEG


def light_ahead(one: LightView) -> float:
    """Angle between the view's axis and the way from the eye to the light: beyond 90 it is behind.

    Unit: degrees; 90 for a light in the eye. Range: 0 to 180. Source: Kozlov 2004: lights behind the eye.
    """
    light, eye = one.light.homogeneous, np.asarray(one.view.camera.position)
    way = light[:3] - light[3] * eye
    length = float(np.linalg.norm(way))
    if length == 0:
        return RIGHT_ANGLE_DEG
    return degrees(float(np.arccos(np.clip(way @ np.asarray(one.view.camera.forward) / length, -1.0, 1.0))))


def light_distance(one: LightView) -> float:
    """Median distance of what is seen from the light, in diagonals of the scene; 4 for a directional light.

    Unit: diagonals. Range: 0 to 4; 4 where nothing is seen. Source: corpus axis `light_distance`.
    """
    found = one.receivers
    if one.light.kind is LightKind.DIRECTIONAL:
        return FARTHEST
    return _median(found.to_light[found.asked], one)


def eye_distance(one: LightView) -> float:
    """Median distance of what is seen from the eye, in diagonals of the scene.

    Unit: diagonals. Range: 0 to 4; 4 where nothing is seen. Source: corpus axis `eye_distance`.
    """
    found = one.receivers
    return _median(found.to_eye[found.asked], one)


def depth_ratio(one: LightView) -> float:
    """How much farther the far receivers in view are than the near ones: 95th over 5th percentile.

    Unit: log2 of the ratio; 0 where nothing is seen. Range: 0 to about 20. Source: Stamminger and Drettakis
    2002, section 3: perspective aliasing grows with it.
    """
    found = one.receivers
    distances = found.to_eye[found.asked]
    if not len(distances):
        return 0.0
    near, far = np.percentile(distances, [5, 95])
    return float(np.log2(far / near)) if near > 0 else 0.0


def edge_distance(one: LightView) -> float:
    """Distance of the nearest shadow edges in view from the eye (5th percentile), in diagonals of the scene.

    Unit: diagonals. Range: 0 to 4; 4 where no edge is seen. Source: corpus axis `boundary_distance`.
    """
    distances = one.edge_distances
    return (
        min(float(np.percentile(distances, 5)) / one.level.extent_m, FARTHEST) if len(distances) else FARTHEST
    )


def incidence(one: LightView) -> float:
    """Mean cosine at which the light strikes what is seen: small where it grazes, and maps need their bias.

    Unit: none; 1 where nothing is seen. Range: 0 to 1. Source: Stamminger and Drettakis 2002, section 3:
    projection aliasing.
    """
    found = one.receivers
    cosines = np.einsum("ij,ij->i", found.normals[found.asked], found.ways[found.asked])
    return float(np.clip(cosines.mean(), 0.0, 1.0)) if len(cosines) else 1.0


def map_texel(one: LightView) -> float:
    """How large the texels of a map of 1024 a side look that covers all the light lights; the view for a sun.

    Unit: log2 of pixels, the longest extent, 95th percentile of what is seen. Range: -6 to 20; -6 where
    nothing is seen. Source: Stamminger and Drettakis 2002, section 3, by the Jacobian of
    `scenes/texel_footprint.py`.
    """
    sun = one.light.kind is LightKind.DIRECTIONAL
    return _pixels(one.texels.view if sun else one.texels.light)


def warped_texel(one: LightView) -> float:
    """The same for the best of sixteen warped maps, or the map that fits the view where none is better.

    Unit, range and source: as for `map_texel`; Wimmer, Scherzer and Purgathofer 2004, section 4.
    """
    return _pixels(min(one.texels.warped, one.texels.view))


def warp_gain(one: LightView) -> float:
    """How much smaller the best warp makes the texels of a map that fits the view; negative if larger.

    Unit: log2 of the ratio of their extents. Range: -26 to 26. Source: as above.
    """
    return _pixels(one.texels.view) - _pixels(one.texels.warped)


def _median(distances: Array, one: LightView) -> float:
    return min(float(np.median(distances)) / one.level.extent_m, FARTHEST) if len(distances) else FARTHEST


def _pixels(extent: float) -> float:
    return log2(max(extent, SMALLEST_TEXEL_PX))
