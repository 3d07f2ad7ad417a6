"""Orders to measure stored instances again."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field

from selector.benchmark.crew import Entry
from selector.benchmark.messages import Job
from selector.benchmark.planning import planned
from selector.benchmark.questions import Question
from selector.benchmark.running import FRAME_TIMEOUT_S, UNTIMED_FACTOR, Order
from selector.benchmark.worker import enter
from selector.evidence.rows import InstanceRow, Purpose
from selector.rebenchmark.staleness import Part, Reason

BY_THEMSELVES = (Reason.DEVICE, Reason.CODE)
"""What is stale for these reasons has other keys in the store: a benchmark finds out what is missing."""


@dataclass(frozen=True)
class Bench:
    """Where and how all is measured.

    Attributes:
        codes: Technique's id -> hash of its code.
        device: Index or name; the first that works where None.
        threads: Of a software renderer where times are taken.
        rounds: Timed at most.
        workers: Processes that judge errors side by side.
        seed: Of the shuffling.
        deadline: On the monotonic clock; None for no limit.
        entry: What runs in a worker's process.
    """

    codes: Mapping[str, str]
    device: str | None = None
    threads: int = 1
    rounds: int = 10
    workers: int = 1
    seed: int = 1
    deadline: float | None = None
    entry: Entry = field(default=enter)


def sample_orders(
    bench: Bench,
    purpose: Purpose,
    sampled: Mapping[str, Collection[str]],
    questions: Mapping[str, Question],
    rows: Mapping[str, InstanceRow],
    *,
    again: bool = False,
) -> Iterator[Order]:
    """Errors or times of the sampled instances, for a store of their own.

    Args:
        bench: How.
        purpose: Which.
        sampled: Instance's key -> ids of techniques, in the order in which they are to be asked.
        questions: Instance's key -> question.
        rows: Instance's key -> instance.
        again: Whether there are times already, and others are to stand beside them.
    """
    for group, keys in _groups(sampled, rows).items():
        yield _order(bench, purpose, group, [questions[key] for key in keys], resume=not again)


def stale_orders(
    bench: Bench,
    stale: Mapping[Part, Reason],
    questions: Mapping[str, Question],
    rows: Mapping[str, InstanceRow],
) -> Iterator[Order]:
    """What brings stale evidence up to date: errors only where code or driver have changed, times everywhere.

    Args:
        bench: How.
        stale: What is stale, and why; what cannot be asked again is left out.
        questions: Instance's key -> question.
        rows: Instance's key -> instance.
    """
    for alone in (True, False):
        wanted: dict[str, list[str]] = defaultdict(list)
        for (instance, technique), reason in stale.items():
            if instance in questions and (reason in BY_THEMSELVES) == alone:
                wanted[instance].append(technique)
        for purpose in Purpose if alone else (Purpose.TIMES,):
            for group, keys in _groups(wanted, rows).items():
                asked = planned(questions[key] for key in sorted(keys))
                yield _order(bench, purpose, group, asked, resume=alone)


_Group = tuple[int, int, tuple[str, ...]]


def _groups(
    wanted: Mapping[str, Collection[str]], rows: Mapping[str, InstanceRow]
) -> dict[_Group, list[str]]:
    """(width, height, techniques) -> instances: what one benchmark can do in one go."""
    found: dict[_Group, list[str]] = defaultdict(list)
    for key, techniques in wanted.items():
        found[rows[key].width, rows[key].height, tuple(sorted(techniques))].append(key)
    return found


def _order(bench: Bench, purpose: Purpose, group: _Group, asked: list[Question], *, resume: bool) -> Order:
    width, height, techniques = group
    errors = purpose is Purpose.ERRORS
    job = Job(
        purpose,
        width,
        height,
        techniques,
        device=bench.device,
        threads=bench.threads,
        rounds=bench.rounds,
        timeout_s=FRAME_TIMEOUT_S * (UNTIMED_FACTOR if errors else 1.0),
        seed=bench.seed,
    )
    workers = bench.workers if errors else 1
    return Order(job, asked, bench.codes, workers, bench.deadline, resume, entry=bench.entry)
