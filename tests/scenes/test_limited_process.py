"""Calls in a program of its own: what it gives, and that it may hang, crash or be greedy."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import numpy as np
import pytest

from scenes.errors import LevelError
from scenes.limited_process import EndedError, LimitedProcess

ENOUGH_S = 60.0
ENOUGH_BYTES = 8 * 2**30


@pytest.fixture(scope="module")
def program() -> LimitedProcess:
    return LimitedProcess(ENOUGH_BYTES, ENOUGH_S)


def test_arrays_of_every_size_come_back_as_they_are(program: LimitedProcess) -> None:
    for count in (0, 1, 1023, 1024, 1025, 300_001):
        found = program.call("numpy", "arange", count)
        np.testing.assert_array_equal(found, np.arange(count))
        assert found.dtype == np.arange(count).dtype
    sent = np.arange(200_000, dtype=np.float32).reshape(-1, 4)
    turned, half = program.call("builtins", "tuple", [sent.T, sent[::2]])
    np.testing.assert_array_equal(turned, sent.T)
    np.testing.assert_array_equal(half, sent[::2])


def test_it_is_one_program_that_works_where_the_caller_does(
    program: LimitedProcess, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    number = program.call("os", "getpid")
    assert number != os.getpid()
    monkeypatch.chdir(tmp_path)
    assert program.call("os", "getcwd") == os.path.realpath(tmp_path)
    assert program.call("os", "getpid") == number


def test_its_errors_are_raised_here(program: LimitedProcess, tmp_path: Path) -> None:
    with pytest.raises(LevelError, match="There is no such file") as caught:
        program.call("scenes.level_file", "read_level_file", tmp_path / "nowhere")
    assert caught.value.where == str(tmp_path / "nowhere")
    assert caught.value.remedy
    with pytest.raises(RuntimeError, match=r"builtins\.int: ValueError"):
        program.call("builtins", "int", "five")


def test_what_hangs_is_ended_and_the_next_call_is_answered() -> None:
    program = LimitedProcess(ENOUGH_BYTES, ENOUGH_S)
    first = program.call("os", "getpid")
    with pytest.raises(EndedError, match="It crashed"):
        program.call("os", "abort")
    # The next program has the new limit.
    program.most_seconds = 0.2
    with pytest.raises(EndedError, match=r"more than 0\.2 seconds"):
        program.call("time", "sleep", ENOUGH_S)
    program.most_seconds = ENOUGH_S
    assert program.call("os", "getpid") != first


@pytest.mark.parametrize("way", [signal.SIGKILL, signal.SIGSEGV, signal.SIGXCPU])
def test_what_dies_is_started_anew(program: LimitedProcess, way: signal.Signals) -> None:
    number = program.call("os", "getpid")
    with pytest.raises(EndedError, match="It crashed"):
        program.call("os", "kill", number, way)
    assert program.call("os", "getpid") != number


def test_its_memory_is_limited() -> None:
    program = LimitedProcess(2 * 2**30, ENOUGH_S)
    with pytest.raises(RuntimeError, match="MemoryError"):
        program.call("numpy", "ones", 2**30)
    assert program.call("numpy", "ones", 5).sum() == 5


def test_a_fork_has_a_program_of_its_own(program: LimitedProcess) -> None:
    number = program.call("os", "getpid")
    # What has no child of its own to end leaves its parent's alone.
    program._owner += 1
    assert program.call("os", "getpid") != number
    os.kill(number, 0)
    os.kill(number, signal.SIGKILL)
    os.waitpid(number, 0)
