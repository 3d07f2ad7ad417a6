from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import log

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import wilcoxon

from scenes.scene import Mobility
from selector.evidence.rows import Timing
from selector.rebenchmark.calmness import CALM, calm, calm_canary_ms, canaries_ms
from selector.rebenchmark.drift import ALPHA, FEWEST, FLOOR, Subject, above_zero, holm, location, shifts
from selector.rebenchmark.pairing import Paired, log_ratios, median_logs, paired
from tests.selector.evidence_rows import SM, SV, asked, instance, timing
from tests.selector.repeated_runs import repeats, techniques, timings
from tests.tolerances import HALF_PAIR, P_VALUE

SUBJECTS: list[Subject] = [(name, mobility) for name in "abcde" for mobility in Mobility]
SUBJECT = SUBJECTS[0]
NOISE = 0.06
"""Standard deviation of an instance's log ratio: what calm runs of `repeats.npz` have."""

values = st.lists(st.floats(-0.5, 0.5, allow_nan=False), min_size=FEWEST, max_size=30)


@given(values)
@settings(max_examples=40, deadline=None)
def test_old_and_new_may_change_places(logs: list[float]) -> None:
    (there,), (back,) = shifts({SUBJECT: logs}), shifts({SUBJECT: [-one for one in logs]})
    assert there.ratio * back.ratio == pytest.approx(1)
    assert there.low * back.high == pytest.approx(1)
    assert there.p_value == pytest.approx(back.p_value)
    assert there.alarm == back.alarm
    assert there.low <= there.ratio <= there.high


@given(values, st.randoms())
@settings(max_examples=20, deadline=None)
def test_the_order_of_instances_does_not_matter(logs: list[float], random: np.random.Generator) -> None:
    shuffled = list(logs)
    random.shuffle(shuffled)  # type: ignore[arg-type]
    (one,), (other,) = shifts({SUBJECT: logs}), shifts({SUBJECT: shuffled})
    assert (one.ratio, one.low, one.high, one.p_value) == (
        other.ratio,
        other.low,
        other.high,
        other.p_value,
    )


@given(values)
@settings(max_examples=40, deadline=None)
def test_no_alarm_without_an_estimate_beyond_the_floor(logs: list[float]) -> None:
    (found,) = shifts({SUBJECT: logs})
    if found.alarm:
        assert not 1 / (1 + FLOOR) <= found.ratio <= 1 + FLOOR


def test_a_sure_but_trifling_shift_raises_no_alarm() -> None:
    logs = np.random.default_rng(3).normal(log(1.04), 0.001, 24)
    (found,) = shifts({SUBJECT: logs})
    assert not found.alarm
    assert found.low > 1.03


def test_few_instances_claim_nothing() -> None:
    (found,) = shifts({SUBJECT: [log(3.0)] * (FEWEST - 1)})
    assert (found.p_value, found.alarm) == (None, False)
    assert found.ratio == pytest.approx(3.0)
    # As few as a test needs are enough for it, with ten tests side by side.
    spread = {one: [0.2 + 0.001 * place for place in range(FEWEST)] for one in SUBJECTS}
    assert all(one.alarm for one in shifts(spread))
    assert shifts({SUBJECT: []}) == ()


def test_one_wild_instance_raises_no_alarm_and_moves_little() -> None:
    logs = np.random.default_rng(4).normal(0.0, NOISE, 24)
    logs[0] = log(20.0)
    (found,) = shifts({SUBJECT: logs})
    assert not found.alarm
    assert found.ratio < 1 + FLOOR


def test_the_interval_is_that_of_all_pairs() -> None:
    middle, low, high = location(np.arange(9.0))
    assert middle == 4.0
    # Hollander and Wolfe 1999, table A.4: for 9 values the 6th of 45 means from either end leaves 96 %.
    means = sorted((a + b) / 2 for a in range(9) for b in range(a, 9))
    assert low == pytest.approx(means[5], abs=HALF_PAIR)
    assert high == pytest.approx(means[-6], abs=HALF_PAIR)


@given(st.lists(st.floats(0.001, 1.0), min_size=FEWEST, max_size=25, unique=True), st.integers(0, 2**25))
@settings(max_examples=20, deadline=None)
def test_the_signed_rank_test_is_that_of_scipy(sizes: list[float], signs: int) -> None:
    rows = np.array([size if signs >> place & 1 else -size for place, size in enumerate(sizes)])
    theirs = wilcoxon(rows, alternative="greater", method="exact").pvalue
    assert above_zero(rows) == pytest.approx(theirs, rel=P_VALUE)


def test_equal_values_and_zeros_are_no_trouble() -> None:
    assert above_zero(np.ones(12)) == pytest.approx(2.0**-12)
    assert above_zero(np.zeros(12)) == 1.0
    assert above_zero(np.ones(100)) < 1e-9


def test_holm_is_stepwise() -> None:
    corrected = holm(dict(zip(SUBJECTS, [0.01, 0.04, 0.03], strict=False)))
    assert list(corrected.values()) == pytest.approx([0.03, 0.06, 0.06])


