"""What a corpus instance is made from: a family, a seed and where it stands on each axis."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from typing import Any, get_type_hints

from scenes.errors import GnomonError
from scenes.scene import LightKind

STEPS = 5
"""Crowding and grain have so many steps, from 0 on."""
MOST_LIGHTS, MOST_CAMERAS = 64, 4
CUT_OFFS_DEG = (2.0, 80.0)
TRIANGLES = (24, 1_000_000)
SEEDS = 2**53


class SpecError(GnomonError):
    """A spec that no instance can be made from."""

    exit_code = 2


class Closure(StrEnum):
    """What was done to the shells of a scene after they were built."""

    AS_BUILT = "as_built"
    BOTTOMLESS = "bottomless"
    FLIPPED = "flipped"


class Rig(StrEnum):
    """Where the light is as seen from camera and target."""

    MINERS_LAMP = "miners_lamp"
    OVER_THE_SHOULDER = "over_the_shoulder"
    DUELLING_FRUSTA = "duelling_frusta"
    BETWEEN = "between"
    FROM_THE_SIDE = "from_the_side"
    FAR_LOW_SUN = "far_low_sun"
    OVERHEAD = "overhead"
    AT_THE_WALL = "at_the_wall"


class Standpoint(StrEnum):
    """Where the camera is.

    A vista is what the family thinks best; near and far are from shadows; close is right before a surface,
    and remote so far out that all is in view.
    """

    VISTA = "vista"
    NEAR = "near"
    FAR = "far"
    CLOSE = "close"
    REMOTE = "remote"


@dataclass(frozen=True)
class Spec:
    """One instance of the corpus.

    Attributes:
        family: A module of `scenes.corpus.families`.
        seed: Everything random comes from it.
        triangles: How many are wanted, 24 to 1,000,000; met within a factor of two.
        crowding: 0 to 4: how many casters stand in one another's light.
        grain: 0 to 4: from few large casters to many small ones.
        closure: `bottomless` leaves out what faces straight down, as artists do; `flipped` turns every
            eighth triangle.
        kind: Of the first light.
        cut_off_deg: Half angle of a spot, 2 to 80.
        reach: The first light's range as a share of the scene's diagonal; none is endless.
        rig: Where the first light is.
        standpoint: Where the first camera is.
        merged: Whether all is one mesh, as some exporters leave it.
        lights: How many, up to 64; those after the first have rigs of their own.
        cameras: How many; those after the first stand elsewhere.
        set_up: Name of a set-up of the thesis, which then decides everything but the family.

    Raises:
        SpecError: A value is outside its axis, or of another type.
    """

    family: str
    seed: int = 0
    triangles: int = 10_000
    crowding: int = 2
    grain: int = 2
    closure: Closure = Closure.AS_BUILT
    kind: LightKind = LightKind.SPOT
    cut_off_deg: float = 45.0
    reach: float | None = None
    rig: Rig = Rig.FROM_THE_SIDE
    standpoint: Standpoint = Standpoint.VISTA
    merged: bool = False
    lights: int = 1
    cameras: int = 1
    set_up: str = ""

    def __post_init__(self) -> None:
        for name in ("seed", "triangles", "crowding", "grain", "lights", "cameras"):
            value = getattr(self, name)
            _require(isinstance(value, int) and not isinstance(value, bool), name, value, "a whole number")
        for name in ("family", "set_up"):
            _require(isinstance(getattr(self, name), str), name, getattr(self, name), "a text")
        _require(isinstance(self.merged, bool), "merged", self.merged, "true or false")
        for name, kind in _CHOICES.items():
            _require(
                isinstance(getattr(self, name), kind), name, getattr(self, name), f"one of {_words(kind)}"
            )
        for name, (low, high) in _BOUNDS.items():
            value = getattr(self, name)
            _require(low <= value <= high, name, value, f"from {low:,} to {high:,}")
        cut_off = self.cut_off_deg
        angle = isinstance(cut_off, int | float) and CUT_OFFS_DEG[0] <= cut_off <= CUT_OFFS_DEG[1]
        _require(angle, "cut_off_deg", cut_off, f"from {CUT_OFFS_DEG[0]:g} to {CUT_OFFS_DEG[1]:g}")
        if self.reach is not None:
            reach = isinstance(self.reach, int | float) and math.isfinite(self.reach) and self.reach > 0
            _require(reach, "reach", self.reach, "over 0, or null for an endless light")

    def record(self) -> dict[str, Any]:
        """As JSON values; `from_record` gives an equal spec."""
        return asdict(self)

    @classmethod
    def from_record(cls, record: Any) -> Spec:
        """The spec that a JSON object stands for; what is left out has its default.

        Raises:
            SpecError: It is no object, has unknown keys or lacks the family, or a value is wrong.
        """
        if not isinstance(record, dict) or "family" not in record:
            raise SpecError(
                "A spec is a JSON object with at least a family.", known=f"It is {record!r:.200}."
            )
        known = {one.name for one in fields(cls)}
        unknown = sorted(set(record) - known)
        if unknown:
            raise SpecError(
                f'A spec has no "{unknown[0]}".', known=f"It has {', '.join(sorted(known))}.", where="spec"
            )
        values = dict(record)
        for name, kind in _CHOICES.items():
            if name in values:
                value = values[name]
                _require(value in list(kind), name, value, f"one of {_words(kind)}")
                values[name] = kind(value)
        return cls(**values)

    @property
    def text(self) -> str:
        """One line of JSON, keys in order: equal specs have equal texts."""
        return json.dumps(self.record(), sort_keys=True, separators=(",", ":"), allow_nan=False)

    @classmethod
    def from_text(cls, text: str) -> Spec:
        """The spec of a JSON text.

        Raises:
            SpecError: It is no JSON, or no spec.
        """
        try:
            record = json.loads(text)
        except (json.JSONDecodeError, RecursionError) as error:
            raise SpecError("This is no JSON.", where="spec", known=str(error)) from error
        return cls.from_record(record)


_CHOICES: dict[str, type[StrEnum]] = {
    name: kind
    for name, kind in get_type_hints(Spec).items()
    if isinstance(kind, type) and issubclass(kind, StrEnum)
}
_BOUNDS = {
    "seed": (0, SEEDS - 1),
    "triangles": TRIANGLES,
    "crowding": (0, STEPS - 1),
    "grain": (0, STEPS - 1),
    "lights": (1, MOST_LIGHTS),
    "cameras": (1, MOST_CAMERAS),
}


def _require(holds: bool, name: str, value: object, wanted: str) -> None:  # noqa: FBT001
    if not holds:
        raise SpecError(f"{name} must be {wanted}.", where="spec", known=f"It is {value!r:.100}.")


def _words(kind: type[StrEnum]) -> str:
    return ", ".join(kind)
