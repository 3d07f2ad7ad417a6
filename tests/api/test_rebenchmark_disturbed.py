"""Jobs over evidence that was taken beside other programs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from api.rebenchmarking import RETRIES, rebenchmark
from selector.evidence.rows import Purpose
from selector.evidence.store import Store
from selector.rebenchmark.calmness import calm_instances
from selector.rebenchmark.drift import FEWEST
from tests.api.rebenchmark_request import machine, request
from tests.selector.repeated_runs import fill
from tests.selector.replaying import NOW, Replay

DISTURBED = 9
"""A run during a third of which other programs were at work."""


def test_instances_that_can_tell_nothing_are_not_timed_twice(tmp_path: Path) -> None:
    """Times of before that were taken beside other programs do not become calm by new ones."""
    wanted = request(tmp_path, learn=False, levels=())
    with Store.open(wanted.store) as store:
        fill(store, [DISTURBED])
        telling, known = calm_instances(store.timings()), len(list(store.instances()))
    assert FEWEST < len(telling) < known
    listener = Replay(DISTURBED + 1)
    report = rebenchmark(wanted, listener, machine(), NOW)
    assert report.sampled is not None
    timed = [count for purpose, count, _ in listener.asked if purpose is Purpose.TIMES]
    assert timed[0] == report.sampled.wanted == known
    assert 0 < len(timed[1:]) <= RETRIES
    assert max(timed[1:]) <= len(telling) - report.sampled.measured
    # A sample of as many as can tell something is those.
    few = rebenchmark(replace(wanted, sample=len(telling)), Replay(DISTURBED + 1), machine(), NOW)
    assert few.sampled is not None
    assert few.sampled.measured == report.sampled.measured
    assert few.sampled.disturbed == len(telling) - few.sampled.measured
