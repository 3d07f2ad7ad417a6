"""Features of the light alone: what kind it is, and where it ends."""

from __future__ import annotations

from math import cos, degrees, isfinite, pi

from features.light_view import LightView
from scenes.scene import LightKind

FARTHEST = 4.0
"""In diagonals of the scene: what is farther away is as good as endless."""


def cone_half_angle(one: LightView) -> float:
    """Half angle of the light's cone; 180 for a point light, 0 for the parallel rays of a directional one.

    Unit: degrees. Range: 0 to 180. Source: thesis, section 8.1 (light cut-off).
    """
    return degrees(_half_angle(one))


def solid_angle(one: LightView) -> float:
    """What the light shines into; 0 for a directional light.

    Unit: steradians. Range: 0 to 4 pi. Source: 2 pi (1 - cos of the half angle); a map's texels share it.
    """
    return 2 * pi * (1 - cos(_half_angle(one)))


def range_over_extent(one: LightView) -> float:
    """Where the light ends, in diagonals of the scene; 4 where that is farther, or never.

    Unit: diagonals. Range: 0 to 4. Source: KHR_lights_punctual, `range`.
    """
    endless = one.light.kind is LightKind.DIRECTIONAL or not isfinite(one.light.range_m)
    return FARTHEST if endless else min(one.light.range_m / one.level.extent_m, FARTHEST)


def is_spot(one: LightView) -> float:
    """1 for a spot, else 0.

    Unit: none. Range: 0 or 1. Source: KHR_lights_punctual, `type`.
    """
    return float(one.light.kind is LightKind.SPOT)


def is_point(one: LightView) -> float:
    """1 for a point light, else 0: six faces of a map instead of one.

    Unit: none. Range: 0 or 1. Source: KHR_lights_punctual, `type`.
    """
    return float(one.light.kind is LightKind.POINT)


def is_directional(one: LightView) -> float:
    """1 for a directional light, else 0: its maps follow the view.

    Unit: none. Range: 0 or 1. Source: KHR_lights_punctual, `type`.
    """
    return float(one.light.kind is LightKind.DIRECTIONAL)


def _half_angle(one: LightView) -> float:
    """Radians."""
    halves = {LightKind.SPOT: one.light.outer_cone_rad, LightKind.POINT: pi, LightKind.DIRECTIONAL: 0.0}
    return halves[one.light.kind]
