"""What a re-benchmark job found, as tables."""

from __future__ import annotations

from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable, printable_name
from api.wording import counted
from renderers.registry import technique
from selector.rebenchmark.report import Report, Sampled, Watched, verdict

MOST_MOVES = 20


def print_report(console: Console, found: Report, page: Path) -> None:
    """Prints the verdict, drift, models and lights, and where the report is."""
    console.print(Text(verdict(found), style="bold"), soft_wrap=True)
    if found.sampled and found.sampled.shifts:
        console.print(_drift_table(found.sampled))
    if found.sampled and found.sampled.differences:
        count = len(found.sampled.differences)
        words = f"  {counted(count, 'figure')} or counters differ though the code is the same."
        console.print(Text(words), soft_wrap=True)
    for words in _sentences(found):
        console.print(Text(f"  {printable(words)}"), soft_wrap=True)
    if found.watched and found.watched.moves:
        console.print(_moves_table(found.watched))
    console.print(Text(f"The report is in {printable(str(page))}."), soft_wrap=True)


def _sentences(found: Report) -> list[str]:
    stale = sum(count for by in found.stale.values() for reason, count in by.items() if reason != "fresh")
    words = []
    if stale:
        words.append(f"Stale were {counted(stale, 'time')} of a technique for an instance.")
    if found.sampled and found.sampled.disturbed:
        count = counted(found.sampled.disturbed, "instance")
        words.append(f"Other programs were at work: {count} of {found.sampled.wanted} bear no witness.")
    words += [
        f"Out of reach: {counted(count, 'instance')}. {why}" for why, count in found.unreachable.items()
    ]
    words += [f"Measured: {purpose} of {counted(n, 'instance')}." for purpose, n in found.remeasured.items()]
    if found.left:
        words.append(f"Left for the next job: {counted(found.left, 'time')} of a technique for an instance.")
    if found.judged:
        words.append(found.judged.decision.why)
        if found.judged.decision.kept:
            words.append(f"The old model is kept as {found.judged.decision.kept}.")
    if found.watched:
        words += [f"{level}: {why}" for level, why in found.watched.problems]
    return words


def _drift_table(sampled: Sampled) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("new / old time", no_wrap=True)
    for name in ("light", "instances", "ratio", "95 % interval", "verdict"):
        table.add_column(name, justify="left" if name in ("light", "verdict") else "right")
    for one in sampled.shifts:
        if one.p_value is None:
            said = "too few"
        elif one.alarm:
            said = "drifted"
        else:
            said = "holds"
        table.add_row(
            technique(one.technique).label,
            str(one.mobility),
            str(one.instances),
            f"{one.ratio:.3f}",
            f"{one.low:.3f} to {one.high:.3f}",
            Text(said, style="bold red" if one.alarm else ""),
        )
    return table


def _moves_table(watched: Watched) -> Table:
    title = "Moved lights" if watched.in_force else "Lights that the new model would move"
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), title=title, title_justify="left")
    for name in ("level", "light", "from", "to"):
        table.add_column(name)
    for one in watched.moves[:MOST_MOVES]:
        old = one.old.label if one.old else "none"
        table.add_row(printable(Path(one.level).name), printable_name(one.light), old, one.new.label)
    if len(watched.moves) > MOST_MOVES:
        table.add_row(f"and {len(watched.moves) - MOST_MOVES} more", "", "", "")
    return table
