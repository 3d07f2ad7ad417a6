"""What is learnt from: arrays of what was measured, without any idea of what it was measured on."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.int64]
Words = npt.NDArray[np.str_]


@dataclass(frozen=True)
class Choices:
    """The k choices.

    Attributes:
        method: (k,) int64 which method each is a variant of, from 0 on.
        settings: (k, m) float64 numbers that tell variants apart.
        error_trend: For each of the m settings -1 where errors never rise with it, 1 where
            they never fall, else 0.
    """

    method: Numbers
    settings: Floats
    error_trend: tuple[int, ...]

    @property
    def methods(self) -> int:
        """How many methods there are."""
        return int(self.method.max()) + 1 if len(self.method) else 0


@dataclass(frozen=True)
class Question:
    """What is asked of a choice.

    Attributes:
        name: How people call it.
        time: Which of the times counts.
        limit: The largest error that is good enough.
    """

    name: str
    time: str
    limit: float


@dataclass(frozen=True)
class Examples:
    """n instances and what each of k choices did for them.

    Attributes:
        features: (n, d) float64, finite.
        families: (n,) names; a family is never parted.
        choices: The columns.
        offered: (n, k) bool: whether the choice exists for the instance.
        ok: (n, k) bool: whether it worked.
        times: Name -> (n, k) float64, nan where unknown.
        error: (n, k) float64, nan where unknown.
        costs: (q, n, k) float64: for each question what each choice costs, at least 1.
        questions: The q questions.
    """

    features: Floats
    families: Words
    choices: Choices
    offered: Bools
    ok: Bools
    times: Mapping[str, Floats]
    error: Floats
    costs: Floats
    questions: tuple[Question, ...]

    def __len__(self) -> int:
        return len(self.features)

    def only(self, rows: npt.NDArray[np.int64] | Bools) -> Examples:
        """Some of the instances."""
        return Examples(
            self.features[rows],
            self.families[rows],
            self.choices,
            self.offered[rows],
            self.ok[rows],
            {name: values[rows] for name, values in self.times.items()},
            self.error[rows],
            self.costs[:, rows],
            self.questions,
        )

    @property
    def weights(self) -> Floats:
        """(n,) float64: every family weighs the same, all together n."""
        _, number, counts = np.unique(self.families, return_inverse=True, return_counts=True)
        weights: Floats = len(self) / (len(counts) * counts[number].astype(np.float64))
        return weights

    @property
    def digest(self) -> str:
        """SHA-256 of all that is learnt from: equal examples have equal digests."""
        sha = hashlib.sha256()
        arrays = [self.features, self.choices.method, self.choices.settings, self.offered, self.ok]
        arrays += [self.times[name] for name in sorted(self.times)] + [self.error, self.costs]
        for array in arrays:
            sha.update(str(array.shape).encode() + np.ascontiguousarray(array).tobytes())
        sha.update("\0".join(self.families.tolist()).encode())
        return sha.hexdigest()


def folds(families: Words, most: int) -> Iterator[tuple[Numbers, Numbers]]:
    """(training rows, test rows) of each of up to `most` folds; a family is in one test fold only.

    Families go, the largest first, each to the fold that is smallest so far: the same folds every time.
    """
    names, counts = np.unique(families, return_counts=True)
    order = sorted(range(len(names)), key=lambda index: (-counts[index], names[index]))
    sizes = np.zeros(min(most, len(names)), np.int64)
    fold_of = {}
    for index in order:
        fold = int(sizes.argmin())
        fold_of[names[index]] = fold
        sizes[fold] += counts[index]
    folded = np.array([fold_of[name] for name in families], np.int64)
    for index in range(len(sizes)):
        yield np.flatnonzero(folded != index), np.flatnonzero(folded == index)
