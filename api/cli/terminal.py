"""The two streams: results go to stdout, everything else to stderr. Rich respects NO_COLOR by itself."""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from typing import Any, TextIO

from rich.console import Console

from api.wording import shortened
from scenes.errors import OutputError

WIDTH_WITHOUT_TERMINAL = 160
LONGEST_TEXT = 2000
"""Characters of one message or cell: names come from strangers' files, and some hold 20,000 scenes."""
LONGEST_NAME = 200
"""Characters of a name in a table."""


class StdoutStream:
    """Stdout; what it cannot take is an error that says so."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        """Everything else is the stream's own."""
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write `text`.

        Raises:
            BrokenPipeError: The reader has gone.
            OutputError: The system refuses it.
        """
        try:
            return self._stream.write(text)
        except OSError as error:
            raise self.failure(error) from error

    def flush(self) -> None:
        """Make sure that all has reached the reader; raises what `write` does."""
        try:
            self._stream.flush()
        except OSError as error:
            raise self.failure(error) from error

    def failure(self, error: OSError) -> Exception:
        """What to raise where the system refuses to write."""
        if isinstance(error, BrokenPipeError):
            return error
        silence(self._stream)
        return OutputError(
            "Stdout cannot be written.",
            known=f"The system says: {error.strerror or error}. Files named with -o are not concerned.",
            remedy="Send the output elsewhere.",
        )


class StderrStream:
    """Stderr; what it cannot take is lost, as hours of measuring must not be."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        """Everything else is the stream's own."""
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write `text`, if possible."""
        try:
            return self._stream.write(text)
        except OSError:
            silence(self._stream)
            return len(text)

    def flush(self) -> None:
        """Make sure that all has reached the reader, if possible."""
        try:
            self._stream.flush()
        except OSError:
            silence(self._stream)


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
    StdoutStream(sys.stdout).write(json.dumps(values, indent=2, allow_nan=False, ensure_ascii=True) + "\n")


def flush_results() -> None:
    """Make sure that all results have reached their reader.

    Raises:
        BrokenPipeError: The reader has gone.
        OutputError: The system refuses it.
    """
    StdoutStream(sys.stdout).flush()


def silence(stream: TextIO) -> None:
    """Nothing that is still in a buffer may complain when the program ends."""
    # Streams of tests have no descriptor.
    with suppress(OSError, ValueError):
        descriptor = stream.fileno()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, descriptor)
        os.close(nowhere)


def open_missing_streams() -> None:
    """A stream that was closed by whoever started the program takes everything, and shows nothing."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115  open to the end


def printable(text: str, longest: int = LONGEST_TEXT) -> str:
    """`text` in which nothing can move the cursor, turn its direction or end the line, of bounded length.

    Names come from strangers' files: a line end in one could forge a message of ours.
    """
    return "".join(
        character if character.isprintable() else _escaped(character)
        for character in shortened(text, longest)
    )


def printable_name(name: str) -> str:
    """The same of a name, which is shorter."""
    return printable(name, LONGEST_NAME)


def _escaped(character: str) -> str:
    number = ord(character)
    return f"\\x{number:02x}" if number <= 0xFF else f"\\u{number:04x}"


def _console(*, stderr: bool) -> Console:
    raw = sys.stderr if stderr else sys.stdout
    # While a progress bar runs, Rich puts a proxy in the stream's place.
    plain: TextIO = getattr(raw, "rich_proxied_file", raw)
    stream: Any = StderrStream(plain) if stderr else StdoutStream(plain)
    width = None if stream.isatty() or "COLUMNS" in os.environ else WIDTH_WITHOUT_TERMINAL
    return PipeConsole(file=stream, width=width, highlight=False, emoji=False, markup=False)
