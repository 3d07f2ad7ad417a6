"""Trees as masks of leaves say what the same trees say when they are walked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.artifact import load
from models.fitting import boosted, cost_forest
from models.leaf_masks import MOST_LEAVES, PAIRS_AT_ONCE, LeafMasks
from models.shipped import SHIPPED_MODEL
from models.trees import LEAF, Trees
from tests.tolerances import TREE_SUM

RANDOM = np.random.default_rng(9)
INSTANCES = RANDOM.normal(size=(60, 4))
CHOICES = RANDOM.integers(0, 3, (7, 2)).astype(float)


def walked(trees: Trees, instances: np.ndarray, choices: np.ndarray) -> np.ndarray:
    """(n, c) outputs for every pair, each a row."""
    pairs = np.hstack([np.repeat(instances, len(choices), axis=0), np.tile(choices, (len(instances), 1))])
    return trees.predict(pairs).reshape(len(instances), len(choices))


def made(trees: Trees, width: int) -> LeafMasks:
    masks = LeafMasks.of(trees, width)
    assert masks is not None
    return masks


def random_trees(seed: int, count: int, columns: int) -> Trees:
    """Trees of every shape with 1 to 16 leaves: a leaf is split at a time, wherever it is."""
    random = np.random.default_rng(seed)
    arrays: dict[str, list[float]] = {name: [] for name in ("feature", "threshold", "left", "right", "value")}
    starts = []

    def leaf() -> int:
        number = len(arrays["feature"])
        for name, value in zip(arrays, (LEAF, 0.0, number, number, random.normal()), strict=True):
            arrays[name].append(value)
        return number

    for _ in range(count):
        open_leaves = [leaf()]
        starts.append(open_leaves[0])
        for _ in range(random.integers(0, MOST_LEAVES)):
            split = open_leaves.pop(int(random.integers(len(open_leaves))))
            left, right = leaf(), leaf()
            open_leaves += [left, right]
            arrays["feature"][split] = int(random.integers(columns))
            arrays["threshold"][split] = float(random.integers(-2, 3))
            arrays["left"][split], arrays["right"][split] = left, right
    whole = {name: np.array(arrays[name], np.int32) for name in ("feature", "left", "right")}
    threshold, value = np.array(arrays["threshold"]), np.array(arrays["value"])[:, None]
    return Trees(
        np.array(starts, np.int32), threshold=threshold, value=value, baseline=np.array([0.5]), **whole
    )


@given(st.integers(0, 2**32), st.integers(1, 9), st.integers(0, 4))
def test_any_trees_say_the_same_either_way(seed: int, count: int, of_choice: int) -> None:
    trees = random_trees(seed, count, 5)
    assert trees.problem(5, 1) == ""
    # Whole numbers: rows lie on thresholds, where left and right are told apart.
    random = np.random.default_rng(seed)
    instances = random.integers(-3, 4, (11, 5 - of_choice)).astype(float)
    choices = random.integers(-3, 4, (3, of_choice)).astype(float)
    found = made(trees, 5 - of_choice).predict(instances, choices)
    assert found == pytest.approx(walked(trees, instances, choices), rel=TREE_SUM, abs=TREE_SUM)


def test_more_pairs_than_are_asked_at_once() -> None:
    trees = random_trees(1, 20, 6)
    many = np.random.default_rng(3).normal(size=(2 * PAIRS_AT_ONCE // len(CHOICES) + 5, 4))
    found = made(trees, 4).predict(many, CHOICES)
    assert found == pytest.approx(walked(trees, many, CHOICES), rel=TREE_SUM, abs=TREE_SUM)
    assert made(trees, 4).predict(many[:0], CHOICES).shape == (0, len(CHOICES))
    assert made(trees, 4).predict(many, CHOICES[:0]).shape == (len(many), 0)


def test_what_has_no_masks_is_walked_instead() -> None:
    rows = RANDOM.normal(size=(400, 6))
    target, even = np.sin(2 * rows[:, 0]) + rows[:, 1] * rows[:, 5], np.ones(400)
    nothing = boosted(rows, np.full(400, 3.5), even, (0,) * 6)
    assert LeafMasks.of(nothing, 4) is None
    assert LeafMasks.of(cost_forest(rows, np.stack([target, -target], axis=1), even), 4) is None
    small = boosted(rows, target, even, (0,) * 6)
    assert LeafMasks.of(small, 4) is not None
    chain = 17
    inner = np.arange(chain - 1) * 2
    feature, left, right = (
        np.full(2 * chain - 1, LEAF, np.int32),
        *np.tile(np.arange(2 * chain - 1), (2, 1)),
    )
    feature[inner], left[inner], right[inner] = 0, inner + 1, inner + 2
    numbers = np.arange(2.0 * chain - 1)
    too_large = Trees(
        np.zeros(1, np.int32),
        feature,
        numbers,
        left.astype(np.int32),
        right.astype(np.int32),
        numbers[:, None],
        np.zeros(1),
    )
    assert too_large.problem(1, 1) == ""
    assert LeafMasks.of(too_large, 1) is None


def test_the_shipped_model_says_the_same_either_way() -> None:
    model = load(SHIPPED_MODEL).model.performance
    width = RANDOM.normal(size=(5, len(load(SHIPPED_MODEL).features)))
    quick = model.predict(width)
    walking = replace(model)
    walking._made.update({(name, m): None for name, all_ in model.trees.items() for m in range(len(all_))})
    slow = walking.predict(width)
    for name in (*quick.log_times, "error", "works"):
        assert quick.target(name) == pytest.approx(slow.target(name), rel=TREE_SUM, abs=TREE_SUM)
    assert any(one is not None for one in model._made.values())
