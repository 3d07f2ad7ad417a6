"""The command line as tests run it: in this process, or as the program that users start."""

from __future__ import annotations

import gc
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from typer.testing import CliRunner, Result

from api.cli.program import app

ROOT = Path(__file__).parents[2]
QUICK = ("--resolution", "96x64", "--rounds", "1", "--technique", "SV")


def gnomon(*arguments: object, width: int = 100) -> Result:
    """Runs a command in this process."""
    # What a context leaves to the garbage collector is deleted in whatever context is current then: the
    # program has one context and ends, the tests have many.
    gc.collect()
    result = CliRunner().invoke(app, [str(one) for one in arguments], env={"COLUMNS": str(width)})
    result.exception, result.exc_info = None, None
    gc.collect()
    return result


def answered(*arguments: object, exit_code: int = 0) -> Any:
    """What a command says as JSON; with the exit code that is expected."""
    result = gnomon(*arguments, "--json")
    assert result.exit_code == exit_code, result.stderr
    return json.loads(result.stdout)


def succeeded(*arguments: object, width: int = 100) -> Result:
    """Runs a command that has to succeed."""
    result = gnomon(*arguments, width=width)
    assert result.exit_code == 0, result.stderr
    return result


def program(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "api.cli.main", *map(str, arguments)]


def environment(**more: str) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "FORCE_COLOR")}
    return {**kept, "PYTHONPATH": str(ROOT), **more}


def started(*arguments: object, folder: Path | None = None, **more: str) -> subprocess.CompletedProcess[str]:
    """Runs the program to its end, with both streams as pipes."""
    return subprocess.run(
        program(*arguments),
        cwd=folder or ROOT,
        env=environment(**more),
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@contextmanager
def running(*arguments: object, **more: str) -> Iterator[subprocess.Popen[str]]:
    """The program while it runs; killed if the test leaves it running."""
    process = subprocess.Popen(
        program(*arguments),
        cwd=ROOT,
        env=environment(**more),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def wait_for_line(process: subprocess.Popen[str], words: str) -> str:
    """Reads stderr until a line holds the words."""
    assert process.stderr is not None
    for line in process.stderr:
        if words in line:
            return line
    raise AssertionError(f"the program ended without saying {words!r}")


def nodes(path: Path) -> dict[str, dict[str, Any]]:
    """Node name to node, for the nodes that carry lights."""
    source = path.read_bytes()
    length = int.from_bytes(source[12:16], "little")
    document = json.loads(source[20 : 20 + length])
    return {
        node["name"]: node
        for node in document["nodes"]
        if "KHR_lights_punctual" in node.get("extensions", {})
    }


def files(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}
