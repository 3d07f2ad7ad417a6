"""Small trees evaluated without walking: every question of every tree at once, as masks of leaves.

Each question whose answer is "right" rules out the leaves on its left; the leaf that is reached is the first
that nothing rules out (Lucchese et al., "QuickScorer", SIGIR 2015). Questions about an instance and those
about a choice rule out leaves independently, so neither is asked again for every pair of the two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from models.trees import LEAF, Floats, Numbers, Trees

Masks = npt.NDArray[np.uint16]

MOST_LEAVES = 16
"""Bits of a mask."""

PAIRS_AT_ONCE = 4096

_ALL = np.uint16(0xFFFF)
_FIRST_LEAF = np.array([0, *((n & -n).bit_length() - 1 for n in range(1, 1 << MOST_LEAVES))], np.int16)
"""Mask -> the lowest leaf in it."""


@dataclass(frozen=True)
class _Questions:
    """Questions about some columns, tree by tree; each tree begins with one that rules out nothing.

    Attributes:
        starts: (t,) the first of each tree.
        column: (q,) which one is asked about; -1 for none.
        threshold: (q,) float64: more than this rules out.
        keeps: (q,) the leaves that then remain.
    """

    starts: Numbers
    column: Numbers
    threshold: Floats
    keeps: Masks

    def leaves(self, rows: Floats) -> Masks:
        """(n, t) which leaves remain, for (n, d) rows."""
        padded = np.hstack([rows, np.zeros((len(rows), 1))])
        answers = np.where(padded[:, self.column] > self.threshold, self.keeps, _ALL)
        found: Masks = np.bitwise_and.reduceat(answers, self.starts, axis=1)
        return found


@dataclass(frozen=True)
class LeafMasks:
    """Trees with one output and at most 16 leaves each, ready to be asked quickly.

    Attributes:
        of_instance: The questions about the first columns.
        of_choice: Those about the others.
        values: (t * 16,) what each leaf adds.
        baseline: What the sum starts from.
    """

    of_instance: _Questions
    of_choice: _Questions
    values: Floats
    baseline: float

    @classmethod
    def of(cls, trees: Trees, width: int) -> LeafMasks | None:
        """The same trees over `width` columns of instances and further ones of choices; None if too large."""
        if not len(trees.starts) or trees.value.shape[1] != 1:
            return None
        levels = _levels(trees)
        leaves = _leaf_counts(trees, levels)
        if leaves[trees.starts].max() > MOST_LEAVES:
            return None
        tree, first = _places(trees, levels, leaves)
        is_leaf = trees.feature == LEAF
        values = np.zeros(len(trees.starts) * MOST_LEAVES)
        values[tree[is_leaf] * MOST_LEAVES + first[is_leaf]] = trees.value[is_leaf, 0]
        gone = ((1 << leaves[trees.left].astype(np.int64)) - 1) << first
        keeps = (~gone & int(_ALL)).astype(np.uint16)
        asks_choice = trees.feature >= width
        return cls(
            _questions(trees, tree, keeps, ~is_leaf & ~asks_choice, 0),
            _questions(trees, tree, keeps, asks_choice, width),
            values,
            float(trees.baseline[0]),
        )

    def predict(self, instances: Floats, choices: Floats) -> Floats:
        """(n, c) float64 outputs for (n, d) instances under each of (c, m) choices."""
        of_choice = self.of_choice.leaves(choices)
        chunk = max(PAIRS_AT_ONCE // max(len(choices), 1), 1)
        found = np.zeros((len(instances), len(choices)))
        places = np.arange(len(self.of_choice.starts), dtype=np.int32) * MOST_LEAVES
        for start in range(0, len(instances), chunk):
            remaining = self.of_instance.leaves(instances[start : start + chunk])[:, None] & of_choice
            found[start : start + chunk] = self.values[places + _FIRST_LEAF[remaining]].sum(axis=2)
        return found + self.baseline


def _levels(trees: Trees) -> list[Numbers]:
    """The nodes by their distance from the root, all trees together."""
    found, level = [], trees.starts
    while len(level):
        found.append(level)
        inner = level[trees.feature[level] != LEAF]
        level = np.concatenate([trees.left[inner], trees.right[inner]])
    return found


def _leaf_counts(trees: Trees, levels: list[Numbers]) -> Numbers:
    """(m,) leaves below each node, itself if it is one."""
    counts = np.ones(len(trees.feature), np.int32)
    for level in reversed(levels):
        inner = level[trees.feature[level] != LEAF]
        counts[inner] = counts[trees.left[inner]] + counts[trees.right[inner]]
    return counts


def _places(trees: Trees, levels: list[Numbers], leaves: Numbers) -> tuple[Numbers, Numbers]:
    """(m,) the tree of each node, and its leftmost leaf's number from the left."""
    tree, first = np.zeros(len(trees.feature), np.int32), np.zeros(len(trees.feature), np.int32)
    tree[trees.starts] = np.arange(len(trees.starts))
    for level in levels:
        inner = level[trees.feature[level] != LEAF]
        left, right = trees.left[inner], trees.right[inner]
        tree[left] = tree[right] = tree[inner]
        first[left] = first[inner]
        first[right] = first[inner] + leaves[left]
    return tree, first


def _questions(
    trees: Trees, tree: Numbers, keeps: Masks, asked: npt.NDArray[np.bool_], width: int
) -> _Questions:
    count = len(trees.starts)
    nodes = np.flatnonzero(asked)
    order = np.argsort(np.concatenate([np.arange(count), tree[nodes]]), kind="stable")
    sizes = np.bincount(tree[nodes], minlength=count) + 1
    starts = (np.cumsum(sizes) - sizes).astype(np.int32)
    nothing = np.full(count, -1, np.int32), np.full(count, np.inf), np.full(count, _ALL)
    columns = np.concatenate([nothing[0], trees.feature[nodes] - width]).astype(np.int32)[order]
    thresholds = np.concatenate([nothing[1], trees.threshold[nodes]])[order]
    return _Questions(starts, columns, thresholds, np.concatenate([nothing[2], keeps[nodes]])[order])
