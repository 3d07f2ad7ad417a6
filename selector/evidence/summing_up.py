"""Samples summed up: medians over rounds with the machine's drift divided out, and how sure they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import binom

from selector.evidence.records import MOBILITIES
from selector.evidence.table import Floats, Numbers, Times

SURENESS = 0.95


@dataclass(frozen=True)
class Samples:
    """Timed frames by the column.

    Attributes:
        cell: (m,) which cell of the table each belongs to.
        mobility: (m,) which of `MOBILITIES`.
        shadow_ms: (m,) the technique's own stages.
        canary_ms: (m,) the fixed frame of the same round.
    """

    cell: Numbers
    mobility: Numbers
    shadow_ms: Floats
    canary_ms: Floats


def summed_up(samples: Samples, shape: tuple[int, int]) -> tuple[tuple[Times, ...], float]:
    """Times for each of `MOBILITIES`, and the median canary in milliseconds."""
    canary_ms = float(np.median(samples.canary_ms)) if len(samples.canary_ms) else float("nan")
    steady_ms = samples.shadow_ms / samples.canary_ms * canary_ms
    return tuple(
        _times(samples.cell[of_this], steady_ms[of_this], shape)
        for of_this in (samples.mobility == number for number in range(len(MOBILITIES)))
    ), canary_ms


def _times(cells: Numbers, ms: Floats, shape: tuple[int, int]) -> Times:
    order = np.lexsort((ms, cells))
    sorted_ms = ms[order]
    known, start, count = np.unique(cells[order], return_index=True, return_counts=True)
    # The interval between two order statistics holds the median with a sureness that no distribution changes.
    rank = np.maximum(binom.ppf((1 - SURENESS) / 2, count, 0.5), 1).astype(np.int64) - 1
    middle = (sorted_ms[start + (count - 1) // 2] + sorted_ms[start + count // 2]) / 2
    values = (middle, sorted_ms[start + rank], sorted_ms[start + count - 1 - rank])
    filled = np.full((len(values), shape[0] * shape[1]), np.nan)
    filled[:, known] = values
    rounds = np.zeros(shape[0] * shape[1], np.int64)
    rounds[known] = count
    median_ms, low_ms, high_ms = filled.reshape(len(values), *shape)
    return Times(median_ms, low_ms, high_ms, rounds.reshape(shape))
