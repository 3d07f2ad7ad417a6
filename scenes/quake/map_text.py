"""What a Quake .map file says: entities, keys and brush faces, each with its place in the bytes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenes.scene import Array

Indices = npt.NDArray[np.int64]


class Pair(NamedTuple):
    """A key of an entity with its value, and their bytes with all four quotes."""

    key: str
    value: str
    start: int
    end: int


class Comment(NamedTuple):
    """The text behind `//` up to the line's end, and its bytes with the slashes."""

    text: bytes
    start: int
    end: int


@dataclass
class Entity:
    """One entity.

    Attributes:
        index: Its place in the file, from 0 on.
        line: The line of its opening brace.
        pairs: Its keys, in the order of the file.
        comments: The comments between them, outside brushes.
        brushes: Index of its first brush, and the one behind its last.
        items: First byte and the byte behind the last of all keys, comments and brushes in it, in order.
        end: Byte of its closing brace.
    """

    index: int
    line: int
    pairs: list[Pair] = field(default_factory=list)
    comments: list[Comment] = field(default_factory=list)
    brushes: tuple[int, int] = (0, 0)
    items: list[tuple[int, int]] = field(default_factory=list)
    end: int = 0

    def value(self, *keys: str) -> str:
        """The value of the first of these keys that is there, in upper or lower case; empty without one."""
        return next((self._values[key] for key in keys if key in self._values), "")

    @cached_property
    def _values(self) -> dict[str, str]:
        """Asked for when the entity is complete."""
        return {pair.key.lower(): pair.value for pair in self.pairs}

    @property
    def kind(self) -> str:
        """Its class name, in lower case."""
        return self.value("classname").lower()

    @property
    def where(self) -> str:
        """Its place, for notes and errors."""
        return f'entity {self.index} "{self.kind}"' if self.kind else f"entity {self.index}"


@dataclass(frozen=True)
class MapText:
    """A parsed file.

    Attributes:
        source: Its bytes.
        entities: Its entities, in order.
        points: (f, 3, 3) float64: the three points of each face's plane, in Quake's units and axes.
        textures: Texture of each face, in lower case.
        face_offsets: (b + 1,) int64: brush i has faces face_offsets[i] .. face_offsets[i + 1].
        brush_lines: Line of each brush's opening brace.
        skipped: What was stepped over: its word, such as `patchDef2`, and how often.
    """

    source: bytes
    entities: list[Entity]
    points: Array
    textures: list[str]
    face_offsets: Indices
    brush_lines: list[int]
    skipped: Counter[str]
