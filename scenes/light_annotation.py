"""What an annotation says about one light, whatever the format of the level that it is written into."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Scalar = str | float | int | bool

# The author's own word on a light, for us to read and never to write.
MOBILITY_KEY = "gnomon_mobility"

# Ours wherever a level holds them: other programs keep these keys and drop what else we wrote.
OWN_KEYS = frozenset(
    {
        "gnomon_technique",
        "gnomon_map_size",
        "gnomon_filter",
        "gnomon_focus",
        "gnomon_shadow_ms",
        "gnomon_edge_error_px",
        "gnomon_confidence",
        "gnomon_source",
    }
)


@dataclass(frozen=True)
class LightAnnotation:
    """What is written at one light.

    Attributes:
        extras: Flat scalars that every engine hands to its users; their keys are in `OWN_KEYS`.
        extension: JSON object with the whole story, for those that ask for it.

    Raises:
        ValueError: A key or value that must not be written: our own bug.
    """

    extras: Mapping[str, Scalar]
    extension: Mapping[str, Any]

    def __post_init__(self) -> None:
        if unknown := sorted(set(self.extras) - OWN_KEYS):
            raise ValueError(f"extras keys {unknown} are not in OWN_KEYS: they would not be found again")
        for key, value in self.extras.items():
            if not isinstance(value, Scalar):
                raise ValueError(f"extras value of {key} is no scalar: {value!r}")  # noqa: TRY004 - one kind of error
            if isinstance(value, float) and not math.isfinite(value):
                raise ValueError(f"extras value of {key} is {value}, which JSON cannot hold")
        json.dumps(dict(self.extension), allow_nan=False)


@dataclass(frozen=True)
class Cleared:
    """A level file without our annotation.

    Attributes:
        data: The file.
        restored: Whether it is byte for byte the file that was annotated.
        note: One sentence for the user.
    """

    data: bytes
    restored: bool
    note: str
