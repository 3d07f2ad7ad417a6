"""Real jobs on real frames: a planted slowdown is found, and 20 nights over unchanged code stay calm.

On a machine that other programs keep busy all nights say that they know nothing, which is no alarm.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path

import pytest

from api.rebenchmarking import Request, machine, rebenchmark
from scenes.corpus.corpora import corpus
from selector.benchmark.messages import Job
from selector.benchmark.questions import SpecQuestion
from selector.benchmark.running import Benchmark, Order
from selector.evidence.rows import Purpose
from selector.evidence.store import Store
from selector.policy import policy
from selector.rebenchmark.remeasuring import Bench
from tests.selector.slowed_technique import enter_slowed
from tests.small_level import small_level

INSTANCES, NIGHTS = 12, 20


class Quiet:
    def begins(self, words: str) -> None:
        pass

    def advances(self, done: int, total: int, words: str = "") -> None:
        pass

    def runs(self, benchmark: Benchmark, words: str) -> None:
        assert words
        for _ in benchmark.run():
            pass


@pytest.mark.slow
def test_a_planted_slowdown_is_found_and_calm_nights_are_calm(tmp_path: Path) -> None:
    small_level(tmp_path, "yard.glb")
    wanted = Request(
        store=str(tmp_path / "e.sqlite"),
        model=tmp_path / "m.model",
        report=tmp_path / "night.html",
        levels=(tmp_path / "yard.glb",),
        policy=policy("balanced"),
        size=(160, 128),
        sample=INSTANCES,
        rounds=6,
        techniques=("SM", "SV"),
    )
    on = machine(wanted)
    baseline(wanted, on.bench)
    now = datetime.now(UTC)
    alarms = []
    for night in range(NIGHTS):
        report = rebenchmark(replace(wanted, seed=night), Quiet(), on, now + timedelta(days=night))
        assert not report.differs
        alarms.append(bool(report.drifted))
    assert sum(alarms) <= 1
    slow = replace(on, bench=replace(on.bench, entry=partial(enter_slowed, "SV", 0.15)))
    report = rebenchmark(replace(wanted, seed=99), Quiet(), slow, now + timedelta(days=NIGHTS))
    assert report.sampled is not None
    if report.sampled.measured < INSTANCES - 1:
        pytest.skip(f"other programs disturbed {report.sampled.disturbed} of {INSTANCES} instances")
    assert {one.technique for one in report.drifted} == {"shadow_volume"}
    assert report.causes == ("times have drifted",)


def baseline(wanted: Request, bench: Bench) -> None:
    """The smallest scenes of the corpus, in few pixels."""
    smallest = sorted(corpus("quick"), key=lambda one: one.triangles)[:INSTANCES]
    with Store.open(wanted.store) as store:
        for purpose in Purpose:
            job = Job(
                purpose,
                160,
                128,
                wanted.techniques,
                threads=bench.threads,
                rounds=wanted.rounds,
                timeout_s=60.0,
            )
            order = Order(job, [SpecQuestion(spec) for spec in smallest], bench.codes)
            Quiet().runs(Benchmark(store, order), "baseline")
