"""Pictures as PNG files, and names for them that every file system takes."""

from __future__ import annotations

import re
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO

from scenes.atomic_file import write_atomically
from scenes.errors import OutputError
from scenes.scene import Light

Picture = npt.NDArray[np.uint8]

LONGEST_NAME = 80
QUICKLY = 1
"""Of libwebp's methods 0 to 6: 70 ms for a noisy picture of 640x360, where 4 takes 990 ms and saves 6 %."""


def write_png(path: Path, picture: Picture) -> None:
    """Writes (h, w, 3) uint8 sRGB, top row first; the same picture gives the same bytes.

    Raises:
        OutputError: The file cannot be written.
    """
    write_atomically(path, png_bytes(picture))


def png_bytes(picture: Picture) -> bytes:
    """(h, w, 3) uint8 sRGB, top row first, as the bytes of a PNG."""
    return _encoded(picture, "picture.png", {})


def webp_bytes(picture: Picture) -> bytes:
    """(h, w, 3 or 4) uint8 sRGB, top row first, alpha unassociated, as the bytes of a lossless WebP."""
    lossless: dict[str, str | int] = {
        "Compression": "lossless",
        "webp:method": QUICKLY,
        "oiio:UnassociatedAlpha": 1,
    }
    return _encoded(picture, "picture.webp", lossless)


def _encoded(picture: Picture, name: str, attributes: Mapping[str, str | int]) -> bytes:
    height, width, channels = picture.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, OpenImageIO.UINT8)
    for key, value in {"oiio:ColorSpace": "sRGB", **attributes}.items():
        spec.attribute(key, value)
    image = OpenImageIO.ImageBuf(spec)
    image.set_pixels(OpenImageIO.ROI(), np.ascontiguousarray(picture))
    # OpenImageIO writes to names only.
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / name
            if not image.write(str(path)):
                raise OutputError("The picture could not be encoded.", known=image.geterror())
            return path.read_bytes()
    except OSError as error:
        raise OutputError(
            "The picture could not be encoded.", known=f"The system says: {error.strerror or error}."
        ) from error


def file_word(name: str) -> str:
    """`name` as a part of a file name: letters, digits, dots, dashes and underscores."""
    word = re.sub(r"[^\w.-]+", "-", name).strip(".-")
    return word.encode()[:LONGEST_NAME].decode(errors="ignore") or "unnamed"


def light_words(lights: Sequence[Light]) -> dict[int, str]:
    """For each light, by its place in the list, a word for file names that no other light has."""
    words = [file_word(light.name) for light in lights]
    # Some file systems do not tell capitals.
    while shared := {word for word, often in Counter(map(str.casefold, words)).items() if often > 1}:
        # A word with a node may be another light's name: then that light gets its node too.
        words = [
            f"{word}.node{index if light.node is None else light.node}" if word.casefold() in shared else word
            for index, (light, word) in enumerate(zip(lights, words, strict=True))
        ]
    return dict(enumerate(words))
