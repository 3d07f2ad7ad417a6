"""Renders a light with every candidate, times them in interleaved rounds and compares them with the truth."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from renderers.canary import Canary
from renderers.clock import StageClock, truthful_clock
from renderers.context import Gpu
from renderers.flicker import Sight, co_visible
from renderers.frame import Frame
from renderers.owner import Owner
from renderers.world import World
from scenes.camera_path import camera_path
from scenes.scene import Camera, Light, Scene
from selector.candidate import Candidate
from selector.measurement import LightMeasurement, Status
from selector.runner import Runner
from selector.truth import Oracle, Reference, Shown

OnPicture = Callable[[Light, Camera, Candidate | None, Shown], None]
OnStep = Callable[[str], None]

PASSES_ALIVE_BYTES = 4 << 30
FLICKER_STEPS = 7
"""Enough where flicker is asked for: eight frames, half a pixel apart."""


def _silently(what: str) -> None:
    del what


@dataclass(frozen=True)
class Plan:
    """How carefully to measure.

    Attributes:
        width: Pixels across.
        height: Pixels down.
        rounds: Timed rounds; each runs all candidates in shuffled order.
        timeout_s: A frame that takes longer is not repeated.
        verify: Whether to check the truth itself against Embree.
        seed: Of the shuffling.
        flicker_steps: Steps of the camera move over which flicker is measured in each view; 0 for none.
    """

    width: int = 640
    height: int = 360
    rounds: int = 3
    timeout_s: float = 4.0
    verify: bool = False
    seed: int = 1
    flicker_steps: int = 0

    def steps(self, views: int, candidates: int) -> int:
        """How often `measure` calls `on_step` for one light, however many passes fit into memory together."""
        return views * candidates * (1 + self.rounds + self.flicker_steps)


class Bench(Owner):
    """A scene on a device, ready to measure its lights. A context manager that gives GPU memory back.

    Raises:
        GlError: The device cannot hold the scene.
    """

    def __init__(self, gpu: Gpu, scene: Scene, plan: Plan) -> None:
        self._gpu, self._scene, self._plan = gpu, scene, plan
        self._clock_kind = truthful_clock(gpu)
        self._silent = StageClock(gpu, self._clock_kind, staged=False)
        with gpu.guard(scene.name):
            self._world = World.of(gpu, scene)
            self._frame = Frame(self._world, plan.width, plan.height)
            self._canary = Canary(gpu, self._clock_kind)
        self._oracle = Oracle(self._frame, self._silent, plan.timeout_s)

    def release(self) -> None:
        """Give the GPU memory back."""
        self._frame.release()
        self._canary.release()
        self._world.release()

    def measure(
        self,
        light: Light,
        cameras: Sequence[Camera],
        candidates: Sequence[Candidate],
        *,
        on_step: OnStep = _silently,
        on_picture: OnPicture | None = None,
    ) -> LightMeasurement:
        """Times, counters and error figures of every candidate for `light`, over all `cameras`.

        Args:
            light: One of the scene's lights.
            cameras: The views it is judged over.
            candidates: What is measured.
            on_step: Called before each step, with what comes next.
            on_picture: Called with what is seen of the truth (no candidate) and of each candidate.

        Raises:
            GlError: The device failed where no single candidate is to blame.
        """
        runners = [Runner(candidate, self._frame) for candidate in candidates]
        canaries: list[tuple[float, ...]] = []
        verified: list[float] = []
        with ExitStack() as alive:
            self._frame.shine(light)
            self._oracle.prepare(light, alive)
            for batch in self._batches(runners, light):
                for camera in cameras:
                    disagreement = self._judge(batch, light, camera, on_step, on_picture)
                    verified += [disagreement] if disagreement is not None else []
                    canaries.append(self._rounds(batch, light, camera, on_step))
                    if self._plan.flicker_steps:
                        self._film(batch, light, camera, on_step)
        return LightMeasurement(
            light=light,
            cameras=tuple(camera.name for camera in cameras),
            width=self._plan.width,
            height=self._plan.height,
            measurements=tuple(runner.result() for runner in runners),
            device=self._gpu.device,
            clock=self._clock_kind,
            canary_ms=tuple(canaries),
            verified_wrong_share=max(verified, default=None),
        )

    def _batches(self, runners: Sequence[Runner], light: Light) -> Iterator[list[Runner]]:
        """Runners whose passes fit into memory together, prepared; each batch is freed before the next."""
        waiting = list(runners)
        while waiting:
            with ExitStack() as alive:
                batch: list[Runner] = []
                while waiting and sum(runner.memory_bytes for runner in batch) < PASSES_ALIVE_BYTES:
                    batch.append(waiting.pop(0))
                    batch[-1].prepare(light, self._scene, alive)
                yield batch
                for runner in batch:
                    runner.release()

    def _judge(
        self,
        batch: Sequence[Runner],
        light: Light,
        camera: Camera,
        on_step: OnStep,
        on_picture: OnPicture | None,
    ) -> float | None:
        """Compare each candidate with the truth; if asked, the share in which the truth is in doubt."""
        reference = self._oracle.reference(light, camera)
        disagreement = self._oracle.disagreement(light, reference) if self._plan.verify else None
        if on_picture:
            on_picture(light, camera, None, reference.shown())
        for runner in batch:
            on_step(f"{light.name}: {runner.candidate.label}, {camera.name}")
            if runner.status is not Status.OK:
                continue
            shown = runner.judge(light, camera, reference, self._silent, self._plan.timeout_s)
            if on_picture and shown is not None:
                on_picture(light, camera, runner.candidate, shown)
        return disagreement

    def _rounds(
        self, batch: Sequence[Runner], light: Light, camera: Camera, on_step: OnStep
    ) -> tuple[float, ...]:
        """Time the candidates in shuffled order; the canary's milliseconds at the start of each round."""
        order = random.Random(self._plan.seed)  # noqa: S311  shuffling needs no secrecy
        canaries = []
        for index in range(self._plan.rounds):
            canaries.append(self._canary.sing())
            shuffled = list(batch)
            order.shuffle(shuffled)
            for runner in shuffled:
                on_step(f"{light.name}: round {index + 1} of {self._plan.rounds}, {camera.name}")
                if runner.status is Status.OK:
                    runner.time(light, index, self._clock_kind)
        for runner in batch:
            runner.close_view()
        return tuple(canaries)

    def _film(self, batch: Sequence[Runner], light: Light, camera: Camera, on_step: OnStep) -> None:
        """Move the camera a little, frame by frame, and see whose errors flicker."""
        truth = self._oracle.reference(light, camera)
        sight = self._sight(truth)
        for last, moved in pairwise(self._path(camera, truth)):
            truth = self._oracle.reference(light, moved)
            before, sight = sight, self._sight(truth)
            seen = co_visible(sight, before)
            for runner in batch:
                on_step(f"{light.name}: {runner.candidate.label}, {moved.name}")
                if runner.status is Status.OK:
                    runner.film(light, (moved, last), truth, seen, self._silent)
        for runner in batch:
            runner.close_film()

    def _path(self, camera: Camera, truth: Reference) -> tuple[Camera, ...]:
        """A move that shifts the median receiver by half a pixel a frame."""
        away = truth.surfaces.positions[truth.domain] - np.asarray(camera.position)
        distance_m = float(np.median(away @ np.asarray(camera.forward))) if len(away) else 0.0
        return camera_path(camera, distance_m, self._plan.height, self._plan.flicker_steps)

    def _sight(self, truth: Reference) -> Sight:
        surfaces, frame = truth.surfaces, self._frame
        positions = surfaces.positions - frame.world.origin
        return Sight(positions, surfaces.normals, truth.domain, frame.clip_from_scene)
