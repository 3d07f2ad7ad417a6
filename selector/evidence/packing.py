"""Values by name as a list of names and packed little-endian numbers, and back."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping

Names = tuple[str, ...]


def packed_floats(values: Mapping[str, float | None]) -> tuple[Names, bytes]:
    """Names in order, and float64; what is not a number stands for None."""
    names = tuple(sorted(values))
    numbers = (math.nan if (number := values[name]) is None else number for name in names)
    return names, struct.pack(f"<{len(names)}d", *numbers)


def packed_counts(values: Mapping[str, int]) -> tuple[Names, bytes]:
    """Names in order, and int64."""
    names = tuple(sorted(values))
    return names, struct.pack(f"<{len(names)}q", *(values[name] for name in names))


def unpacked_floats(names: Names, data: bytes) -> dict[str, float | None]:
    """What was packed."""
    return {name: None if math.isnan(number) else number for name, number in unpacked(names, data).items()}


def unpacked(names: Names, data: bytes) -> dict[str, float]:
    """What was packed, where there was a number for each name."""
    return dict(zip(names, struct.unpack(f"<{len(names)}d", data), strict=True))


def unpacked_counts(names: Names, data: bytes) -> dict[str, int]:
    """What was packed."""
    return dict(zip(names, struct.unpack(f"<{len(names)}q", data), strict=True))


def names_text(names: Names) -> str:
    """As the table of vocabularies holds them."""
    return json.dumps(names, separators=(",", ":"))


def names_of(text: str) -> Names:
    """The names that a text of the table of vocabularies holds."""
    return tuple(json.loads(text))
