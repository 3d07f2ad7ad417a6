from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from api.comparison_labels import Dot, Point, label_width
from api.comparison_plot import Plot, pareto_front, plot


def point(time_ms: float, error_px: float, key: str = "a", *, chosen: bool = False) -> Point:
    return Point(key, f"SM {key} 2x2", 0, time_ms, error_px, chosen)


def random_points(seed: int, count: int) -> list[Point]:
    random = np.random.default_rng(seed)
    times, errors = 10 ** random.uniform(-2, 3, count), 10 ** random.uniform(-3, 1.5, count)
    errors[random.random(count) < 0.2] = 0.0
    return [
        point(float(time), float(error), str(index), chosen=index == 0)
        for index, (time, error) in enumerate(zip(times, errors, strict=True))
    ]


def assert_within(drawn: Plot) -> None:
    for dot in drawn.dots:
        assert drawn.left <= dot.x <= drawn.right
        assert drawn.top <= dot.y <= drawn.bottom
    for x, y in drawn.front:
        assert drawn.left <= x <= drawn.right
        assert drawn.top <= y <= drawn.bottom
    assert drawn.x_ticks
    assert drawn.y_ticks
    assert all(drawn.left <= tick.at <= drawn.right for tick in drawn.x_ticks)
    assert all(drawn.top <= tick.at <= drawn.lane_y for tick in drawn.y_ticks)
    assert drawn.top <= drawn.limit_y <= drawn.lane_y
    assert 0 < drawn.left < drawn.right <= drawn.width
    assert 0 < drawn.top < drawn.bottom <= drawn.height


@pytest.mark.parametrize("limit_px", [0.0, 1.5, 400.0])
@pytest.mark.parametrize("count", [1, 2, 40])
def test_everything_lies_in_the_frame(count: int, limit_px: float) -> None:
    for seed in range(20):
        assert_within(plot(random_points(seed, count), limit_px))


@pytest.mark.parametrize(
    "points",
    [
        [point(5.0, 0.0)],
        [point(0.0, 0.0)],
        [point(0.0, 1.0), point(5.0, 0.0, "b")],
        [point(5.0, 1.0), point(5.0, 1.0, "b")],
        [point(1e-9, 1e9), point(1e9, 1e-9, "b")],
    ],
)
def test_odd_points_have_their_place(points: list[Point]) -> None:
    drawn = plot(points, 1.5)
    assert_within(drawn)
    assert len(drawn.dots) == len(points)


def test_right_is_slower_and_up_is_worse() -> None:
    fast, slow, exact = plot([point(1, 3.0), point(4, 0.3, "b"), point(9, 0.0, "c")], 1.5).dots
    assert fast.x < slow.x < exact.x
    assert fast.y < slow.y < exact.y


def test_the_band_ends_at_the_limit() -> None:
    drawn = plot([point(1, 3.0), point(4, 1.5, "b"), point(9, 0.3, "c")], 1.5)
    above, on, below = drawn.dots
    assert above.y < drawn.limit_y == on.y < below.y


def test_errors_under_a_hundredth_share_the_lane() -> None:
    drawn = plot([point(1, 3.0), point(4, 0.004, "b"), point(9, 0.0, "c")], 1.5)
    assert drawn.lane_words == "< 0.01"
    assert drawn.lane_y < drawn.dots[1].y == drawn.dots[2].y
    assert plot([point(1, 3.0), point(9, 0.0, "c")], 1.5).lane_words == "< 0.01"


def test_nothing_beats_the_front() -> None:
    for seed in range(20):
        points = random_points(seed, 30)
        unbeaten = {
            one.key
            for one in points
            if not any(
                other.time_ms <= one.time_ms and other.error_px <= one.error_px
                for other in points
                if other is not one and (other.time_ms, other.error_px) != (one.time_ms, one.error_px)
            )
        }
        front = pareto_front(points)
        assert {one.key for one in front} == unbeaten
        assert [one.time_ms for one in front] == sorted(one.time_ms for one in front)


def test_labels_that_are_shown_cover_neither_each_other_nor_a_dot() -> None:
    for seed in range(10):
        drawn = plot(random_points(seed, 30), 1.5)
        shown = [dot for dot in drawn.dots if dot.shown]
        assert shown
        for one, other in combinations(shown, 2):
            left, right = sorted((span(one), span(other)))
            assert left[1] <= right[0] or abs(one.label_y - other.label_y) >= 13
        for dot in shown:
            start, end = span(dot)
            others = [one for one in drawn.dots if one is not dot and start < one.x < end]
            assert all(not dot.label_y - 10 < one.y < dot.label_y + 3 for one in others)


def span(dot: Dot) -> tuple[float, float]:
    width = label_width(dot.point)
    start = dot.label_x - {"start": 0, "middle": width / 2, "end": width}[dot.anchor]
    return start, start + width
