"""What a glTF or GLB file says about the annotation it carries: the nodes, and what was there before."""

from __future__ import annotations

from dataclasses import dataclass, field

from scenes.gltf.json_chunk import JsonChunk, find_json
from scenes.gltf.json_splice import Item, RawJson, Span

EXTENSION = "GNOMON_lights_shadow_technique"
PREFIX = "gnomon_"
Scalar = str | float | int | bool
# Some exporters pad the JSON chunk with zeros, against the specification.
_GLB_PADDING = b" \t\n\r\0"


@dataclass(frozen=True)
class Original:
    """What the extension of one node says about the file without annotation.

    Attributes:
        sha256: Digest of that file; empty where the extension does not say.
        json_length: Bytes of its JSON chunk with padding, if it is a GLB.
        extras: Keys that we wrote into the node's `extras`.
        absent: Which of `extras`, `extensions` and `extensionsUsed` we created.
        declared: Whether the author had listed our extension in `extensionsUsed` already.
    """

    sha256: str = ""
    json_length: int | None = None
    extras: frozenset[str] = frozenset()
    absent: frozenset[str] = frozenset()
    declared: bool = False


@dataclass(frozen=True)
class AnnotatedNode:
    """A node that carries our extension.

    Attributes:
        node: Span of the node object.
        extensions: Its `extensions` member.
        ours: Our members in it: one, unless another program has doubled it.
        original: What the last of them says.
    """

    node: Span
    extensions: Item
    ours: list[Item]
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
    if chunk.binary:
        raw = RawJson(chunk.text, where=where, offset=chunk.start, trailing=_GLB_PADDING)
    else:
        raw = RawJson(chunk.text, where=where)
    nodes = raw.member(raw.root, "nodes")
    if nodes is None or raw.kind(nodes.value) != "[":
        return GltfFile(chunk, raw, where)
    return GltfFile(chunk, raw, where, [item.value for item in raw.items(nodes.value)])


def annotated_nodes(file: GltfFile) -> list[AnnotatedNode]:
    """The nodes that carry our extension, in order."""
    found = []
    for node in file.nodes:
        if file.raw.kind(node) != "{" or not _may_name_us(file.raw.text, node):
            continue
        extensions = file.raw.member(node, "extensions")
        if extensions is None or file.raw.kind(extensions.value) != "{":
            continue
        ours = [item for item in file.raw.items(extensions.value) if item.name == EXTENSION]
        if ours:
            found.append(AnnotatedNode(node, extensions, ours, _original(file.raw, ours[-1].value)))
    return found


def _may_name_us(text: bytes, node: Span) -> bool:
    # A key may be spelt with escapes. Most nodes are done with here: files have thousands of them.
    return text.find(EXTENSION.encode(), *node) >= 0 or text.find(b"\\", *node) >= 0


def _original(raw: RawJson, extension: Span) -> Original:
    member = raw.member(extension, "original") if raw.kind(extension) == "{" else None
    if member is None:
        return Original()
    try:
        record = raw.value(member.value)
    except (RecursionError, ValueError):
        # Nothing that we wrote: no record, so `clear` will say that it cannot restore the bytes.
        return Original()
    if not isinstance(record, dict):
        return Original()
    length = record.get("jsonLength")
    return Original(
        sha256=str(record.get("sha256")),
        json_length=length if isinstance(length, int) else None,
        extras=frozenset(name for name in _strings(record.get("extras")) if name.startswith(PREFIX)),
        absent=frozenset(_strings(record.get("absent"))),
        declared=record.get("declared") is True,
    )


def _strings(value: object) -> list[str]:
    return [item for item in value if isinstance(item, str)] if isinstance(value, list) else []
