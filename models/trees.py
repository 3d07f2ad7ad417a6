"""Decision trees as flat arrays: walked by NumPy alone, and checked before they are believed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int32]

LEAF = -1
ROWS_AT_ONCE = 4096


@dataclass(frozen=True)
class Trees:
    """Trees whose leaves' values are added up. The nodes of all trees stand behind each other.

    Attributes:
        starts: (t,) int32 root of each tree.
        feature: (m,) int32 column that a node asks about; -1 for a leaf.
        threshold: (m,) float64: at most this goes left, more goes right.
        left: (m,) int32 node; its own number for a leaf.
        right: (m,) int32 node; its own number for a leaf.
        value: (m, o) float64 what a leaf adds to each output.
        baseline: (o,) float64 what the sum starts from.
    """

    starts: Numbers
    feature: Numbers
    threshold: Floats
    left: Numbers
    right: Numbers
    value: Floats
    baseline: Floats

    def predict(self, rows: Floats) -> Floats:
        """(n, o) float64 outputs for (n, d) float64 rows without gaps."""
        assert np.isfinite(rows).all(), "trees know nothing of gaps"
        chunks = [
            self._predict(rows[start : start + ROWS_AT_ONCE]) for start in range(0, len(rows), ROWS_AT_ONCE)
        ]
        return np.concatenate(chunks) if chunks else np.zeros((0, len(self.baseline)))

    def _predict(self, rows: Floats) -> Floats:
        index = np.arange(len(rows))
        nodes = np.broadcast_to(self.starts[:, None], (len(self.starts), len(rows))).copy()
        while True:
            asked = self.feature[nodes]
            inner = asked != LEAF
            if not inner.any():
                break
            goes_left = rows[index, np.where(inner, asked, 0)] <= self.threshold[nodes]
            nodes = np.where(goes_left, self.left[nodes], self.right[nodes])
        # Tree by tree: the order of the sum is that of the fit.
        total = np.tile(self.baseline, (len(rows), 1))
        for of_tree in nodes:
            total += self.value[of_tree]
        return total

    def problem(self, columns: int, outputs: int) -> str:
        """Why these are no trees over so many columns with so many outputs; empty where they are."""
        count = len(self.feature)
        node = np.arange(count)
        leaf = self.feature == LEAF
        checks = {
            "arrays differ in length": len({len(one) for one in self._of_nodes}) == 1,
            "a value or a baseline has another number of outputs": self.value.shape[1:]
            == self.baseline.shape
            == (outputs,),
            "a root is no node": bool(((self.starts >= 0) & (self.starts < count)).all()),
        }
        wrong = [what for what, right in checks.items() if not right]
        if wrong:
            return wrong[0]
        checks = {
            "a node asks about a column that is not there": bool(
                ((self.feature >= LEAF) & (self.feature < columns)).all()
            ),
            # So every walk ends.
            "a child does not come after its parent": bool(
                (
                    leaf
                    | ((self.left > node) & (self.right > node) & (self.left < count) & (self.right < count))
                ).all()
            ),
            "a number is not finite": bool(
                np.isfinite(self.threshold).all()
                and np.isfinite(self.value).all()
                and np.isfinite(self.baseline).all()
            ),
        }
        leaves_stay = (self.left == node) & (self.right == node)
        checks["a leaf has children"] = bool((~leaf | leaves_stay).all())
        reached = np.concatenate([self.starts, self.left[~leaf], self.right[~leaf]])
        checks["a node has two parents"] = len(np.unique(reached)) == len(reached)
        return next((what for what, right in checks.items() if not right), "")

    @property
    def arrays(self) -> dict[str, npt.NDArray[np.float64] | npt.NDArray[np.int32]]:
        """All of it, by name."""
        return {name: getattr(self, name) for name in ARRAYS}

    @property
    def _of_nodes(self) -> tuple[npt.NDArray[np.float64] | npt.NDArray[np.int32], ...]:
        return self.feature, self.threshold, self.left, self.right, self.value


ARRAYS: dict[str, type[np.float64 | np.int32]] = {
    "starts": np.int32,
    "feature": np.int32,
    "threshold": np.float64,
    "left": np.int32,
    "right": np.int32,
    "value": np.float64,
    "baseline": np.float64,
}
"""Name of each array -> its type."""


def joined(
    parts: list[dict[str, npt.NDArray[np.float64] | npt.NDArray[np.int32]]], baseline: Floats
) -> Trees:
    """Trees of single ones, whose nodes count from 0, with -1 for a leaf's feature."""
    counts = [len(one["feature"]) for one in parts]
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]) if parts else np.zeros(0)
    moved = []
    for part, start in zip(parts, starts, strict=True):
        node = np.arange(len(part["feature"]))
        leaf = part["feature"] == LEAF
        children = {side: np.where(leaf, node, part[side]) + start for side in ("left", "right")}
        moved.append({**part, **children})
    outputs = len(baseline)
    empty: dict[str, npt.NDArray[np.float64]] = {name: np.zeros(0) for name in ("feature", "left", "right")}
    empty |= {"threshold": np.zeros(0), "value": np.zeros((0, outputs))}
    gathered = {name: np.concatenate([empty[name], *(one[name] for one in moved)]) for name in empty}
    typed = {name: np.ascontiguousarray(gathered[name], ARRAYS[name]) for name in gathered}
    return Trees(
        starts=np.asarray(starts, np.int32),
        feature=typed["feature"].astype(np.int32),
        threshold=typed["threshold"].astype(np.float64),
        left=typed["left"].astype(np.int32),
        right=typed["right"].astype(np.int32),
        value=typed["value"].astype(np.float64),
        baseline=np.asarray(baseline, np.float64),
    )
