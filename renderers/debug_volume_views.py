"""Views of shadow volumes: counts, silhouette edges, silhouette pixels, and the volumes themselves."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from renderers.debug_palette import (
    AMBER,
    BLUE,
    COUNT,
    MAGENTA,
    MINT,
    ORANGE,
    Color,
    along,
    dimmed,
    over,
    picture_of,
)
from renderers.debug_picture import DebugPicture, Legend, Panel
from renderers.debug_volumes import FIRST_RIM, SECOND_RIM, SILHOUETTE, edge_lines, volume_layers
from renderers.frame import Frame
from renderers.internals import Internals
from scenes.scene import Array

EDGE_COLORS: tuple[Color, Color, Color] = (MINT, AMBER, MAGENTA)
EDGE_WIDTH, RIM_WIDTH = 1 / 200, 1 / 400
"""Of the picture's height."""
HIDDEN_EDGE, HIDDEN_RIM = 0.22, 0.0
MOST_SINGLE = 8
"""Counts up to this have a colour each; larger ones share one by doublings."""
COVER = 0.72
"""How much the picture is covered where more sides overlap than in 95 % of the pixels that have any."""
MOST_LAYER_ALPHA = 0.3
NEAR_CAP = 0.14
PALE: Color = (214, 214, 208)


def counts(frame: Frame, internals: Internals) -> npt.NDArray[np.int64]:
    """(h, w) volumes counted in each pixel, top row first; meant where the frame's domain is."""
    assert internals.volumes is not None
    texture = internals.volumes.counts
    rows = np.frombuffer(texture.read(alignment=1), np.float32).reshape(frame.height, frame.width)[::-1]
    return np.rint(rows).astype(np.int64)


def silhouette_pixels(frame: Frame, internals: Internals) -> npt.NDArray[np.bool_]:
    """(h, w) where the map is not trusted and volumes decide, top row first."""
    assert internals.silhouette_pixels is not None
    texture = internals.silhouette_pixels
    rows = np.frombuffer(texture.read(alignment=1), np.float32).reshape(frame.height, frame.width)[::-1]
    asked: npt.NDArray[np.bool_] = (rows > 0) & frame.read_domain()
    return asked


def counter_view(frame: Frame, internals: Internals) -> DebugPicture:
    """How many volumes hold each surface: how many triangles that make volumes stand before the light."""
    found, asked = counts(frame, internals), frame.read_domain()
    if internals.silhouette_pixels is not None:
        # Elsewhere nobody counts, which is not the same as 0.
        asked = silhouette_pixels(frame, internals)
    bins = [(0, 0, PALE, "0"), *_bins(int(found[asked].max(initial=0)))]
    if wrong := int((found[asked] < 0).sum()):
        bins.append((int(found[asked].min()), -1, ORANGE, f"below 0, wrong: {wrong} px"))
    picture = _faint_outside(frame)
    lightness = 0.88 + 0.12 * frame.read_picture().max(axis=2) / 255
    for low, high, color, _ in bins:
        here = asked & (found >= low) & (found <= high)
        picture[here] = np.array(color) * lightness[here, None]
    swatches = tuple((color, words) for _, _, color, words in bins)
    legend = Legend(swatches, unit="volumes that hold a surface")
    return DebugPicture((Panel(picture_of(picture)),), legend)


def edges_view(frame: Frame, internals: Internals) -> DebugPicture:
    """The edges from which the volumes' sides start, over the shaded picture."""
    assert internals.volumes is not None
    width = max(1.5, EDGE_WIDTH * frame.height)
    lines = edge_lines(frame, internals.volumes, EDGE_COLORS, width_px=width, hidden=HIDDEN_EDGE)
    below = dimmed(frame.read_picture(), 0.6, 0.5)
    names = ("1", "2", "3 and more")
    legend = Legend(tuple(zip(EDGE_COLORS, names, strict=True)), unit="weight of an edge, faint where hidden")
    return DebugPicture((Panel(picture_of(_laid_over(below, lines))),), legend)


