"""A debug view: one picture or one for each face of a map, and what its colours mean."""

from __future__ import annotations

from dataclasses import dataclass

from renderers.debug_palette import Color
from renderers.frame import Picture


@dataclass(frozen=True)
class Panel:
    """One picture of a view.

    Attributes:
        picture: (h, w, 3) uint8 sRGB, top row first; None where there is nothing to see.
        title: What tells it from its neighbours; empty where it is alone.
    """

    picture: Picture | None
    title: str = ""


@dataclass(frozen=True)
class Scale:
    """A bar of colours with marks on it.

    Attributes:
        colors: From its left end to its right end.
        marks: Places on it, 0 left and 1 right, with what stands there.
    """

    colors: tuple[Color, ...]
    marks: tuple[tuple[float, str], ...]


@dataclass(frozen=True)
class Legend:
    """What the colours of a view mean.

    Attributes:
        swatches: Colours with their meanings, the most telling first.
        scale: A bar of colours, if there is one.
        unit: What the bar measures.
    """

    swatches: tuple[tuple[Color, str], ...] = ()
    scale: Scale | None = None
    unit: str = ""


@dataclass(frozen=True)
class DebugPicture:
    """What a view shows.

    Attributes:
        panels: One, or six in the order +X -X +Y -Y +Z -Z.
        legend: What the colours mean.
        of_screen: Whether its pixels are those of the frame; else they are those of a map.
    """

    panels: tuple[Panel, ...]
    legend: Legend
    of_screen: bool = True
