"""Annotations in a glTF or GLB file: written into the raw JSON text, and taken out again byte for byte.

A light node gets flat scalars in its `extras` and the vendor extension. The extension also keeps what
`clear` needs, under `original`:

- `sha256`: digest of the file without annotation;
- `jsonLength`: bytes of its JSON chunk with padding (GLB only);
- `extras`: the keys that were written into this node's `extras`;
- `absent`: which of `extras`, `extensions` (of this node) and `extensionsUsed` were created;
- `declared`: true where the author had already listed the extension in `extensionsUsed`.

Scalars whose key the author uses himself, and all of them where `extras` is not an object, stand in the
extension under `withheldExtras` instead.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from scenes.gltf.annotation_edits import declaration, node_edits, node_removals, undeclaration
from scenes.gltf.annotation_record import (
    EXTENSION,
    PREFIX,
    AnnotatedNode,
    GltfFile,
    Scalar,
    annotated_nodes,
    opened,
)
from scenes.gltf.json_chunk import padded
from scenes.gltf.json_splice import spliced

__all__ = ["EXTENSION", "Cleared", "LightAnnotation", "annotate", "clear", "is_annotated"]

_RESERVED = ("original", "withheldExtras")


@dataclass(frozen=True)
class LightAnnotation:
    """What is written at one light node.

    Attributes:
        extras: Flat scalars for the node's `extras`; every key starts with `gnomon_`.
        extension: JSON object for the vendor extension on the same node.

    Raises:
        ValueError: A key or value that must not be written: our own bug.
    """

    extras: Mapping[str, Scalar]
    extension: Mapping[str, Any]

    def __post_init__(self) -> None:
        for key, value in self.extras.items():
            if not key.startswith(PREFIX):
                raise ValueError(f"extras key {key!r} does not start with {PREFIX}")
            if not isinstance(value, Scalar):
                raise ValueError(f"extras value of {key} is no scalar: {value!r}")  # noqa: TRY004 - one kind of error
            if isinstance(value, float) and not math.isfinite(value):
                raise ValueError(f"extras value of {key} is {value}, which JSON cannot hold")
        if taken := [key for key in _RESERVED if key in self.extension]:
            raise ValueError(f"extension keys {taken} are written by the annotation itself")
        json.dumps(dict(self.extension), allow_nan=False)


@dataclass(frozen=True)
class Cleared:
    """A file without our annotation.

    Attributes:
        data: The file.
        restored: Whether it is, by SHA-256, byte for byte the file that was annotated.
        note: One sentence for the user.
    """

    data: bytes
    restored: bool
    note: str


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation], *, where: str = "") -> bytes:
    """The glTF or GLB file with these annotations, by node index, in place of any earlier ones of ours.

    Args:
        source: The whole file; every byte of it that is not ours stays as it is.
        annotations: Node index to annotation. The same ones give the same bytes.
        where: Name of the file, for errors.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB, or has no such node.
    """
    file = opened(source, where)
    if annotated := annotated_nodes(file):
        source = _cleared(file, annotated).data
        file = opened(source, where)
    if not annotations:
        return source
    raw = file.raw
    edits, record = declaration(file)
    record["sha256"] = hashlib.sha256(source).hexdigest()
    if file.chunk.binary:
        record["jsonLength"] = len(raw.text)
    for index, one in annotations.items():
        edits += node_edits(file, index, one.extras, one.extension, record)
    text = spliced(raw.text, edits)
    return file.chunk.holding(padded(text) if file.chunk.binary else text)


def clear(source: bytes, *, where: str = "") -> Cleared:
    """The glTF or GLB file without our annotations.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    file = opened(source, where)
    annotated = annotated_nodes(file)
    if not annotated:
        return Cleared(source, restored=True, note="There was nothing to clear.")
    return _cleared(file, annotated)


def is_annotated(source: bytes) -> bool:
    """Whether any node of the glTF or GLB file carries our extension.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    return bool(annotated_nodes(opened(source, "")))


def _cleared(file: GltfFile, annotated: list[AnnotatedNode]) -> Cleared:
    raw = file.raw
    edits = undeclaration(file, annotated)
    for one in annotated:
        edits += node_removals(file, one)
    text = spliced(raw.text, edits)
    root_end = raw.root.end - (len(raw.text) - len(text))
    original = annotated[0].original
    exact = text if original.json_length is None else text[: max(original.json_length, root_end)]
    data = file.chunk.holding(exact)
    if hashlib.sha256(data).hexdigest() == original.sha256:
        return Cleared(data, restored=True, note="The original is restored byte for byte.")
    if file.chunk.binary:
        data = file.chunk.holding(padded(text[:root_end]))
    note = (
        "Gnomon's annotation is removed, but another program has changed the file since it was annotated,"
        " so the bytes of the original cannot be restored."
    )
    return Cleared(data, restored=False, note=note)
