"""Fits trees by scikit-learn, and takes them apart into flat arrays. The only module that needs it."""

from __future__ import annotations

from typing import Any

import numpy as np
from sklearn.ensemble import ExtraTreesRegressor, HistGradientBoostingRegressor
from threadpoolctl import threadpool_limits

from models.trees import LEAF, Floats, Trees, joined

SEED = 2005
BOOSTING: dict[str, Any] = {
    "max_iter": 80,
    "learning_rate": 0.1,
    "max_leaf_nodes": 12,
    "min_samples_leaf": 20,
    "l2_regularization": 1.0,
    "early_stopping": False,
    "random_state": SEED,
}
FOREST: dict[str, Any] = {
    "n_estimators": 60,
    "min_samples_leaf": 8,
    "max_features": 0.5,
    "random_state": SEED,
}
NEGLIGIBLE = 1e-12
"""A target that varies by less is a constant, and needs no tree."""


def boosted(rows: Floats, target: Floats, weights: Floats, monotone: tuple[int, ...]) -> Trees:
    """Boosted trees for (n,) targets of (n, d) rows (Friedman 2001; histograms as in LightGBM).

    Args:
        rows: (n, d) float64, each value one of float32.
        target: (n,) float64.
        weights: (n,) float64.
        monotone: For each column 1 where the output must not fall with it, -1 where it must not rise, else 0.
    """
    if np.ptp(target) < NEGLIGIBLE:
        return joined([], np.array([target[0]]))
    model = HistGradientBoostingRegressor(monotonic_cst=list(monotone), **BOOSTING)
    # One thread: sums are added up in one order, and small fits wait for no busy core.
    with threadpool_limits(1):
        model.fit(rows, target, sample_weight=weights)
    parts = [_boosted_tree(stage[0].nodes) for stage in model._predictors]  # noqa: SLF001  there is no other way
    return joined(parts, np.asarray(model._baseline_prediction, np.float64).reshape(1))  # noqa: SLF001


def cost_forest(rows: Floats, costs: Floats, weights: Floats) -> Trees:
    """A forest whose leaves hold the mean cost of each of (n, k) choices: a classifier that knows costs.

    Extremely randomised trees with several outputs (Geurts, Ernst and Wehenkel 2006): a split is good where
    it parts rows whose costs differ, whichever choice is right.
    """
    model = ExtraTreesRegressor(**FOREST)
    model.fit(rows, costs, sample_weight=weights)
    share = 1.0 / len(model.estimators_)
    parts = [_forest_tree(one.tree_, share) for one in model.estimators_]
    return joined(parts, np.zeros(costs.shape[1]))


def _boosted_tree(nodes: Any) -> dict[str, Any]:
    leaf = nodes["is_leaf"].astype(bool)
    return {
        "feature": np.where(leaf, LEAF, nodes["feature_idx"]),
        "threshold": np.where(leaf, 0.0, nodes["num_threshold"]),
        "left": nodes["left"].astype(np.int64),
        "right": nodes["right"].astype(np.int64),
        "value": np.where(leaf, nodes["value"], 0.0)[:, None],
    }


def _forest_tree(tree: Any, share: float) -> dict[str, Any]:
    leaf = tree.children_left < 0
    values = tree.value[:, :, 0] * share
    return {
        "feature": np.where(leaf, LEAF, tree.feature),
        "threshold": np.where(leaf, 0.0, tree.threshold),
        "left": tree.children_left,
        "right": tree.children_right,
        "value": np.where(leaf[:, None], values, 0.0),
    }
