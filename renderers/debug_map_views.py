"""Views of maps: what they hold, what they look at, and how large their texels are on the screen."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.ndimage import uniform_filter

from renderers.debug_light import seen_from_light, usual_fit
from renderers.debug_maps import (
    FACE_NAMES,
    LARGEST_OF_SIX,
    LARGEST_SHOWN,
    distances,
    light_place,
    sampling,
)
from renderers.debug_palette import (
    DISTANCE,
    EITHER_WAY,
    LUMA,
    NIGHT,
    SLATE,
    Color,
    along,
    checked,
    dimmed,
    over,
    picture_of,
)
from renderers.debug_picture import DebugPicture, Legend, Panel, Scale
from renderers.frame import Frame, Picture
from renderers.internals import Internals
from scenes.scene import Array

SINGLE_SIDE, CUBE_SIDE = 720, 384
"""Pixels along a face of the view from the light, alone and as one of six."""
FARTHEST_OCTAVE = 4.0
"""Footprints from 1/16 to 16 pixels are told apart."""
GRID_ALPHA, CROWDED, GRID_WINDOW = 0.55, 0.45, 9
"""How dark borders of texels are, and the share of border pixels nearby at which they are left out."""
SCALE_STEPS = 64


def map_view(frame: Frame, internals: Internals) -> DebugPicture:
    """The map, near bright and far dark, by distance from the light whatever depth it stores."""
    assert internals.map is not None
    most = LARGEST_SHOWN if len(internals.map.fit.faces) == 1 else LARGEST_OF_SIX
    found = distances(internals.map, light_place(frame), most)
    drawn = np.isfinite(found)
    nearest, farthest = (float(np.nanmin(found)), float(np.nanmax(found))) if drawn.any() else (0.0, 1.0)
    panels = []
    for metres, is_drawn in zip(found, drawn, strict=True):
        share = (farthest - np.where(is_drawn, metres, farthest)) / max(farthest - nearest, 1e-9)
        nothing = checked(*metres.shape)
        panels.append(picture_of(np.where(is_drawn[..., None], along(DISTANCE, share), nothing)))
    marks = [(place, f"{nearest + place * (farthest - nearest):.3g}") for place in (0.0, 0.5, 1.0)]
    sun = frame.light.homogeneous[3] == 0
    legend = Legend(
        swatches=((SLATE, "nothing drawn"),),
        scale=_scale(DISTANCE[::-1], marks),
        unit="metres along the rays" if sun else "metres from the light",
    )
    return _faces(panels, legend)


def light_view(frame: Frame, internals: Internals) -> DebugPicture:
    """The scene through the map's own matrices; through those of an ordinary map where there is none."""
    fit = usual_fit(frame) if internals.map is None else internals.map.fit
    side = SINGLE_SIDE if len(fit.faces) == 1 else CUBE_SIDE
    legend = Legend(
        swatches=(((225, 225, 220), "seen by the camera"), ((84, 84, 84), "not seen"), (SLATE, "nothing"))
    )
    return _faces(seen_from_light(frame, fit, side), legend)


def texels_view(frame: Frame, internals: Internals) -> DebugPicture:
    """How many pixels a texel of the map covers: blue where texels are wasted, red where they are too few."""
    assert internals.map is not None
    shade = frame.read_picture()
    found = sampling(frame, internals.map)
    known = np.isfinite(found.footprints)
    octaves = np.log2(np.maximum(np.where(known, found.footprints, 1), 1e-6))
    heat = along(EITHER_WAY, octaves / FARTHEST_OCTAVE / 2 + 0.5)
    # A hint of the scene's own light, so that places are recognised.
    lightness = 0.78 + 0.22 * (shade @ LUMA / 255)[..., None]
    colors = over(heat * lightness, NIGHT, np.where(known, _grid(found.texels), 0.0))
    picture = np.where(known[..., None], colors, dimmed(shade))
    marks = [
        (share, text) for share, text in ((0.0, "1/16"), (0.25, "1/4"), (0.5, "1"), (0.75, "4"), (1.0, "16"))
    ]
    legend = Legend(
        swatches=(((70, 70, 70), "out of reach"),),
        scale=_scale(EITHER_WAY, marks),
        unit="pixels a texel is long",
    )
    return DebugPicture((Panel(picture_of(picture)),), legend)


def _grid(texels: npt.NDArray[np.int64]) -> Array:
    """(h, w) float64 opacity of the borders of texels, which fade where they crowd."""
    borders = _borders(texels).astype(float)
    crowd = uniform_filter(borders, GRID_WINDOW)
    opacity: Array = GRID_ALPHA * borders * np.clip(2 * (1 - crowd / CROWDED), 0, 1)
    return opacity


def _borders(texels: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """(h, w): whether a pixel's right or lower neighbour lies in another texel."""
    found = np.zeros(texels.shape[:2], bool)
    found[:, :-1] |= (texels[:, 1:] != texels[:, :-1]).any(axis=2)
    found[:-1] |= (texels[1:] != texels[:-1]).any(axis=2)
    return found


def _faces(pictures: list[Picture] | list[Picture | None], legend: Legend) -> DebugPicture:
    titles = FACE_NAMES if len(pictures) > 1 else ("",)
    panels = tuple(Panel(picture, title) for picture, title in zip(pictures, titles, strict=False))
    return DebugPicture(panels or (Panel(None),), legend, of_screen=False)


def _scale(colors: Array, marks: list[tuple[float, str]]) -> Scale:
    bar = along(colors, np.linspace(0, 1, SCALE_STEPS)).round().astype(int)
    shades: tuple[Color, ...] = tuple((int(r), int(g), int(b)) for r, g, b in bar)
    return Scale(shades, tuple(marks))
