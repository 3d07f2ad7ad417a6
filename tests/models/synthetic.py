"""A table to learn from whose truth is known: smooth costs, and effects of families that no feature shows."""

from __future__ import annotations

import numpy as np

from models.examples import Choices, Examples, Question

FAMILIES, OF_EACH, FEATURES = 9, 14, 5
MISS = 10.0
QUESTIONS = (Question("lax", "dynamic", 4.0), Question("strict", "dynamic", 0.5))
CHOICES = Choices(
    np.array([0, 0, 0, 1, 1, 2]),
    np.array([[8.0], [9.0], [10.0], [8.0], [9.0], [-1.0]]),
    (-1,),
)
"""Maps of three sizes, warped maps of two, volumes."""


def synthetic(seed: int = 0, family_effect: float = 0.15) -> Examples:
    """Examples in which the first features decide."""
    random = np.random.default_rng(seed)
    count = FAMILIES * OF_EACH
    family = np.repeat(np.arange(FAMILIES), OF_EACH)
    features = random.uniform(-1, 1, (count, FEATURES))
    features[:, 3] = family / FAMILIES + random.normal(0, 0.02, count)
    effect = family_effect * random.normal(size=(FAMILIES, 6))[family]
    size = CHOICES.settings[:, 0]
    side = np.where(size > 0, size - 8, 0.0)
    texel, overlap, warp = features[:, :1], features[:, 1:2], features[:, 2:3]
    log_time = np.where(CHOICES.method == 2, 1.2 + 1.6 * overlap, 0.2 + 0.45 * side) + effect
    log_error = np.where(CHOICES.method == 2, -6.0, 1.0 + 1.6 * texel - 0.69 * side)
    log_error = log_error - np.where(CHOICES.method == 1, 1.2 * (warp + 0.3), 0.0) + effect
    ok = (CHOICES.method != 1) | (warp > -0.3)
    times, error = np.exp(log_time), np.exp(log_error)
    costs = np.stack([_costs(times, error, ok, one.limit) for one in QUESTIONS])
    return Examples(
        features.astype(np.float32).astype(np.float64),
        np.array([f"family {index}" for index in family]),
        CHOICES,
        np.ones(ok.shape, bool),
        ok,
        {"dynamic": times},
        error,
        costs,
        QUESTIONS,
    )


def _costs(times: np.ndarray, error: np.ndarray, ok: np.ndarray, limit: float) -> np.ndarray:
    """As a policy has it: relative time of what keeps the limit, 10 for the rest."""
    keeps = ok & (error <= limit)
    fastest = np.where(keeps, times, np.inf).min(axis=1, keepdims=True)
    return np.where(keeps, times / fastest, MISS)
