"""Whether times have drifted: a test of log ratios, with the instance as the unit.

Samples of one instance are not independent: they share a scene, a moment and a machine's mood, and tests that
take each for a witness of its own find drifts where there are none. So all samples of one instance make one
number, the logarithm of new over old time, both in canary frames; and instances are the witnesses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import exp, log

import numpy as np
from scipy.stats import norm, rankdata

from models.examples import Floats
from scenes.scene import Mobility

Subject = tuple[str, Mobility]
"""Id of a technique, and which of its times."""

FLOOR = 0.05
"""Shifts up to this share raise no alarm, however sure: they move only answers that were a coin's toss."""
ALPHA = 0.05
"""Chance that a job raises any alarm although no true shift is larger than the floor."""
FEWEST = 10
"""Instances without which nothing is claimed: of fewer even a unanimous verdict would drown in ten tests."""
_SURENESS = 0.95
_EXACT = 60


@dataclass(frozen=True)
class Shift:
    """By how much one kind of time has moved.

    Attributes:
        technique: Its id.
        mobility: Which of its times.
        ratio: New over old; 1.15 is 15 % slower. The Hodges-Lehmann estimate: the median of all means of two.
        low: Where the ratio is not below, in 95 of 100 repetitions.
        high: Where it is not above.
        p_value: Chance of such a sample, were the true shift within the floor, corrected for all tests of the
            job; None where there are too few instances.
        alarm: Whether it is larger than the floor, surely.
        ratios: (m,) new over old of each instance, in the order in which they were given.
    """

    technique: str
    mobility: Mobility
    ratio: float
    low: float
    high: float
    p_value: float | None
    alarm: bool
    ratios: tuple[float, ...]

    @property
    def instances(self) -> int:
        """How many witnesses there are."""
        return len(self.ratios)


def shifts(
    log_ratios: Mapping[Subject, Sequence[float]], alpha: float = ALPHA, floor: float = FLOOR
) -> tuple[Shift, ...]:
    """One verdict for each technique and mobility, in the order given.

    Wilcoxon's signed-rank test (1945) against the nearer end of the floor, twice the smaller of both sides;
    Holm's correction (1979) over all that are tested together.

    Args:
        log_ratios: For each subject one number an instance: ln(new / old).
        alpha: Chance of any false alarm.
        floor: Share up to which shifts do not matter.
    """
    corrected = holm(_p_values(log_ratios, log(1 + floor)))
    found = []
    for subject, values in log_ratios.items():
        if not len(values):
            continue
        logs = np.asarray(values, np.float64)
        middle, low, high = location(logs)
        p_value = corrected.get(subject)
        alarm = p_value is not None and p_value <= alpha
        ratios = tuple(np.exp(logs).tolist())
        found.append(Shift(*subject, exp(middle), exp(low), exp(high), p_value, alarm, ratios))
    return tuple(found)


def location(values: Floats) -> tuple[float, float, float]:
    """The median of the means of all pairs, and the interval that the signed-rank test leaves standing.

    Hodges and Lehmann (1963); the interval by the normal approximation of the rank sum, which is right to one
    pair from ten values on and errs on the wide side below.
    """
    count = len(values)
    first, second = np.triu_indices(count)
    means = np.sort((values[first] + values[second]) / 2)
    pairs = len(means)
    spread = float(np.sqrt(count * (count + 1) * (2 * count + 1) / 24))
    outside = max(int(np.floor(pairs / 2 - float(norm.ppf((1 + _SURENESS) / 2)) * spread)), 0)
    return float(np.median(means)), float(means[outside]), float(means[pairs - 1 - outside])


def holm(p_values: Mapping[Subject, float]) -> dict[Subject, float]:
    """P-values that may be compared with the chance of any false alarm among all of them."""
    corrected: dict[Subject, float] = {}
    highest = 0.0
    for rank, subject in enumerate(sorted(p_values, key=lambda one: p_values[one])):
        highest = max(highest, min(1.0, (len(p_values) - rank) * p_values[subject]))
        corrected[subject] = highest
    return corrected


def _p_values(log_ratios: Mapping[Subject, Sequence[float]], floor: float) -> dict[Subject, float]:
    """Of the hypothesis that the shift is within the floor, where there are enough values."""
    found: dict[Subject, float] = {}
    for subject, values in log_ratios.items():
        if len(values) >= FEWEST:
            row = np.asarray(values, np.float64)
            found[subject] = min(1.0, 2 * min(above_zero(row - floor), above_zero(-row - floor)))
    return found


def above_zero(values: Floats) -> float:
    """P-value of the signed-rank test that values lie about zero, against that they lie above.

    Exact up to 60 values. Of equal values each has the mean of their ranks; zeros keep their ranks and speak
    for neither side, which errs on the safe side. SciPy's test draws thousands of permutations where any two
    values are equal.
    """
    count = len(values)
    rank_sum = float(rankdata(np.abs(values))[values > 0].sum())
    if count <= _EXACT:
        return float(_tails(count)[int(rank_sum)])
    mean, spread = count * (count + 1) / 4, np.sqrt(count * (count + 1) * (2 * count + 1) / 24)
    return float(norm.sf((rank_sum - 0.5 - mean) / spread))


@cache
def _tails(count: int) -> Floats:
    """Chance of a rank sum of at least 0, 1, 2, ... where a coin decides the sign of each rank."""
    chances = np.ones(1)
    for rank in range(1, count + 1):
        with_rank = np.concatenate([np.zeros(rank), chances])
        chances = (np.pad(chances, (0, rank)) + with_rank) / 2
    tails: Floats = np.minimum(np.cumsum(chances[::-1])[::-1], 1.0)
    return tails
