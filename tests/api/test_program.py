"""The program as it is started: streams, exit codes, signals."""

from __future__ import annotations

import json
import os
import pty
import shlex
import signal
import subprocess
from importlib.metadata import version
from pathlib import Path
from unittest.mock import Mock

import pytest

from tests.api.command import QUICK, environment, gnomon, program, running, started, wait_for_line
from tests.small_level import small_level

ENDLESS = ("--resolution", "320x180", "--rounds", "1000", "--technique", "SV")


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path)


def files(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_version() -> None:
    result = gnomon("--version")
    assert (result.exit_code, result.stdout) == (0, f"gnomon {version('gnomon')}\n")


@pytest.mark.parametrize("arguments", [("--help",), ("-h",), ("annotate", "--help"), ("render", "-h")])
def test_help_names_the_exit_codes(arguments: tuple[str, ...]) -> None:
    result = gnomon(*arguments)
    assert result.exit_code == 0
    assert "Exit codes" in result.stdout
    assert "130" in result.stdout
    assert ("no recommendation" in result.stdout) is (arguments[0] != "render")
    assert "<bool>" not in result.stdout
    assert "{" not in result.stdout


@pytest.mark.parametrize("arguments", [("paint",), ("inspect",), ("inspect", "a.glb", "--colour")])
def test_wrong_usage_is_exit_2(arguments: tuple[str, ...]) -> None:
    result = gnomon(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""


def test_our_own_bug_is_exit_1_and_no_traceback(level: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("api.inspection.Shells.of", Mock(side_effect=ZeroDivisionError("oh")))
    result = gnomon("inspect", level, width=200)
    assert result.exit_code == 1
    assert "This is a bug, not your fault." in result.stderr
    assert "ZeroDivisionError: oh" in result.stderr
    assert "Traceback" not in result.stderr
    monkeypatch.setenv("GNOMON_DEBUG", "1")
    assert "Traceback" in gnomon("inspect", level).stderr


def test_json_has_stdout_for_itself_while_progress_goes_to_stderr(level: Path) -> None:
    done = started("annotate", level, *QUICK, "--json")
    assert done.returncode == 0
    assert len(json.loads(done.stdout)["lights"]) == 3
    assert "Measuring 3 lights with 1 candidate in 1 view, 96x64, 1 round" in done.stderr
    assert "light 1 of 3" in done.stderr
    assert "\x1b" not in done.stdout + done.stderr


def test_a_missing_level_is_exit_3_and_one_block(tmp_path: Path) -> None:
    done = started("annotate", tmp_path / "missing.glb")
    assert done.returncode == 3
    assert done.stdout == ""
    assert done.stderr == (
        f"error: {tmp_path / 'missing.glb'}: There is no such file.\n  Check its name and its folder.\n"
    )


def test_ctrl_c_stops_cleanly(level: Path, tmp_path: Path) -> None:
    earlier = tmp_path / "small.annotated.glb"
    assert gnomon("annotate", level, *QUICK).exit_code == 0
    before = (level.read_bytes(), earlier.read_bytes())
    with running("annotate", level, *ENDLESS) as process:
        wait_for_line(process, "light 1 of 3")
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=60)
    assert process.returncode == 130
    assert stdout == ""
    assert "interrupted: 0 of 3 lights were measured" in stderr
    assert "Traceback" not in stderr
    assert (level.read_bytes(), earlier.read_bytes()) == before
    assert files(tmp_path) == {"small.glb", "small.annotated.glb"}


@pytest.mark.parametrize("in_place", [False, True])
def test_kill_9_leaves_input_and_earlier_output_alone(level: Path, tmp_path: Path, in_place: bool) -> None:  # noqa: FBT001
    earlier = tmp_path / "small.annotated.glb"
    assert gnomon("annotate", level, *QUICK).exit_code == 0
    before = (level.read_bytes(), earlier.read_bytes())
    with running("annotate", level, *ENDLESS, *(["--in-place"] if in_place else [])) as process:
        wait_for_line(process, "light 1 of 3")
        process.kill()
        process.communicate(timeout=60)
    assert process.returncode == -signal.SIGKILL
    assert (level.read_bytes(), earlier.read_bytes()) == before
    assert files(tmp_path) == {"small.glb", "small.annotated.glb"}


@pytest.mark.parametrize("more", [(), ("--json",)], ids=["tables", "json"])
def test_a_reader_that_stops_reading_is_exit_141_and_no_word(level: Path, more: tuple[str, ...]) -> None:
    with running("inspect", level, *more) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.stderr is not None
        assert process.stderr.read() == ""
        assert process.wait(timeout=60) == 141
        process.stdout = None


@pytest.mark.parametrize("no_color", [False, True])
def test_a_terminal_gets_a_bar_and_colors_unless_it_says_no(level: Path, no_color: bool) -> None:  # noqa: FBT001
    shown = _on_a_terminal("annotate", level, *QUICK, no_color=no_color)
    assert "light 3 of 3" in shown
    assert "\u2501" in shown  # the bar
    colored = any(f"\x1b[{code}" in shown for code in ("1;32m", "91m", "31m", "32m", "90m"))
    assert colored is not no_color


def _on_a_terminal(*arguments: object, no_color: bool) -> str:
    ours, theirs = pty.openpty()
    more = {"TERM": "xterm-256color", "COLUMNS": "120", **({"NO_COLOR": "1"} if no_color else {})}
    with subprocess.Popen(
        program(*arguments), env=environment(**more), stdin=theirs, stdout=theirs, stderr=theirs
    ) as process:
        os.close(theirs)
        shown = b""
        while True:
            try:
                part = os.read(ours, 4096)
            except OSError:
                # The other side is closed: the program has ended.
                break
            shown += part
        assert process.wait(timeout=60) == 0
    os.close(ours)
    return shown.decode()


def _in_a_shell(redirection: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    command = f"exec {shlex.join(program(*arguments))} {redirection}"
    return subprocess.run(
        ["bash", "-c", command], env=environment(), capture_output=True, text=True, check=False, timeout=120
    )


@pytest.mark.parametrize("command", ["inspect", "annotate", "--version"])
def test_a_full_stdout_is_exit_5_and_costs_no_level(level: Path, tmp_path: Path, command: str) -> None:
    options = {"inspect": ("inspect", level), "annotate": ("annotate", level, *QUICK)}
    done = _in_a_shell("> /dev/full", *options.get(command, (command,)))
    assert done.returncode == 5
    assert "error: Stdout cannot be written." in done.stderr
    assert "bug" not in done.stderr
    assert (tmp_path / "small.annotated.glb").exists() is (command == "annotate")


@pytest.mark.parametrize("redirection", ["2> /dev/full", "2>&-", ">&-", ">&- 2>&-"])
def test_a_closed_stream_or_a_full_stderr_aborts_nothing(
    level: Path, tmp_path: Path, redirection: str
) -> None:
    done = _in_a_shell(redirection, "annotate", level, *QUICK)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "small.annotated.glb").exists()


def test_ctrl_c_during_the_imports_is_no_traceback(tmp_path: Path) -> None:
    # A Rich that interrupts stands for the user who does while it is imported.
    (tmp_path / "rich").mkdir()
    (tmp_path / "rich/__init__.py").write_text("raise KeyboardInterrupt\n")
    done = started("--version", PYTHONPATH=f"{tmp_path}:{environment()['PYTHONPATH']}")
    assert done.returncode == 130
    assert done.stderr.startswith("interrupted: ")
    assert "Traceback" not in done.stderr
