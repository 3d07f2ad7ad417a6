"""JSON objects of a glTF file that know where they stand and check the type of what is asked of them."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeGuard

from scenes.errors import LevelError

# The largest integer that JSON readers agree on (RFC 8259, section 6).
LARGEST_INTEGER = 2**53 - 1


def printable(text: str) -> str:
    """`text` without lone surrogates, which JSON can spell and no terminal or file can take."""
    return text.encode("utf-8", "replace").decode("utf-8")


@dataclass(frozen=True)
class Entry:
    """A JSON object with its place in the file.

    A property that is `null` counts as absent. Every method raises LevelError, with the place, the
    property, what was found and what is expected, where a property has the wrong type.

    Attributes:
        values: The JSON object.
        where: Its place, such as `node 12 "Lamp"`.
    """

    values: Mapping[str, Any]
    where: str

    def has(self, key: str) -> bool:
        """Whether the property is there."""
        return self.values.get(key) is not None

    def wrong(self, key: str, expected: str) -> LevelError:
        """The error for a property that is missing or not what is expected."""
        if not self.has(key):
            return LevelError(f'"{key}" is missing.', where=self.where, known=f"It must be {expected}.")
        return LevelError(
            f'"{key}" must be {expected}.',
            where=self.where,
            known=f"It is {printable(reprlib.repr(self.values[key]))}.",
        )

    def integer(self, key: str, default: int | None = None) -> int:
        """A whole number from 0 on; `default` where it is absent, which None forbids."""
        value = self.values.get(key)
        if value is None and default is not None:
            return default
        if not _is_integer(value):
            raise self.wrong(key, "a whole number from 0 on")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number; `default` where it is absent, which None forbids."""
        value = self.values.get(key)
        if value is None and default is not None:
            return default
        if not _is_number(value):
            raise self.wrong(key, "a finite number")
        return float(value)

    def numbers(self, key: str, count: int, default: Sequence[float]) -> tuple[float, ...]:
        """`count` finite numbers; `default` where they are absent."""
        value = self.values.get(key)
        if value is None:
            return tuple(default)
        if not isinstance(value, list) or len(value) != count or not all(map(_is_number, value)):
            raise self.wrong(key, f"a list of {count} finite numbers")
        return tuple(map(float, value))

    def text(self, key: str) -> str:
        """A string, empty where it is absent."""
        value = self.values.get(key, "")
        if value is None:
            return ""
        if not isinstance(value, str):
            raise self.wrong(key, "a string")
        return printable(value)

    def boolean(self, key: str) -> bool:
        """True or False, False where it is absent."""
        value = self.values.get(key)
        if value is None:
            return False
        if not isinstance(value, bool):
            raise self.wrong(key, "true or false")
        return value

    def items(self, key: str) -> list[Any]:
        """A list, empty where it is absent."""
        value = self.values.get(key)
        if value is None:
            return []
        if not isinstance(value, list):
            raise self.wrong(key, "a list")
        return value

    def integers(self, key: str) -> list[int]:
        """A list of whole numbers from 0 on, empty where it is absent."""
        values = self.items(key)
        if not all(map(_is_integer, values)):
            raise self.wrong(key, "a list of whole numbers from 0 on")
        return values

    def texts(self, key: str) -> list[str]:
        """A list of strings, empty where it is absent."""
        values = self.items(key)
        if not all(isinstance(value, str) for value in values):
            raise self.wrong(key, "a list of strings")
        return [printable(value) for value in values]

    def child(self, key: str, where: str = "") -> Entry:
        """An object, empty where it is absent; its place is `where`, else this entry's with the key."""
        value = self.values.get(key)
        if value is None:
            value = {}
        if not isinstance(value, dict):
            raise self.wrong(key, "an object")
        return Entry(value, where or f"{self.where}, {key}")

    def extension(self, name: str) -> Entry | None:
        """The extension of that name on this object, if there is one."""
        extensions = self.child("extensions")
        return extensions.child(name, f"{self.where}, {name}") if extensions.has(name) else None


def _is_integer(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= LARGEST_INTEGER


def _is_number(value: object) -> TypeGuard[float]:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= LARGEST_INTEGER if isinstance(value, int) else math.isfinite(value)
