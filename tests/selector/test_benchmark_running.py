from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import pytest

from scenes.errors import DeviceError
from scenes.scene import Mobility
from selector.benchmark.questions import SpecQuestion
from selector.benchmark.ranking import FEWEST_ROUNDS
from selector.evidence.rows import Purpose, Role
from selector.measurement import Status
from tests.selector.benchmarks import CODES, SPECS, facts, instances, job, judgements, order, ran, timings


def test_errors_and_counters_repeat_whatever_the_number_of_workers(tmp_path: Path) -> None:
    alone, pair = tmp_path / "alone.sqlite", tmp_path / "pair.sqlite"
    ran(alone, order(Purpose.ERRORS, workers=1))
    benchmark = ran(pair, order(Purpose.ERRORS, workers=2))
    assert benchmark.score.done == len(SPECS)
    assert facts(alone) == facts(pair)
    found = judgements(pair)
    assert {instance for instance, _ in found} == {row.key for row in instances(pair)}
    assert all("edge_error_px" in row.figures for row in found.values())
    assert all("flip" not in row.figures for row in found.values())
    assert all(row.counters for row in found.values())


def test_what_is_fresh_is_not_asked_again(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    ran(path, order(Purpose.ERRORS, [SpecQuestion(SPECS[0])]))
    benchmark = ran(path, order(Purpose.ERRORS))
    assert (benchmark.score.fresh, benchmark.score.done) == (1, 1)
    before = judgements(path)
    changed = {**CODES, "shadow_volume": "f" * 32}
    again = ran(path, replace(order(Purpose.ERRORS), codes=changed))
    assert (again.score.fresh, again.score.done) == (0, 2)
    assert sum(again.score.statuses.values()) == 2, "only the volumes' code has changed"
    after = judgements(path, changed)
    assert after.keys() == before.keys()
    for key, row in after.items():
        assert (row == before[key]) == (row.asked.code != changed["shadow_volume"])


def test_times_are_taken_in_rounds_beside_a_canary(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    asked = [SpecQuestion(SPECS[0])]
    ran(path, order(Purpose.ERRORS, asked))
    benchmark = ran(path, order(Purpose.TIMES, asked))
    rows = timings(path)
    assert {row.asked.candidate for row in rows} == {row.asked.candidate for row in judgements(path).values()}
    for row in rows:
        assert row.status is Status.OK
        rounds = {sample.round for sample in row.samples}
        assert len(rounds) == FEWEST_ROUNDS
        assert len(row.samples) == len(rounds) * len(Mobility)
        assert all(sample.shadow_ms > 0 and sample.canary_ms > 0 for sample in row.samples)
    canaries = {(sample.round, sample.canary_ms) for row in rows for sample in row.samples}
    assert len(canaries) == FEWEST_ROUNDS, "all of a round share one canary"
    assert sum(benchmark.tally.wins(Mobility.STATIC, "balanced").values()) == 1
    assert ran(path, order(Purpose.TIMES, asked)).score.fresh == 1


def test_no_question_begins_after_the_deadline(tmp_path: Path) -> None:
    benchmark = ran(tmp_path / "evidence.sqlite", order(Purpose.ERRORS, deadline=time.monotonic()))
    assert (benchmark.score.total, benchmark.score.done) == (2, 0)


def test_roles_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    ran(path, order(Purpose.ERRORS, [SpecQuestion(SPECS[0], Role.TEST)]))
    assert [row.role for row in instances(path)] == [Role.TEST]


def test_a_scene_that_cannot_be_made_fails_alone(tmp_path: Path) -> None:
    nowhere = replace(SPECS[0], family="nowhere")
    asked = [SpecQuestion(nowhere), SpecQuestion(SPECS[0])]
    benchmark = ran(tmp_path / "evidence.sqlite", order(Purpose.ERRORS, asked))
    assert benchmark.score.done == 2
    ((origin, reason),) = benchmark.score.failed
    assert origin == nowhere.text
    assert 'no family "nowhere"' in reason


def test_a_device_that_is_not_there_is_said(tmp_path: Path) -> None:
    wanted = replace(order(Purpose.ERRORS), job=job(Purpose.ERRORS, device="Voodoo"))
    with pytest.raises(DeviceError, match="Voodoo"):
        ran(tmp_path / "evidence.sqlite", wanted)
