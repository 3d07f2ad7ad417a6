"""The dots of a plot and their labels, placed so that none covers another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

Box = tuple[float, float, float, float]
"""Left, top, right, bottom."""

CHARACTER, BOLD, LINE = 6.8, 7.7, 13.0
"""Estimated width of a label's letters at 11 px, plain and bold, and their height, in wide fonts."""
REACH, RING = 9.0, 14.0
"""Distance of a label from its dot, and from the ring around the chosen one."""


@dataclass(frozen=True)
class Point:
    """One candidate.

    Attributes:
        key: By which the page knows it.
        label: Its name.
        technique: Place of its technique in the registry, for colour and shape.
        time_ms: Milliseconds.
        error_px: Displacement of the edge, or its stand-in.
        chosen: Whether it is recommended.
    """

    key: str
    label: str
    technique: int
    time_ms: float
    error_px: float
    chosen: bool


@dataclass(frozen=True)
class Dot:
    """A point in its place, with its label; `shown` is off where the label would cover something."""

    point: Point
    x: float
    y: float
    best: bool
    label_x: float = 0.0
    label_y: float = 0.0
    anchor: str = "start"
    shown: bool = False


def labelled(dots: Sequence[Dot], corners: Sequence[tuple[float, float]], frame: Box) -> list[Dot]:
    """Each dot with its label where that hides nothing; the most telling ones choose first.

    Args:
        dots: Those of one plot.
        corners: Of the line through the best, which their own labels may cross rather than be left out.
        frame: In which labels stay.
    """
    taken: list[Box] = [(dot.x - 6, dot.y - 6, dot.x + 6, dot.y + 6) for dot in dots]
    line: list[Box] = [
        (min(x, to_x), min(y, to_y), max(x, to_x), max(y, to_y)) for (x, y), (to_x, to_y) in pairwise(corners)
    ]
    placed: dict[str, Dot] = {}
    for dot in sorted(dots, key=lambda one: (not one.point.chosen, not one.best, one.y)):
        width = label_width(dot.point)
        inside = [place for place in _places(dot) if _inside(_box(place, width), frame)]
        off_others = [place for place in inside if not _met(_box(place, width), taken)]
        crossings = {place: _met(_box(place, width), line) for place in off_others}
        most = len(line) if dot.best or dot.point.chosen else 0
        found = [place for place in sorted(off_others, key=crossings.__getitem__) if crossings[place] <= most]
        if found:
            taken.append(_box(found[0], width))
        x, y, anchor = (found or inside or _places(dot))[0]
        placed[dot.point.key] = replace(dot, label_x=x, label_y=y, anchor=anchor, shown=bool(found))
    return [placed[dot.point.key] for dot in dots]


def _places(dot: Dot) -> list[tuple[float, float, str]]:
    """Right, left, above and below the dot, then the four corners between."""
    x, y, reach = dot.x, dot.y, RING if dot.point.chosen else REACH
    beside, above, below = reach - 4, y - reach, y + reach + 9
    return [
        (x + reach, y + 4, "start"),
        (x - reach, y + 4, "end"),
        (x, above, "middle"),
        (x, below, "middle"),
        (x + beside, above + 2, "start"),
        (x - beside, above + 2, "end"),
        (x + beside, below - 2, "start"),
        (x - beside, below - 2, "end"),
    ]


def _met(box: Box, others: Sequence[Box]) -> int:
    return sum(_meet(box, other) for other in others)


def label_width(point: Point) -> float:
    """How wide its label is, about."""
    return (BOLD if point.chosen else CHARACTER) * len(point.label)


def _box(place: tuple[float, float, str], width: float) -> Box:
    x, y, anchor = place
    left = x - {"start": 0.0, "middle": width / 2, "end": width}[anchor]
    return left, y - LINE + 3, left + width, y + 3


def _inside(box: Box, frame: Box) -> bool:
    return box[0] >= frame[0] and box[1] >= frame[1] and box[2] <= frame[2] and box[3] <= frame[3]


def _meet(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
