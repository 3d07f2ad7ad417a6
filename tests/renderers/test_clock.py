from __future__ import annotations

from itertools import count

import pytest

from renderers import clock
from renderers.clock import ClockKind, StageClock, truthful_clock
from renderers.context import Gpu


def test_a_software_rasteriser_is_timed_by_the_wall(gpu: Gpu) -> None:
    if not gpu.device.software:
        pytest.skip("this device is a GPU")
    assert truthful_clock(gpu) is ClockKind.WALL


def test_the_choice_of_clock_is_made_once(gpu: Gpu, monkeypatch: pytest.MonkeyPatch) -> None:
    first = truthful_clock(gpu)

    def again(_: Gpu) -> float:
        raise AssertionError

    monkeypatch.setattr(clock, "_query_over_wall", again)
    assert truthful_clock(gpu) is first


BELIEFS = [(1.0, ClockKind.QUERY), (0.01, ClockKind.WALL), (9.0, ClockKind.WALL)]


@pytest.mark.parametrize(("ratio", "kind"), BELIEFS)
def test_a_query_is_believed_only_where_it_agrees(
    gpu: Gpu, monkeypatch: pytest.MonkeyPatch, ratio: float, kind: ClockKind
) -> None:
    monkeypatch.setattr(gpu, "_cache", {})
    monkeypatch.setattr(gpu, "device", type("Real", (), {"software": False})())
    monkeypatch.setattr(clock, "_query_over_wall", lambda _: ratio)
    assert truthful_clock(gpu) is kind


def test_the_probe_draws_and_leaves_nothing(gpu: Gpu) -> None:
    assert clock._query_over_wall(gpu) > 0


@pytest.mark.parametrize("kind", list(ClockKind))
def test_stages_are_named_by_what_they_make_and_add_up(gpu: Gpu, kind: ClockKind) -> None:
    timed = StageClock(gpu, kind)
    for name in ("map", "visibility", "map"):
        with timed.stage(name):
            gpu.ctx.finish()
    assert set(timed.stages()) == {"map", "visibility"}
    assert all(milliseconds >= 0 for milliseconds in timed.stages().values())


def test_a_stage_that_runs_twice_is_the_sum(gpu: Gpu, monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = count(0.0, 0.5)
    monkeypatch.setattr(clock.time, "perf_counter", lambda: next(ticks))
    timed = StageClock(gpu, ClockKind.WALL)
    for name in ("map", "visibility", "map"):
        with timed.stage(name):
            pass
    assert timed.stages() == {"map": 1000.0, "visibility": 500.0}


@pytest.mark.parametrize("kind", list(ClockKind))
def test_stages_that_are_not_asked_for_stay_empty(gpu: Gpu, kind: ClockKind) -> None:
    timed = StageClock(gpu, kind, staged=False)
    with timed.stage("map"):
        pass
    assert timed.stages() == {}
