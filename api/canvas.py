"""A picture to draw panels, pictures and text on, for the sheets that people look at."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import OpenImageIO

from scenes.errors import OutputError

Picture = npt.NDArray[np.uint8]
Color = tuple[int, int, int]

# OpenImageIO brings these fonts along, so that a machine without any draws the same sheet.
REGULAR, BOLD = "DroidSans", "DroidSans-Bold"
ELLIPSIS = "..."


class Canvas:
    """(h, w, 3) uint8 sRGB; x runs right and y down, in pixels from the top left corner."""

    def __init__(self, width: int, height: int, background: Color) -> None:
        self.picture: Picture = np.full((height, width, 3), background, np.uint8)

    def panel(self, x: int, y: int, width: int, height: int, color: Color) -> None:
        """Fill a rectangle."""
        self.picture[y : y + height, x : x + width] = color

    def frame(self, x: int, y: int, width: int, height: int, color: Color, thickness: int) -> None:
        """Draw a frame around a rectangle, on its outside."""
        left, top = x - thickness, y - thickness
        right, bottom = x + width, y + height
        self.panel(left, top, width + 2 * thickness, thickness, color)
        self.panel(left, bottom, width + 2 * thickness, thickness, color)
        self.panel(left, top, thickness, height + 2 * thickness, color)
        self.panel(right, top, thickness, height + 2 * thickness, color)

    def paste(self, x: int, y: int, picture: Picture) -> None:
        """Put a picture there."""
        height, width = picture.shape[:2]
        self.picture[y : y + height, x : x + width] = picture

    def text(
        self,
        x: int,
        baseline: int,
        text: str,
        size: int,
        color: Color,
        *,
        font: str = REGULAR,
        right: bool = False,
    ) -> None:
        """Write a line that starts, or with `right` ends, at `x`.

        Raises:
            OutputError: OpenImageIO cannot draw text here.
        """
        if not text:
            return
        width = text_width(text, size, font)
        left = max((x - width if right else x) - size, 0)
        top = max(baseline - 2 * size, 0)
        # A strip around the line: handing over the whole picture for every line takes a second a sheet.
        strip = self.picture[top : baseline + size, left : left + width + 2 * size]
        image = OpenImageIO.ImageBuf(np.ascontiguousarray(strip))
        start = (x - width if right else x) - left
        channels = tuple(channel / 255 for channel in color)
        if not OpenImageIO.ImageBufAlgo.render_text(image, start, baseline - top, text, size, font, channels):
            raise _no_text(image.geterror())
        drawn = image.get_pixels(OpenImageIO.UINT8)
        assert drawn is not None, image.geterror()
        strip[:] = drawn


def text_width(text: str, size: int, font: str = REGULAR) -> int:
    """Pixels that a line takes."""
    roi = OpenImageIO.ImageBufAlgo.text_size(text, size, font)
    return int(roi.width) if roi.defined else 0


def shortened(text: str, width: int, size: int, font: str = REGULAR) -> str:
    """As much of a line as fits, with dots where something is left out."""
    if text_width(text, size, font) <= width:
        return text
    fits, too_long = 0, len(text)
    while too_long - fits > 1:
        middle = (fits + too_long) // 2
        if text_width(text[:middle].rstrip() + ELLIPSIS, size, font) <= width:
            fits = middle
        else:
            too_long = middle
    return text[:fits].rstrip() + ELLIPSIS


def wrapped(text: str, width: int, size: int, lines: int, font: str = REGULAR) -> list[str]:
    """The text in at most so many lines that fit; the last is shortened if it has to be."""
    rows: list[str] = []
    words = text.split()
    while words:
        if len(rows) == lines - 1:
            return [*rows, shortened(" ".join(words), width, size, font)]
        count = 1
        while count < len(words) and text_width(" ".join(words[: count + 1]), size, font) <= width:
            count += 1
        rows.append(shortened(" ".join(words[:count]), width, size, font))
        words = words[count:]
    return rows


def resized(picture: Picture, width: int, height: int) -> Picture:
    """The picture at another size, smoothly."""
    image = OpenImageIO.ImageBuf(np.ascontiguousarray(picture))
    smaller = OpenImageIO.ImageBufAlgo.resize(image, roi=OpenImageIO.ROI(0, width, 0, height, 0, 1, 0, 3))
    assert not smaller.has_error, smaller.geterror()
    pixels: Picture = np.ascontiguousarray(smaller.get_pixels(OpenImageIO.UINT8)).reshape(height, width, 3)
    return pixels


def _no_text(known: str) -> OutputError:
    return OutputError(
        "No text can be drawn on a picture.",
        known=f"OpenImageIO says: {known}.",
        remedy="Install OpenImageIO as its wheel, which brings its fonts along (make setup does).",
    )
