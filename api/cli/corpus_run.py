"""What `gnomon corpus` does, with progress and tables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from api.cli.terminal import errors, print_json, printable, results
from api.corpus import Advance, Coverage, export, family_records, level_files, surveyed, surveyed_levels
from api.wording import counted, path_words
from scenes.corpus.bins import AXES, AxisBins
from scenes.corpus.corpora import corpus
from scenes.corpus.registry import families

_BAR = 30
_MOST_NAMED = 4


def run_list(*, as_json: bool) -> None:
    """Prints the families."""
    found = family_records()
    if as_json:
        print_json(found)
        return
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("family", no_wrap=True)
    table.add_column("", no_wrap=True)
    table.add_column("triangles", justify="right", no_wrap=True)
    table.add_column("what it is, and what it stretches", overflow="fold")
    for one in found:
        low, high = one["triangles"]
        table.add_row(
            one["family"], "indoor" if one["indoor"] else "outdoor", f"{low:,} .. {high:,}", one["summary"]
        )
    results().print(table)


def run_export(folder: Path, names: tuple[str, ...], seed: int, *, as_json: bool) -> None:
    """Writes scenes, and says which."""
    written = []
    with _progress(errors(), len(names or families())) as advance:
        for spec, path in export(folder, names, seed):
            advance(spec.family)
            written.append({"spec": spec.record(), "file": path_words(path)})
    if as_json:
        print_json(written)
        return
    for one in written:
        results().print(Text(printable(str(one["file"]))), soft_wrap=True)


def run_stats(name: str, levels: Path | None, *, as_json: bool) -> None:
    """Measures a corpus, and levels beside it, and prints what is in each bin of each axis."""
    specs = corpus(name)
    paths = level_files(levels) if levels is not None else []
    with _progress(errors(), len(specs) + len(paths)) as advance:
        rows = surveyed(specs, advance)
        coverage = Coverage(name, rows, surveyed_levels(paths, advance))
    if as_json:
        print_json(coverage.record())
        return
    console = results()
    console.print(f"{name}: {counted(len(rows), 'instance')}")
    for axis in AXES:
        console.print(_table(coverage, axis))
    _print_outside(console, coverage)


def _table(coverage: Coverage, axis: AxisBins) -> Table:
    """One line a bin that something is in; what only levels are in stands out."""
    corpus_counts, level_counts = coverage.counts(axis)
    most = max(*corpus_counts, 1)
    table = Table(box=None, padding=(0, 1), title=axis.title, title_justify="left", show_header=False)
    table.add_column(justify="right", no_wrap=True, min_width=20)
    table.add_column(no_wrap=True, min_width=_BAR)
    table.add_column(justify="right", no_wrap=True, min_width=5)
    table.add_column(no_wrap=True)
    for label, ours, theirs in zip(axis.labels, corpus_counts, level_counts, strict=True):
        if not ours and not theirs:
            continue
        bar = "#" * max(round(_BAR * ours / most), 1 if ours else 0)
        beside = f"{theirs} of levels" if theirs else ""
        table.add_row(label, bar, str(ours), Text(beside, style="" if ours else "bold red"))
    return table


def _print_outside(console: Console, coverage: Coverage) -> None:
    if not coverage.levels:
        return
    for level in coverage.levels:
        if level.failure:
            errors().print(
                Text(f"not compared: {printable(path_words(level.path))}: {printable(level.failure)}")
            )
    found = {axis.title: coverage.outside(axis) for axis in AXES}
    if not any(found.values()):
        console.print("No level lies outside the corpus on any axis.")
    for title, levels in found.items():
        if levels:
            named = [f"{Path(path).name} ({count})" for path, count in list(levels.items())[:_MOST_NAMED]]
            more = f" and {len(levels) - _MOST_NAMED} more levels" if len(levels) > _MOST_NAMED else ""
            console.print(Text(f"outside on {title}: {printable(', '.join(named))}{more}"), soft_wrap=True)


@contextmanager
def _progress(console: Console, total: int) -> Iterator[Advance]:
    """A bar on a terminal; its callable takes the name of what begins."""
    columns = (
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("", total=total)
        begun = 0

        def advance(name: str) -> None:
            nonlocal begun
            progress.update(task, description=printable(name), completed=begun)
            begun += 1

        yield advance
