"""The views that lights are judged over, as one picture: a row of views for each light."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from api.canvas import BOLD, Canvas, Color, Picture, shortened
from api.choosing import chosen_lights
from api.destinations import check_spares_level, check_writable
from api.inspection import camera_record
from api.pictures import write_png
from api.wording import counted, path_words
from scenes.errors import OutputError
from scenes.formats.registry import format_of
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.ray_traced_view import RayTracer
from scenes.scene import Array, Camera
from selector.level_measuring import SeenLight, seen_lights
from selector.measurement_record import light_record

BACKGROUND: Color = (22, 24, 29)
BRIGHT: Color = (238, 240, 244)
DIM: Color = (150, 156, 168)
BAD: Color = (240, 120, 104)

MOST_LIGHTS = 24
"""Of a level with more, so many evenly spread ones: all 267 of a Quake level would be 66,000 pixels tall."""
MOST_CAMERAS = 12
COLUMNS = 4
TILE_WIDTH, TILE_HEIGHT = 320, 180
MARGIN, GAP, LABEL, HEADING, TITLE = 28, 12, 26, 40, 64


def write_views(level: Level, path: Path, wanted: Sequence[str] = ()) -> tuple[SeenLight, ...]:
    """Writes a sheet of the views that the lights of a level are judged over; no GPU is needed.

    Args:
        level: The level.
        path: The PNG.
        wanted: Lights by name, number or node; at most 24 of all, evenly spread, where empty.

    Returns:
        The lights that are shown, with their views.

    Raises:
        LevelError: The level has no lights, or none of these.
        OutputError: The picture cannot be written.
    """
    if path.suffix.lower() != ".png":
        raise OutputError(
            "The picture is a PNG, so its name must end in .png.",
            where=str(path),
            remedy="Choose such a name with --views.",
        )
    lights = chosen_lights(level, wanted)
    named = format_of(level.path).companions(read_level_file(level.path), level.path)
    check_spares_level(path, level.path, named, "--views")
    check_writable(path, "--views")
    shown = lights if wanted else lights[:: -(-len(lights) // MOST_LIGHTS)]
    seen = seen_lights(level.scene, shown)
    title = f"{level.path.name}: views of {counted(len(shown), 'light')}"
    if len(shown) < len(lights):
        title += f" of {len(lights)}, evenly spread"
    write_png(path, _sheet(title, RayTracer(level.scene), seen))
    return seen


def views_record(path: Path, seen: Sequence[SeenLight]) -> dict[str, Any]:
    """The views and the name of their picture as JSON values."""
    lights = [
        {
            **light_record(one.light),
            "problem": one.problem,
            "cameras": [camera_record(index, camera) for index, camera in enumerate(one.cameras)],
        }
        for one in seen
    ]
    return {"picture": path_words(path), "views": lights}


def _sheet(title: str, tracer: RayTracer, seen: Sequence[SeenLight]) -> Picture:
    width = 2 * MARGIN + COLUMNS * TILE_WIDTH + (COLUMNS - 1) * GAP
    canvas = Canvas(width, TITLE + sum(map(_height, seen)) + MARGIN, BACKGROUND)
    canvas.text(MARGIN, 42, shortened(title, width - 2 * MARGIN, 24, BOLD), 24, BRIGHT, font=BOLD)
    top = TITLE
    for one in seen:
        words, color = (one.problem, BAD) if one.problem else (str(one.light.kind), DIM)
        text = shortened(f"{one.light.name}: {words}", width - 2 * MARGIN, 17)
        canvas.text(MARGIN, top + 26, text, 17, color)
        for index, camera in enumerate(one.cameras[:MOST_CAMERAS]):
            x = MARGIN + index % COLUMNS * (TILE_WIDTH + GAP)
            y = top + HEADING + index // COLUMNS * (TILE_HEIGHT + LABEL)
            canvas.paste(x, y, _pixels(tracer.picture(camera, one.light, TILE_WIDTH, TILE_HEIGHT)))
            canvas.text(x, y + TILE_HEIGHT + 17, shortened(_label(camera), TILE_WIDTH, 14), 14, DIM)
        top += _height(one)
    return canvas.picture


def _height(seen: SeenLight) -> int:
    rows = -(-min(len(seen.cameras), MOST_CAMERAS) // COLUMNS)
    return HEADING + rows * (TILE_HEIGHT + LABEL)


def _label(camera: Camera) -> str:
    x, y, z = camera.position
    return f"{camera.name}, at {x:.4g}, {y:.4g}, {z:.4g}"


def _pixels(linear: Array) -> Picture:
    """(h, w, 3) uint8 sRGB (IEC 61966-2-1)."""
    clipped = np.clip(linear, 0.0, 1.0)
    encoded = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    pixels: Picture = np.round(255 * encoded).astype(np.uint8)
    return pixels
