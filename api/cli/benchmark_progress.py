"""How far a benchmark is, and who wins so far: a bar and a table on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Self

from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from api.cli.benchmark_tables import wins_table
from api.cli.progress import SECONDS_BETWEEN_LINES, time_left
from api.cli.terminal import printable
from api.wording import counted
from selector.benchmark.running import Benchmark

_SECONDS_BETWEEN_PICTURES = 0.5
_BAR = 24


class BenchmarkProgress:
    """Shows a benchmark while it runs. A context manager.

    Args:
        console: Where it is shown.
        benchmark: What is shown.
    """

    def __init__(self, console: Console, benchmark: Benchmark) -> None:
        self._console, self._benchmark = console, benchmark
        self._words = ""
        self._last = -SECONDS_BETWEEN_LINES
        self._live = (
            Live(console=console, transient=True, auto_refresh=False) if console.is_terminal else None
        )

    def __enter__(self) -> Self:
        """Show it."""
        if self._live:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Take it away."""
        if self._live:
            self._live.stop()

    def show(self, words: str) -> None:
        """Something may have happened; now and then it is shown."""
        self._words = words or self._words
        now = time.monotonic()
        if self._live and now - self._last >= _SECONDS_BETWEEN_PICTURES:
            self._last = now
            self._live.update(self._picture(), refresh=True)
        elif not self._live and self._words and now - self._last >= SECONDS_BETWEEN_LINES:
            self._last = now
            self._console.print(Text(f"{self._state()}, {printable(self._words)}"), soft_wrap=True)

    def _picture(self) -> Group:
        score = self._benchmark.score
        line = Table.grid(padding=(0, 1))
        bar = ProgressBar(total=max(score.total, 1), completed=score.fresh + score.done, width=_BAR)
        line.add_row(bar, Text(self._state()), Text(printable(self._words), style="dim"))
        table = wins_table(self._benchmark)
        return Group(line, table) if table.row_count else Group(line)

    def _state(self) -> str:
        score, remaining_s = self._benchmark.score, self._benchmark.remaining_s
        parts = [f"{score.fresh + score.done} of {counted(score.total, 'instance')}"]
        if score.fresh:
            parts.append(f"{score.fresh} were there")
        if remaining_s is not None:
            parts.append(time_left(remaining_s))
        return ", ".join(parts)
