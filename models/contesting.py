"""Two models on the same folds and the same examples: one learnt from old examples, one from new."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.examples import Examples, Floats, Numbers, Question, Words, folds
from models.selector_model import SelectorModel, chosen

RESAMPLES = 2000
SEED = 1
ABSENT = -1
"""Stands for a choice that the new examples do not have."""

OnFold = Callable[[int, int], None]


@dataclass(frozen=True)
class Contest:
    """What each would have chosen for n instances that neither was learnt from, and what that costs.

    Attributes:
        questions: The q questions.
        families: (n,) names.
        champion: (q, n) cost of the old model's choices.
        challenger: (q, n) cost of the new model's.
        best: (q, n) least possible cost.
    """

    questions: tuple[Question, ...]
    families: Words
    champion: Floats
    challenger: Floats
    best: Floats

    def by_family(self, costs: Floats) -> Floats:
        """(q, f) mean of (q, n) costs over each family, in the order of names."""
        _, number = np.unique(self.families, return_inverse=True)
        sizes = np.bincount(number)
        means: Floats = np.stack([np.bincount(number, row) / sizes for row in costs])
        return means

    def difference(self, question: int | None = None) -> tuple[float, float, float]:
        """Mean cost of the challenger minus the champion's, and where it lies in 95 of 100 draws of families.

        Both are drawn together: a hard family is hard for both. Families weigh alike, as do questions.
        """
        per_question = self.by_family(self.challenger - self.champion)
        means = per_question.mean(axis=0) if question is None else per_question[question]
        drawn = np.random.default_rng(SEED).integers(0, len(means), (RESAMPLES, len(means)))
        low, high = np.percentile(means[drawn].mean(axis=1), [2.5, 97.5])
        return float(means.mean()), float(low), float(high)


def contestable(new: Examples, count: int, old: Examples | None = None) -> bool:
    """Whether every fold leaves two families or more to learn from, of new and of old examples."""
    for train, test in folds(new.families, count):
        left = [new.families[train]]
        if old is not None:
            left.append(old.families[~np.isin(old.families, new.families[test])])
        if any(len(np.unique(families)) < 2 for families in left):
            return False
    return True


def contest(
    old: Examples, new: Examples, columns: Numbers, miss: float, count: int, on_fold: OnFold | None = None
) -> Contest:
    """Learns from either, without the families that it is then asked about, and asks both about the new.

    Args:
        old: What the champion was learnt from.
        new: What the challenger is learnt from, and what both are judged by.
        columns: (k_old,) which choice of the new examples each choice of the old ones is, or `ABSENT`.
        miss: What a miss costs.
        count: Folds.
        on_fold: Hears of each before it begins.
    """
    parts = list(folds(new.families, count))
    costs = np.zeros((2, len(new.questions), len(new)))
    for number, (train, test) in enumerate(parts):
        if on_fold:
            on_fold(number, len(parts))
        learnt = new.only(train)
        unseen = ~np.isin(old.families, np.unique(new.families[test]))
        champion = SelectorModel.fit(old.only(unseen), miss)
        challenger = SelectorModel.fit(learnt, miss)
        held = new.only(test)
        costs[0][:, test] = costs_of(champion, held, columns, miss)
        costs[1][:, test] = costs_of(challenger, held, np.arange(new.offered.shape[1]), miss)
    return Contest(new.questions, new.families, costs[0], costs[1], _best(new, miss))


def contest_as_is(
    champion: SelectorModel,
    new: Examples,
    columns: Numbers,
    miss: float,
    count: int,
    on_fold: OnFold | None = None,
) -> Contest:
    """The same where nobody knows what the champion was learnt from: it is asked as it is.

    Where it has seen the families, that favours it.
    """
    parts = list(folds(new.families, count))
    challenger = np.zeros((len(new.questions), len(new)))
    for number, (train, test) in enumerate(parts):
        if on_fold:
            on_fold(number, len(parts))
        model = SelectorModel.fit(new.only(train), miss)
        challenger[:, test] = costs_of(model, new.only(test), np.arange(new.offered.shape[1]), miss)
    return Contest(
        new.questions, new.families, costs_of(champion, new, columns, miss), challenger, _best(new, miss)
    )


def costs_of(model: SelectorModel, held: Examples, columns: Numbers, miss: float) -> Floats:
    """(q, n) what a model's choices cost.

    Args:
        model: The model.
        held: What it is asked about.
        columns: (k,) which choice of the examples each choice of the model is, or `ABSENT`.
        miss: What a miss, and a choice that is not there, cost.
    """
    there = columns != ABSENT
    offered = np.zeros((len(held), len(columns)), bool)
    offered[:, there] = held.offered[:, columns[there]]
    found = np.zeros((len(held.questions), len(held)))
    rows = np.arange(len(held))
    for index, question in enumerate(held.questions):
        costs = model.costs(held.features, question)
        place = columns[chosen(costs, offered, model.single_for(question))]
        known = (place != ABSENT) & held.offered[rows, place]
        found[index] = np.where(known, held.costs[index][rows, place], miss)
    return found


def _best(examples: Examples, miss: float) -> Floats:
    best: Floats = np.where(examples.offered, examples.costs, miss).min(axis=2)
    return best
