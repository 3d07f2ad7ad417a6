"""The table of `gnomon annotate`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.annotating import Workload
from api.cli.terminal import printable, printable_name
from api.verdicts import measurement_of, off_words, shows_shadow_edge
from api.wording import counted
from renderers.settings import Settings
from selector.level_measuring import Answer
from selector.measurement import Status
from selector.recommendation import Recommendation

NOTHING = "-"
LEGEND = (
    "shadow ms: what the light's shadow costs each frame; edge off px: distance from the true edge in the "
    "worst view; confidence: how often the technique beats the runner-up."
)
WIDE = 140
"""Columns from which on a reason fits beside its light; narrower, the reasons follow the table."""


def print_answers(console: Console, work: Workload, found: Sequence[Answer]) -> None:
    """One row a light, then why, then what went wrong, then how often each technique won."""
    answered = [(answer, answer.recommendation) for answer in found if answer.recommendation]
    wide = console.width >= WIDE
    if answered:
        console.print(_table([recommendation for _, recommendation in answered], wide=wide))
        console.print(Text(LEGEND, style="dim"))
        console.print()
    if not wide:
        for answer, recommendation in answered:
            console.print(
                Text.assemble((printable_name(answer.light.name), "bold"), f": {recommendation.reason}")
            )
        if answered:
            console.print()
    _print_failed_candidates(console, [recommendation for _, recommendation in answered])
    for answer in found:
        if answer.recommendation is None:
            stays = " Its earlier annotation stays." if answer.light.node in work.standing else ""
            console.print(
                Text.assemble(
                    ("no recommendation ", "bold red"),
                    (f"{printable_name(answer.light.name)} (node {answer.light.node}): ", "bold"),
                    printable(answer.problem + stays),
                )
            )
    _print_verified(console, found)
    _print_shadowless(console, [recommendation for _, recommendation in answered])
    wins = Counter(recommendation.chosen.candidate.method.label for _, recommendation in answered)
    if len(answered) > 1:
        shares = ", ".join(f"{label} for {count}" for label, count in wins.most_common())
        console.print(
            Text(f"{shares} of {len(found)} lights, within {work.order.request.max_edge_error_px:g} px.")
        )


def _table(recommendations: Sequence[Recommendation], *, wide: bool) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), collapse_padding=True)
    table.add_column("light", overflow="fold")
    table.add_column("technique", no_wrap=True)
    table.add_column("map size", justify="right")
    table.add_column("filter", justify="right", no_wrap=True)
    for column in ("shadow ms", "edge off px"):
        table.add_column(column, justify="right")
    table.add_column("runner-up", min_width=len("runner-up"))
    table.add_column("confidence", justify="right", no_wrap=True, min_width=len("confidence"))
    if wide:
        table.add_column("why", ratio=1)
    for one in recommendations:
        settings = dict(one.chosen.candidate.settings)
        color = "green" if one.within_limit else "yellow"
        cells: list[Text | str] = [
            Text(printable_name(one.light.name)),
            Text(one.chosen.candidate.method.label, style=f"bold {color}"),
            _map_size(settings),
            str(settings.get("filter", NOTHING)),
            f"{one.chosen.shadow_ms:.2f}",
            off_words(measurement_of(one, one.chosen), one.chosen) or NOTHING,
            one.runner_up.candidate.label if one.runner_up else NOTHING,
            NOTHING if one.confidence is None else f"{100 * one.confidence:.0f} %",
        ]
        table.add_row(*cells, *([one.reason] if wide else []))
    return table


def _map_size(settings: Settings) -> str:
    size = str(settings.get("map_size", NOTHING))
    return f"{size} view" if settings.get("focus") == "view" else size


def _print_shadowless(console: Console, recommendations: Sequence[Recommendation]) -> None:
    """Such lights get the cheapest technique, and would be cheaper still without any."""
    shadowless = sum(not shows_shadow_edge(one) for one in recommendations)
    if shadowless:
        lights = counted(len(recommendations), "light")
        casts, theirs = ("casts", "its") if shadowless == 1 else ("cast", "theirs")
        console.print(
            Text(
                f"{shadowless} of {lights} {casts} no shadow whose edge any view shows: consider switching "
                f"{theirs} off, unless walls keep the light out there."
            )
        )


def _print_failed_candidates(console: Console, recommendations: Sequence[Recommendation]) -> None:
    """A candidate that failed was not weighed: the choice might have been another."""
    for one in recommendations:
        failed = [measurement for measurement in one.failed if measurement.status is not Status.REFUSED]
        for reason, labels in _by_reason([(f.candidate.label, f"{f.status}: {f.reason}") for f in failed]):
            console.print(
                Text.assemble(
                    ("not weighed ", "bold yellow"),
                    (f"{printable_name(one.light.name)}: ", "bold"),
                    printable(f"{', '.join(labels)}: {reason.replace('_', ' ')}"),
                )
            )


def _by_reason(failures: Sequence[tuple[str, str]]) -> list[tuple[str, list[str]]]:
    reasons = dict.fromkeys(reason for _, reason in failures)
    return [(reason, [label for label, why in failures if why == reason]) for reason in reasons]


def _print_verified(console: Console, found: Sequence[Answer]) -> None:
    shares = [
        answer.measurement.verified_wrong_share
        for answer in found
        if answer.measurement and answer.measurement.verified_wrong_share is not None
    ]
    if shares:
        console.print(
            Text(f"The ground truth agrees with ray casting to {100 * max(shares):.4f} % of pixels at worst.")
        )
