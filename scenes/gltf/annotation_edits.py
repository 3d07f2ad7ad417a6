"""The edits that put an annotation into the raw JSON text of a glTF file, and those that take it out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from scenes.errors import LevelError
from scenes.gltf.annotation_record import EXTENSION, GltfFile, MarkedNode
from scenes.json_splice import Edit, Item, RawJson, Span
from scenes.light_annotation import Scalar


def declaration(file: GltfFile) -> tuple[list[Edit], dict[str, Any]]:
    """The edits that list our extension in `extensionsUsed`, and what the record says about it.

    Args:
        file: A file without anything of ours.

    Raises:
        LevelError: `extensionsUsed` is not an array.
    """
    raw = file.raw
    used = raw.member(raw.root, "extensionsUsed")
    if used is None:
        member = _written(raw, raw.root, "extensionsUsed", [EXTENSION])
        return [raw.appending(raw.root, [member])], {"absent": ["extensionsUsed"]}
    if raw.kind(used.value) != "[":
        raise _misfit(file, "extensionsUsed", "an array", used.value)
    return [raw.appending(used.value, [json.dumps(EXTENSION).encode()])], {"absent": []}


def removals(file: GltfFile, marked: list[MarkedNode]) -> list[Edit]:
    """The edits that take out everything of ours; containers that we created and emptied go with it."""
    edits = _undeclaration(file, marked)
    for one in marked:
        edits += _node_removals(file, one)
    return edits


def _undeclaration(file: GltfFile, marked: list[MarkedNode]) -> list[Edit]:
    raw = file.raw
    used = raw.member(raw.root, "extensionsUsed")
    if used is None or raw.kind(used.value) != "[":
        return []
    listed = _listed(raw, used.value)
    created = all("extensionsUsed" in one.original.absent for one in marked)
    if created and listed and listed == raw.items(used.value):
        return raw.removing(raw.root, [used])
    return raw.removing(used.value, listed)


def node_edits(
    file: GltfFile,
    index: int,
    extras: Mapping[str, Scalar],
    extension: Mapping[str, Any],
    record: dict[str, Any],
) -> list[Edit]:
    """The edits that put the scalars and the extension, with its record, at one node without any of ours.

    Raises:
        LevelError: There is no such node, or its `extensions` are not an object.
    """
    raw, node = file.raw, _node(file, index)
    before, extensions = raw.member(node, "extras"), raw.member(node, "extensions")
    if extensions is not None and raw.kind(extensions.value) != "{":
        raise _misfit(file, f"node {index}, extensions", "an object", extensions.value)
    fits = before is None or raw.kind(before.value) == "{"
    written, withheld = (dict(extras), {}) if fits else ({}, dict(extras))
    created = [] if extensions else ["extensions"]
    if before is None and written:
        created.append("extras")
    original = {**record, "absent": [*record["absent"], *created], "extras": list(written)}
    ours = {**extension, **({"withheldExtras": withheld} if withheld else {}), "original": original}

    edits, members = [], []
    if extensions:
        edits.append(raw.appending(extensions.value, [_written(raw, extensions.value, EXTENSION, ours)]))
    else:
        members.append(_written(raw, node, "extensions", {EXTENSION: ours}))
    if before and written:
        texts = [_written(raw, before.value, key, value) for key, value in written.items()]
        edits.append(raw.appending(before.value, texts))
    elif written:
        members.append(_written(raw, node, "extras", written))
    return [*edits, raw.appending(node, members)] if members else edits


def _node_removals(file: GltfFile, one: MarkedNode) -> list[Edit]:
    edits: list[Edit] = []
    emptied: list[Item] = []
    for container, ours in ((one.extensions, one.ours), (one.extras, one.keys)):
        if container is None or not ours:
            continue
        if container.name in one.original.absent and ours == file.raw.items(container.value):
            emptied.append(container)
        else:
            edits += file.raw.removing(container.value, ours)
    return edits + file.raw.removing(one.node, emptied)


def _node(file: GltfFile, index: int) -> Span:
    if not 0 <= index < len(file.nodes):
        raise LevelError(
            f"The level has no node {index}.",
            where=file.where,
            known=f"It has {len(file.nodes)} nodes, counted from 0.",
            remedy="Annotate the file that the lights were read from.",
        )
    if file.raw.kind(file.nodes[index]) != "{":
        raise _misfit(file, f"node {index}", "an object", file.nodes[index])
    return file.nodes[index]


def _listed(raw: RawJson, used: Span) -> list[Item]:
    # The longest spelling writes every character as an escape of six.
    longest = 6 * len(EXTENSION) + 2
    items = [item for item in raw.items(used) if item.end - item.start <= longest]
    return [item for item in items if raw.kind(item.value) == '"' and raw.value(item.value) == EXTENSION]


def _misfit(file: GltfFile, place: str, expected: str, found: Span) -> LevelError:
    byte = file.chunk.start + found.start
    return LevelError(
        f"{place} is not {expected}.",
        where=f"{file.where}, byte {byte}" if file.where else f"byte {byte}",
        known=f"Found {file.raw.text[found.start : found.end][:24]!r} there.",
        remedy="Export the level again as valid glTF 2.0.",
    )


def _written(raw: RawJson, container: Span, name: str, value: object) -> bytes:
    """A member, indented like its future neighbours where they stand on lines of their own."""
    members = raw.items(raw.root)
    if not members:
        return json.dumps({name: value}, allow_nan=False, separators=(",", ":"))[1:-1].encode()
    first = members[0]
    separator = raw.separator(container).decode()
    # No editor indents deeper; a file of blanks must not be multiplied.
    _, line_break, indent = (
        raw.text[max(raw.root.start + 1, first.start - 16) : first.start].decode().rpartition("\n")
    )
    if line_break and "\n" in separator:
        text = json.dumps({name: value}, allow_nan=False, indent=indent)
        body = text[text.index('"') : text.rindex("\n")].replace("\n" + indent, separator)
        return body.encode()
    spaced = raw.text[first.value.start - 1 : first.value.start] != b":"
    separators = (", ", ": ") if spaced else (",", ":")
    return json.dumps({name: value}, allow_nan=False, separators=separators)[1:-1].encode()
