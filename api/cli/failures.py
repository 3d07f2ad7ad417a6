"""Failures as a user sees them: a few clear sentences on stderr and an exit code, never a traceback."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

import typer
from rich.text import Text

from api.cli.terminal import errors, flush_results, printable, silence
from scenes.errors import GnomonError

EXIT_INTERNAL, EXIT_USAGE, EXIT_INCOMPLETE, EXIT_STORE, EXIT_INTERRUPTED = 1, 2, 6, 7, 130
EXIT_CALLS, EXIT_BUSY = 8, 9
EXIT_CLOSED_PIPE = 141
"""What shells report of a program that writes to a reader who has gone: 128 and the number of SIGPIPE."""

EXIT_MEANINGS = {
    0: "done",
    EXIT_INTERNAL: "a technique refuses the light, or something is wrong inside Gnomon",
    EXIT_USAGE: "wrong usage",
    3: "the level cannot be read or lacks what was asked for",
    4: "no usable device",
    5: "an output cannot be written",
    EXIT_INCOMPLETE: "done, but some lights have no recommendation",
    EXIT_STORE: "the evidence store cannot be read or written",
    EXIT_CALLS: "rebenchmark is done, and somebody should look at its report",
    EXIT_BUSY: "another job is running",
    EXIT_INTERRUPTED: "interrupted",
    EXIT_CLOSED_PIPE: "the reader of the output has gone",
}

DEBUG_VARIABLE = "GNOMON_DEBUG"

Options = ParamSpec("Options")
Result = TypeVar("Result")


def epilog(*, annotates: bool) -> str:
    """The exit codes, for the foot of a help page."""
    meanings = {code: words for code, words in EXIT_MEANINGS.items() if annotates or code != EXIT_INCOMPLETE}
    return "Exit codes: " + ", ".join(f"{code} {words}" for code, words in meanings.items()) + "."


class UsageError(GnomonError):
    """Options that contradict each other."""

    exit_code = EXIT_USAGE


class InterruptedRunError(GnomonError):
    """The user pressed Ctrl-C."""

    exit_code = EXIT_INTERRUPTED


def interrupted() -> InterruptedRunError:
    """What to say where nothing better is known."""
    return InterruptedRunError("Interrupted.", remedy="No half-written file is left behind.")


def internal(error: Exception) -> GnomonError:
    """Our own bug, or a machine out of memory, in words."""
    if os.environ.get(DEBUG_VARIABLE):
        errors().file.write("".join(traceback.format_exception(error)))
    if isinstance(error, MemoryError):
        return GnomonError("There is not enough memory for this.", known=str(error))
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return GnomonError(
        "Something went wrong inside Gnomon. This is a bug, not your fault.",
        known=f"{type(error).__name__}: {error} ({os.path.basename(frame.filename)}:{frame.lineno})",  # noqa: PTH119
        remedy=f"Please report it; with {DEBUG_VARIABLE}=1 the whole traceback is shown.",
    )


def report(error: GnomonError) -> None:
    """Prints what is wrong, where, what is known and what to do."""
    head = Text("interrupted: " if isinstance(error, InterruptedRunError) else "error: ", style="bold red")
    head.append(printable(f"{error.where}: {error.what}" if error.where else error.what), style="default")
    console = errors()
    console.print(head, soft_wrap=True)
    for line in (error.known, error.remedy):
        if line:
            console.print(Text(f"  {printable(line)}"), soft_wrap=True)


def failing_cleanly(command: Callable[Options, Result]) -> Callable[Options, Result]:
    """`command`, whose failures are a few sentences and an exit code."""

    @wraps(command)
    def run(*args: Options.args, **options: Options.kwargs) -> Result:
        try:
            return _flushed(command, *args, **options)
        except BrokenPipeError:
            silence(sys.stdout)
            raise typer.Exit(EXIT_CLOSED_PIPE) from None
        except GnomonError as error:
            failure = error
        except KeyboardInterrupt:
            failure = interrupted()
        except (typer.Exit, typer.Abort, typer.TyperException):
            # Wrong usage: Typer knows what to do.
            raise
        except Exception as error:  # noqa: BLE001  the last resort: users never see a traceback
            failure = internal(error)
        report(failure)
        raise typer.Exit(failure.exit_code)

    return run


def _flushed(command: Callable[Options, Result], *args: Options.args, **options: Options.kwargs) -> Result:
    """What the command gives, all of its output having reached its reader."""
    try:
        result = command(*args, **options)
    except typer.Exit:
        flush_results()
        raise
    flush_results()
    return result
