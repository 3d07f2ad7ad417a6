"""Draws docs/images/corpus.jpg: one scene of each family, as `gnomon corpus --export` writes it."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO

from api.canvas import BOLD, Canvas
from api.corpus import export
from api.rendering import Order, rendered

COLUMNS = 5
WIDTH, HEIGHT, GAP, LABEL = 320, 200, 8, 22
PAPER, INK = (250, 249, 246), (40, 40, 40)
SHEET = Path(__file__).parents[1] / "docs/images/corpus.jpg"


def drawn(folder: Path) -> dict[str, Path]:
    """Family -> its picture, rendered with shadow volumes."""
    found = {}
    for spec, level in export(folder, (), 0):
        picture = folder / f"{spec.family}.png"
        rendered(
            Order(
                level=level,
                scene=None,
                technique="SV",
                settings={},
                light=None,
                camera=None,
                output=picture,
                width=WIDTH,
                height=HEIGHT,
                device=None,
                view=None,
            )
        )
        found[spec.family] = picture
    return found


def sheet(pictures: dict[str, Path]) -> Canvas:
    """All pictures in rows, each over its name."""
    rows = -(-len(pictures) // COLUMNS)
    canvas = Canvas(COLUMNS * (WIDTH + GAP) + GAP, rows * (HEIGHT + LABEL + GAP) + GAP, PAPER)
    for number, (name, path) in enumerate(pictures.items()):
        x = GAP + number % COLUMNS * (WIDTH + GAP)
        y = GAP + number // COLUMNS * (HEIGHT + LABEL + GAP)
        pixels = OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8)
        canvas.paste(x, y, np.ascontiguousarray(pixels[..., :3]))
        canvas.text(x, y + HEIGHT + 16, name.replace("_", " "), 14, INK, font=BOLD)
    return canvas


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        picture = sheet(drawn(Path(temporary))).picture
    height, width, _ = picture.shape
    spec = OpenImageIO.ImageSpec(width, height, 3, OpenImageIO.UINT8)
    spec.attribute("Compression", "jpeg:86")
    image = OpenImageIO.ImageBuf(spec)
    image.set_pixels(OpenImageIO.ROI(), picture)
    assert image.write(str(SHEET)), image.geterror()
