"""Numbers in the values of an entity's keys, or an error that says which key of which entity is wrong."""

from __future__ import annotations

import re

from scenes.errors import LevelError
from scenes.quake.map_text import Entity

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
LONGEST = 60
# No key of a real map holds more; what the GPU reckons with ends at 1e38.
LARGEST = 1e9


def numbers(entity: Entity, counts: tuple[int, ...], *keys: str) -> tuple[float, ...] | None:
    """The numbers in the first of these keys that is there; None where none is, or its value is empty.

    Raises:
        LevelError: They are not as many as one of `counts`, or not all finite and moderate numbers.
    """
    text = entity.value(*keys)
    words = text.split()
    if not words:
        return None
    found = tuple(float(word) for word in words if _NUMBER.fullmatch(word))
    if len(found) == len(words) and len(found) in counts and max(map(abs, found)) <= LARGEST:
        return found
    key = next(key for key in keys if entity.value(key) == text)
    wanted = " or ".join(map(str, counts))
    raise LevelError(
        f'"{key}" must hold {wanted} {"number" if counts == (1,) else "numbers"} of at most {LARGEST:g}.',
        where=f"line {entity.line}, {entity.where}",
        known=f'It is "{text[:LONGEST]}".',
        remedy="Mend the key in the map's editor.",
    )


def number(entity: Entity, default: float, *keys: str) -> float:
    """The number in the first of these keys that is there.

    Raises:
        LevelError: It is none.
    """
    found = numbers(entity, (1,), *keys)
    return default if found is None else found[0]
