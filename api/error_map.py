"""Where a shadow is wrong, as a picture: false light and false shadow in colour over a faint grey view."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from api.canvas import Color
from api.pictures import Picture
from renderers.frame import Mask

FALSE_LIT: Color = (255, 176, 0)
FALSE_SHADOW: Color = (100, 143, 255)
"""Amber and blue of the palette for all kinds of colour blindness by David Nichols, "Coloring for
Colorblindness" (IBM's design library), bright enough for a dark ground."""

LUMA = np.array([0.2126, 0.7152, 0.0722])
"""Rec. 709."""
OUTSIDE, IN_SHADOW, LIT = 12.0, 40.0, 84.0
"""Grey of black surfaces where no answer counts, in true shadow and in true light, of 255."""
FAINT, FAINTEST = 0.16, 0.05
"""How much of the view's own brightness is left where answers count and elsewhere: places are recognised."""


def error_map(
    mask: Mask, truth: npt.NDArray[np.bool_], domain: npt.NDArray[np.bool_], shade: Picture
) -> Picture:
    """(h, w, 3) uint8 sRGB: false light in amber, false shadow in blue, as strong as the mask is wrong.

    Args:
        mask: (h, w) float32 in [0, 1]: 1 lit, 0 shadowed, fractions where filtered.
        truth: (h, w) bool, True where lit.
        domain: (h, w) bool, the pixels in which a mask has to answer; the others are never wrong.
        shade: (h, w, 3) uint8 sRGB, what the view looks like; shown faintly and in grey.

    What is right is dark grey, in shadow darker than in light.
    """
    assert mask.shape == truth.shape == domain.shape == shade.shape[:2]
    ground = np.where(domain, np.where(truth, LIT, IN_SHADOW), OUTSIDE)
    grey = ground + np.where(domain, FAINT, FAINTEST) * (shade @ LUMA)
    false_lit, false_shadow = np.where(truth, 0, mask) * domain, np.where(truth, 1 - mask, 0) * domain
    right = 1 - false_lit - false_shadow
    color = (
        right[..., None] * grey[..., None]
        + false_lit[..., None] * np.array(FALSE_LIT)
        + false_shadow[..., None] * np.array(FALSE_SHADOW)
    )
    picture: Picture = np.round(color).clip(0, 255).astype(np.uint8)
    return picture
