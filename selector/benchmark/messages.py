"""What a benchmark and its workers say to each other: small, frozen, told before the next thing begins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from renderers.context import DeviceLimits
from selector.benchmark.questions import Question
from selector.evidence.rows import CandidateRow, DeviceRow, InstanceRow, Purpose, SampleRow
from selector.measurement import Status, Truth


class Part(StrEnum):
    """What a worker is at; one that hangs or dies is blamed on that."""

    START = "start"
    SCENE = "scene"
    TRUTH = "truth"
    CANDIDATE = "candidate"


@dataclass(frozen=True)
class Job:
    """How all questions of a run are answered.

    Attributes:
        purpose: Errors and counters, or times.
        width: Pixels across.
        height: Pixels down.
        techniques: Ids or labels; all where empty.
        device: Index or name; the first that works where None.
        threads: Of a software renderer where times are taken.
        rounds: Timed at most; the other limits are in `selector.benchmark.timing`.
        timeout_s: A frame that takes longer counts as a timeout.
        flip: Whether the pictures are compared by FLIP as well.
        seed: Of the shuffling.
    """

    purpose: Purpose
    width: int
    height: int
    techniques: tuple[str, ...] = ()
    device: str | None = None
    threads: int = 1
    rounds: int = 10
    timeout_s: float = 4.0
    flip: bool = False
    seed: int = 1


@dataclass(frozen=True)
class Task:
    """One question for one worker.

    Attributes:
        question: The question.
        rays: Whether rays tell the truth, because shadow volumes took a worker down before.
    """

    question: Question
    rays: bool = False


@dataclass(frozen=True)
class Ready:
    """A worker has its device."""

    device: DeviceRow
    limits: DeviceLimits


@dataclass(frozen=True)
class Unfit:
    """A worker has no device: the words of the error."""

    what: str
    where: str
    known: str
    remedy: str


@dataclass(frozen=True)
class Asks:
    """The question is posed: which of these candidates are wanted? A set of their keys is the answer."""

    instance: InstanceRow
    candidates: tuple[CandidateRow, ...]


@dataclass(frozen=True)
class Begins:
    """The next part begins; for a candidate, with its key."""

    part: Part
    candidate: str = ""


@dataclass(frozen=True)
class Judged:
    """One candidate is judged; as in `Judgement`."""

    candidate: str
    status: Status
    reason: str = ""
    memory_bytes: int = 0
    truth: Truth = Truth.SHADOW_VOLUME
    fallback: str = ""
    figures: Mapping[str, float | None] = field(default_factory=dict)
    counters: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Timed:
    """One candidate is timed; as in `Timing`."""

    candidate: str
    status: Status
    reason: str = ""
    samples: tuple[SampleRow, ...] = ()


@dataclass(frozen=True)
class Finished:
    """The question is answered; seconds by part of the work."""

    seconds: Mapping[str, float]


@dataclass(frozen=True)
class Failed:
    """The question cannot be answered at all, and no candidate is to blame."""

    reason: str


Word = Ready | Unfit | Asks | Begins | Judged | Timed | Finished | Failed
"""What a worker says."""
