"""One picture that shows a light under all its candidates, side by side with the truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
import numpy.typing as npt

from api.canvas import BOLD, Canvas, Color, Picture, resized, shortened, wrapped
from api.verdicts import off_words
from selector.candidate import Candidate
from selector.measurement import Measurement, Status
from selector.recommendation import Recommendation

BACKGROUND: Color = (22, 24, 29)
PANEL: Color = (34, 37, 44)
BRIGHT: Color = (238, 240, 244)
DIM: Color = (150, 156, 168)
CHOSEN: Color = (255, 196, 61)
GOOD: Color = (120, 205, 140)
BAD: Color = (240, 120, 104)
INSET: Color = (255, 255, 255)

COLUMNS = 3
TILE_WIDTH = 448
CAPTION_HEIGHT = 64
MARGIN, GAP, PADDING = 36, 28, 14
HEADER_HEIGHT = 128
ZOOM, CROP, SMALLEST_CROP = 4, 36, 8
INSET_SHARE = 0.6
FRAME = 5
NEARLY_AS_GOOD = 0.5
"""Of the difference a spot off the border must hold, compared with the best one, to be taken instead."""

Differences = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SheetTexts:
    """What the header says besides the light's name.

    Attributes:
        title: The light.
        place: Level, view, resolution, device.
    """

    title: str
    place: str


@dataclass(frozen=True)
class _Tile:
    picture: Picture | None
    title: str
    caption: str
    color: Color
    badge: str = ""
    chosen: bool = False


@dataclass(frozen=True)
class _Spot:
    """A square of the picture, in its pixels."""

    left: int
    top: int
    side: int


@dataclass(frozen=True)
class _Corner:
    right: bool
    low: bool


@dataclass(frozen=True)
class _Inset:
    """What is magnified, and in which corner it is shown."""

    spot: _Spot
    corner: _Corner


def contact_sheet(
    texts: SheetTexts,
    truth: Picture,
    pictures: Mapping[Candidate, Picture],
    measurements: Sequence[Measurement],
    recommendation: Recommendation | None,
) -> Picture:
    """(h, w, 3) uint8 sRGB: the truth, then every candidate with what it costs and how far it is off.

    Args:
        texts: The header.
        truth: (h, w, 3) uint8 sRGB, of one view.
        pictures: The same of each candidate that rendered anything.
        measurements: Every candidate, in the order of the tiles.
        recommendation: The choice, which gets a frame; None where there is none.

    Each tile magnifies the same place: the one where the candidates differ most from the truth. It is shown
    in the corner that hides least of what differs.

    Raises:
        OutputError: Text cannot be drawn here.
    """
    tiles = [
        _Tile(truth, "Truth", _source(measurements), DIM),
        *(_tile(one, pictures.get(one.candidate), recommendation) for one in measurements),
    ]
    picture_height = min(max(round(TILE_WIDTH * truth.shape[0] / truth.shape[1]), 1), TILE_WIDTH)
    tile_height = picture_height + CAPTION_HEIGHT
    rows = ceil(len(tiles) / COLUMNS)
    canvas = Canvas(
        2 * MARGIN + COLUMNS * TILE_WIDTH + (COLUMNS - 1) * GAP,
        HEADER_HEIGHT + rows * tile_height + (rows - 1) * GAP + MARGIN,
        BACKGROUND,
    )
    width = _width_at(picture_height, truth)
    side = min(CROP, *truth.shape[:2], round(INSET_SHARE * min(picture_height, width)) // ZOOM)
    difference = _difference(truth, list(pictures.values()))
    spot = _most_different(difference, side)
    inset = _Inset(spot, _free_corner(difference, spot, width / truth.shape[1])) if spot else None
    _draw_header(canvas, texts, recommendation, magnified=inset is not None)
    for index, tile in enumerate(tiles):
        x = MARGIN + (index % COLUMNS) * (TILE_WIDTH + GAP)
        y = HEADER_HEIGHT + (index // COLUMNS) * (tile_height + GAP)
        _draw_tile(canvas, x, y, picture_height, tile, inset)
    return canvas.picture


def _source(measurements: Sequence[Measurement]) -> str:
    sources = [one.views[0].truth for one in measurements if one.views]
    words = f"by {sources[0].replace('_', ' ')}, " if sources else ""
    return f"{words}what every candidate is compared with"


def _tile(one: Measurement, picture: Picture | None, recommendation: Recommendation | None) -> _Tile:
    label = one.candidate.label
    if recommendation is None or one.status is not Status.OK:
        reason = f"{one.status}: {one.reason}" if one.reason else str(one.status)
        return _Tile(picture, label, reason.replace("_", " "), BAD)
    rated = next(rated for rated in recommendation.rated if rated.candidate == one.candidate)
    chosen = rated == recommendation.chosen
    off = off_words(one, rated, "edge off by {:.2f} px") or "nothing to judge by"
    good = rated.exceedance_px <= recommendation.max_edge_error_px
    badge = "CHOSEN" if chosen else "runner-up" if rated == recommendation.runner_up else ""
    return _Tile(picture, label, f"{rated.shadow_ms:.1f} ms,  {off}", GOOD if good else BAD, badge, chosen)


def _width_at(height: int, picture: Picture) -> int:
    across = int(picture.shape[1])
    return min(TILE_WIDTH, max(round(height * across / len(picture)), 1))


def _difference(truth: Picture, pictures: Sequence[Picture]) -> Differences:
    """(h, w) float64, how much all pictures together differ from the truth, in levels of 255."""
    difference = np.zeros(truth.shape[:2])
    for picture in pictures:
        difference += np.abs(picture.astype(np.int32) - truth).sum(axis=2)
    return difference


def _most_different(difference: Differences, side: int) -> _Spot | None:
    """The square that holds most of the difference, off the picture's border if that costs little."""
    if not difference.any() or side < SMALLEST_CROP:
        return None
    sums = np.pad(difference, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    windows: Differences = (
        sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    )
    margin = side // 2
    inside = np.zeros_like(windows)
    inside[margin:-margin, margin:-margin] = windows[margin:-margin, margin:-margin]
    chosen = inside if inside.max() >= NEARLY_AS_GOOD * windows.max() else windows
    top, left = np.unravel_index(int(np.argmax(chosen)), chosen.shape)
    return _Spot(int(left), int(top), side)


def _free_corner(difference: Differences, spot: _Spot, scale: float) -> _Corner:
    """Where the magnified square hides least of the difference, and not the spot itself if that can be.

    Among equals the one that is farthest from the spot.
    """
    height, width = difference.shape
    side = ceil((spot.side * ZOOM + 4 * FRAME) / scale)

    def hidden(corner: _Corner) -> tuple[bool, float, float]:
        x, y = (width - side if corner.right else 0), (height - side if corner.low else 0)
        covers = _overlap(spot.left, spot.side, x, side) and _overlap(spot.top, spot.side, y, side)
        far = abs(spot.left + spot.side / 2 - x - side / 2) + abs(spot.top + spot.side / 2 - y - side / 2)
        return covers, float(difference[max(y, 0) : y + side, max(x, 0) : x + side].sum()), -far

    return min((_Corner(right, low) for right in (False, True) for low in (False, True)), key=hidden)


def _overlap(start: int, length: int, other: int, other_length: int) -> bool:
    return start < other + other_length and other < start + length


def _draw_header(
    canvas: Canvas, texts: SheetTexts, recommendation: Recommendation | None, *, magnified: bool
) -> None:
    width = canvas.picture.shape[1] - 2 * MARGIN
    canvas.text(MARGIN, 50, shortened(texts.title, width, 30, BOLD), 30, BRIGHT, font=BOLD)
    place = texts.place + (f", magnified {ZOOM} times where the candidates differ most" if magnified else "")
    canvas.text(MARGIN, 78, shortened(place, width, 16), 16, DIM)
    reason = recommendation.reason if recommendation else "No candidate could serve this light."
    color = CHOSEN if recommendation and recommendation.within_limit else BAD
    canvas.text(MARGIN, 106, shortened(reason, width, 18), 18, color)


def _draw_tile(canvas: Canvas, x: int, y: int, height: int, tile: _Tile, inset: _Inset | None) -> None:
    canvas.panel(x, y, TILE_WIDTH, height + CAPTION_HEIGHT, PANEL)
    if tile.chosen:
        canvas.frame(x, y, TILE_WIDTH, height + CAPTION_HEIGHT, CHOSEN, FRAME)
    if tile.picture is None:
        for row, line in enumerate(wrapped(tile.caption, TILE_WIDTH - 2 * PADDING, 15, max(1, height // 24))):
            canvas.text(x + PADDING, y + 34 + 22 * row, line, 15, tile.color)
    else:
        # Upright pictures get bars at their sides.
        width = _width_at(height, tile.picture)
        left = x + (TILE_WIDTH - width) // 2
        canvas.paste(left, y, resized(tile.picture, width, height))
        if inset is not None:
            _draw_inset(canvas, (left, y, width, height), tile.picture, inset)
    baseline = y + height + 26
    color = CHOSEN if tile.chosen else BRIGHT
    canvas.text(x + PADDING, baseline, tile.title, 19, color, font=BOLD)
    canvas.text(x + TILE_WIDTH - PADDING, baseline, tile.badge, 15, color if tile.chosen else DIM, right=True)
    if tile.picture is not None:
        caption = shortened(tile.caption, TILE_WIDTH - 2 * PADDING, 16)
        canvas.text(x + PADDING, baseline + 24, caption, 16, tile.color)


def _draw_inset(canvas: Canvas, area: tuple[int, int, int, int], picture: Picture, inset: _Inset) -> None:
    """The magnified square in its corner, and a frame where it comes from."""
    x, y, width, height = area
    left, top, side = inset.spot.left, inset.spot.top, inset.spot.side
    scale = width / picture.shape[1]
    crop = picture[top : top + side, left : left + side].repeat(ZOOM, axis=0).repeat(ZOOM, axis=1)
    shown = len(crop)
    corner_x = x + width - shown - 2 * FRAME if inset.corner.right else x + 2 * FRAME
    corner_y = y + height - shown - 2 * FRAME if inset.corner.low else y + 2 * FRAME
    box_x, box_y, box = x + round(left * scale), y + round(top * scale), max(round(side * scale), 3)
    canvas.frame(box_x + 1, box_y + 1, box - 2, box - 2, BACKGROUND, 2)
    canvas.frame(box_x + 1, box_y + 1, box - 2, box - 2, INSET, 1)
    # White in black, so that it shows on any picture.
    canvas.frame(corner_x, corner_y, shown, shown, BACKGROUND, 3)
    canvas.frame(corner_x, corner_y, shown, shown, INSET, 2)
    canvas.paste(corner_x, corner_y, crop)
