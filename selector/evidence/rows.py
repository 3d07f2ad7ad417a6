"""What the store keeps, as flat rows: each can be traced to a device, a code version and a scene's digest.

A row's key is made from what it says, so the same fact has one key in every store, and stores merge without
doubling anything.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from renderers.settings import Setting
from scenes.scene import Mobility
from selector.measurement import Status, Truth

Json = Mapping[str, Any]


class Role(StrEnum):
    """What an instance may be used for."""

    TRAINING = "training"
    TEST = "test"


class Purpose(StrEnum):
    """What a run asks: how wrong and how much work, or how long."""

    ERRORS = "errors"
    TIMES = "times"


@dataclass(frozen=True)
class InstanceRow:
    """One question: this light of this scene, seen in this view.

    Attributes:
        scene_digest: Of the whole scene.
        scene: Its name.
        family: What it shares with its like and is never split from: a family of the corpus, a level's name.
        origin: What makes the scene again: a spec's line of JSON, or a level file's name, without its folder.
        role: Levels are test data, unless they are a team's own.
        light: Everything that the scene says of the light, with its `index`.
        camera: Everything that the scene says of the camera.
        width: Pixels across.
        height: Pixels down.
    """

    scene_digest: str
    scene: str
    family: str
    origin: str
    role: Role
    light: Json
    camera: Json
    width: int
    height: int

    @property
    def key(self) -> str:
        """The same for the same picture, whatever scene, light and camera are called."""
        unnamed = ({k: v for k, v in what.items() if k != "name"} for what in (self.light, self.camera))
        return digest_of(self.scene_digest, *unnamed, self.width, self.height)


@dataclass(frozen=True)
class CandidateRow:
    """A technique with its settings."""

    technique: str
    settings: Mapping[str, Setting]

    @property
    def key(self) -> str:
        """The same for the same settings in any order."""
        return digest_of(self.technique, dict(self.settings))


@dataclass(frozen=True)
class DeviceRow:
    """Where something was measured.

    Attributes:
        renderer: As OpenGL calls it.
        vendor: As OpenGL calls it.
        gl_version: Driver and version.
        clock: How time was read.
        processor: The CPU, which is the device where rendering is software; empty where unknown.
        threads: Threads that a software renderer may use; 0 for a GPU.
        virtual: Where the times come from that no clock read: the name of the coefficients; else empty.
    """

    renderer: str
    vendor: str
    gl_version: str
    clock: str
    processor: str = ""
    threads: int = 0
    virtual: str = ""

    @property
    def key(self) -> str:
        """One key for each driver on each device."""
        return digest_of(asdict(self))


@dataclass(frozen=True)
class RunRow:
    """One start of the program, by which rows are told apart that say different things about the same.

    Attributes:
        key: A random identifier.
        started: UTC, ISO 8601.
        commit: Of the code; ends in `+` where files had been changed since.
        purpose: What it asked.
        seed: Of the shuffling.
        remarks: What may have disturbed it, such as other programs on the machine.
    """

    key: str
    started: str
    commit: str
    purpose: Purpose
    seed: int
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Asked:
    """What a fact is about: one candidate for one instance, by one version of the code, on one device.

    Attributes:
        instance: Key of the instance.
        candidate: Key of the candidate.
        device: Key of the device.
        code: Hash of all sources and shaders that decide what this candidate's technique draws.
    """

    instance: str
    candidate: str
    device: str
    code: str

    @property
    def key(self) -> str:
        """One key for each fact."""
        return digest_of(self.instance, self.candidate, self.device, self.code)


@dataclass(frozen=True)
class Judgement:
    """How wrong a candidate is and how much work it takes: exact, and repeatable on any core.

    Attributes:
        asked: What this is about.
        run: Key of the run that found it out.
        status: How it ended.
        reason: Why it is not ok.
        memory_bytes: What its pass holds on the device.
        truth: What the mask was compared with.
        fallback: Id of the technique that was drawn in its place; empty where it was drawn itself.
        figures: Error figures by name, such as `edge_error_px`; None where one has no meaning in the view.
        counters: Work counts by name.
    """

    asked: Asked
    run: str
    status: Status
    reason: str = ""
    memory_bytes: int = 0
    truth: Truth = Truth.SHADOW_VOLUME
    fallback: str = ""
    figures: Mapping[str, float | None] = field(default_factory=dict)
    counters: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class SampleRow:
    """One timed frame.

    Attributes:
        round: Which round it belongs to; all of a round share one canary.
        mobility: Whether the map or the volumes were made anew.
        shadow_ms: The technique's own stages.
        frame_ms: Everything.
        canary_ms: The fixed frame at the start of the round: divide by it, and the machine's drift is gone.
        stages_ms: Milliseconds by stage.
    """

    round: int
    mobility: Mobility
    shadow_ms: float
    frame_ms: float
    canary_ms: float
    stages_ms: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Timing:
    """How long a candidate takes: every sample of one run, raw.

    Attributes:
        asked: What this is about.
        run: Key of the run in which the samples were taken; another run's stand beside them.
        status: How it ended.
        reason: Why it is not ok.
        samples: Every timed frame.
    """

    asked: Asked
    run: str
    status: Status
    reason: str = ""
    samples: tuple[SampleRow, ...] = ()


def digest_of(*parts: object) -> str:
    """32 hexadecimal digits that stand for some JSON values."""
    text = json.dumps(parts, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:32]
