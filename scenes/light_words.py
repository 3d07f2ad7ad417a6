"""A light in words, as one types it: `spot position_m=0,3,0 target_m=1,0,2 outer_cone_deg=30`."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterable, Mapping
from typing import Any

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.plain.entries import LIGHT_KEYS, read_light
from scenes.scene import Light, LightKind

EXAMPLE = "spot position_m=0,3,0 target_m=1,0,2 outer_cone_deg=30 range_m=12"


def light_in_words(words: str, node: int | None = None) -> Light:
    """The light that these words describe: its kind, then `key=value` with the keys of a lights file.

    Lists are written with commas, values with blanks in quotes: `point position_m=0,2,0 name="Left lamp"`.

    Raises:
        LevelError: They describe none: it says which word is wrong, and what an example looks like.
    """
    return read_light_values(light_values(words), words, node)


def light_values(words: str) -> dict[str, Any]:
    """The same as the JSON object that a lights file would hold.

    Raises:
        LevelError: A word is no `key=value`, has a key that is none of a light's, or comes twice.
    """
    try:
        parts = shlex.split(words)
    except ValueError as error:
        raise _wrong(words, f"The quotes in this light do not match: {error}.") from error
    if not parts or parts[0] not in set(LightKind):
        kinds = ", ".join(LightKind)
        raise _wrong(words, f"A light begins with its kind, one of {kinds}.")
    values: dict[str, Any] = {"kind": parts[0]}
    for part in parts[1:]:
        key, sign, text = part.partition("=")
        if not (key and sign and text):
            raise _wrong(words, f'"{part[:40]}" is no key=value.')
        if key not in LIGHT_KEYS:
            known = ", ".join(sorted(LIGHT_KEYS - {"kind"}))
            raise _wrong(words, f'A light in words has no "{key[:40]}".', f"It has {known}.")
        if key in values:
            raise _wrong(words, f'"{key[:40]}" is said twice.')
        values[key] = _value(key, text)
    return values


def read_light_values(values: Mapping[str, Any], words: str, node: int | None = None) -> Light:
    """The light of such an object.

    Raises:
        LevelError: A value is missing or wrong.
    """
    try:
        return read_light(Entry(values, f'light "{words[:60]}"'), node, NoteBook())
    except LevelError as error:
        error.remedy = error.remedy or f"For example: {EXAMPLE}."
        raise


def lights_file(geometry: str, lights: Iterable[Light]) -> bytes:
    """A lights file with these lights over that geometry, in ASCII, one value to a line.

    Args:
        geometry: Name of the geometry's file, relative to where the lights file goes.
        lights: The lights.
    """
    record = {"geometry": geometry, "lights": [_values(light) for light in lights]}
    return (json.dumps(record, indent=2, allow_nan=False) + "\n").encode("ascii")


def _values(light: Light) -> dict[str, Any]:
    values: dict[str, Any] = {"name": light.name, "kind": str(light.kind)}
    if light.kind is not LightKind.DIRECTIONAL:
        values["position_m"] = list(light.position)
        if math.isfinite(light.range_m):
            values["range_m"] = light.range_m
    if light.kind is not LightKind.POINT:
        values["direction"] = list(light.direction)
    if light.kind is LightKind.SPOT:
        values |= {"inner_cone_rad": light.inner_cone_rad, "outer_cone_rad": light.outer_cone_rad}
    values |= {"intensity": light.intensity, "color": list(light.color), "mobility": str(light.mobility)}
    return values


def _value(key: str, text: str) -> Any:
    if key in ("name", "mobility"):
        return text
    numbers = [_number(part) for part in text.split(",")]
    return numbers[0] if len(numbers) == 1 else numbers


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        # What is no number is refused by the key that it stands for.
        return text


def _wrong(words: str, what: str, known: str = "") -> LevelError:
    return LevelError(what, where=f'light "{words[:60]}"', known=known, remedy=f"For example: {EXAMPLE}.")
