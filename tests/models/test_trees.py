from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sklearn.ensemble import ExtraTreesRegressor, HistGradientBoostingRegressor

from models.fitting import BOOSTING, FOREST, boosted, cost_forest
from models.trees import LEAF, Trees
from tests.tolerances import TREE_SUM

RANDOM = np.random.default_rng(4)
ROWS = RANDOM.normal(size=(400, 6)).astype(np.float32).astype(np.float64)
TARGET = np.sin(2 * ROWS[:, 0]) + ROWS[:, 1] * ROWS[:, 2]
WEIGHTS = RANDOM.uniform(0.5, 2.0, 400)
FRESH = RANDOM.normal(size=(5000, 6)).astype(np.float32).astype(np.float64)
FREE = (0,) * 6


def test_boosted_trees_say_what_scikit_learn_says() -> None:
    theirs = HistGradientBoostingRegressor(monotonic_cst=list(FREE), **BOOSTING)
    theirs.fit(ROWS, TARGET, sample_weight=WEIGHTS)
    ours = boosted(ROWS, TARGET, WEIGHTS, FREE)
    assert ours.problem(6, 1) == ""
    assert ours.predict(FRESH)[:, 0] == pytest.approx(theirs.predict(FRESH), rel=TREE_SUM, abs=TREE_SUM)
    # On thresholds themselves too, where left and right are told apart by one bit.
    edges = np.tile(ROWS[:50], (2, 1))
    assert ours.predict(edges)[:, 0] == pytest.approx(theirs.predict(edges), rel=TREE_SUM, abs=TREE_SUM)


def test_a_cost_forest_says_what_scikit_learn_says() -> None:
    costs = np.stack([TARGET, -TARGET, ROWS[:, 3]], axis=1)
    theirs = ExtraTreesRegressor(**FOREST).fit(ROWS, costs, sample_weight=WEIGHTS)
    ours = cost_forest(ROWS, costs, WEIGHTS)
    assert ours.problem(6, 3) == ""
    assert ours.predict(FRESH) == pytest.approx(theirs.predict(FRESH), rel=TREE_SUM, abs=TREE_SUM)


def test_a_monotone_column_is_obeyed() -> None:
    falling = boosted(ROWS, TARGET, WEIGHTS, (-1, 0, 0, 0, 0, 0))
    along = np.tile(ROWS[:20, None], (1, 9, 1))
    along[:, :, 0] = np.linspace(-2, 2, 9)
    found = falling.predict(along.reshape(-1, 6)).reshape(20, 9)
    assert (np.diff(found, axis=1) <= 0).all()
    assert np.ptp(found) > 0


def test_a_constant_needs_no_tree() -> None:
    constant = boosted(ROWS, np.full(400, 3.5), WEIGHTS, FREE)
    assert len(constant.starts) == 0
    assert (constant.predict(FRESH) == 3.5).all()
    assert constant.predict(np.zeros((0, 6))).shape == (0, 1)


def test_trees_by_hand() -> None:
    """Left for at most 1: 10, else by the second column at 0: 20 or 30; and a second tree that adds 1."""
    trees = Trees(
        starts=np.array([0, 5], np.int32),
        feature=np.array([0, LEAF, 1, LEAF, LEAF, LEAF], np.int32),
        threshold=np.array([1.0, 0, 0.0, 0, 0, 0]),
        left=np.array([1, 1, 3, 3, 4, 5], np.int32),
        right=np.array([2, 1, 4, 3, 4, 5], np.int32),
        value=np.array([[0.0], [10.0], [0.0], [20.0], [30.0], [1.0]]),
        baseline=np.array([100.0]),
    )
    assert trees.problem(2, 1) == ""
    rows = np.array([[1.0, 5.0], [1.5, 0.0], [1.5, 0.5]])
    assert trees.predict(rows).ravel().tolist() == [111.0, 121.0, 131.0]


GOOD = boosted(ROWS, TARGET, WEIGHTS, FREE)
INNER = int(np.flatnonzero(GOOD.feature != LEAF)[0])
A_LEAF = int(np.flatnonzero(GOOD.feature == LEAF)[0])


def changed(name: str, index: int, value: float) -> Trees:
    array = getattr(GOOD, name).copy()
    array[index] = value
    return replace(GOOD, **{name: array})


@pytest.mark.parametrize(
    ("trees", "problem"),
    [
        (changed("feature", INNER, 6), "column"),
        (changed("feature", INNER, -2), "column"),
        (changed("left", INNER, INNER), "child"),
        (changed("right", INNER, 0), "child"),
        (changed("right", INNER, len(GOOD.feature)), "child"),
        (changed("left", A_LEAF, A_LEAF + 1), "leaf"),
        (changed("threshold", INNER, np.nan), "finite"),
        (changed("value", A_LEAF, np.inf), "finite"),
        (changed("starts", 0, len(GOOD.feature)), "root"),
        (changed("starts", 0, -1), "root"),
        (changed("right", INNER, int(GOOD.left[INNER])), "two parents"),
        (replace(GOOD, starts=np.concatenate([GOOD.starts, GOOD.starts[:1]])), "two parents"),
        (replace(GOOD, left=GOOD.left[:-1]), "length"),
        (replace(GOOD, baseline=np.zeros(2)), "outputs"),
    ],
)
def test_what_is_no_tree_is_told(trees: Trees, problem: str) -> None:
    assert problem in trees.problem(6, 1)
    assert GOOD.problem(6, 1) == ""
