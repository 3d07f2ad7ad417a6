from __future__ import annotations

from math import comb

import numpy as np
import pytest

from scenes.scene import Mobility
from selector.benchmark import idleness
from selector.benchmark.ranking import (
    COVERAGE,
    median_interval,
    settled,
    stability,
    winning_share,
)
from selector.benchmark.tally import Tally, exceedance_px
from selector.evidence.rows import Asked, Judgement, SampleRow, Timing
from selector.measurement import Status


@pytest.mark.parametrize("count", [1, 3, 5, 8, 12, 30])
def test_the_interval_covers_the_median_as_often_as_it_says(count: int) -> None:
    random = np.random.default_rng(7)
    drawn = random.exponential(size=(2000, count))
    spans = [median_interval(list(row)) for row in drawn]
    covered = np.mean([low <= np.log(2) <= high for low, high in spans])
    # From the smallest to the largest, where no narrower one covers enough.
    most = 1 - 2 / 2**count
    assert covered >= min(COVERAGE, most) - 4 * np.sqrt(0.25 / len(drawn))


def test_the_interval_is_the_narrowest_that_covers_enough() -> None:
    assert median_interval(list(range(12))) == (2, 9)
    assert 1 - 2 * sum(comb(12, k) for k in range(3)) / 2**12 >= COVERAGE
    assert 1 - 2 * sum(comb(12, k) for k in range(4)) / 2**12 < COVERAGE


def test_candidates_apart_are_settled_after_three_and_overlapping_ones_are_not() -> None:
    apart, near = [1.0, 1.1, 1.2], [2.0, 2.2, 2.4]
    overlapping = [2.1, 2.3, 2.5]
    assert settled([apart, near, overlapping]) == [True, False, False]
    assert settled([apart[:2], near[:2]]) == [False, False]


def test_a_tie_that_is_known_closely_is_settled() -> None:
    assert settled([[1.0, 1.001, 1.002], [1.0, 1.001, 1.003]]) == [True, True]


def test_the_winner_is_as_sure_as_its_samples_are_apart() -> None:
    assert winning_share({"a": [1.0, 1.1, 1.2], "b": [2.0, 2.1, 2.2]}) == ("a", 1.0)
    found = winning_share({"a": [1.0, 2.0, 3.0], "b": [1.1, 2.1, 2.9]})
    assert found is not None
    assert found[0] == "a"
    assert 0.3 < found[1] < 0.8
    assert winning_share({}) is None


def test_halves_that_rank_alike_have_tau_one() -> None:
    assert stability([[1.0, 1.1], [2.0, 2.1], [3.0, 3.1]]) == pytest.approx(1.0)
    assert stability([[1.0, 3.1], [2.0, 2.1], [3.0, 1.1]]) == pytest.approx(-1.0)
    assert stability([[1.0]]) is None


def test_a_short_edge_counts_its_wrong_pixels() -> None:
    assert exceedance_px({"edge_error_px": 0.25, "wrong_share": 1.0, "pixels": 6400.0}) == 0.25
    assert exceedance_px({"edge_error_px": None, "wrong_share": 0.01, "pixels": 6400.0}) == 1.0


def judgement(candidate: str, edge_error_px: float) -> Judgement:
    figures = {"edge_error_px": edge_error_px}
    return Judgement(Asked("place", candidate, "here", "now"), "run", Status.OK, figures=figures)


def timing(candidate: str, *shadow_ms: float) -> Timing:
    samples = tuple(
        SampleRow(index, mobility, ms, ms, 2.0) for index, ms in enumerate(shadow_ms) for mobility in Mobility
    )
    return Timing(Asked("place", candidate, "here", "now"), "run", Status.OK, samples=samples)


def test_the_fastest_within_a_policy_wins_and_the_most_exact_where_none_is() -> None:
    tally = Tally()
    tally.techniques = {"coarse": "shadow_map", "fine": "perspective_shadow_map", "near": "chan_hybrid"}
    for candidate, error_px, ms in (("coarse", 3.0, 1.0), ("fine", 1.0, 2.0), ("near", 0.7, 3.0)):
        tally.judge(judgement(candidate, error_px))
        tally.time(timing(candidate, ms, ms * 1.1, ms * 1.2))
    tally.close("place", surely=True)
    wins = {name: tally.wins(Mobility.DYNAMIC, name) for name in ("speed", "balanced", "quality")}
    assert wins == {
        "speed": {"shadow_map": 1},
        "balanced": {"perspective_shadow_map": 1},
        "quality": {"chan_hybrid": 1},
    }
    assert tally.sureness(Mobility.DYNAMIC, "speed") == 1.0
    assert tally.tau() == pytest.approx(1.0)


def test_who_failed_wins_nothing() -> None:
    tally = Tally()
    tally.techniques = {"coarse": "shadow_map"}
    tally.time(timing("coarse", 1.0))
    tally.close("place", surely=False)
    assert not tally.wins(Mobility.DYNAMIC, "speed")


def test_only_what_others_do_is_remarked(monkeypatch: pytest.MonkeyPatch) -> None:
    # Seconds on the clock, of all cores, and of our own processes.
    told = iter([(0.0, 5.0, 3.0), (2.0, 8.0, 4.0), (4.0, 10.0, 6.0), (6.0, 12.3, 8.0)])
    monkeypatch.setattr(idleness, "_reading", lambda: idleness._Reading(*next(told)))
    watch = idleness.Idleness()
    assert "other programs used 1.0 of" in watch.remark("Before")
    assert watch.remark("Then") == "", "all of it was ours"
    assert watch.cores_of_others() == pytest.approx(0.15)


def test_ones_own_work_is_known() -> None:
    before = idleness._own_s()
    while (used_s := idleness._own_s() - before) < 0.05:
        sum(index * index for index in range(100_000))
    assert used_s <= idleness._reading().busy_s
