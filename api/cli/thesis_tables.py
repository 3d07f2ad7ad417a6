"""The tables of `gnomon thesis`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable
from api.wording import counted
from selector.ordering_grades import Grade
from selector.ordering_records import Finding, Ordering
from selector.thesis_orderings import FASTER

VERDICTS = {True: ("holds", "green"), False: ("does not hold", "yellow"), None: ("unclear", "dim")}
NOTHING = "-"
GRADES_LEGEND = (
    "speed, quality: the thesis' grades of 2005, 5 is best. ms: the technique's own passes. times the "
    "fastest: of this scene. edge off px: mean distance from the true edge; SV is the truth."
)
WIDE = 140
"""Columns from which on evidence and reason fit beside their ordering; narrower, they follow the table."""


def print_findings(console: Console, findings: Sequence[tuple[Ordering, Finding]], *, timed: bool) -> None:
    """One row an ordering: what the thesis says, whether it holds, by which figures, and why not."""
    wide = console.width >= WIDE
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), collapse_padding=True, show_lines=True, expand=True)
    table.add_column("", no_wrap=True)
    table.add_column("ordering", ratio=4)
    table.add_column("here", no_wrap=True)
    if wide:
        table.add_column("evidence", ratio=9)
        table.add_column("reason", ratio=6)
    for ordering, finding in findings:
        more = [_evidence(finding), Text(printable(finding.reason))] if wide else []
        table.add_row(Text(ordering.id, style="bold"), ordering.sentence, _verdict(finding), *more)
    console.print(table)
    if not wide:
        for ordering, finding in findings:
            console.print(Text.assemble((f"{ordering.id} ", "bold"), _verdict(finding)))
            console.print(_evidence(finding))
            if finding.reason:
                console.print(Text(printable(finding.reason)))
            console.print()
    counts = Counter(finding.holds for _, finding in findings)
    words = [f"{VERDICTS[holds][0]}: {counts[holds]}" for holds in VERDICTS if counts[holds]]
    console.print(Text(f"{counted(len(findings), 'ordering')}; {', '.join(words)}."))
    _print_rules(console, [ordering for ordering, _ in findings], timed=timed)


def _print_rules(console: Console, orderings: Sequence[Ordering], *, timed: bool) -> None:
    console.print()
    if timed:
        console.print(Text(FASTER, style="dim"))
    for ordering in orderings:
        console.print(Text(f"{ordering.id} holds if: {ordering.rule}", style="dim"))


def print_grades(console: Console, grades: Sequence[Grade]) -> None:
    """The thesis' grades beside what is measured; nothing where no scene was measured with all techniques."""
    if not grades:
        return
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), collapse_padding=True)
    for column in ("scene", "technique"):
        table.add_column(column, no_wrap=True)
    for column in ("speed", "ms", "times the fastest", "quality", "edge off px"):
        table.add_column(column, justify="right")
    before = ""
    for one in grades:
        if before and one.scene != before:
            table.add_section()
        table.add_row(
            "" if one.scene == before else one.scene,
            one.technique,
            str(one.speed),
            _number(one.shadow_ms),
            _number(one.relative),
            str(one.quality),
            _number(one.edge_error_px),
        )
        before = one.scene
    console.print(table)
    console.print(Text(GRADES_LEGEND, style="dim"))


def _verdict(finding: Finding) -> Text:
    word, style = VERDICTS[finding.holds]
    return Text(word, style=f"bold {style}")


def _evidence(finding: Finding) -> Text:
    lines = [
        Text.assemble((f"{printable(one.where)}: ", "bold"), printable(one.words)) for one in finding.evidence
    ]
    return Text("\n").join(lines) if lines else Text(NOTHING)


def _number(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.2f}"
