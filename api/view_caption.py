"""Puts a debug view on its sheet: the picture, or a map's faces, over a strip that says what it shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from api.canvas import BOLD, Canvas, Color, Picture, shortened, text_width
from renderers.debug_maps import LARGEST_OF_SIX, LARGEST_SHOWN
from renderers.debug_picture import DebugPicture, Legend, Panel, Scale

BACKGROUND: Color = (22, 24, 29)
PANEL: Color = (34, 37, 44)
BRIGHT: Color = (238, 240, 244)
DIM: Color = (150, 156, 168)

NARROWEST = 480
COLUMNS = 3
MARGIN, GAP = 14, 10
TITLE, TEXT, SMALL = 15, 13, 11
TITLE_ROW, SWATCH_ROW, SCALE_ROW, FOOT = 28, 20, 34, 8
SWATCH, BAR_WIDTH, BAR_HEIGHT = 11, 260, 8


@dataclass(frozen=True)
class _Placed:
    """A swatch in its row."""

    x: int
    row: int
    color: Color
    words: str


def captioned(view: DebugPicture, title: str, details: str) -> Picture:
    """(h, w, 3) uint8 sRGB: the view, and beneath it what it is called, what it shows and what colours mean.

    Args:
        view: Pictures of the screen keep their pixels; small maps are enlarged.
        title: Name of the view.
        details: Whose it is.

    Raises:
        OutputError: Text cannot be drawn here.
    """
    picture = _body(view)
    height, across = picture.shape[:2]
    width = max(across, NARROWEST)
    swatches = _swatches(view.legend, width - 2 * MARGIN)
    rows = max((one.row for one in swatches), default=-1) + 1
    scale = SCALE_ROW if view.legend.scale else 0
    canvas = Canvas(width, height + TITLE_ROW + rows * SWATCH_ROW + scale + FOOT, BACKGROUND)
    canvas.paste((width - across) // 2, 0, picture)
    end = MARGIN + text_width(title, TITLE, BOLD)
    canvas.text(MARGIN, height + 20, title, TITLE, BRIGHT, font=BOLD)
    # Names of lights may hold any white space.
    words = shortened(" ".join(details.split()), width - end - GAP - MARGIN, TEXT)
    canvas.text(end + GAP, height + 20, words, TEXT, DIM)
    top = height + TITLE_ROW
    for one in swatches:
        y = top + one.row * SWATCH_ROW
        if one.words != view.legend.unit:
            canvas.panel(one.x, y + 3, SWATCH, SWATCH, one.color)
        canvas.text(one.x + _indent(one.words, view.legend), y + 13, one.words, TEXT, DIM)
    if view.legend.scale:
        _draw_scale(canvas, top + rows * SWATCH_ROW, view.legend.scale, view.legend.unit)
    return canvas.picture


def _swatches(legend: Legend, width: int) -> list[_Placed]:
    """The swatches, and with no scale the unit before them, in as many rows as they need."""
    entries = list(legend.swatches)
    if legend.unit and legend.scale is None:
        entries.insert(0, (BACKGROUND, legend.unit))
    placed: list[_Placed] = []
    x = row = 0
    for color, words in entries:
        taken = _indent(words, legend) + text_width(words, TEXT)
        if x and x + taken > width:
            x, row = 0, row + 1
        placed.append(_Placed(MARGIN + x, row, color, words))
        x += taken + 2 * GAP
    return placed


def _indent(words: str, legend: Legend) -> int:
    return 0 if words == legend.unit else SWATCH + 6


def _draw_scale(canvas: Canvas, top: int, scale: Scale, unit: str) -> None:
    edges = np.linspace(0, BAR_WIDTH, len(scale.colors) + 1).round().astype(int)
    for left, right, color in zip(edges[:-1], edges[1:], scale.colors, strict=True):
        canvas.panel(MARGIN + int(left), top + 4, int(right - left), BAR_HEIGHT, color)
    for place, words in scale.marks:
        x = MARGIN + round(place * (BAR_WIDTH - 1))
        canvas.panel(x, top + 4 + BAR_HEIGHT, 1, 3, DIM)
        taken = text_width(words, SMALL)
        left = min(max(x - taken // 2, MARGIN), MARGIN + BAR_WIDTH - taken)
        canvas.text(left, top + 27, words, SMALL, DIM)
    canvas.text(MARGIN + BAR_WIDTH + GAP, top + 13, unit, TEXT, DIM)


def _body(view: DebugPicture) -> Picture:
    if view.of_screen:
        (panel,) = view.panels
        assert panel.picture is not None
        return panel.picture
    if len(view.panels) == 1:
        return _face(view.panels[0], LARGEST_SHOWN)
    most = max((len(panel.picture) for panel in view.panels if panel.picture is not None), default=1)
    side = most * max(LARGEST_OF_SIX // most, 1)
    faces = [_face(panel, side) for panel in view.panels]
    rows = -(-len(faces) // COLUMNS)
    step = side + GAP
    canvas = Canvas(COLUMNS * step + GAP, rows * (step + SWATCH_ROW) + GAP, BACKGROUND)
    for index, (panel, face) in enumerate(zip(view.panels, faces, strict=True)):
        x, y = GAP + index % COLUMNS * step, GAP + index // COLUMNS * (step + SWATCH_ROW)
        canvas.text(x, y + 12, panel.title, TEXT, BRIGHT, font=BOLD)
        canvas.paste(x, y + SWATCH_ROW, face)
    return canvas.picture


def _face(panel: Panel, side: int) -> Picture:
    """A face with its texels as squares, `side` pixels long at most; a plain one if it shows nothing."""
    if panel.picture is None:
        canvas = Canvas(side, side, PANEL)
        canvas.text(MARGIN, 2 * MARGIN, "nothing in reach", TEXT, DIM)
        return canvas.picture
    times = max(side // len(panel.picture), 1)
    return panel.picture.repeat(times, axis=0).repeat(times, axis=1)
