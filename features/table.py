"""The features, in the order in which models see them. A new one is a function and one line here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from features.light_camera import (
    depth_ratio,
    edge_distance,
    eye_distance,
    incidence,
    light_ahead,
    light_distance,
    map_texel,
    view_light_angle,
    warp_gain,
    warped_texel,
)
from features.light_cut_off import (
    cone_half_angle,
    is_directional,
    is_point,
    is_spot,
    range_over_extent,
    solid_angle,
)
from features.light_view import LightView
from features.polygon_count import (
    casting_meshes,
    casting_triangles,
    closed_share,
    silhouette_edges,
    silhouette_length,
)
from features.shadow_complexity import (
    casters_before_shadow,
    crowding,
    depth_complexity,
    edge_density,
    receiver_pixels,
    shadow_share,
)


class Group(StrEnum):
    """The thesis' four groups of what decides."""

    POLYGONS = "polygon count"
    SHADOWS = "shadow complexity"
    CUT_OFF = "light cut-off"
    GEOMETRY = "light-camera geometry"


@dataclass(frozen=True)
class Feature:
    """One number about a light in a view.

    Attributes:
        measure: The function that gives it; its name is the feature's.
        group: What it is about.
        unit: In which it is given.
        low: What a small value means, in a designer's words.
        high: What a large one means.
    """

    measure: Callable[[LightView], float]
    group: Group
    unit: str
    low: str
    high: str

    @property
    def name(self) -> str:
        """Its name in tables and files."""
        return self.measure.__name__

    @property
    def meaning(self) -> str:
        """What it is, in a sentence: the first line of the function's docstring."""
        return (self.measure.__doc__ or "").strip().split("\n")[0]


_P, _S, _C, _G = Group.POLYGONS, Group.SHADOWS, Group.CUT_OFF, Group.GEOMETRY

FEATURES: tuple[Feature, ...] = (
    Feature(casting_triangles, _P, "log2(1 + count)", "few triangles cast", "many triangles cast"),
    Feature(casting_meshes, _P, "log2(1 + count)", "few meshes cast", "many meshes cast"),
    Feature(silhouette_edges, _P, "log2(1 + count)", "short silhouettes", "silhouettes of many edges"),
    Feature(silhouette_length, _P, "log2(1 + diagonals)", "small outlines", "long outlines"),
    Feature(closed_share, _P, "share", "open casters", "closed casters"),
    Feature(depth_complexity, _S, "surfaces", "casters hardly overlap", "casters overlap much"),
    Feature(crowding, _S, "surfaces", "no crowded places", "casters crowd in places"),
    Feature(shadow_share, _S, "share", "little is in shadow", "much is in shadow"),
    Feature(casters_before_shadow, _S, "surfaces", "few casters per shadow", "many casters per shadow"),
    Feature(edge_density, _S, "share", "little shadow edge in view", "much shadow edge in view"),
    Feature(
        receiver_pixels, _S, "log2(1 + pixels)", "it lights little of the view", "it lights much of the view"
    ),
    Feature(cone_half_angle, _C, "degrees", "a narrow cone", "a wide cone"),
    Feature(solid_angle, _C, "steradians", "it shines into little space", "it shines into much space"),
    Feature(range_over_extent, _C, "diagonals", "a short range", "a long range"),
    Feature(is_spot, _C, "0 or 1", "no spot", "a spot"),
    Feature(is_point, _C, "0 or 1", "no point light", "a point light"),
    Feature(is_directional, _C, "0 or 1", "no directional light", "a directional light"),
    Feature(view_light_angle, _G, "degrees", "it shines along the view", "it shines against the view"),
    Feature(light_ahead, _G, "degrees", "the light is ahead", "the light is behind the eye"),
    Feature(
        light_distance, _G, "diagonals", "it is close to what it lights", "it is far from what it lights"
    ),
    Feature(eye_distance, _G, "diagonals", "shadows are seen from close by", "shadows are seen from afar"),
    Feature(depth_ratio, _G, "log2", "what is seen is equally far", "what is seen is near and far"),
    Feature(edge_distance, _G, "diagonals", "a shadow's edge is near", "shadow edges are far or none"),
    Feature(incidence, _G, "none", "it grazes what it lights", "it strikes squarely"),
    Feature(map_texel, _G, "log2(pixels)", "a map's texels look small", "a map's texels look large"),
    Feature(warped_texel, _G, "log2(pixels)", "warped texels look small", "even warped texels look large"),
    Feature(warp_gain, _G, "log2", "a warp gains little", "a warp gains much"),
)

NAMES: tuple[str, ...] = tuple(one.name for one in FEATURES)
