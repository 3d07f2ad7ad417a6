"""Which times of before are worth comparing with: a job times those instances again, and no others.

Where other programs were at work for half of the evidence, a sample that took no notice could compare 3 or 4
of 14 instances. The rules are those of `pairing`: what holds no longer, an older code's times, and a session
whose canary was slow bear no witness.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from selector.evidence.rows import Timing
from selector.evidence.superseding import Marks
from selector.measurement import Status
from selector.rebenchmark.calmness import CALM, calm_of, canaries_ms
from selector.rebenchmark.pairing import holding, newest_code
from selector.rebenchmark.staleness import Part


@dataclass(frozen=True)
class Told:
    """What the times of one device tell of.

    Attributes:
        known: (instance, technique) of which there are times that hold.
        calm: Those whose times were taken on a calm machine.
    """

    known: frozenset[Part] = frozenset()
    calm: frozenset[Part] = frozenset()


def told(
    timings: Iterable[Timing], started: Mapping[str, str], marks: Marks, techniques: Mapping[str, str]
) -> Told:
    """What times tell of; their samples are not kept, since there may be millions.

    Args:
        timings: Of one device.
        started: Key of a run -> when it began.
        marks: What no longer holds.
        techniques: Candidate's key -> id of its technique.
    """
    rows: list[Timing] = []
    canaries = canaries_ms(_noted(timings, rows))
    valid = [row for row in holding(newest_code(rows, started), started, marks, techniques) if _counts(row)]
    sessions = {(row.asked.instance, row.run): canaries[row.asked.instance, row.run] for row in valid}
    most_ms = CALM * calm_of(sessions.values())
    return Told(
        frozenset((row.asked.instance, techniques[row.asked.candidate]) for row in valid),
        frozenset(
            (row.asked.instance, techniques[row.asked.candidate])
            for row in valid
            if sessions[row.asked.instance, row.run] <= most_ms
        ),
    )


def telling(here: Told, former: Told, among: Mapping[str, Iterable[str]]) -> dict[str, list[str]]:
    """Instance's key -> techniques whose times of before are worth comparing with.

    Args:
        here: Of this driver.
        former: Of the driver of before; it counts where this one knows nothing.
        among: Instance's key -> techniques that can be timed again.
    """
    parts = here.calm | (former.calm - here.known)
    found: dict[str, list[str]] = defaultdict(list)
    for instance, names in among.items():
        for name in names:
            if (instance, name) in parts:
                found[instance].append(name)
    return dict(found)


def _noted(timings: Iterable[Timing], rows: list[Timing]) -> Iterator[Timing]:
    for row in timings:
        rows.append(replace(row, samples=row.samples[:1]))
        yield row


def _counts(row: Timing) -> bool:
    return row.status is Status.OK and bool(row.samples)
