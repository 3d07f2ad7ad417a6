from __future__ import annotations

import io
import os
import signal
import time
from contextlib import suppress

import pytest
from rich.console import Console

from api.cli import progress
from api.cli.progress import MeasuringProgress


class Clock:
    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(progress, "time", made)
    return made


def lines(stream: io.StringIO) -> list[str]:
    return stream.getvalue().splitlines()


def shown(clock: Clock, steps: list[int], seconds: list[float], *, skip_last: int = 0) -> list[str]:
    """What is printed where the steps of each light take so many seconds each."""
    stream = io.StringIO()
    with MeasuringProgress(Console(file=stream, width=200), steps) as running:
        for light, (count, each) in enumerate(zip(steps, seconds, strict=True)):
            for index in range(count - (skip_last if light == 0 else 0)):
                running.step(f"step {index + 1}")
                clock.now += each
            running.light_done()
        assert running.lights_done == len(steps)
    return lines(stream)


def test_without_a_terminal_a_line_comes_now_and_then(clock: Clock) -> None:
    printed = shown(clock, [10, 10], [3.0, 3.0])
    assert printed[0] == "0 %  light 1 of 2, step 1"
    assert printed[1] == "20 %  light 1 of 2, about 50 s left, step 5"
    assert len(printed) == 1 + 60 // 12


def test_a_light_that_is_done_is_not_named_as_the_next(clock: Clock) -> None:
    stream = io.StringIO()
    with MeasuringProgress(Console(file=stream, width=200), [1, 1]) as running:
        running.step("Sun: SM")
        clock.now += 20
        running.light_done()
    assert lines(stream) == ["0 %  light 1 of 2, Sun: SM", "50 %  light 2 of 2, about 20 s left"]


def test_the_estimate_is_exact_where_all_steps_are_alike(clock: Clock) -> None:
    for line in shown(clock, [30, 30, 30], [20.0, 20.0, 20.0])[1:]:
        percent = int(line.split(" %")[0])
        minutes = (100 - percent) / 100 * 90 * 20 / 60
        if minutes > 2:
            assert abs(int(line.split("about ")[1].split(" min")[0]) - minutes) <= 1, line


def test_lights_with_more_views_count_for_more(clock: Clock) -> None:
    printed = shown(clock, [10, 30], [12.0, 12.0])
    assert any(line.startswith("25 %  light 2 of 2, about 6 min left") for line in printed)


def test_steps_that_were_left_out_are_made_up_for(clock: Clock) -> None:
    printed = shown(clock, [10, 10], [12.0, 12.0], skip_last=5)
    assert printed[5].startswith("50 %  light 2 of 2")


def test_more_steps_than_planned_never_pass_the_light(clock: Clock) -> None:
    stream = io.StringIO()
    with MeasuringProgress(Console(file=stream, width=200), [2, 2]) as running:
        for _ in range(9):
            running.step("again")
            clock.now += 11
    assert all(line.startswith(("0 %", "25 %")) for line in lines(stream))


def test_hours_are_called_hours(clock: Clock) -> None:
    printed = shown(clock, [4, 4], [3600.0, 3600.0])
    assert any("about 4 h 00 min left" in line for line in printed)


def measured_but_ctrl_c_gets_lost(done: list[str], steps: tuple[str, ...]) -> None:
    with MeasuringProgress(Console(file=io.StringIO()), [10]) as progress:
        with suppress(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1)
        for step in steps:
            progress.step(step)
            done.append(step)
    done.append("the end")


@pytest.mark.parametrize("steps", [(), ("one", "two")])
def test_ctrl_c_that_got_lost_is_raised_at_the_next_step(steps: tuple[str, ...]) -> None:
    before, done = signal.getsignal(signal.SIGINT), list[str]()
    with pytest.raises(KeyboardInterrupt):
        measured_but_ctrl_c_gets_lost(done, steps)
    assert done == []
    assert signal.getsignal(signal.SIGINT) is before
