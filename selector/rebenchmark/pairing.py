"""Old and new evidence side by side: times as log ratios, errors and counters by equality."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, log
from statistics import median

from scenes.scene import Mobility
from selector.evidence.rows import Judgement, Timing
from selector.evidence.superseding import Marks
from selector.measurement import Status
from selector.rebenchmark.calmness import calm, calm_canary_ms
from selector.rebenchmark.drift import Subject

Cell = tuple[str, str]
"""Keys of an instance and a candidate."""
Logs = dict[tuple[str, str, Mobility], float]
"""(instance, candidate, mobility) -> ln of the median time in canaries."""


@dataclass(frozen=True)
class Difference:
    """A figure or a counter that should be what it was, and is not.

    Attributes:
        instance: Key of the instance.
        candidate: Key of the candidate.
        what: Name of the figure or counter; `status` where it ended otherwise.
        old: What it was.
        new: What it is.
    """

    instance: str
    candidate: str
    what: str
    old: str
    new: str


@dataclass(frozen=True)
class Paired:
    """Old and new times of the instances that bear witness.

    Attributes:
        ratios: Technique and mobility -> instance -> ln(new / old).
        disturbed: Instances that were timed on both sides, but not calmly on both.
        canary_ratio: New over old calm canary of one device; None where there is no old one.
    """

    ratios: Mapping[Subject, Mapping[str, float]]
    disturbed: frozenset[str]
    canary_ratio: float | None


def paired(
    old: Sequence[Timing], new: Sequence[Timing], former: Sequence[Timing], techniques: Mapping[str, str]
) -> Paired:
    """Calm times side by side.

    Args:
        old: Of before, by this driver.
        new: Of now.
        former: Of before, by the driver of before; they count where this driver has none.
        techniques: Candidate's key -> id of its technique.
    """
    old_canary, new_canary = calm_canary_ms(old), calm_canary_ms(new)
    known = {(row.asked.instance, row.asked.candidate) for row in old}
    lacking = [row for row in former if (row.asked.instance, row.asked.candidate) not in known]
    before = median_logs(calm(lacking, calm_canary_ms(former))) | median_logs(calm(old, old_canary))
    # A night that was busy from beginning to end must not pass for calm.
    ratios = log_ratios(before, median_logs(calm(new, min(old_canary, new_canary))), techniques)
    both = {row.asked.instance for row in (*old, *former)} & {row.asked.instance for row in new}
    witnesses = {instance for found in ratios.values() for instance in found}
    comparable = isfinite(old_canary) and isfinite(new_canary)
    return Paired(ratios, frozenset(both - witnesses), new_canary / old_canary if comparable else None)


def median_logs(timings: Iterable[Timing]) -> Logs:
    """Of all samples of all runs that are given; times that are zero on any side tell nothing."""
    samples: dict[tuple[str, str, Mobility], list[float]] = defaultdict(list)
    for row in timings:
        if row.status is Status.OK:
            for one in row.samples:
                key = row.asked.instance, row.asked.candidate, one.mobility
                samples[key].append(one.shadow_ms / one.canary_ms)
    middles = {key: median(values) for key, values in samples.items()}
    return {key: log(value) for key, value in middles.items() if value > 0}


def log_ratios(old: Logs, new: Logs, techniques: Mapping[str, str]) -> dict[Subject, dict[str, float]]:
    """Technique and mobility -> instance -> ln(new / old), the median over the technique's candidates.

    Args:
        old: Before.
        new: Now.
        techniques: Candidate's key -> id of its technique.
    """
    by_instance: dict[tuple[Subject, str], list[float]] = defaultdict(list)
    for key in sorted(old.keys() & new.keys()):
        instance, candidate, mobility = key
        by_instance[(techniques[candidate], mobility), instance].append(new[key] - old[key])
    found: dict[Subject, dict[str, float]] = {}
    for (subject, instance), values in sorted(by_instance.items()):
        found.setdefault(subject, {})[instance] = median(values)
    return found


def holding(
    timings: Iterable[Timing], started: Mapping[str, str], marks: Marks, techniques: Mapping[str, str]
) -> list[Timing]:
    """Timings without those that no longer hold, as far as the candidate has been timed again since.

    Args:
        timings: Of one device.
        started: Key of a run -> when it began.
        marks: What no longer holds.
        techniques: Candidate's key -> id of its technique.
    """
    rows = list(timings)
    late: dict[Cell, bool] = {}
    is_late = []
    for row in rows:
        before = marks.get((row.asked.device, techniques[row.asked.candidate]), "")
        is_late.append(started[row.run] >= before)
        cell = row.asked.instance, row.asked.candidate
        late[cell] = late.get(cell, False) or is_late[-1]
    return [
        row
        for row, fine in zip(rows, is_late, strict=True)
        if fine or not late[row.asked.instance, row.asked.candidate]
    ]


def newest_code(timings: Sequence[Timing], started: Mapping[str, str]) -> list[Timing]:
    """Of each candidate and instance only the timings by the code that was timed last."""
    code: dict[Cell, str] = {}
    for row in sorted(timings, key=lambda one: started[one.run]):
        code[row.asked.instance, row.asked.candidate] = row.asked.code
    return [row for row in timings if row.asked.code == code[row.asked.instance, row.asked.candidate]]


def differences(old: Iterable[Judgement], new: Iterable[Judgement]) -> tuple[int, tuple[Difference, ...]]:
    """How many judgements are of the same device and code, and where these differ at all.

    A candidate that failed on either side is left out: a busy machine can fail one.
    """
    before = {row.asked: row for row in old if row.status is Status.OK}
    compared, found = 0, []
    for row in new:
        was = before.get(row.asked)
        if was is None or row.status is not Status.OK:
            continue
        compared += 1
        about = row.asked.instance, row.asked.candidate
        for name, then, now in _values(was, row):
            if then != now:
                found.append(Difference(*about, name, str(then), str(now)))
    return compared, tuple(found)


def _values(old: Judgement, new: Judgement) -> Iterable[tuple[str, object, object]]:
    """Figures that both know, and counters; FLIP may have been asked for on one side only."""
    for name in sorted(old.figures.keys() & new.figures.keys()):
        yield name, old.figures[name], new.figures[name]
    for name in sorted(old.counters.keys() | new.counters.keys()):
        yield name, old.counters.get(name), new.counters.get(name)
    yield "fallback", old.fallback, new.fallback
