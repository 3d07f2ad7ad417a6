"""Which times were taken on a calm machine: the canary tells.

Dividing by the canary removes what slows all frames alike, such as a lower clock. Other programs do not: they
take turns with a frame of 5 ms and leave one of 0.2 ms alone, so under load the ratio of a short stage to the
canary fell to 0.6 of what it was, on code that had not changed. Times of an instance whose canary was that
much slower than the device's calm one therefore bear no witness. Rounds are not picked one by one: a fast
canary among slow ones was lucky, and the frames after it were not.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from statistics import median

import numpy as np

from selector.evidence.rows import Timing

CALM = 1.25
"""Times its calm length that a canary may take: calm runs kept within 1.1, runs under load took 1.6 to 3."""
_CALM_SHARE = 10.0
"""Percent of the sessions by which a device's calm canary is known, however busy it was most of the time."""

Session = tuple[str, str]
"""Keys of an instance and of the run in which it was timed: candidates side by side, some seconds long."""


def canaries_ms(timings: Iterable[Timing]) -> dict[Session, float]:
    """The median canary of each session."""
    rounds: dict[Session, dict[int, float]] = defaultdict(dict)
    for row in timings:
        for one in row.samples:
            rounds[row.asked.instance, row.run][one.round] = one.canary_ms
    return {session: median(of_round.values()) for session, of_round in rounds.items()}


def calm_canary_ms(timings: Iterable[Timing]) -> float:
    """How long the canary takes where little else runs; infinity where nothing was timed."""
    return calm_of(canaries_ms(timings).values())


def calm_of(canaries: Iterable[float]) -> float:
    """The calm one among canaries of sessions, in milliseconds; infinity where there are none."""
    known = list(canaries)
    return float(np.percentile(known, _CALM_SHARE)) if known else float("inf")


def calm(timings: Sequence[Timing], canary_ms: float) -> list[Timing]:
    """Timings of sessions whose canary was not much slower than this."""
    known = canaries_ms(timings)
    return [row for row in timings if known.get((row.asked.instance, row.run), 0.0) <= CALM * canary_ms]
