"""The two streams: results go to stdout, everything else to stderr. Rich respects NO_COLOR by itself."""

from __future__ import annotations

import json
import os
import sys
from typing import Any

from rich.console import Console

WIDTH_WITHOUT_TERMINAL = 160


class PipeConsole(Console):
    """A console that tells of a reader who has gone, where Rich would end the program itself."""

    def on_broken_pipe(self) -> None:
        """Pass on the error that Rich is handling.

        Raises:
            BrokenPipeError: Always.
        """
        raise BrokenPipeError


def results() -> Console:
    """Where results go; wide where nobody's screen limits it."""
    return _console(stderr=False)


def errors() -> Console:
    """Where progress, warnings and errors go."""
    return _console(stderr=True)


def print_json(values: Any) -> None:
    """Prints the result for a program: JSON on stdout, and nothing else there."""
    sys.stdout.write(json.dumps(values, indent=2, allow_nan=False, ensure_ascii=False) + "\n")


def printable(text: str) -> str:
    """`text` in which nothing can move the cursor or end the line: names come from strangers' files."""
    return "".join(
        character if character.isprintable() or character == "\n" else f"\\x{ord(character):02x}"
        for character in text
    )


def _console(*, stderr: bool) -> Console:
    stream = sys.stderr if stderr else sys.stdout
    width = None if stream.isatty() or "COLUMNS" in os.environ else WIDTH_WITHOUT_TERMINAL
    return PipeConsole(stderr=stderr, width=width, highlight=False, emoji=False, markup=False)
