"""Time against error as a plot: where dots, ticks and the front of the best lie, in SVG units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from api.comparison_labels import Dot, Point, labelled

WIDTH, HEIGHT = 720.0, 400.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 18.0, 18.0, 48.0
LABELS_TOP = 2.0
"""Labels may stand above the frame."""
LANE = 34.0
"""Height of the lane at the bottom for errors that a logarithm cannot show."""
LEAST_ERROR_PX = 0.01
LEAST_TIME_MS = 0.001
"""Timer queries may say 0, which has no logarithm."""
LEAST_SPAN = 4.0
"""Factor that an axis spans at least: nearly equal times look nearly equal."""
MANY_STEPS = 3000.0
"""Factor that an axis spans from which on only powers of ten have ticks."""
ROOM = 1.4
"""Factor between an axis' ends and the first and last values, for their labels."""


@dataclass(frozen=True)
class Tick:
    """A place on an axis and what is written there."""

    at: float
    words: str


@dataclass(frozen=True)
class Plot:
    """All that an SVG of this size needs to show.

    Attributes:
        width: Of the view box.
        height: Of the view box.
        left, right, top, bottom: The frame of the plot.
        dots: One a candidate.
        front: Corners of the line through the candidates that nothing beats in both time and error.
        x_ticks: Milliseconds.
        y_ticks: Pixels.
        limit_y: Top of the band within the error limit.
        lane_y: Border between the logarithmic part and the lane below it.
        lane_words: What the lane holds.
    """

    width: float
    height: float
    left: float
    right: float
    top: float
    bottom: float
    dots: tuple[Dot, ...]
    front: tuple[tuple[float, float], ...]
    x_ticks: tuple[Tick, ...]
    y_ticks: tuple[Tick, ...]
    limit_y: float
    lane_y: float
    lane_words: str


@dataclass(frozen=True)
class _Axis:
    """A logarithmic axis from `low` at `start` to `high` at `end`."""

    low: float
    high: float
    start: float
    end: float

    @classmethod
    def over(cls, values: Sequence[float], start: float, end: float) -> _Axis:
        low, high = min(values) / ROOM, max(values) * ROOM
        widen = math.sqrt(max(LEAST_SPAN / (high / low), 1.0))
        return cls(low / widen, high * widen, start, end)

    def at(self, value: float) -> float:
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self) -> tuple[Tick, ...]:
        """At 1, 2 and 5 times the powers of ten, at powers alone where that would be too many."""
        first, last = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
        steps = (1, 2, 5) if self.high / self.low < MANY_STEPS else (1,)
        values = [step * 10.0**power for power in range(first, last + 1) for step in steps]
        return tuple(Tick(self.at(one), f"{one:,g}") for one in values if self.low <= one <= self.high)


def plot(points: Sequence[Point], limit_px: float) -> Plot:
    """Time to the right, error upwards, both logarithmic; errors under 0.01 px lie in a lane below.

    Args:
        points: At least one.
        limit_px: The error limit.
    """
    assert points
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    lane_y = bottom - LANE
    shown = [error for error in (*(point.error_px for point in points), limit_px) if error >= LEAST_ERROR_PX]
    time = _Axis.over([_shown_ms(point) for point in points], LEFT, right)
    error = _Axis.over(shown or [1.0], lane_y, TOP)

    def height(error_px: float) -> float:
        return error.at(error_px) if error_px >= LEAST_ERROR_PX else (lane_y + bottom) / 2

    front = pareto_front(points)
    dots = [Dot(one, time.at(_shown_ms(one)), height(one.error_px), one in front) for one in points]
    corners = _stairs([dot for point in front for dot in dots if dot.point is point])
    return Plot(
        WIDTH,
        HEIGHT,
        LEFT,
        right,
        TOP,
        bottom,
        tuple(labelled(dots, corners, (LEFT, LABELS_TOP, right, bottom))),
        corners,
        time.ticks(),
        error.ticks(),
        error.at(limit_px) if limit_px >= LEAST_ERROR_PX else lane_y,
        lane_y,
        f"< {LEAST_ERROR_PX:g}",
    )


def pareto_front(points: Sequence[Point]) -> list[Point]:
    """Those that no other beats in time without being worse in error, cheapest first."""
    front: list[Point] = []
    for point in sorted(points, key=lambda one: (one.time_ms, one.error_px)):
        if not front or point.error_px < front[-1].error_px:
            front.append(point)
    return front


def _shown_ms(point: Point) -> float:
    return max(point.time_ms, LEAST_TIME_MS)


def _stairs(front: Sequence[Dot]) -> tuple[tuple[float, float], ...]:
    """Each buys its error for all times from its own on, so the line runs right before it goes down."""
    corners = [(front[0].x, front[0].y)]
    for dot in front[1:]:
        corners += [(dot.x, corners[-1][1]), (dot.x, dot.y)]
    return tuple(corners)