def silhouettes_view(frame: Frame, internals: Internals) -> DebugPicture:
    """Where the hybrid's map is certain, and the silhouette pixels that are left to volumes."""
    asked, domain = silhouette_pixels(frame, internals), frame.read_domain()
    lit = frame.read_mask() > 0.5
    below = _faint_outside(frame)
    picture = over(below, BLUE, np.where(domain & ~lit & ~asked, 0.22, 0.0))
    picture = over(picture, AMBER, np.where(asked, 0.92, 0.0))
    share = asked.sum() / max(int(domain.sum()), 1)
    swatches: tuple[tuple[Color, str], ...] = (
        (AMBER, f"volumes decide: {100 * share:.2g} %"),
        ((58, 70, 104), "map: shadow"),
        ((120, 120, 120), "map: lit"),
    )
    return DebugPicture((Panel(picture_of(picture)),), Legend(swatches))


def volumes_view(frame: Frame, internals: Internals) -> DebugPicture:
    """The volumes as glass: sides, lit faces that close them, far ends, and the rays along their corners."""
    assert internals.volumes is not None
    layers = volume_layers(frame, internals.volumes)
    picture = dimmed(frame.read_picture(), 0.62, 0.6)
    picture = over(picture, AMBER, np.where(layers[..., 1] > 0, NEAR_CAP, 0.0))
    picture = over(picture, MAGENTA, _opacity(layers[..., 2]))
    picture = over(picture, BLUE, _opacity(layers[..., 0]))
    colors = ((186, 205, 255),) * 3
    width = max(1.0, RIM_WIDTH * frame.height)
    rims = edge_lines(
        frame,
        internals.volumes,
        colors,
        lines=(FIRST_RIM, SECOND_RIM, SILHOUETTE),
        width_px=width,
        hidden=HIDDEN_RIM,
    )
    swatches = ((BLUE, "sides"), (AMBER, "caps on casters"), (MAGENTA, "far caps"))
    picture = _laid_over(picture, rims * _opacity_of_rims(rims))
    return DebugPicture((Panel(picture_of(picture)),), Legend(swatches))


def _faint_outside(frame: Frame) -> Array:
    """(h, w, 3) the scene dimmed, more so where a mask need not answer."""
    shade = frame.read_picture()
    return np.where(frame.read_domain()[..., None], dimmed(shade, 0.58, 0.3), dimmed(shade, 0.3))


def _laid_over(below: Array, layer: Array) -> Array:
    """`layer` (h, w, 4), colour of 0..1 times alpha and alpha, over (h, w, 3) of 0..255."""
    mixed: Array = below * (1 - layer[..., 3:]) + 255 * layer[..., :3]
    return mixed


def _opacity(layers: Array) -> Array:
    """(h, w): each layer lets the same share of light through, such that most pixels stay translucent."""
    some = layers[layers > 0]
    many = float(np.percentile(some, 95)) if len(some) else 1.0
    each = min(1 - (1 - COVER) ** (1 / max(many, 1.0)), MOST_LAYER_ALPHA)
    covered: Array = 1 - (1 - each) ** np.maximum(layers, 0)
    return covered


def _opacity_of_rims(rims: Array) -> float:
    """Fewer lines may be brighter."""
    covered = float((rims[..., 3] > 0).mean())
    return float(np.clip(0.05 / max(covered, 1e-6), 0.12, 0.6))


def _bins(most: int) -> list[tuple[int, int, Color, str]]:
    """Lowest and highest count, colour and words of each class of counts from 1 to `most`."""
    ends = [(count, count) for count in range(1, min(most, MOST_SINGLE) + 1)]
    low = MOST_SINGLE + 1
    while low <= most:
        ends.append((low, 2 * (low - 1)))
        low = 2 * (low - 1) + 1
    colors = along(COUNT, np.linspace(0, 1, max(len(ends), 4))).round().astype(int)
    return [
        (low, high, (int(r), int(g), int(b)), f"{low}" if low == high else f"{low} to {high}")
        for (low, high), (r, g, b) in zip(ends, colors[: len(ends)], strict=True)
    ]
