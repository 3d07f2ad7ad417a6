"""How far a long measurement is: a bar on a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn
from rich.table import Column
from rich.text import Text

from api.cli.interruption import Interruption
from api.cli.terminal import printable

SECONDS_BETWEEN_LINES = 10.0
WIDE = 110
"""Columns from which on a long bar leaves room for what is being measured."""


class MeasuringProgress:
    """Counts steps of lights and says what remains. A context manager, within which no Ctrl-C gets lost.

    Args:
        console: Where it is shown.
        steps: Steps of each light, in the order in which they are measured.
        what: What stands in place of a light, in the singular.
        patient: Whether nothing is said of what is done within seconds, where there is no terminal.

    The estimate is what the steps so far took on average: all lights of a level meet the same candidates,
    so that whole lights are alike, however much the steps within one differ.
    """

    def __init__(
        self, console: Console, steps: list[int], what: str = "light", *, patient: bool = False
    ) -> None:
        self._console = console
        self._what = what
        self._steps = steps
        self._light = 0
        self._begun = 0
        self._start = time.monotonic()
        self._last_line = time.monotonic() if patient else -SECONDS_BETWEEN_LINES
        self._interruption = Interruption()
        self._bar: Progress | None = None
        if console.is_terminal:
            self._bar = Progress(
                BarColumn(bar_width=24 if console.width >= WIDE else 8),
                TextColumn("{task.fields[state]}"),
                TextColumn(
                    "{task.description}",
                    style="dim",
                    markup=False,
                    table_column=Column(no_wrap=True, overflow="ellipsis", ratio=1),
                ),
                console=console,
                transient=True,
                expand=True,
            )
            self._task = self._bar.add_task("starting", total=max(sum(steps), 1), state="")

    def __enter__(self) -> Self:
        """Show it."""
        self._interruption.__enter__()
        if self._bar:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Take the bar away."""
        if self._bar:
            self._bar.stop()
        self._interruption.__exit__(kind, error, trace)

    @property
    def lights_done(self) -> int:
        """How many lights have their answer."""
        return self._light

    def step(self, what: str) -> None:
        """Another step begins; those before it are done."""
        self._interruption.check()
        self._begun = min(self._begun + 1, self._steps[self._light])
        self._show(what)

    def light_done(self) -> None:
        """The light has its answer, however many of its steps were left out."""
        self._light += 1
        self._begun = 0
        self._show()

    def _show(self, what: str = "") -> None:
        done = sum(self._steps[: self._light]) + max(self._begun - 1, 0)
        total = max(sum(self._steps), 1)
        light = min(self._light + 1, len(self._steps))
        state = f"{100 * done // total:3} %  {self._what} {light} of {len(self._steps)}"
        remaining = time_left(self._remaining(done, total)) if 0 < done < total else ""
        if self._bar:
            shown = f"{state}  {remaining}" if remaining else state
            self._bar.update(self._task, completed=done, description=printable(what), state=shown)
        elif time.monotonic() - self._last_line >= SECONDS_BETWEEN_LINES:
            self._last_line = time.monotonic()
            parts = [state.strip(), remaining, printable(what)]
            self._console.print(Text(", ".join(part for part in parts if part)), soft_wrap=True)

    def _remaining(self, done: int, total: int) -> float:
        return (time.monotonic() - self._start) / done * (total - done)


def time_left(seconds: float) -> str:
    """`about 20 min left`, in steps that do not jump about."""
    if seconds < 60:
        return f"about {max(5, 5 * round(seconds / 5))} s left"
    minutes = round(seconds / 60)
    if minutes < 60:
        return f"about {minutes} min left"
    return f"about {minutes // 60} h {minutes % 60:02} min left"
