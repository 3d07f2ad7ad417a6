"""Tables of features, of verdicts on models, and of what models recommend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable, printable_name
from api.predicting import Predicted
from models.evaluation import Gap, Verdict, Winners
from scenes.level import Level
from selector.learning.predicting import LEAST_SHOWN, Expected, Prediction, reason

MOST_CHOICES = 3


def print_features(console: Console, record: dict[str, Any]) -> None:
    """One table a light: a row for each feature, a column for each view."""
    for light in record["lights"]:
        name = printable_name(light["light"])
        if not light["views"]:
            console.print(Text(f"{name}: {printable(light['problem'])}"), soft_wrap=True)
            continue
        table = Table(title=name, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1))
        table.add_column("feature", no_wrap=True)
        table.add_column("unit", no_wrap=True)
        for view in light["views"]:
            table.add_column(printable_name(view["camera"]), justify="right")
        for feature in record["features"]:
            values = [f"{view['values'][feature['name']]:.3g}" for view in light["views"]]
            table.add_row(feature["name"], feature["unit"], *values)
        times = [f"{1e3 * view['seconds']:.0f} ms" for view in light["views"]]
        table.add_row("(found in)", "", *times, style="dim")
        console.print(table)


def print_verdicts(console: Console, verdicts: Sequence[Verdict]) -> None:
    """The closed gap under each policy, then by family."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    heads = (
        "lights",
        "policy",
        "closed gap",
        "95 % of draws",
        "single/best",
        "right",
        "misses",
        "worse",
        "late",
    )
    for head in heads:
        table.add_column(head, no_wrap=True, justify="left" if head in heads[:2] else "right")
    for one in verdicts:
        gap = one.gap
        span = f"{gap.low:.2f} .. {gap.high:.2f}" if gap.low is not None and gap.high is not None else ""
        table.add_row(
            one.time,
            one.question,
            _gap(gap),
            span,
            f"{gap.single / gap.best:.2f}",
            f"{one.accuracy:.0%}",
            f"{one.misses:.0%}",
            f"{one.worse:.0%}",
            f"{one.regret_time:.3g} ms",
        )
    console.print(table)
    console.print(_by_family(verdicts))


def _gap(gap: Gap) -> str:
    """The gap; in brackets where there is too little to gain for it to mean anything."""
    if gap.closed is None:
        return "none to close"
    return f"{gap.closed:.2f}" if gap.claimed else f"({gap.closed:.2f})"


def _by_family(verdicts: Sequence[Verdict]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("closed gap by family", no_wrap=True)
    for one in verdicts:
        table.add_column(f"{one.time}\n{one.question}", justify="right", no_wrap=True)
    for family in sorted({name for one in verdicts for name in one.by_family}):
        cells = [_gap(one.by_family[family]) if family in one.by_family else "" for one in verdicts]
        table.add_row(printable_name(family), *cells)
    return table


def print_winners(console: Console, found: Sequence[Winners], labels: tuple[str, ...]) -> None:
    """How often each technique is best, whatever its settings, and which choices are best most often."""
    techniques = list(dict.fromkeys(label.split()[0] for label in labels))
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    for head in ("lights", "policy"):
        table.add_column(head, no_wrap=True)
    for technique in techniques:
        table.add_column(technique, justify="right", no_wrap=True)
    table.add_column("most often best")
    table.add_column("one for all")
    table.add_column("single/best", justify="right")
    for one in found:
        counts = dict(zip(labels, one.wins.tolist(), strict=True))
        sums = [sum(n for label, n in counts.items() if label.split()[0] == name) for name in techniques]
        most = sorted(counts.items(), key=lambda entry: (-entry[1], entry[0]))[:MOST_CHOICES]
        named = ", ".join(f"{label} {count}" for label, count in most if count)
        gain = f"{one.single_over_best:.2f}"
        table.add_row(one.time, one.question, *map(str, sums), named, labels[one.single], gain)
    console.print(table)


def print_predictions(console: Console, level: Level, found: Sequence[Predicted]) -> None:
    """One row a light, and the reason of each below."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    for head in ("light", "recommended", "ms", "px", "keeps limit", "runner-up", "confidence"):
        table.add_column(head, no_wrap=head != "light")
    for one in found:
        name = printable_name(level.scene.lights[one.light].name)
        if one.prediction is None:
            table.add_row(name, "none")
            continue
        table.add_row(name, *_cells(one.prediction))
    console.print(table)
    for one in found:
        name = printable_name(level.scene.lights[one.light].name)
        words = reason(one.prediction) if one.prediction else one.problem
        console.print(Text(f"{name}: {printable(words)}"), soft_wrap=True)
        if one.prediction and one.prediction.outside:
            outside = ", ".join(one.prediction.outside)
            console.print(Text(f"  Unlike anything learnt from in: {outside}."), soft_wrap=True)


def _cells(found: Prediction) -> list[str]:
    chosen = found.chosen
    return [
        chosen.candidate.label,
        _ranged(chosen.shadow_ms, chosen.shadow_ms_range),
        _ranged(chosen.edge_error_px, chosen.edge_error_px_range),
        f"{chosen.keeps_limit:.0%}",
        _runner_up(found.runner_up, found.margin),
        f"{found.confidence:.0%}",
    ]


def _ranged(value: float, ends: tuple[float, float]) -> str:
    if ends[1] < LEAST_SHOWN:
        return f"< {LEAST_SHOWN:g}"
    return f"{value:.2g} ({ends[0]:.2g} .. {ends[1]:.2g})"


def _runner_up(one: Expected | None, margin: float | None) -> str:
    if one is None or margin is None:
        return "none"
    return f"{one.candidate.label} (+{margin:.0%})"
