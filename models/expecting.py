"""What a choice is expected to cost, given what is predicted of it and how far predictions miss."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.examples import Choices, Floats, Question
from models.performance import ERROR, PERCENTS, WORKS, Predicted

LIKELY = 0.5
"""A choice that keeps the limit with this probability counts as one that does."""


def keeps_limit(predicted: Predicted, missed: Mapping[str, Floats], choices: Choices, limit: float) -> Floats:
    """(n, k) float64 probability that each choice works and its error is at most `limit`.

    The distribution is that of the misses on families that were not learnt from, moved to the prediction.
    """
    room = np.log1p(limit) - predicted.log_error
    found = np.zeros(room.shape)
    for method in range(choices.methods):
        columns = choices.method == method
        # Ties at the ends belong to the limit's own side.
        found[:, columns] = np.interp(
            room[:, columns], *_ascending(missed[ERROR][method]), left=0.0, right=1.0
        )
    return found * predicted.works


def expected_costs(
    predicted: Predicted, missed: Mapping[str, Floats], choices: Choices, question: Question, miss: float
) -> Floats:
    """(n, k) float64 expected cost of each choice.

    The predicted time over that of the fastest choice that likely keeps the limit, where it does, and `miss`
    where it does not. Where none likely does, the one is best that is expected to exceed it least.
    """
    keeps = keeps_limit(predicted, missed, choices, question.limit)
    log_time = predicted.log_times[question.time]
    fastest = np.where(keeps >= LIKELY, log_time, np.inf).min(axis=1, keepdims=True)
    any_likely = np.isfinite(fastest)
    ratio = np.exp(np.clip(log_time - np.where(any_likely, fastest, 0.0), -2.0, 20.0))
    likely = keeps * ratio + (1 - keeps) * miss
    exceeding = predicted.log_error + miss * (1 - predicted.works)
    unlikely = 1 + exceeding - exceeding.min(axis=1, keepdims=True)
    found: Floats = np.where(any_likely, likely, unlikely)
    return found


def interval(
    values: Floats, missed: Mapping[str, Floats], choices: Choices, target: str, share: float
) -> tuple[Floats, Floats]:
    """(n, k) low and high end of a predicted target that hold the truth with probability `share`."""
    assert target != WORKS
    tail = 50.0 * (1 - share)
    ends = [
        np.array([np.interp(percent, PERCENTS, of_method) for of_method in missed[target]])
        for percent in (tail, 100.0 - tail)
    ]
    low, high = (values + end[choices.method] for end in ends)
    return low, high


def _ascending(percentiles: Floats) -> tuple[Floats, Floats]:
    """Misses and the share that is not above each, without repetitions."""
    values, last = np.unique(percentiles[::-1], return_index=True)
    shares = PERCENTS[::-1][last] / 100
    return values, shares
