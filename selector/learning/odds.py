"""How likely one uncertain number is below another."""

from __future__ import annotations

import numpy as np

from models.examples import Floats


def ahead(ours: Floats, theirs: Floats) -> float:
    """Probability that one number is below another, of which percentiles at even steps are known."""
    mine, others = _middles(ours)[:, None], _middles(theirs)[None, :]
    return float(np.mean(mine < others) + np.mean(mine == others) / 2)


def _middles(percentiles: Floats) -> Floats:
    """Between two neighbours, where equally much of the distribution lies."""
    middles: Floats = (percentiles[1:] + percentiles[:-1]) / 2
    return middles
