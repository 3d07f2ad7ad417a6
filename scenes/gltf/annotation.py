"""Annotations in a glTF or GLB file: written into the raw JSON text, and taken out again byte for byte.

A light node gets flat scalars in its `extras` and the vendor extension. The extension also keeps what
`clear` needs, under `original`:

- `sha256`: digest of the file without annotation;
- `jsonLength`: bytes of its JSON chunk with padding (GLB only);
- `extras`: the keys that were written into this node's `extras`;
- `absent`: which of `extras`, `extensions` (of this node) and `extensionsUsed` were created;
- `hadStrays`: true where the file held keys of ours already, but no record of them.

Such strays are left by programs that keep `extras` and drop the extension, as Blender does. Everything of
ours is taken out before an annotation is written, so nobody reads a stale one; what such a file was like
before cannot be told, so clearing it never counts as restoring it.

Where `extras` is not an object, the scalars stand in the extension under `withheldExtras` instead.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

from scenes.bare_level import NOTHING, RESTORED, Bare
from scenes.gltf.annotation_edits import declaration, node_edits, removals
from scenes.gltf.annotation_record import GltfFile, MarkedNode, decoded, marked_nodes, opened
from scenes.gltf.json_chunk import padded
from scenes.json_splice import RawJson, spliced
from scenes.light_annotation import OWN_KEYS, Cleared, LightAnnotation, Scalar

_RESERVED = frozenset({"original", "withheldExtras"})

_CHANGED = (
    "Gnomon's annotation is removed, but another program has changed the file since it was annotated,"
    " so the bytes of the original cannot be restored."
)
_STRAYS = (
    "Gnomon's keys are removed, but another program has dropped the record of what the file was before,"
    " so the bytes of the original cannot be restored."
)


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation], *, where: str = "") -> bytes:
    """The glTF or GLB file with these annotations, by node index, in place of any earlier ones of ours.

    Args:
        source: The whole file; every byte of it that is not ours stays as it is.
        annotations: Node index to annotation. The same ones give the same bytes.
        where: Name of the file, for errors.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB, or has no such node.
        ValueError: An extension holds a key that is written here: our own bug.
    """
    file = opened(source, where)
    bare = _bare(file)
    if not annotations:
        return bare.data
    if bare.data is not source:
        file = opened(bare.data, where)
    raw = file.raw
    edits, record = declaration(file)
    record["sha256"] = hashlib.sha256(bare.data).hexdigest()
    if file.chunk.binary:
        record["jsonLength"] = len(raw.text)
    if bare.had_strays:
        record["hadStrays"] = True
    for index, one in annotations.items():
        if taken := sorted(_RESERVED & one.extension.keys()):
            raise ValueError(f"extension keys {taken} are written by the annotation itself")
        edits += node_edits(file, index, one.extras, one.extension, record)
    text = spliced(raw.text, edits)
    return file.chunk.holding(padded(text) if file.chunk.binary else text)


def read_annotations(source: bytes, *, where: str = "") -> dict[int, LightAnnotation]:
    """What our annotations in the glTF or GLB file say, by node index, without what `clear` needs.

    Given to `annotate`, they are written the same once more. What other programs have made of them that we
    would never write, such as a list among the scalars, is left out, and so is a node with `extensions` that
    are no object: it takes no annotation.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    file = opened(source, where)
    index = {node: number for number, node in enumerate(file.nodes)}
    return {
        index[one.node]: _annotation(file.raw, one)
        for one in marked_nodes(file)
        if (extensions := file.raw.member(one.node, "extensions")) is None
        or file.raw.kind(extensions.value) == "{"
    }


def clear(source: bytes, *, where: str = "") -> Cleared:
    """The glTF or GLB file without our annotations.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    return _bare(opened(source, where)).cleared()


def is_annotated(source: bytes) -> bool:
    """Whether any node of the glTF or GLB file carries our extension.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    return any(one.ours for one in marked_nodes(opened(source, "")))


def _annotation(raw: RawJson, one: MarkedNode) -> LightAnnotation:
    extension = decoded(raw, one.ours[-1].value) if one.ours else {}
    extension = extension if isinstance(extension, dict) else {}
    withheld = extension.get("withheldExtras")
    scalars = {item.name: decoded(raw, item.value) for item in one.keys}
    scalars = (withheld if isinstance(withheld, dict) else {}) | scalars
    return LightAnnotation(
        {key: value for key, value in scalars.items() if key in OWN_KEYS and isinstance(value, Scalar)},
        {key: value for key, value in extension.items() if key not in _RESERVED},
    )


def _bare(file: GltfFile) -> Bare:
    marked = marked_nodes(file)
    edits = removals(file, marked)
    if not edits:
        return Bare(file.chunk.source, had_strays=False, note=NOTHING)
    raw = file.raw
    text = spliced(raw.text, edits)
    root_end = raw.root.end - (len(raw.text) - len(text))
    records = [one.original for one in marked if one.ours]
    had_strays = not records or any(one.had_strays for one in records)
    if records:
        length = records[0].json_length
        exact = file.chunk.holding(text if length is None else text[: max(length, root_end)])
        if hashlib.sha256(exact).hexdigest() == records[0].sha256:
            return Bare(exact, had_strays, _STRAYS if had_strays else RESTORED)
    data = file.chunk.holding(padded(text[:root_end]) if file.chunk.binary else text)
    had_strays |= any(not one.ours for one in marked)
    return Bare(data, had_strays, _CHANGED if records else _STRAYS)