@pytest.mark.parametrize("shift", [0.0, FLOOR])
def test_unchanged_code_raises_alarms_as_rarely_as_is_said(shift: float) -> None:
    """Of 300 jobs with ten tests each, whose shifts are at most the floor; heavy tails, as machines have."""
    random = np.random.default_rng(11)
    jobs = 300
    alarms = 0
    for _ in range(jobs):
        noise = random.standard_t(3, (len(SUBJECTS), 24)) * NOISE
        found = shifts(dict(zip(SUBJECTS, (log(1 + shift) + noise).tolist(), strict=True)))
        alarms += any(one.alarm for one in found)
    # Three standard deviations of a binomial above the level that is promised.
    assert alarms <= jobs * ALPHA + 3 * np.sqrt(jobs * ALPHA * (1 - ALPHA))


def test_a_slowdown_of_15_percent_is_found() -> None:
    random = np.random.default_rng(12)
    jobs, found = 200, 0
    for _ in range(jobs):
        logs = dict(zip(SUBJECTS, random.normal(0, NOISE, (len(SUBJECTS), 24)).tolist(), strict=True))
        for mobility in Mobility:
            logs["a", mobility] = [one + log(1.15) for one in logs["a", mobility]]
        alarms = {one.technique for one in shifts(logs) if one.alarm}
        found += alarms == {"a"}
    assert found >= 0.95 * jobs


def test_all_samples_of_an_instance_are_one_witness() -> None:
    one, two = instance(1), instance(2)
    named = {SM.key: "shadow_map", SV.key: "shadow_volume"}
    before = [timing(asked(one, SM), 1.0, 9.0, 1.0), timing(asked(two, SM), 4.0), timing(asked(one, SV), 1.0)]
    old = median_logs(before)
    new = median_logs([timing(asked(one, SM), 2.0, 2.0), timing(asked(two, SM), 4.0, canaries=(4.0,))])
    found = log_ratios(old, new, named)
    assert set(found) == {("shadow_map", one) for one in Mobility}
    ratios = found["shadow_map", Mobility.DYNAMIC]
    assert ratios[one.key] == pytest.approx(log(2.0))
    # Twice the canary and the same time: the technique is twice as fast.
    assert ratios[two.key] == pytest.approx(log(0.5))


def test_times_beside_a_slow_canary_bear_no_witness() -> None:
    one, two = instance(1), instance(2)
    fast = timing(asked(one, SM), 1.0, 1.0, 1.0, canaries=(2.0, 2.0, 9.0))
    slow = timing(asked(two, SM), 1.0, 1.0, 1.0, canaries=(9.0, 2.0 * CALM + 0.1, 2.0))
    assert list(canaries_ms([fast, slow]).values()) == [2.0, 2.0 * CALM + 0.1]
    assert calm([fast, slow], 2.0) == [fast]
    assert calm_canary_ms([]) == float("inf")
    assert calm([fast], calm_canary_ms([])) == [fast]


def test_recorded_instances_are_enough_for_every_technique() -> None:
    found = repeats()
    assert len(found.instances) >= 2 * FEWEST
    assert set(techniques().values()) == {"shadow_map", "shadow_volume", "chan_hybrid"}
    assert len(timings([0])) == len({(row.asked.instance, row.asked.candidate) for row in timings([0])})


COMPARISONS = 20
ENOUGH = 20
"""Of 24 instances: fewer say that other programs were at work."""


FIRST_CALM = 6
"""Runs 0 to 5 were recorded beside other programs that used the whole machine, run 6 and others were not."""


@cache
def pairing(before: tuple[int, ...], night: int) -> Paired:
    """What a job compares that knows some runs."""
    return paired(all_of(before), all_of((night,)), [], techniques())


@cache
def all_of(numbers: tuple[int, ...]) -> list[Timing]:
    if len(numbers) == 1:
        return timings(numbers)
    return [row for number in numbers for row in all_of((number,))]


def recorded(before: Sequence[int], night: int, slowed: str = "") -> tuple[set[str], int]:
    """Techniques that a job after some runs raises an alarm about, and how many instances bear witness."""
    found = pairing(tuple(before), night)
    logs = {
        (name, mobility): [value + (log(1.15) if name == slowed else 0.0) for value in values.values()]
        for (name, mobility), values in found.ratios.items()
    }
    alarms = {one.technique for one in shifts(logs) if one.alarm}
    return alarms, len({instance for values in found.ratios.values() for instance in values})


def test_20_comparisons_of_recorded_runs_over_unchanged_code_raise_at_most_one_alarm() -> None:
    runs = range(len(repeats().runs))
    pairs = [(night - back, night) for night in runs for back in (1, 2) if night >= back]
    assert len(pairs) >= COMPARISONS
    assert sum(bool(recorded([before], night)[0]) for before, night in pairs) <= 1
    assert sum(bool(recorded(range(night), night)[0]) for night in runs[1:]) <= 1


@pytest.mark.parametrize("slowed", ["shadow_map", "shadow_volume", "chan_hybrid"])
def test_the_same_runs_with_one_technique_slowed_by_15_percent_raise_it(slowed: str) -> None:
    runs = range(FIRST_CALM + 1, len(repeats().runs))
    nights = [recorded(range(night), night, slowed) for night in runs]
    calm_nights = [alarms for alarms, witnesses in nights if witnesses >= ENOUGH]
    assert len(calm_nights) >= 3
    assert all(alarms <= {slowed} for alarms, _ in nights)
    assert sum(alarms == {slowed} for alarms in calm_nights) >= 0.9 * len(calm_nights)
