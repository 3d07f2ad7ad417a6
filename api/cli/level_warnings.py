"""What a level's reader warns of, before something is measured that it may affect."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.text import Text

from api.cli.terminal import printable
from api.wording import counted
from scenes.level import Level, Severity

MOST_WARNINGS = 5


def print_warnings(console: Console, level: Level) -> None:
    """The first few warnings of the reader; `gnomon inspect` shows all."""
    warnings = [note for note in level.notes if note.severity is Severity.WARNING]
    for note in warnings[:MOST_WARNINGS]:
        _warn(console, f"{note.where}: {note.text}")
    more = len(warnings) - MOST_WARNINGS
    if more > 0:
        console.print(
            Text(f"  ... and {counted(more, 'more warning')}; `gnomon inspect` shows all."), soft_wrap=True
        )


def print_left_behind(console: Console, names: Sequence[Path]) -> None:
    """Which files that a level names outside its folder are not found from where it goes."""
    if not names:
        return
    more = f" and {len(names) - MOST_WARNINGS:,} more" if len(names) > MOST_WARNINGS else ""
    listed = ", ".join(map(str, names[:MOST_WARNINGS]))
    _warn(console, f"The level names files outside its folder, which are not taken along: {listed}{more}.")


def _warn(console: Console, text: str) -> None:
    console.print(Text.assemble(("warning: ", "bold yellow"), printable(text)), soft_wrap=True)
