"""Jobs over evidence that was taken beside other programs."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

from api.rebenchmark_sampling import RETRIES
from api.rebenchmarking import rebenchmark
from selector.evidence.rows import Purpose
from selector.evidence.store import Store
from selector.rebenchmark.drift import FEWEST
from selector.rebenchmark.telling import Told, telling, told
from tests.api.rebenchmark_request import machine, request
from tests.selector.repeated_runs import codes, fill, repeats, techniques, timings
from tests.selector.replaying import NOW, Replay

CALM, DISTURBED = 6, 9
"""Recorded runs: during a third of the second other programs were at work."""


def told_of(store: Store) -> Told:
    started = {row.key: row.started for row in store.runs()}
    return told(store.timings(), started, store.marks(), techniques())


def test_only_what_can_be_compared_is_timed(tmp_path: Path) -> None:
    """Times of before that were taken beside other programs do not become calm by new ones."""
    wanted = request(tmp_path, learn=False, levels=())
    with Store.open(wanted.store) as store:
        fill(store, [DISTURBED])
        worth, known = {key for key, _ in told_of(store).calm}, len(list(store.instances()))
    assert FEWEST < len(worth) < known
    listener = Replay(DISTURBED + 1)
    report = rebenchmark(wanted, listener, machine(), NOW)
    assert report.sampled is not None
    counts = {purpose: [count for one, count, _ in listener.asked if one is purpose] for purpose in Purpose}
    # Errors are what they are on any machine.
    assert counts[Purpose.ERRORS] == [known]
    assert counts[Purpose.TIMES][0] == report.sampled.wanted == len(worth)
    assert 0 < len(counts[Purpose.TIMES][1:]) <= RETRIES
    assert max(counts[Purpose.TIMES][1:]) == report.sampled.disturbed == len(worth) - report.sampled.measured


def test_errors_of_disturbed_instances_are_compared_too(tmp_path: Path) -> None:
    wanted = request(tmp_path, learn=False, levels=(), sample=12)
    with Store.open(wanted.store) as store:
        fill(store, [DISTURBED])
        worth = {key for key, _ in told_of(store).calm}
    seen: set[str] = set()
    for seed in range(20):
        listener = Replay(DISTURBED + 1, changed=0.5)
        report = rebenchmark(replace(wanted, seed=seed), listener, machine(), NOW)
        assert report.sampled is not None
        seen |= {one.instance for one in report.sampled.differences}
    assert seen - worth
    assert len(seen) == len(repeats().instances)


def test_times_that_no_longer_count_tell_nothing(tmp_path: Path) -> None:
    """A calm run by older code, and a calm run of one technique only."""
    of = techniques()
    with Store.open(str(tmp_path / "e.sqlite")) as store:
        fill(store, [CALM], codes=dict.fromkeys(codes(), "old"))
        before = told_of(store)
        fill(store, [DISTURBED])
        after = told_of(store)
    with Store.open(str(tmp_path / "only.sqlite")) as store:
        fill(store, [DISTURBED])
        assert told_of(store) == after
    assert after.calm < before.calm == before.known == after.known
    rows = [row for row in timings([CALM]) if of[row.asked.candidate] == "shadow_map"]
    rows += [row for row in timings([DISTURBED]) if of[row.asked.candidate] != "shadow_map"]
    started = {run.key: run.started for run in repeats().runs}
    mixed = told(rows, started, {}, of)
    calm = Counter(name for _, name in mixed.calm)
    assert calm["shadow_map"] == len(repeats().instances) > max(calm["shadow_volume"], calm["chan_hybrid"])


def test_the_driver_of_before_tells_of_what_this_one_does_not_know() -> None:
    here = Told(frozenset({("a", "SM"), ("b", "SM")}), frozenset({("a", "SM")}))
    former = Told(
        frozenset({("a", "SM"), ("b", "SM"), ("c", "SM")}), frozenset({("a", "SM"), ("b", "SM"), ("c", "SM")})
    )
    among = {"a": ["SM", "SV"], "b": ["SM"], "c": ["SM"], "d": ["SM"]}
    assert telling(here, former, among) == {"a": ["SM"], "c": ["SM"]}
