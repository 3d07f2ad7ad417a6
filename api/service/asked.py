"""What clients may ask, as types that check it and describe it in /openapi.json."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    FiniteFloat,
    WithJsonSchema,
    create_model,
)

from features.table import FEATURES
from renderers.registry import TECHNIQUES
from selector.policy import DEFAULT_POLICY, POLICIES

MOST_VIEWS = 16
"""Of one recommendation: as many as make the answer take a second."""
LARGEST_FEATURE = 1e9
LARGEST_ERROR_PX = 10_000.0
MOST_NAMES, LONGEST_NAME = 100, 200
SMALLEST_SIDE, LARGEST_SIDE = 16, 4096
DEFAULT_ROUNDS, MOST_ROUNDS = 3, 100

_TECHNIQUE_NAMES = tuple(name for one in TECHNIQUES for name in (one.label, one.name))
_POLICY_NAMES = tuple(one.name for one in POLICIES)


def _known(names: tuple[str, ...], what: str) -> AfterValidator:
    def check(text: str) -> str:
        if text not in names:
            raise ValueError(f"there is no {what} of this name; known are {', '.join(names)}")
        return text

    return AfterValidator(check)


def _schema(names: tuple[str, ...]) -> WithJsonSchema:
    return WithJsonSchema({"type": "string", "enum": list(names)})


def _check_resolution(text: str) -> str:
    sides = [int(side) for side in text.split("x")]
    if not all(SMALLEST_SIDE <= side <= LARGEST_SIDE for side in sides):
        raise ValueError(f"both sides must be between {SMALLEST_SIDE} and {LARGEST_SIDE} pixels")
    return text


def _no_boolean(value: object) -> object:
    if isinstance(value, bool):
        raise ValueError("true and false are no numbers")  # noqa: TRY004  pydantic wants this one
    return value


# 16 to 4096, so that /openapi.json says what the check does.
_SIDE = r"(1[6-9]|[2-9][0-9]|[1-9][0-9]{2}|[1-3][0-9]{3}|40[0-8][0-9]|409[0-6])"

TechniqueName = Annotated[str, _known(_TECHNIQUE_NAMES, "technique"), _schema(_TECHNIQUE_NAMES)]
PolicyName = Annotated[str, _known(_POLICY_NAMES, "policy"), _schema(_POLICY_NAMES)]
Name = Annotated[str, Field(max_length=LONGEST_NAME)]
Resolution = Annotated[str, Field(pattern=f"^{_SIDE}x{_SIDE}$"), AfterValidator(_check_resolution)]
Number = Annotated[FiniteFloat, BeforeValidator(_no_boolean)]
MaxEdgeError = Annotated[
    Number | None,
    Field(
        ge=0, le=LARGEST_ERROR_PX, description="How far a shadow's edge may be off, in place of the policy's."
    ),
]
Mobility = Literal["dynamic", "static"]

_feature_fields: dict[str, Any] = {
    one.name: (
        Number,
        Field(
            ge=-LARGEST_FEATURE,
            le=LARGEST_FEATURE,
            description=f"{one.meaning} Unit: {one.unit}.",
            examples=[0.0],
        ),
    )
    for one in FEATURES
}
FeatureValues: type[BaseModel] = create_model(
    "FeatureValues",
    __config__=ConfigDict(extra="forbid"),
    __doc__="All features of a light in one view, as GET /v1/features lists them.",
    **_feature_fields,
)


class RecommendationRequest(BaseModel):
    """A light of which nothing is known but its features, in one view or several."""

    model_config = ConfigDict(extra="forbid")

    kind: Literal["spot", "point", "directional"]
    views: list[FeatureValues] = Field(min_length=1, max_length=MOST_VIEWS)  # type: ignore[valid-type]
    mobility: Mobility = Field("dynamic", description="Whether the light, and what it lights, stands still.")
    policy: PolicyName = DEFAULT_POLICY
    max_edge_error_px: MaxEdgeError = None
    techniques: list[TechniqueName] = Field(
        [], max_length=len(_TECHNIQUE_NAMES), description="To choose from; all where empty."
    )


class LevelOptions(BaseModel):
    """What is asked about the lights of a level."""

    model_config = ConfigDict(extra="forbid")

    policy: PolicyName = DEFAULT_POLICY
    max_edge_error_px: MaxEdgeError = None
    mobility: Mobility | None = Field(None, description="Of all lights; what the level says where left out.")
    technique: list[TechniqueName] = Field(
        [], max_length=len(_TECHNIQUE_NAMES), description="To choose from; all where left out."
    )
    scene: Name | None = Field(None, description="Name or number of a scene of the file.")
    resolution: Resolution = Field("640x360", description="Pixels across and down of each view.")
    light: list[Name] = Field(
        [], max_length=MOST_NAMES, description="Only these lights: names, numbers or node:NUMBER."
    )
    camera: list[Name] = Field([], max_length=MOST_NAMES, description="Judge only by these cameras.")
    name: Name = Field("", description="File name of the level, for records and downloads only.")

    @property
    def size(self) -> tuple[int, int]:
        """Pixels across and down."""
        width, height = self.resolution.split("x")
        return int(width), int(height)


class JobOptions(LevelOptions):
    """What is asked about the lights of a level that is measured."""

    rounds: int = Field(
        DEFAULT_ROUNDS, ge=1, le=MOST_ROUNDS, description="How often every candidate is timed."
    )
