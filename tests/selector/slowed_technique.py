"""A technique that takes longer than it needs, and workers that know it: a driver's bad day."""

from __future__ import annotations

import time
from collections.abc import Sequence
from multiprocessing.connection import Connection

import renderers.registry
import selector.candidate
from renderers.clock import StageClock
from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.internals import Internals
from renderers.registry import technique
from renderers.settings import Settings
from renderers.technique import Counters, Outcome, ShadowPass
from scenes.scene import Light, LightKind, Scene
from selector.benchmark.messages import Job
from selector.benchmark.worker import enter


class SlowedPass(ShadowPass):
    """Waits after each frame for a share of what the frame took."""

    def __init__(self, real: ShadowPass, frame: Frame, share: float) -> None:
        self._real, self._frame, self._share = real, frame, share
        self.memory_bytes = real.memory_bytes

    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:
        self._frame.gpu.ctx.finish()
        start = time.perf_counter()
        outcome = self._real.render(clock, rebuild=rebuild)
        self._frame.gpu.ctx.finish()
        end = time.perf_counter() + self._share * (time.perf_counter() - start)
        with clock.stage("volumes"):
            while time.perf_counter() < end:
                pass
        return outcome

    def count(self) -> Counters:
        return self._real.count()

    def internals(self) -> Internals:
        return self._real.internals()

    def release(self) -> None:
        self._real.release()


class Slowed:
    """A technique of another's name, results and candidates that takes longer."""

    def __init__(self, name: str, share: float) -> None:
        self._real, self._share = technique(name), share
        self.name, self.label = self._real.name, self._real.label
        self.title, self.options = self._real.title, self._real.options

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        return self._real.candidates(kind, limits)

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        return self._real.refuses(light, scene, limits, settings)

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ShadowPass:
        return SlowedPass(self._real.prepare(frame, light, settings), frame, self._share)


def enter_slowed(name: str, share: float, pipe: Connection, job: Job, parent: int) -> None:
    """A worker in which one technique takes so much longer."""
    slowed = Slowed(name, share)
    known = tuple(slowed if one.name == slowed.name else one for one in renderers.registry.TECHNIQUES)
    renderers.registry.TECHNIQUES = known
    selector.candidate.TECHNIQUES = known
    enter(pipe, job, parent)
