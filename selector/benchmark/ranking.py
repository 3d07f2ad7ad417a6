"""How well medians are known: when a candidate needs no more repetitions, and how sure a ranking is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb

import numpy as np
from scipy.stats import kendalltau

FEWEST_ROUNDS = 3
COVERAGE = 0.9
"""Of the interval about a median, where there are enough samples for it."""
TIE = 1.02
"""Factor: a median that is known this closely is known well enough, whoever else is as near."""
RESAMPLES = 1000
_SEED = 1


def median_interval(values: Sequence[float]) -> tuple[float, float]:
    """An interval for the median of what the values are drawn from, by order statistics alone.

    From the k-th smallest to the k-th largest value, for the largest k with a coverage of at least 0.9, and
    from the smallest to the largest where there are too few values for that: of three they cover the median
    in 75 of 100 cases. No distribution is assumed (David and Nagaraja 2003, Order Statistics, section 7.1).
    """
    assert values
    ordered = sorted(values)
    count = len(ordered)
    rank = 1
    while 2 * (rank + 1) <= count and _coverage(rank + 1, count) >= COVERAGE:
        rank += 1
    return ordered[rank - 1], ordered[count - rank]


def settled(samples: Sequence[Sequence[float]]) -> list[bool]:
    """For each candidate whether its median is known well enough to rank it.

    Args:
        samples: Times of each candidate, as multiples of the canary's in the same round.

    It is, from three samples on, if its interval overlaps with neither neighbour's in the order of medians,
    or is narrower than 2 %. Three samples that lie wholly on one side of three others do so by chance in 1 of
    20 pairs of equals.
    """
    spans = [median_interval(one) if one else (0.0, float("inf")) for one in samples]
    order = sorted(range(len(samples)), key=lambda index: float(np.median(samples[index] or [np.inf])))
    known = [False] * len(samples)
    for place, index in enumerate(order):
        low, high = spans[index]
        neighbours = order[max(place - 1, 0) : place] + order[place + 1 : place + 2]
        apart = all(spans[other][1] < low or high < spans[other][0] for other in neighbours)
        known[index] = len(samples[index]) >= FEWEST_ROUNDS and (apart or high <= low * TIE)
    return known


def winning_share(samples: Mapping[str, Sequence[float]]) -> tuple[str, float] | None:
    """Who has the lowest median, and in which share of bootstrap resamples it still has; None without any.

    The bootstrap of the statistic that ranks them (Efron 1979), each candidate's samples drawn on their own:
    what all of a round have in common is gone with the canary.
    """
    named = {name: np.asarray(values) for name, values in samples.items() if len(values)}
    if not named:
        return None
    winner = min(named, key=lambda name: float(np.median(named[name])))
    random = np.random.default_rng(_SEED)
    drawn = {
        name: np.median(values[random.integers(0, len(values), (RESAMPLES, len(values)))], axis=1)
        for name, values in named.items()
    }
    others = [medians for name, medians in drawn.items() if name != winner]
    ahead = drawn[winner] <= np.min(others, axis=0) if others else np.ones(1)
    return winner, float(np.mean(ahead))


def stability(samples: Sequence[Sequence[float]]) -> float | None:
    """Kendall's tau between the rankings by even and by odd samples; None where fewer than two have both."""
    halves = [(np.median(one[::2]), np.median(one[1::2])) for one in samples if len(one) > 1]
    if len(halves) < 2:
        return None
    tau = float(kendalltau(*zip(*halves, strict=True)).statistic)
    return tau if np.isfinite(tau) else None


def _coverage(rank: int, count: int) -> float:
    """Chance that the median lies between the rank-th smallest and the rank-th largest of so many values."""
    return 1 - 2 * sum(comb(count, below) for below in range(rank)) / float(1 << count)
