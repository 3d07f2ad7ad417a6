"""What the service answers, as typed records; docs/client.md tells what the fields mean."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from .reading import known_fields, record

Kind: TypeAlias = Literal["spot", "point", "directional"]
Mobility: TypeAlias = Literal["static", "dynamic"]
State: TypeAlias = Literal["queued", "running", "done", "failed", "cancelled"]
Settings: TypeAlias = dict[str, str | int | float | bool]


@dataclass(frozen=True)
class Technique:
    """A shadow technique."""

    id: str
    label: str
    summary: str


@dataclass(frozen=True)
class Techniques:
    """All techniques."""

    techniques: tuple[Technique, ...]


@dataclass(frozen=True)
class Policy:
    """What is good enough: how far a shadow's edge may be off."""

    name: str
    max_edge_error_px: float


@dataclass(frozen=True)
class Policies:
    """All policies, and the name of the one that holds where none is named."""

    policies: tuple[Policy, ...]
    default: str


@dataclass(frozen=True)
class Feature:
    """A number about a light in a view."""

    name: str
    group: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class Features:
    """All features, and which version of the extractor makes them."""

    extractor: str
    features: tuple[Feature, ...]


@dataclass(frozen=True)
class Expected:
    """What is expected of one candidate."""

    technique: str
    id: str
    settings: Settings
    shadow_ms: float
    shadow_ms_range: tuple[float, float]
    edge_error_px: float
    edge_error_px_range: tuple[float, float]
    works: float
    keeps_limit: float
    cost: float


@dataclass(frozen=True)
class Refused:
    """A candidate that cannot serve the light, and why."""

    technique: str
    settings: Settings
    reason: str


@dataclass(frozen=True)
class Deciding:
    """A feature that speaks for the choice, in words."""

    feature: str
    group: str
    value: float
    words: str


@dataclass(frozen=True)
class Recommendation(Expected):
    """What to use for a light, as predicted, and why."""

    source: str
    mobility: Mobility
    policy: str
    max_edge_error_px: float
    reason: str
    confidence: float
    margin: float | None
    runner_up: Expected | None
    alternatives: tuple[Expected, ...]
    refused: tuple[Refused, ...]
    decided_by: tuple[Deciding, ...]
    outside_training: tuple[str, ...]
    features: dict[str, float]


@dataclass(frozen=True)
class LightAnswer:
    """The answer for one light of a level: a recommendation, or the sentence that says why there is none."""

    light: str
    index: int
    node: int | None
    kind: str
    problem: str
    recommendation: Recommendation | None = None

    @classmethod
    def from_json(cls, value: Mapping[str, object], where: str) -> LightAnswer:
        """The recommendation lies beside the light's name, not below it."""
        found = known_fields(cls, value, where)
        if not found["problem"]:
            found["recommendation"] = record(Recommendation, value, where)
        return cls(**found)


@dataclass(frozen=True)
class Model:
    """Which model has answered."""

    device: str
    generator: str
    training: str


@dataclass(frozen=True)
class LevelAnswer:
    """The predictions for the lights of a level."""

    level: str
    digest: str
    format: str
    model: Model
    resolution: tuple[int, int]
    policy: str
    max_edge_error_px: float
    lights: tuple[LightAnswer, ...]


@dataclass(frozen=True)
class Progress:
    """How far a job is, and what it is doing."""

    done: int
    total: int
    what: str


@dataclass(frozen=True)
class Problem:
    """Why a job has failed."""

    title: str
    status: int
    detail: str
    type: str = "about:blank"
    instance: str | None = None
    known: str | None = None
    remedy: str | None = None


@dataclass(frozen=True)
class Job:
    """A measuring job.

    `retry_after_s` is when to ask again, where the service said so.
    """

    id: str
    state: State
    level: str
    created: str
    started: str | None
    finished: str | None
    progress: Progress
    options: dict[str, Any]
    problem: Problem | None
    lights: int | None
    links: dict[str, str]
    retry_after_s: float | None = field(default=None, compare=False)

    @property
    def ended(self) -> bool:
        """Whether nothing more will come of it."""
        return self.state in ("done", "failed", "cancelled")


@dataclass(frozen=True)
class MeasuredCandidate:
    """A candidate with what was measured; None where nothing could be."""

    technique: str
    label: str
    settings: Settings
    shadow_ms: float | None
    edge_error_px: float | None
    status: str = "ok"
    reason: str = ""
    frame_ms: float | None = None
    memory_bytes: int | None = None
    wrong_share: float | None = None
    flip: float | None = None
    flicker: float | None = None


@dataclass(frozen=True)
class MeasuredRecommendation:
    """What to use for a light, as measured, and why."""

    chosen: MeasuredCandidate
    runner_up: MeasuredCandidate | None
    within_limit: bool
    confidence: float | None
    reason: str
    mobility: Mobility
    views: tuple[str, ...]
    candidates: tuple[MeasuredCandidate, ...]
    shadow_edge_seen: bool


@dataclass(frozen=True)
class MeasuredLight:
    """The result for one light: a recommendation, or the sentence that says why there is none."""

    node: int | None
    name: str
    kind: Kind
    problem: str = ""
    verified_wrong_share: float | None = None
    recommendation: MeasuredRecommendation | None = None

    @classmethod
    def from_json(cls, value: Mapping[str, object], where: str) -> MeasuredLight:
        """The recommendation lies beside the light's name, not below it."""
        found = known_fields(cls, value, where)
        if not found.get("problem"):
            found["recommendation"] = record(MeasuredRecommendation, value, where)
        return cls(**found)


@dataclass(frozen=True)
class MeasuredLevel:
    """What a job has measured."""

    level: str
    format: str
    digest: str
    device: dict[str, Any]
    clock: str
    resolution: tuple[int, int]
    rounds: int
    max_edge_error_px: float
    lights: tuple[MeasuredLight, ...]
    problems: tuple[str, ...]


@dataclass(frozen=True)
class Download:
    """A file from the service.

    `name` is a bare file name, safe to join to a folder; empty where the service gave none.
    """

    data: bytes
    media_type: str
    name: str
