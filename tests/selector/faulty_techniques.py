# ruff: noqa: ARG002  a protocol names its arguments
"""Techniques that hang, abort or take all memory, and workers that know them: the program does not."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Sequence
from multiprocessing.connection import Connection
from typing import ClassVar

import renderers.registry
import selector.candidate
from renderers.clock import StageClock
from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.internals import Internals
from renderers.registry import technique
from renderers.settings import Options, Settings
from renderers.technique import Counters, Outcome, ShadowPass
from scenes.scene import Light, LightKind, Scene
from selector.benchmark.messages import Job
from selector.benchmark.worker import enter

CHUNK = 32 << 20


def hang() -> None:
    time.sleep(3600)


def abort() -> None:
    os.abort()


def hog() -> None:
    held = []
    while True:
        held.append(b"\xff" * CHUNK)
        time.sleep(0.01)


def be_killed() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


FAULTS = {"hang": hang, "abort": abort, "hog": hog, "be_killed": be_killed}


class FaultyPass(ShadowPass):
    memory_bytes = 0

    def __init__(self, fault: str) -> None:
        self._fault = fault

    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:
        FAULTS[self._fault]()
        raise AssertionError("this is never reached")

    def count(self) -> Counters:
        return {}

    def internals(self) -> Internals:
        return Internals()

    def release(self) -> None:
        pass


class Faulty:
    title = "At fault"
    options: ClassVar[Options] = {}

    def __init__(self, fault: str) -> None:
        self.name, self.label = fault, fault

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        return [{}]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        return None

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ShadowPass:
        return FaultyPass(self.name)


class FewMaps:
    """Shadow maps with one setting, so that little is measured."""

    def __init__(self) -> None:
        self._known = technique("SM")
        self.name, self.label = self._known.name, self._known.label
        self.title, self.options = self._known.title, self._known.options

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        return self._known.candidates(kind, limits)[:1]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        return self._known.refuses(light, scene, limits, settings)

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ShadowPass:
        return self._known.prepare(frame, light, settings)


def enter_faulty(faults: tuple[str, ...], pipe: Connection, job: Job, parent: int) -> None:
    """A worker with one shadow map, these faults, and shadow volumes, in this order."""
    known = (FewMaps(), *map(Faulty, faults), technique("SV"))
    renderers.registry.TECHNIQUES = known
    selector.candidate.TECHNIQUES = known
    enter(pipe, job, parent)
