"""Measures what the thesis' orderings ask for: every set-up once, with all candidates that any needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from renderers.context import Gpu
from scenes.scene import Camera, Light, Scene
from scenes.thesis.registry import OPEN_SCENES, THESIS_SCENES
from scenes.thesis.set_ups import SetUp, set_ups
from selector.candidate import Candidate
from selector.measuring import FLICKER_STEPS, Bench, OnStep, Plan
from selector.ordering_records import Ordering
from selector.ordering_results import Halves, TrialResult
from selector.ordering_trials import Ask, Contender, Trial
from selector.truth import Shown


@dataclass(frozen=True)
class Thoroughness:
    """How carefully orderings are measured.

    Attributes:
        width: Pixels across.
        height: Pixels down.
        rounds: Timed rounds; 0 for errors and counters only.
    """

    width: int = 640
    height: int = 512
    rounds: int = 5

    def plan(self, trial: Trial) -> Plan:
        """How a trial is measured. The truth is checked against Embree, for volumes are judged as well."""
        share = 2 if trial.halved else 1
        return Plan(
            width=self.width // share,
            height=self.height // share,
            rounds=self.rounds if trial.timed else 0,
            verify=True,
            flicker_steps=FLICKER_STEPS if trial.moving else 0,
        )


def set_up_named(name: str) -> SetUp:
    """The set-up with this name."""
    return next(one for one in set_ups() if one.name == name)


def trials_of(orderings: Sequence[Ordering]) -> tuple[Ask, ...]:
    """Each trial once, with all contenders that any ordering needs; trials that share a bench in a row."""
    contenders: dict[Trial, dict[Candidate, Contender]] = {}
    for ask in (ask for ordering in orderings for ask in ordering.asks):
        of_trial = contenders.setdefault(ask.trial, {})
        for contender in ask.contenders:
            of_trial.setdefault(contender.candidate, contender)
    asks = [Ask(trial, tuple(some.values())) for trial, some in contenders.items()]
    scenes = list(THESIS_SCENES | OPEN_SCENES)
    return tuple(
        sorted(asks, key=lambda ask: (scenes.index(set_up_named(ask.trial.set_up).scene), _way(ask.trial)))
    )


def measured_trials(
    gpu: Gpu, asks: Sequence[Ask], thoroughness: Thoroughness, on_step: OnStep
) -> Iterator[tuple[Trial, TrialResult]]:
    """Each trial, as soon as it is measured.

    Raises:
        GlError: The device failed where no single candidate is to blame.
    """
    for (key, _), group in groupby(
        asks, key=lambda ask: (set_up_named(ask.trial.set_up).scene, _way(ask.trial))
    ):
        of_bench = list(group)
        staged = [set_up_named(ask.trial.set_up) for ask in of_bench]
        made = (THESIS_SCENES | OPEN_SCENES)[key]()
        lights, cameras = tuple(one.light for one in staged), tuple(one.camera for one in staged)
        scene = Scene(made.name, made.meshes, lights, cameras)
        with Bench(gpu, scene, thoroughness.plan(of_bench[0].trial)) as bench:
            for ask, set_up in zip(of_bench, staged, strict=True):
                yield ask.trial, _measured(bench, set_up, ask, on_step)


def _way(trial: Trial) -> tuple[bool, bool, bool]:
    return trial.timed, trial.halved, trial.moving


def _measured(bench: Bench, set_up: SetUp, ask: Ask, on_step: OnStep) -> TrialResult:
    halves: dict[Candidate, Halves] = {}

    def split(light: Light, camera: Camera, candidate: Candidate | None, shown: Shown) -> None:
        del light
        if candidate is not None and (found := near_and_far(camera, shown)):
            halves[candidate] = found

    candidates = [one.candidate for one in ask.contenders]
    measurement = bench.measure(set_up.light, (set_up.camera,), candidates, on_step=on_step, on_picture=split)
    return TrialResult(measurement, halves)


def near_and_far(camera: Camera, shown: Shown) -> Halves | None:
    """Where the errors lie, split at the median distance of the receivers; None where there are none."""
    domain, lit = shown.truth.domain, shown.truth.lit
    if not domain.any():
        return None
    wrong = ((shown.mask >= 0.5) != lit)[domain]
    away = shown.truth.surfaces.positions[domain] - np.asarray(camera.position)
    distance = np.linalg.norm(away, axis=1)
    near = distance <= np.median(distance)
    return Halves(float(wrong[near].mean()), float(wrong[~near].mean()) if (~near).any() else 0.0)
