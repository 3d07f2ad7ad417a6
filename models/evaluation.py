"""How much of what can be gained a model gains, on families that it has never seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from models.examples import Examples, Floats, Numbers, folds
from models.selector_model import METHODS, SelectorModel, chosen, single_best

OUTER_FOLDS = 10
RESAMPLES = 1000
SEED = 1
WORTH_CLAIMING = 1.1
"""With the single best this close to the best of all, a share of what is left is noise."""
NEGLIGIBLE = 1e-9

OnFold = Callable[[int, int], None]


@dataclass(frozen=True)
class Outcome:
    """What was chosen for n instances under one question, none of them learnt from.

    Attributes:
        picked: Method of `METHODS`, or "model" for the one that the model settled on -> (n,) choice.
        costs: The same, and "best" -> (n,) float64 cost.
        fold: (n,) which fold each was tested in.
    """

    picked: Mapping[str, Numbers]
    costs: Mapping[str, Floats]
    fold: Numbers


MODEL, BEST = "model", "best"


@dataclass(frozen=True)
class Gap:
    """Closed gap = (single best - model) / (single best - best): 1 is perfect, 0 no better than one for all.

    Attributes:
        closed: The gap; None where there is none to close.
        low: Where it is not below in 95 of 100 draws of families; None likewise.
        high: Where it is not above.
        model: Mean cost of the model.
        single: Mean cost of the single best choice, chosen on the training folds.
        best: Mean cost of the best choice of each instance.
        instances: How many.
    """

    closed: float | None
    low: float | None
    high: float | None
    model: float
    single: float
    best: float
    instances: int

    @property
    def claimed(self) -> bool:
        """Whether there is enough to gain for the share to mean anything."""
        return self.closed is not None and self.single >= WORTH_CLAIMING * self.best


@dataclass(frozen=True)
class Verdict:
    """How a model fares under one question.

    Attributes:
        question: Its name, and the time that counts.
        gap: Over everything.
        by_family: Family -> its own.
        methods: Way of choosing -> closed gap of each by itself; None where there is none to close.
        accuracy: Share of instances for which it picks one of the best.
        misses: Share for which its pick misses although another would not.
        worse: Share for which its pick costs more than the single best.
        regret_time: Mean time over that of the best choice, where both keep the limit.
        regret_error: Mean error over the limit, or over the least possible where none keeps it.
        wins: (k,) how often each choice is the best.
        picks: (k,) how often the model picks each.
    """

    question: str
    time: str
    gap: Gap
    by_family: Mapping[str, Gap]
    methods: Mapping[str, float | None]
    accuracy: float
    misses: float
    worse: float
    regret_time: float
    regret_error: float
    wins: Numbers
    picks: Numbers


@dataclass(frozen=True)
class Winners:
    """Who wins under one question, and what there is to gain; nothing is learnt for it.

    Attributes:
        question: Its name.
        time: The time that counts.
        wins: (k,) how often each choice is the best.
        single: The one choice that costs least for all.
        single_over_best: Its mean cost over that of the best choices, families weighing alike.
    """

    question: str
    time: str
    wins: Numbers
    single: int
    single_over_best: float


def winners(examples: Examples, miss: float) -> tuple[Winners, ...]:
    """Who wins, for each question."""
    singles = single_best(examples, miss)
    found = []
    for index, question in enumerate(examples.questions):
        costs = np.where(examples.offered, examples.costs[index], miss)
        means = np.average(costs, axis=0, weights=examples.weights)
        best = float(np.average(costs.min(axis=1), weights=examples.weights))
        wins = np.bincount(costs.argmin(axis=1), minlength=costs.shape[1])
        single = int(singles[index])
        found.append(Winners(question.name, question.time, wins, single, float(means[single]) / best))
    return tuple(found)


def evaluate(
    examples: Examples, miss: float, count: int = OUTER_FOLDS, on_fold: OnFold | None = None
) -> tuple[Verdict, ...]:
    """One verdict for each question, by nested folds: how to choose is found without the test families."""
    outcomes = _outcomes(examples, miss, count, on_fold)
    return tuple(_verdict(examples, index, outcome, miss) for index, outcome in enumerate(outcomes))


def evaluate_as_is(
    model: SelectorModel, examples: Examples, columns: Numbers, miss: float
) -> tuple[Verdict, ...]:
    """One verdict for each question on a finished model, and on its own single best choice.

    Args:
        model: It must not have learnt from the examples.
        examples: What it is asked about; all its choices are among theirs.
        columns: (k,) which choice of the examples each choice of the model is.
        miss: What a miss costs.
    """
    offered, names = examples.offered[:, columns], (*METHODS, MODEL)
    rows = np.arange(len(examples))
    verdicts = []
    for index, question in enumerate(examples.questions):
        single = model.single_for(question)
        picked = {}
        for name in names:
            costs = model.costs(examples.features, question, model.method if name == MODEL else name)
            picked[name] = columns[chosen(costs, offered, single)]
        true = np.where(examples.offered, examples.costs[index], miss)
        costs_of = {name: true[rows, picked[name]] for name in names} | {BEST: true.min(axis=1)}
        outcome = Outcome(picked, costs_of, np.zeros(len(examples), np.int64))
        verdicts.append(_verdict(examples, index, outcome, miss))
    return tuple(verdicts)


def _outcomes(examples: Examples, miss: float, count: int, on_fold: OnFold | None) -> list[Outcome]:
    size, asked = len(examples), len(examples.questions)
    names = (*METHODS, MODEL)
    picked = {name: np.zeros((asked, size), np.int64) for name in names}
    fold = np.zeros(size, np.int64)
    parts = list(folds(examples.families, count))
    for number, (train, test) in enumerate(parts):
        if on_fold:
            on_fold(number, len(parts))
        learnt, held = examples.only(train), examples.only(test)
        model = SelectorModel.fit(learnt, miss)
        single = single_best(learnt, miss)
        fold[test] = number
        for index in range(asked):
            for name in names:
                costs = model.costs(
                    held.features, examples.questions[index], model.method if name == MODEL else name
                )
                picked[name][index, test] = chosen(costs, held.offered, int(single[index]))
    true = np.where(examples.offered, examples.costs, miss)
    rows = np.arange(size)
    return [
        Outcome(
            {name: picked[name][index] for name in names},
            {name: true[index][rows, picked[name][index]] for name in names}
            | {BEST: true[index].min(axis=1)},
            fold,
        )
        for index in range(asked)
    ]


def closed_gap(model: Floats, single: Floats, best: Floats, families: np.ndarray) -> Gap:
    """The gap over (n,) costs each, families weighing alike, with an interval by drawing families anew."""
    names, number = np.unique(families, return_inverse=True)
    means = np.stack([_by_family(costs, number, len(names)) for costs in (model, single, best)])
    drawn = np.random.default_rng(SEED).integers(0, len(names), (RESAMPLES, len(names)))
    resampled = means[:, drawn].mean(axis=2)
    room = resampled[1] - resampled[2]
    gaps = (resampled[1] - resampled[0])[room > NEGLIGIBLE] / room[room > NEGLIGIBLE]
    of_all = means.mean(axis=1)
    left = of_all[1] - of_all[2]
    closed = float((of_all[1] - of_all[0]) / left) if left > NEGLIGIBLE else None
    low, high = (
        (float(np.percentile(gaps, percent)) for percent in (2.5, 97.5)) if len(gaps) else (None, None)
    )
    if closed is None:
        low = high = None
    model_mean, single_mean, best_mean = (float(mean) for mean in of_all)
    return Gap(closed, low, high, model_mean, single_mean, best_mean, len(model))


def _verdict(examples: Examples, index: int, outcome: Outcome, miss: float) -> Verdict:
    question, costs = examples.questions[index], outcome.costs
    gaps = {
        name: closed_gap(costs[name], costs[METHODS[0]], costs[BEST], examples.families)
        for name in (MODEL, *METHODS[1:])
    }
    best = costs[BEST]
    by_family = {}
    for name in np.unique(examples.families):
        inside = examples.families == name
        ours, single, least_cost = (costs[of][inside] for of in (MODEL, METHODS[0], BEST))
        by_family[str(name)] = closed_gap(ours, single, least_cost, examples.families[inside])
    rows, picked = np.arange(len(examples)), outcome.picked[MODEL]
    true = np.where(examples.offered, examples.costs[index], miss)
    winner = true.argmin(axis=1)
    time, error = examples.times[question.time], examples.error
    weights = examples.weights / len(examples)
    kept = (costs[MODEL] < miss) & examples.ok[rows, picked] & (error[rows, picked] <= question.limit)
    late = np.where(kept, time[rows, picked] - time[rows, winner], 0.0)
    least = np.maximum(error[rows, winner], question.limit)
    over = np.where(examples.ok[rows, picked], np.maximum(error[rows, picked] - least, 0.0), 0.0)
    count = len(examples.choices.method)
    return Verdict(
        question.name,
        question.time,
        gaps[MODEL],
        by_family,
        {name: gaps[name].closed for name in METHODS[1:]},
        accuracy=float(weights @ (costs[MODEL] <= best + NEGLIGIBLE)),
        misses=float(weights @ ((costs[MODEL] >= miss) & (best < miss))),
        worse=float(weights @ (costs[MODEL] > costs[METHODS[0]] + NEGLIGIBLE)),
        regret_time=float(np.average(late, weights=weights)) if len(late) else 0.0,
        regret_error=float(np.average(np.nan_to_num(over), weights=weights)),
        wins=np.bincount(winner, minlength=count),
        picks=np.bincount(picked, minlength=count),
    )


def _by_family(costs: Floats, number: Numbers, count: int) -> Floats:
    sums = np.bincount(number, costs, count)
    means: Floats = sums / np.bincount(number, minlength=count)
    return means
