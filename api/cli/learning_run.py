"""What `gnomon train` and `gnomon evaluate` do, with progress and tables."""

from __future__ import annotations

import time
from pathlib import Path

from rich.console import Console
from rich.text import Text

from api.cli.learning_options import Source
from api.cli.learning_tables import print_verdicts, print_winners
from api.cli.progress import SECONDS_BETWEEN_LINES
from api.cli.terminal import errors, print_json, printable, results
from api.learning import (
    evaluation,
    evaluation_of,
    evaluation_record,
    evidence,
    learning_record,
    learnt,
    test_data,
    winners,
    winners_record,
    write_model,
)
from api.wording import counted, path_words
from models.artifact import load
from models.evaluation import Verdict
from selector.learning.training import Learning


class _Steps:
    """Says now and then how far a long thing is."""

    def __init__(self, console: Console, what: str) -> None:
        self._console, self._what = console, what
        self._last = time.monotonic()

    def __call__(self, done: int, total: int, name: str = "") -> None:
        now = time.monotonic()
        if now - self._last < SECONDS_BETWEEN_LINES:
            return
        self._last = now
        words = f"{self._what}: {done} of {total}{f', {name}' if name else ''}"
        self._console.print(Text(printable(words)), soft_wrap=True)


def run_train(output: Path, source: Source, *, quick: bool, as_json: bool) -> None:
    """Learns, judges, writes, and says what came out."""
    found, verdicts = _learnt(source, judge=not quick)
    with errors().status("learning from everything"):
        artifact = write_model(found, verdicts, output)
    if as_json:
        print_json(
            {
                "output": path_words(output),
                **learning_record(found),
                "chooses_by": artifact.model.method,
                "closed_gap": evaluation_record(found, verdicts),
            }
        )
        return
    console = results()
    if verdicts:
        print_verdicts(console, verdicts)
        print_winners(console, winners(found), _labels(found))
    size = output.stat().st_size / 1024
    words = f"Wrote {output} ({size:,.0f} KiB); it chooses by its {artifact.model.method}."
    console.print(Text(printable(words)), soft_wrap=True)


def run_evaluate(source: Source, *, quick: bool, as_json: bool) -> None:
    """Judges what can be learnt, or only says who wins, and prints it."""
    _print(*_learnt(source, judge=not quick), as_json=as_json)


def run_test(source: Source, model: Path, *, as_json: bool) -> None:
    """Judges a finished model on test data, and prints it."""
    console = errors()
    # Before minutes are spent on features.
    artifact = load(model)
    with evidence(source.store, source.evidence) as store:
        found = test_data(store, source.device, source.levels, _Steps(console, "Finding features"))
    _say(console, f"Asking {model} about", found)
    _print(found, evaluation_of(artifact, found), as_json=as_json)


def _print(found: Learning, verdicts: tuple[Verdict, ...], *, as_json: bool) -> None:
    who = winners(found)
    if as_json:
        gap = evaluation_record(found, verdicts)
        print_json({**learning_record(found), "closed_gap": gap, "winners": winners_record(found, who)})
        return
    if verdicts:
        print_verdicts(results(), verdicts)
    print_winners(results(), who, _labels(found))


def _labels(source: Learning) -> tuple[str, ...]:
    return tuple(slot.label for slot in source.dataset.slots)


def _learnt(source: Source, *, judge: bool) -> tuple[Learning, tuple[Verdict, ...]]:
    console = errors()
    with evidence(source.store, source.evidence) as store:
        found = learnt(store, source.device, source.levels, _Steps(console, "Finding features"))
    _say(console, "Learning from", found)
    return found, evaluation(found, _Steps(console, "Judging, fold")) if judge else ()


def _say(console: Console, what: str, found: Learning) -> None:
    data = found.dataset
    families = len(set(data.examples.families.tolist()))
    words = f"{what} {counted(len(data.examples), 'instance')} of {families} families, "
    words += f"{len(data.slots)} candidates, times of {found.device.renderer}"
    console.print(Text(printable(words)), soft_wrap=True)
    for reason, count in [*data.left_out.items(), *found.problems.items()]:
        if count:
            console.print(Text(printable(f"Left out: {count} {reason}")), soft_wrap=True)
