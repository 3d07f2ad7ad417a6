"""What was measured for the thesis' orderings, and what faster, equal and larger mean there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from statistics import median

from scenes.scene import Mobility
from selector.candidate import Candidate
from selector.measurement import LightMeasurement, Measurement, Sample, Status, ViewRun
from selector.ordering_trials import Contender, Trial

MARGIN = 1.05
"""Ratio up to which two figures are a tie."""
ABOUT_EQUAL = 1.25
"""Ratio up to which two bars, or two edges, are about equal to the eye."""
CLEARLY = 1.5
"""Ratio from which on a figure is clearly larger, not only measurably."""


class UnmeasuredError(Exception):
    """A figure that an ordering needs is missing; the message says which, and why."""


class Order(Enum):
    """How one figure compares with another."""

    LESS = -1
    TIE = 0
    MORE = 1


@dataclass(frozen=True)
class Halves:
    """Wrong pixels of the nearer and of the farther half of the receivers, as shares of the half.

    Attributes:
        near: Not farther from the camera than the median receiver.
        far: The others.
    """

    near: float
    far: float


@dataclass(frozen=True)
class TrialResult:
    """All that was measured in one trial.

    Attributes:
        measurement: Every candidate.
        halves: Errors near and far, of every candidate that drew a mask.
    """

    measurement: LightMeasurement
    halves: Mapping[Candidate, Halves] = field(default_factory=dict)


@dataclass(frozen=True)
class Run:
    """One contender in one trial."""

    name: str
    where: str
    view: ViewRun
    halves: Halves | None

    @property
    def samples(self) -> tuple[Sample, ...]:
        """Timed frames in which the light moves, as everything does in the thesis; by round."""
        return tuple(one for one in self.view.samples if one.mobility is Mobility.DYNAMIC)

    @property
    def times_ms(self) -> tuple[float, ...]:
        """The technique's own passes, by round."""
        return tuple(one.shadow_ms for one in self.samples)

    @property
    def ms(self) -> float:
        """The median over rounds."""
        return median(self.times_ms)

    def stage_times_ms(self, *stages: str) -> tuple[float, ...]:
        """The sum of some stages, by round."""
        return tuple(sum(one.stages_ms.get(stage, 0.0) for stage in stages) for one in self.samples)

    def stage_ms(self, *stages: str) -> float:
        """The median over rounds of the sum of some stages."""
        return median(self.stage_times_ms(*stages))

    def counter(self, name: str) -> int:
        """A work counter; 0 where the technique has none of that name."""
        return self.view.counters.get(name, 0)

    def error(self, name: str) -> float:
        """An error figure, or `flicker`.

        Raises:
            UnmeasuredError: The view has none.
        """
        value = self.view.flicker if name == "flicker" else getattr(self.view.figures, name, None)
        if value is None:
            raise UnmeasuredError(f"{self.where}: {self.name} has no {name.replace('_', ' ')} in this view.")
        return float(value)


class Results:
    """The trials that were measured."""

    def __init__(self, trials: Mapping[Trial, TrialResult]) -> None:
        self.trials = dict(trials)

    @property
    def timed(self) -> bool:
        """Whether anything was timed."""
        return any(any(result.measurement.canary_ms) for result in self.trials.values())

    def has(self, trial: Trial) -> bool:
        """Whether this trial was measured."""
        return trial in self.trials

    def measurement(self, trial: Trial, contender: Contender) -> Measurement | None:
        """All that became of one contender in one trial; None where it was not asked for."""
        result = self.trials.get(trial)
        found = result.measurement.measurements if result else ()
        return next((one for one in found if one.candidate == contender.candidate), None)

    def run(self, trial: Trial, contender: Contender) -> Run:
        """What was measured of one contender in one trial.

        Raises:
            UnmeasuredError: Nothing, or it was refused or failed.
        """
        one = self.measurement(trial, contender)
        if one is None:
            raise UnmeasuredError(f"{trial.set_up}: {contender.name} was not measured.")
        if one.status is not Status.OK or not one.views:
            raise UnmeasuredError(f"{trial.set_up}: {contender.name}: {one.status}: {one.reason}.")
        halves = self.trials[trial].halves.get(contender.candidate)
        return Run(contender.name, trial.set_up, one.views[0], halves)


def compared(first: Sequence[float], second: Sequence[float]) -> Order:
    """How the first figures, one for each round, compare with the second.

    LESS or MORE where they differ by more than `MARGIN` in more than half of the rounds, a TIE otherwise.
    """
    assert first
    less = sum(one * MARGIN < other for one, other in zip(first, second, strict=True))
    more = sum(one > other * MARGIN for one, other in zip(first, second, strict=True))
    if 2 * less > len(first):
        return Order.LESS
    return Order.MORE if 2 * more > len(first) else Order.TIE


def faster(first: Run, second: Run) -> bool:
    """Whether the first contender takes less time than the second, by more than a tie."""
    return compared(first.times_ms, second.times_ms) is Order.LESS


def less(first: float, second: float, margin: float = MARGIN) -> bool:
    """Whether an exact figure is smaller than another by more than a tie."""
    return first * margin < second
