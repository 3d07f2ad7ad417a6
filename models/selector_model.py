"""The model that chooses: learnt in nested folds by family, so that it knows how far to trust itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.examples import Choices, Examples, Floats, Numbers, Question, folds
from models.expecting import expected_costs
from models.fitting import cost_forest
from models.performance import PerformanceModel, Predicted, residuals
from models.trees import Trees

SINGLE, PERFORMANCE, FOREST = "single best", "performance model", "cost forest"
METHODS = (SINGLE, PERFORMANCE, FOREST)
INNER_FOLDS = 4


@dataclass(frozen=True)
class SelectorModel:
    """Everything that is needed to choose.

    Attributes:
        choices: The columns.
        questions: What may be asked.
        miss: What a miss costs.
        performance: Predicts times and errors.
        missed: Target -> (methods, 41) percentiles of what it missed on families it had not seen.
        forest: Predicts the costs of all choices, for features and the question's numbers.
        single: (q,) the choice that is best for all instances, for each question.
        method: Which of `METHODS` chooses: the one that did best on families it had not seen.
        inner_costs: Its mean cost there, and that of the others.
    """

    choices: Choices
    questions: tuple[Question, ...]
    miss: float
    performance: PerformanceModel
    missed: Mapping[str, Floats]
    forest: Trees
    single: Numbers
    method: str
    inner_costs: Mapping[str, float]

    @classmethod
    def fit(cls, examples: Examples, miss: float, inner_folds: int = INNER_FOLDS) -> SelectorModel:
        """Learns from examples of at least two families."""
        assert len(np.unique(examples.families)) >= 2, "with one family there is none to be tested on"
        missed, inner = _inner(examples, miss, inner_folds)
        best = min(METHODS, key=lambda name: inner[name])
        return cls(
            examples.choices,
            examples.questions,
            miss,
            PerformanceModel.fit(examples),
            missed,
            _forest(examples, miss),
            single_best(examples, miss),
            best,
            inner,
        )

    def costs(
        self,
        features: Floats,
        asked: Question,
        method: str | None = None,
        predicted: Predicted | None = None,
    ) -> Floats:
        """(n, k) float64 expected costs, the lowest being the answer; by `method`, if one is given.

        Limits between those learnt from are fine; the single best choice is that of the nearest one.

        Args:
            features: (n, d) of each instance.
            asked: The policy.
            method: Another than the model's own.
            predicted: What the performance model says of the same features, where that is known already.
        """
        by = method or self.method
        if by == FOREST:
            return self.forest.predict(np.hstack([features, _numbers(asked, len(features), self.questions)]))
        if by == PERFORMANCE:
            predicted = predicted or self.performance.predict(features, asked.time)
            return expected_costs(predicted, self.missed, self.choices, asked, self.miss)
        single = self.single_for(asked)
        return _single_costs(len(features), len(self.choices.method), single, self.miss)

    def single_for(self, asked: Question) -> int:
        """The one choice that was best for all that was learnt from, under the nearest known question."""
        return int(self.single[self._nearest(asked)])

    def _nearest(self, asked: Question) -> int:
        """The question about the same time whose limit is nearest, in ratio."""

        def away(index: int) -> tuple[bool, float]:
            known = self.questions[index]
            ratio = np.log(max(known.limit, 1e-6)) - np.log(max(asked.limit, 1e-6))
            return known.time != asked.time, abs(float(ratio))

        return min(range(len(self.questions)), key=away)


def single_best(examples: Examples, miss: float) -> Numbers:
    """(q,) the choice with the lowest mean cost for each question; what was not offered costs a miss."""
    costs = np.where(examples.offered, examples.costs, miss)
    means = np.average(costs, axis=1, weights=examples.weights)
    best: Numbers = means.argmin(axis=1)
    return best


def chosen(costs: Floats, offered: np.ndarray, single: int) -> Numbers:
    """(n,) the cheapest of what is offered; the single best one where nothing is."""
    masked = np.where(offered, costs, np.inf)
    found: Numbers = np.where(offered.any(axis=1), masked.argmin(axis=1), single)
    return found


def _inner(examples: Examples, miss: float, count: int) -> tuple[dict[str, Floats], dict[str, float]]:
    """What the performance model misses on families it has not seen, and what each method costs there."""
    parts = list(folds(examples.families, count))
    predicted = _unseen([PerformanceModel.fit(examples.only(train)) for train, _ in parts], parts, examples)
    missed = residuals(examples, predicted)
    totals = dict.fromkeys(METHODS, 0.0)
    for train, test in parts:
        learnt, held = examples.only(train), examples.only(test)
        forest, single = _forest(learnt, miss), single_best(learnt, miss)
        for index, question in enumerate(examples.questions):
            numbers = _numbers(question, len(held), examples.questions)
            ways = {
                PERFORMANCE: expected_costs(predicted.only(test), missed, examples.choices, question, miss),
                FOREST: forest.predict(np.hstack([held.features, numbers])),
                SINGLE: _single_costs(len(held), len(held.choices.method), int(single[index]), miss),
            }
            for name, costs in ways.items():
                picked = chosen(costs, held.offered, int(single[index]))
                true = np.where(held.offered, held.costs[index], miss)[np.arange(len(held)), picked]
                totals[name] += float((true * examples.weights[test]).sum())
    asked = len(examples) * len(examples.questions)
    return missed, {name: total / asked for name, total in totals.items()}


def _unseen(
    models: Sequence[PerformanceModel], parts: Sequence[tuple[Numbers, Numbers]], examples: Examples
) -> Predicted:
    """Predictions for every instance by the model that has not seen its family."""
    shape = examples.offered.shape
    whole = Predicted({name: np.zeros(shape) for name in examples.times}, np.zeros(shape), np.zeros(shape))
    for model, (_, test) in zip(models, parts, strict=True):
        found = model.predict(examples.features[test])
        whole.log_error[test], whole.works[test] = found.log_error, found.works
        for name, values in whole.log_times.items():
            values[test] = found.log_times[name]
    return whole


def _single_costs(rows: int, choices: int, single: int, miss: float) -> Floats:
    costs = np.full((rows, choices), miss)
    costs[:, single] = 1.0
    return costs


def _forest(examples: Examples, miss: float) -> Trees:
    """Learns the costs of all questions at once, the question being two numbers among the inputs."""
    count = len(examples.questions)
    rows = [
        np.hstack([examples.features, _numbers(question, len(examples), examples.questions)])
        for question in examples.questions
    ]
    costs = np.where(examples.offered, np.minimum(examples.costs, miss), miss)
    return cost_forest(np.concatenate(rows), np.concatenate(list(costs)), np.tile(examples.weights, count))


def _numbers(question: Question, rows: int, questions: tuple[Question, ...]) -> Floats:
    """(n, 2) float64: logarithm of the limit, and which time counts."""
    times = sorted({one.time for one in questions})
    numbers: Floats = np.tile([np.log(max(question.limit, 1e-6)), times.index(question.time)], (rows, 1))
    return numbers.astype(np.float32).astype(np.float64)
