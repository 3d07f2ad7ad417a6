"""Settings that all techniques with a map share: its size, its filter, its bias."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

from renderers.context import DeviceLimits
from renderers.map_back_faces import back_faces_fall_short
from renderers.map_pass import atlas_shape
from renderers.settings import Option, Settings
from scenes.map_frusta import faces_of
from scenes.scene import Light, LightKind, Scene

LARGEST_CUBE_SIDE = 2048
# Bilinear comparisons along a side of the filter; none: the nearest texel alone. k of them side by side are a
# box k texels wide, which reads k + 1 texels.
TAPS = {"1x1": 0, "2x2": 1, "3x3": 2, "4x4": 3}
OFFSET_UNITS = 4.0
"""Depth units: covers the rounding of the depth buffer itself."""
THESIS_SLOPE = 1.1
LEAST_GUARD_TEXELS = 2

MAP_OPTIONS: dict[str, Option] = {
    "map_size": Option(1024, "texels along a side of a map, or of each of six faces", bounds=(16, 8192)),
    "filter": Option("2x2", "texels that a comparison reads", choices=tuple(TAPS)),
    "bias": Option(
        "auto",
        "auto fits the filter and no scene scale; thesis is slope 1.1, 4 units, no normal offset",
        choices=("auto", "thesis"),
    ),
    "map_faces": Option(
        "both",
        "faces in the map: all, or those turned away from the light, which take no bias and leak at contacts",
        choices=("both", "back"),
    ),
    "bias_slope": Option("auto", "slope factor of the polygon offset", ("auto",), (0, 1000), replay=True),
    "bias_units": Option("auto", "units of the polygon offset", ("auto",), (0, 1e6), replay=True),
    "bias_normal": Option("auto", "offset along the normal, texels", ("auto",), (0, 16), replay=True),
}


@dataclass(frozen=True)
class Bias:
    """What keeps a surface out of its own shadow.

    Attributes:
        slope: Factor of the polygon offset's slope.
        units: Units of the polygon offset.
        normal_texels: How far a receiver moves along its normal, in texels, where light grazes it.
    """

    slope: float
    units: float
    normal_texels: float

    @classmethod
    def of(cls, settings: Settings) -> Bias:
        """What `settings` ask for; numbers come before presets."""
        preset = auto_bias(filter_radius(str(settings["filter"])))
        if settings.get("map_faces") == "back":
            preset = cls(0.0, 0.0, 0.0)
        if settings["bias"] == "thesis":
            preset = cls(THESIS_SLOPE, OFFSET_UNITS, 0.0)
        asked = [settings[name] for name in ("bias_slope", "bias_units", "bias_normal")]
        usual = (preset.slope, preset.units, preset.normal_texels)
        return cls(
            *(one if value == "auto" else float(value) for value, one in zip(asked, usual, strict=True))
        )


def filter_radius(kernel: str) -> float:
    """Half-width in texels of what a comparison with this filter reads."""
    return (TAPS[kernel] + 1) / 2


def auto_bias(radius_texels: float) -> Bias:
    """The bias for a footprint of this radius.

    Over a footprint of radius r a plane's depth moves by at most 2 r m, with m the larger of its two
    slopes as GL takes it; 0.1 covers rounding. Free of any scene scale.
    """
    return Bias(2 * radius_texels + 0.1, OFFSET_UNITS, 0.5 * radius_texels)


def guard_share(side: int, kernel: str) -> float:
    """Share of a map's side that is left between its guard texels.

    A place on a cube's edge moves by the normal offset, times sqrt 2 across a face that it looks at from
    the side, and the filter reads its own radius further.
    """
    radius = filter_radius(kernel)
    guard = max(LEAST_GUARD_TEXELS, ceil(radius + sqrt(0.5) * radius))
    return 1 - 2 * guard / side


def map_refusal(light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
    """Why a map cannot be: it is larger than the device allows, or back faces alone would be wrong."""
    side, faces = int(settings["map_size"]), faces_of(light)
    if faces == 6 and side > LARGEST_CUBE_SIDE:
        return f"cube maps are at most {LARGEST_CUBE_SIDE} a face, not {side}"
    if side * atlas_shape(faces)[0] > limits.max_texture_side:
        return f"a map of {side} does not fit the device's textures of {limits.max_texture_side}"
    return back_faces_fall_short(light, scene) if settings.get("map_faces") == "back" else None


def fits(side: int, kind: LightKind, limits: DeviceLimits) -> bool:
    """Whether a map of this size for a usual light of this kind fits the device."""
    faces = 6 if kind is LightKind.POINT else 1
    return side * atlas_shape(faces)[0] <= limits.max_texture_side and (
        faces == 1 or side <= LARGEST_CUBE_SIDE
    )
