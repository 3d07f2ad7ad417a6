"""What a level's reader warns of, before something is measured that it may affect."""

from __future__ import annotations

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
        console.print(
            Text.assemble(("warning: ", "bold yellow"), printable(f"{note.where}: {note.text}")),
            soft_wrap=True,
        )
    more = len(warnings) - MOST_WARNINGS
    if more > 0:
        console.print(
            Text(f"  ... and {counted(more, 'more warning')}; `gnomon inspect` shows all."), soft_wrap=True
        )
