"""What a glTF or GLB file says about the annotation it carries: the nodes, and what was there before."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from scenes.gltf.json_chunk import PADDING, JsonChunk, find_json
from scenes.json_splice import Item, RawJson, Span
from scenes.light_annotation import MOBILITY_KEY, OWN_KEYS

EXTENSION = "GNOMON_lights_shadow_technique"
PREFIX = "gnomon_"


@dataclass(frozen=True)
class Original:
    """What the extension of one node says about the file without annotation.

    Attributes:
        sha256: Digest of that file; empty where nothing says it.
        json_length: Bytes of its JSON chunk with padding, if it is a GLB.
        extras: Keys that we wrote into the node's `extras`.
        absent: Which of `extras`, `extensions` and `extensionsUsed` we created; all where nothing says it.
        had_strays: Whether the file held keys of ours already, without a record.
    """

    sha256: str = ""
    json_length: int | None = None
    extras: frozenset[str] = frozenset()
    absent: frozenset[str] = frozenset({"extras", "extensions", "extensionsUsed"})
    had_strays: bool = False


@dataclass(frozen=True)
class MarkedNode:
    """A node that carries our extension, or keys of ours in its `extras`.

    Attributes:
        node: Span of the node object.
        extensions: Its `extensions` member, where that holds ours.
        ours: Our members in it: one, unless another program has doubled it or dropped it.
        extras: Its `extras` member, if that is an object.
        keys: Our members in it.
        original: What our last extension says.
    """

    node: Span
    extensions: Item | None
    ours: list[Item]
    extras: Item | None
    keys: list[Item]
    original: Original


@dataclass(frozen=True)
class GltfFile:
    """A glTF or GLB file, opened for splicing.

    Attributes:
        chunk: Where its JSON text lies.
        raw: The JSON text, in spans.
        where: Name of the file, for errors.
        nodes: Spans of its nodes, in order.
    """

    chunk: JsonChunk
    raw: RawJson
    where: str
    nodes: list[Span] = field(default_factory=list)


def opened(source: bytes, where: str) -> GltfFile:
    """The file in spans.

    Raises:
        LevelError: It is not valid glTF JSON or GLB.
    """
    chunk = find_json(source, where=where)
    raw = RawJson(chunk.text, where=where, offset=chunk.start, trailing=PADDING)
    nodes = raw.member(raw.root, "nodes")
    if nodes is None or raw.kind(nodes.value) != "[":
        return GltfFile(chunk, raw, where)
    return GltfFile(chunk, raw, where, [item.value for item in raw.items(nodes.value)])


def marked_nodes(file: GltfFile) -> list[MarkedNode]:
    """The nodes that carry anything of ours, in order."""
    found = []
    for node in file.nodes:
        if file.raw.kind(node) != "{" or not _may_name_us(file.raw.text, node):
            continue
        extensions, ours = _members(file.raw, node, "extensions", frozenset({EXTENSION}))
        original = _original(file.raw, ours[-1].value) if ours else Original()
        extras, keys = _members(file.raw, node, "extras", OWN_KEYS | original.extras)
        if ours or keys:
            found.append(MarkedNode(node, extensions, ours, extras, keys, original))
    return found


def decoded(raw: RawJson, span: Span) -> Any:
    """A JSON value that we may have written, or None where it is one that we cannot have written.

    That is one nested too deep, or with a number that Python's `int` or a `float` does not hold.
    """
    try:
        value = raw.value(span)
        json.dumps(value, allow_nan=False)
    except (RecursionError, ValueError):
        return None
    return value


def _members(
    raw: RawJson, node: Span, container: str, names: frozenset[str]
) -> tuple[Item | None, list[Item]]:
    """A node's `extras` or `extensions`, if it is an object, and those of its members with these names."""
    member = raw.member(node, container)
    if member is None or raw.kind(member.value) != "{":
        return None, []
    return member, [item for item in raw.items(member.value) if item.name in names]


def _may_name_us(text: bytes, node: Span) -> bool:
    # A key may be spelt with escapes. Most nodes are done with here: files have thousands of them.
    return any(text.find(one, *node) >= 0 for one in (EXTENSION.encode(), PREFIX.encode(), b"\\"))


def _original(raw: RawJson, extension: Span) -> Original:
    member = raw.member(extension, "original") if raw.kind(extension) == "{" else None
    if member is None:
        return Original()
    record = decoded(raw, member.value)
    if not isinstance(record, dict):
        # Nothing that we wrote: no record, so `clear` will say that it cannot restore the bytes.
        return Original()
    length = record.get("jsonLength")
    return Original(
        sha256=str(record.get("sha256")),
        json_length=length if isinstance(length, int) else None,
        extras=frozenset(
            name
            for name in _strings(record.get("extras"))
            if name.startswith(PREFIX) and name != MOBILITY_KEY
        ),
        absent=frozenset(_strings(record.get("absent"))),
        had_strays=record.get("hadStrays") is True,
    )


def _strings(value: object) -> list[str]:
    return [item for item in value if isinstance(item, str)] if isinstance(value, list) else []
