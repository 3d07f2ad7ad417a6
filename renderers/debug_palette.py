"""Colours of the debug views: even ramps, and distinct hues for all kinds of colour blindness."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from renderers.frame import Picture
from scenes.scene import Array

Color = tuple[int, int, int]

# Blue, violet, magenta, orange and amber of IBM's design library, after David Nichols, "Coloring for
# Colorblindness".
BLUE: Color = (100, 143, 255)
VIOLET: Color = (151, 125, 245)
MAGENTA: Color = (220, 38, 127)
ORANGE: Color = (254, 97, 0)
AMBER: Color = (255, 176, 0)
MINT: Color = (110, 219, 184)

NIGHT: Color = (22, 24, 29)
SLATE: Color = (38, 41, 49)
LUMA = np.array([0.2126, 0.7152, 0.0722])
"""Rec. 709."""


def ramp(*hexes: str) -> Array:
    """(n, 3) float64 sRGB of 0..255 from colours such as "1f2e3d"."""
    return np.array([list(bytes.fromhex(one)) for one in hexes], float)


# Seaborn's mako (Waskom 2021), from far to near, without its black.
DISTANCE = ramp("221631", "2e1e3b", "413d7b", "37659e", "348fa7", "40b7ad", "8bdab2", "def5e5")
# Matplotlib's viridis (Smith and van der Walt 2015), from a quarter on: dark on dark tells nothing.
COUNT = ramp("355f8d", "2a788e", "21918c", "22a884", "44bf70", "7ad151", "bddf26", "fde725")
# ColorBrewer's RdBu (Brewer 2003), blue first.
EITHER_WAY = ramp("2166ac", "4393c3", "92c5de", "d1e5f0", "f4f4f2", "fddbc7", "f4a582", "d6604d", "b2182b")


def along(colors: Array, share: Array) -> Array:
    """(..., 3) float64 sRGB of 0..255 at places (...) of a ramp, 0 its start and 1 its end."""
    place = np.clip(share, 0, 1) * (len(colors) - 1)
    first = np.minimum(place.astype(int), len(colors) - 2)
    rest = (place - first)[..., None]
    mixed: Array = colors[first] * (1 - rest) + colors[first + 1] * rest
    return mixed


def picture_of(colors: Array) -> Picture:
    """(h, w, 3) uint8 sRGB from float64 of 0..255."""
    rounded: Picture = np.round(np.clip(colors, 0, 255)).astype(np.uint8)
    return rounded


def dimmed(picture: Picture, share: float = 0.4, color_share: float = 0.25) -> Array:
    """(h, w, 3) float64 sRGB of 0..255: darker and nearly grey, so that what is drawn over it stands out."""
    grey = (picture @ LUMA)[..., None]
    mixed: Array = share * (grey + color_share * (picture - grey))
    return mixed


def over(below: Array, color: Color | Array, alpha: Array | float) -> Array:
    """(..., 3) `color` laid over `below`, as opaque as `alpha` (...) says."""
    opacity = np.asarray(alpha, float)[..., None]
    mixed: Array = below * (1 - opacity) + np.asarray(color, float) * opacity
    return mixed


def checked(height: int, width: int) -> Array:
    """(h, w, 3) float64 sRGB of 0..255: a dark chequer that stands for nothing."""
    cell = max(height // 48, 4)
    rows, columns = np.arange(height) // cell, np.arange(width) // cell
    odd: npt.NDArray[np.bool_] = (rows[:, None] + columns[None, :]) % 2 == 1
    return np.where(odd[..., None], np.array(SLATE, float), np.array(NIGHT, float))
