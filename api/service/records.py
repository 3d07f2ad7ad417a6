"""What the service answers, as types that describe it in /openapi.json.

The answers themselves are made where they are found out; the tests hold them against these types.
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

SettingValue = str | int | float | bool
Kind = Literal["spot", "point", "directional"]


class Problem(BaseModel):
    """What went wrong (RFC 9457)."""

    type: str = Field(examples=["urn:gnomon:problem:bad-level"])
    title: str = Field(examples=["The level cannot be used"])
    status: int = Field(examples=[422])
    detail: str = Field(examples=["tower.glb: This level has no lights that cast shadows."])
    instance: str | None = None
    known: str | None = Field(None, description="What was found.")
    remedy: str | None = Field(None, description="What can be done about it.")


class Technique(BaseModel):
    """A shadow technique."""

    id: str = Field(examples=["shadow_map"])
    label: str = Field(examples=["SM"])
    summary: str


class Techniques(BaseModel):
    """All techniques that are chosen from."""

    techniques: list[Technique]


class Policy(BaseModel):
    """What is good enough."""

    name: str = Field(examples=["balanced"])
    max_edge_error_px: float = Field(examples=[1.5])


class Policies(BaseModel):
    """All policies."""

    policies: list[Policy]
    default: str = Field(examples=["balanced"])


class Feature(BaseModel):
    """One number about a light in a view."""

    name: str = Field(examples=["casting_triangles"])
    group: str = Field(examples=["polygon count"])
    unit: str
    meaning: str


class Features(BaseModel):
    """All features, in the order in which models see them."""

    extractor: str = Field(description="Changes with any source that decides a feature.")
    features: list[Feature]


class Expected(BaseModel):
    """What is expected of one candidate."""

    technique: str = Field(examples=["SM"])
    id: str = Field(examples=["shadow_map"])
    settings: dict[str, SettingValue]
    shadow_ms: float = Field(description="Mean over views.")
    shadow_ms_range: list[float] = Field(description="Four of five such lights lie between.")
    edge_error_px: float = Field(description="The worst of the views.")
    edge_error_px_range: list[float]
    works: float = Field(description="Probability that it does not fall back or fail.")
    keeps_limit: float = Field(description="Probability that it keeps the limit in every view.")
    cost: float


class Refused(BaseModel):
    """A candidate that cannot serve."""

    technique: str
    settings: dict[str, SettingValue]
    reason: str


class Deciding(BaseModel):
    """A feature that speaks for the chosen technique."""

    feature: str
    group: str
    value: float
    words: str


class Recommendation(Expected):
    """What to use, what else was weighed, and why."""

    source: Literal["predicted"]
    mobility: Literal["static", "dynamic"]
    policy: str
    max_edge_error_px: float
    reason: str
    confidence: float
    margin: float | None
    runner_up: Expected | None
    alternatives: list[Expected]
    refused: list[Refused]
    decided_by: list[Deciding]
    outside_training: list[str]
    features: dict[str, float] = Field(description="Mean over views.")


class LightRecommendation(Recommendation):
    """A recommendation for a light of a level."""

    light: str
    index: int
    node: int | None
    kind: Kind
    problem: Literal[""]


class LightWithout(BaseModel):
    """A light for which there is none."""

    model_config = ConfigDict(extra="forbid")

    light: str
    index: int
    node: int | None
    kind: Kind
    problem: str = Field(min_length=1, description="Why.")


class ModelFacts(BaseModel):
    """What was asked."""

    device: str = Field(description="Whose times it predicts.")
    generator: str
    training: str = Field(description="Digest of what it was learnt from.")


class PredictedLevel(BaseModel):
    """Recommendations for the lights of a level, without rendering."""

    level: str
    digest: str
    format: str
    model: ModelFacts
    resolution: list[int] = Field(min_length=2, max_length=2)
    policy: str
    max_edge_error_px: float
    lights: list[LightRecommendation | LightWithout]


class Progress(BaseModel):
    """How far a job is, in steps."""

    done: int
    total: int
    what: str


class Links(BaseModel):
    """Where the rest of a job is."""

    self: str
    events: str
    result: str
    annotated: str
    report: str


class Job(BaseModel):
    """A job that measures the lights of a level."""

    id: str
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    level: str
    created: str = Field(examples=["2030-01-02T03:04:05.678Z"])
    started: str | None
    finished: str | None
    progress: Progress
    options: dict[str, Any]
    problem: Problem | None
    lights: int | None
    links: Links


class MeasuredLevel(BaseModel):
    """What a job has measured, as `gnomon annotate --json` prints it."""

    level: str
    format: str
    digest: str
    output: str | None
    written: list[str]
    device: dict[str, Any]
    clock: str
    resolution: list[int]
    rounds: int
    max_edge_error_px: float
    lights: list[dict[str, Any]]
    problems: list[str]


class Health(BaseModel):
    """That the service is alive."""

    status: Literal["ok"]


class Readiness(BaseModel):
    """That the service can work, and what it rests on."""

    status: Literal["ready"]
    checks: dict[str, str]
