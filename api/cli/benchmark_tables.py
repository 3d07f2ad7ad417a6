"""What a benchmark found, as tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.benchmarking import Request, rate
from api.cli.terminal import printable
from api.wording import counted
from renderers.registry import TECHNIQUES, technique
from scenes.scene import Mobility
from selector.benchmark.running import Benchmark
from selector.evidence.rows import Purpose
from selector.policy import POLICIES

_MOST_FAILURES = 10


def wins_table(benchmark: Benchmark) -> Table:
    """For how many instances each technique is best, or keeps the limit where no times are known."""
    tally = benchmark.tally
    timed = benchmark.order.job.purpose is Purpose.TIMES
    if not timed:
        return _table(
            "keeps the error of", [(one.name, tally.good_enough(one)) for one in POLICIES], tally.judged
        )
    columns = [
        (f"{one.name}, {mobility}", tally.wins(mobility, one.name))
        for one in POLICIES
        for mobility in (Mobility.DYNAMIC, Mobility.STATIC)
    ]
    return _table("best for", columns, None)


def print_summary(console: Console, request: Request, done: Sequence[Benchmark]) -> None:
    """Prints who wins, how candidates fared, and where the time went, for each run."""
    for benchmark in done:
        _print_run(console, benchmark)
    console.print(Text(f"The evidence is in {printable(request.store)}."), soft_wrap=True)


def _print_run(console: Console, benchmark: Benchmark) -> None:
    score, tally = benchmark.score, benchmark.tally
    left = score.total - score.fresh - score.done
    parts = [
        f"{score.done - len(score.failed)} of {counted(score.total, 'instance')} answered",
        *([f"{score.fresh} were there"] if score.fresh else []),
        *([f"{len(score.failed)} failed"] if score.failed else []),
        *([f"{left} left"] if left else []),
    ]
    device = f" on {benchmark.device.renderer}" if benchmark.device else ""
    console.print(Text(f"{benchmark.order.job.purpose}{device}: {', '.join(parts)}"), soft_wrap=True)
    table = wins_table(benchmark)
    if table.row_count:
        console.print(table)
    statuses = ", ".join(f"{count:,} {status}" for status, count in score.statuses.most_common())
    if statuses:
        console.print(Text(f"  candidates: {statuses}"), soft_wrap=True)
    if score.done:
        console.print(Text(f"  {_pace(benchmark)}"), soft_wrap=True)
    if (tau := tally.tau()) is not None:
        sure = tally.sureness(Mobility.DYNAMIC, "balanced")
        words = "" if sure is None else f"; the winner is right in {100 * sure:.0f} % of resamples"
        console.print(
            Text(f"  rankings by either half of the rounds: Kendall's tau {tau:.2f}{words} (medians)")
        )
    for origin, reason in score.failed[:_MOST_FAILURES]:
        console.print(Text(f"  failed: {printable(origin)}: {printable(reason)}"), soft_wrap=True)


def _pace(benchmark: Benchmark) -> str:
    total = sum(benchmark.score.seconds.values()) or 1.0
    shares = ", ".join(
        f"{part} {100 * seconds / total:.0f} %"
        for part, seconds in Counter(benchmark.score.seconds).most_common()
    )
    return f"{rate(benchmark)} instances a minute; of the time: {shares}"


def _table(title: str, columns: Sequence[tuple[str, Counter[str]]], among: int | None) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column(title if among is None else f"{title} ({among} judged)", no_wrap=True)
    for name, _ in columns:
        table.add_column(name, justify="right")
    found = {name for _, counts in columns for name in counts}
    known = [one.name for one in TECHNIQUES if one.name in found]
    for name in known:
        table.add_row(technique(name).label, *(str(counts[name]) for _, counts in columns))
    return table
