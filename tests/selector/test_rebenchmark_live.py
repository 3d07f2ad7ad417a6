"""Real jobs on real frames: a planted slowdown is found, and 20 nights over unchanged code stay calm.

A night in which other programs were at work says that it knows nothing, which is no alarm: where most nights
were like that the test has nothing to say and is skipped.
"""

from __future__ import annotations

import sys
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
from selector.rebenchmark.drift import FEWEST
from selector.rebenchmark.remeasuring import Bench
from selector.rebenchmark.report import Report
from tests.selector.slowed_technique import enter_slowed
from tests.small_level import small_level

NIGHTS = 20
ATTEMPTS = 4
"""Nights that a slowdown may take to find a calm machine."""
MOST_NEEDED = 20
"""Calm instances in which 15 % must be found: where they scatter by 6 %, 24 find even 10 % in 99 of 100."""


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
def test_calm_nights_are_calm(tmp_path: Path) -> None:
    wanted = asked(tmp_path, sample=14)
    on = machine(wanted)
    baseline(wanted, on.bench)
    now = datetime.now(UTC)
    nights = []
    for night in range(NIGHTS):
        report = rebenchmark(replace(wanted, seed=night), Quiet(), on, now + timedelta(days=night))
        sys.stdout.write(told(report))
        assert not report.differs
        nights.append(report)
    assert sum(bool(one.drifted) for one in nights) <= 1
    blind = sum(witnesses(one) < FEWEST for one in nights)
    if blind > NIGHTS // 2:
        pytest.skip(f"other programs were at work in {blind} of {NIGHTS} nights")


@pytest.mark.slow
def test_a_planted_slowdown_is_found(tmp_path: Path) -> None:
    wanted = asked(tmp_path, sample=24)
    on = machine(wanted)
    baseline(wanted, on.bench)
    now = datetime.now(UTC)
    slow = replace(on, bench=replace(on.bench, entry=partial(enter_slowed, "SV", 0.15)))
    for night in range(ATTEMPTS):
        report = rebenchmark(replace(wanted, seed=night), Quiet(), slow, now + timedelta(days=night))
        sys.stdout.write(told(report))
        if report.drifted or witnesses(report) >= MOST_NEEDED:
            break
    else:
        pytest.skip(f"other programs were at work in all {ATTEMPTS} nights")
    assert {one.technique for one in report.drifted} == {"shadow_volume"}
    assert report.causes == ("times have drifted",)


def asked(folder: Path, sample: int) -> Request:
    return Request(
        store=str(folder / "e.sqlite"),
        model=folder / "m.model",
        report=folder / "night.html",
        levels=(small_level(folder, "yard.glb"),),
        policy=policy("balanced"),
        size=(160, 128),
        sample=sample,
        rounds=6,
        techniques=("SM", "SV"),
    )


def witnesses(report: Report) -> int:
    assert report.sampled is not None
    return report.sampled.measured


def told(report: Report) -> str:
    """What a night found, for whoever follows the test with -s."""
    assert report.sampled is not None
    shifts = (f"{one.technique} {one.mobility} {one.ratio:.3f}" for one in report.sampled.shifts)
    found = ", ".join(sorted({one.technique for one in report.drifted})) or "nothing"
    return f"{report.started} {witnesses(report)} witnesses; {'; '.join(shifts)}; drifted: {found}\n"


def baseline(wanted: Request, bench: Bench) -> None:
    """Twice as many of the smallest scenes as a night asks for, in few pixels: not all will be calm."""
    smallest = sorted(corpus("quick"), key=lambda one: one.triangles)[: 2 * wanted.sample]
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
