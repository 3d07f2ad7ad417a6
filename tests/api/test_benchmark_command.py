from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import pytest

from api.cli.options import parse_time
from selector.evidence.store import Store
from tests.api.command import answered, gnomon, running, wait_for_line
from tests.small_level import SPOT, small_level, small_scene

QUICK = ("-t", "SM", "--resolution", "64x48", "--rounds", 3, "--workers", 1)


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path, scene=small_scene((SPOT,)))


def test_both_purposes_are_stored_and_told(level: Path, tmp_path: Path) -> None:
    store = tmp_path / "evidence.sqlite"
    command = ("benchmark", "--corpus", level, "--store", store, "--test", *QUICK)
    found: dict[str, Any] = answered(*command)
    errors, times = found["runs"]
    assert (errors["purpose"], times["purpose"]) == ("errors", "times")
    assert errors["answered"] == times["answered"] == 1
    assert errors["statuses"]["ok"] == times["statuses"]["ok"]
    assert sum(times["wins"]["static"]["balanced"].values()) == 1
    assert found["device"]["renderer"]
    with Store.open(str(store), write=False) as opened:
        (row,) = opened.instances()
        assert (row.role, row.family) == ("test", "small")
        assert len(list(opened.judgements())) == errors["statuses"]["ok"]
        assert len(list(opened.timings())) == times["statuses"]["ok"]
        assert {run.purpose for run in opened.runs()} == {"errors", "times"}


def test_the_summary_says_who_wins(level: Path, tmp_path: Path) -> None:
    store = tmp_path / "evidence.sqlite"
    result = gnomon(
        "benchmark", "--corpus", level, "--store", store, "--purpose", "errors", *QUICK, width=160
    )
    assert result.exit_code == 0, result.stderr
    assert "1 of 1 instance answered" in result.stdout
    assert "keeps the error of" in result.stdout
    assert str(store) in result.stdout.replace("\n", "")
    assert "Errors and counters of 1 instance at 64x48" in result.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--corpus", "nowhere.glb"), "nowhere.glb"),
        (("--time-limit", "soon"), "is not a time such as 90s"),
        (("--purpose", "fun"), 'is not "errors" or "times" or "both"'),
        (("-t", "nonsense"), 'no technique "nonsense"'),
    ],
)
def test_wrong_usage_is_said(tmp_path: Path, options: tuple[str, ...], words: str) -> None:
    result = gnomon("benchmark", "--store", tmp_path / "evidence.sqlite", *options, width=300)
    assert result.exit_code in {2, 3}
    assert words in result.stderr


def test_a_device_that_is_not_there_is_said(level: Path, tmp_path: Path) -> None:
    store = tmp_path / "evidence.sqlite"
    result = gnomon("benchmark", "--corpus", level, "--store", store, "--device", "Voodoo", *QUICK)
    assert result.exit_code == 4
    assert "Voodoo" in result.stderr


def test_ctrl_c_ends_it_and_what_is_stored_stays(tmp_path: Path) -> None:
    store = tmp_path / "evidence.sqlite"
    arguments = ("benchmark", "--corpus", small_level(tmp_path), "--store", store, "--workers", 1)
    with running(*arguments, "--resolution", "320x256") as process:
        wait_for_line(process, "0 of 3 instances")
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
        assert process.returncode == 130, said
        assert "of 3 instances are in the store" in said
        assert "Traceback" not in said
    with Store.open(str(store), write=False) as opened:
        list(opened.judgements())


def test_time_limits() -> None:
    assert [parse_time(text) for text in ("90s", "20min", "2h", "0.5 h", "1d")] == [
        90,
        1200,
        7200,
        1800,
        86_400,
    ]
