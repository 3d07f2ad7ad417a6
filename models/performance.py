"""Predicts what each choice does: its time, its error, and whether it works at all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.examples import Bools, Choices, Examples, Floats, Numbers
from models.fitting import boosted
from models.leaf_masks import LeafMasks
from models.trees import Trees

ERROR, WORKS = "error", "works"
"""Targets beside the times: log(1 + error), and 1 where a choice works, else 0."""

PERCENTS = np.linspace(0.0, 100.0, 41)
"""At which the distribution of what a prediction misses is kept."""

FEWEST = 20
"""Rows from which trees are grown; fewer give their mean."""


@dataclass(frozen=True)
class Predicted:
    """What is expected of n instances under k choices.

    Attributes:
        log_times: Name -> (n, k) float64 natural logarithms.
        log_error: (n, k) float64 log(1 + error).
        works: (n, k) float64 probability in [0, 1].
    """

    log_times: Mapping[str, Floats]
    log_error: Floats
    works: Floats

    def target(self, name: str) -> Floats:
        """(n, k) one of them by its target's name."""
        return {ERROR: self.log_error, WORKS: self.works, **self.log_times}[name]

    def only(self, rows: Numbers) -> Predicted:
        """Some of the instances."""
        times = {name: values[rows] for name, values in self.log_times.items()}
        return Predicted(times, self.log_error[rows], self.works[rows])


@dataclass(frozen=True)
class PerformanceModel:
    """One set of trees for each method and target: logarithms, since costs are ratios.

    Attributes:
        choices: What is chosen from.
        trees: Target -> one for each method.
    """

    choices: Choices
    trees: Mapping[str, tuple[Trees, ...]]

    @classmethod
    def fit(cls, examples: Examples) -> PerformanceModel:
        """Learns from what was tried; every family weighs the same."""
        choices = examples.choices
        wanted = _targets(examples)
        trees = {
            name: tuple(
                _fitted(examples, values, known, method, _trends(choices, name))
                for method in range(choices.methods)
            )
            for name, (values, known) in wanted.items()
        }
        return cls(choices, trees)

    def predict(self, features: Floats, time: str | None = None) -> Predicted:
        """For (n, d) float64 features, what every choice would do; of the times all, or one."""
        wanted = (name for name in self.trees if time is None or name in (ERROR, WORKS, time))
        found = {name: self._predicted(name, features) for name in wanted}
        works = np.clip(found.pop(WORKS), 0.0, 1.0)
        return Predicted(log_error=np.maximum(found.pop(ERROR), 0.0), works=works, log_times=found)

    def _predicted(self, name: str, features: Floats) -> Floats:
        found = np.zeros((len(features), len(self.choices.method)))
        for method, trees in enumerate(self.trees[name]):
            columns = np.flatnonzero(self.choices.method == method)
            quick = self._masks(name, method, features.shape[1])
            if quick is not None:
                found[:, columns] = quick.predict(features, self.choices.settings[columns])
            else:
                rows, _ = _rows(features, self.choices, columns)
                found[:, columns] = trees.predict(rows).reshape(len(features), len(columns))
        return found

    def _masks(self, name: str, method: int, width: int) -> LeafMasks | None:
        """The trees as masks of leaves, made when they are first asked; None where they have to be walked."""
        if (name, method) not in self._made:
            self._made[name, method] = LeafMasks.of(self.trees[name][method], width)
        return self._made[name, method]

    @cached_property
    def _made(self) -> dict[tuple[str, int], LeafMasks | None]:
        return {}


def residuals(examples: Examples, predicted: Predicted) -> dict[str, Floats]:
    """Target -> (methods, 41) float64: percentiles of what predictions missed, true minus predicted.

    Every family weighs the same, so an interval holds for a new family, not for more of a large one.
    """
    found = {}
    for name, (values, known) in _targets(examples).items():
        missed = values - predicted.target(name)
        weights = np.broadcast_to(examples.weights[:, None], missed.shape)
        of_method = [
            _weighted_percentiles(missed[inside], weights[inside])
            for method in range(examples.choices.methods)
            for inside in [known & (examples.choices.method == method)]
        ]
        found[name] = np.stack(of_method)
    return found


def _targets(examples: Examples) -> dict[str, tuple[Floats, Bools]]:
    """Target -> (n, k) values, and where they are known."""
    ok, error = examples.ok, examples.error
    with np.errstate(invalid="ignore", divide="ignore"):
        found = {name: (np.log(times), ok & (times > 0)) for name, times in examples.times.items()}
        found[ERROR] = np.log1p(error), ok & np.isfinite(error)
    found[WORKS] = ok.astype(np.float64), examples.offered
    return {name: (np.where(known, values, 0.0), known) for name, (values, known) in found.items()}


def _trends(choices: Choices, target: str) -> tuple[int, ...]:
    return choices.error_trend if target == ERROR else (0,) * len(choices.error_trend)


def _rows(features: Floats, choices: Choices, columns: Numbers) -> tuple[Floats, int]:
    """(n * c, d + m) features beside settings, instance by instance; and d."""
    of_instance = np.repeat(features, len(columns), axis=0)
    of_choice = np.tile(choices.settings[columns], (len(features), 1))
    return np.hstack([of_instance, of_choice]), features.shape[1]


def _fitted(examples: Examples, values: Floats, known: Bools, method: int, trends: tuple[int, ...]) -> Trees:
    columns = np.flatnonzero(examples.choices.method == method)
    rows, width = _rows(examples.features, examples.choices, columns)
    inside = known[:, columns].ravel()
    target = values[:, columns].ravel()[inside]
    weights = np.repeat(examples.weights, len(columns))[inside]
    if len(target) < FEWEST:
        mean = float(np.average(target, weights=weights)) if len(target) else 0.0
        return _constant(mean)
    return boosted(rows[inside], target, weights, (0,) * width + trends)


def _constant(value: float) -> Trees:
    nothing = np.zeros(0, np.int32)
    return Trees(
        nothing, nothing, np.zeros(0), nothing, nothing, np.zeros((0, 1)), np.array([value], np.float64)
    )


def _weighted_percentiles(values: Floats, weights: Floats) -> Floats:
    """(41,) percentiles; zeros where there are no values."""
    if not len(values):
        return np.zeros(len(PERCENTS))
    order = np.argsort(values, kind="stable")
    shares = np.cumsum(weights[order])
    places = np.searchsorted(shares, PERCENTS / 100 * shares[-1])
    found: Floats = values[order][np.minimum(places, len(values) - 1)]
    return found
