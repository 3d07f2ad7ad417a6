"""Annotations in a .map: put before the keys of a light entity, and taken out again byte for byte.

Each piece of ours, comment or key, stands directly before what was there first, followed by the blanks that
stood before that: so taking out a piece up to what follows it restores the bytes. The comment keeps, under
`original`, the SHA-256 of the file without annotation, and `hadStrays` where the file held keys of ours
already but no comment. Such strays are left by editors, which keep keys and drop comments when they save;
they are taken out before an annotation is written, and clearing such a file never counts as restoring it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from typing import Any

from scenes.bare_level import NOTHING, RESTORED, Bare
from scenes.errors import LevelError
from scenes.json_splice import Edit, spliced
from scenes.light_annotation import OWN_KEYS, Cleared, LightAnnotation
from scenes.quake.annotation_text import OWN_PAIRS, comment_text, is_ours, pair_text, scalars, story
from scenes.quake.map_parser import parse_map
from scenes.quake.map_text import Entity, MapText

_RECORD = "original"
_LONGEST_INDENT = 64

_CHANGED = (
    "Gnomon's annotation is removed, but another program has changed the file since it was annotated,"
    " so the bytes of the original cannot be restored."
)
_STRAYS = (
    "Gnomon's keys are removed, but another program has dropped the record of what the file was before,"
    " so the bytes of the original cannot be restored."
)


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation]) -> bytes:
    """The map with these annotations, by entity, in place of any earlier ones of ours.

    Raises:
        LevelError: The file is no map, or has no such entity.
        ValueError: An extension holds a key that is written here: our own bug.
    """
    bare = _bare(parse_map(source))
    if not annotations:
        return bare.data
    text = parse_map(bare.data)
    original: dict[str, Any] = {"sha256": hashlib.sha256(bare.data).hexdigest()}
    if bare.had_strays:
        original["hadStrays"] = True
    edits = [
        _insertion(text, _entity(text, node), one, original) for node, one in sorted(annotations.items())
    ]
    return spliced(bare.data, edits)


def read_annotations(source: bytes) -> dict[int, LightAnnotation]:
    """What our annotations in the map say, by entity, without what `clear` needs.

    Raises:
        LevelError: The file is no map.
    """
    found = {}
    for entity in parse_map(source).entities:
        if _has_ours(entity):
            extension = {key: value for key, value in story(entity.comments).items() if key != _RECORD}
            found[entity.index] = LightAnnotation(scalars(entity.pairs), extension)
    return found


def clear(source: bytes) -> Cleared:
    """The map without our annotations.

    Raises:
        LevelError: The file is no map.
    """
    return _bare(parse_map(source)).cleared()


def _bare(text: MapText) -> Bare:
    edits = list(_removals(text))
    if not edits:
        return Bare(text.source, had_strays=False, note=NOTHING)
    data = spliced(text.source, edits)
    records = [_record(entity) for entity in text.entities if any(map(is_ours, entity.comments))]
    had_strays = not records or any(record.get("hadStrays") is True for record in records)
    if records and records[0].get("sha256") == hashlib.sha256(data).hexdigest():
        return Bare(data, had_strays, _STRAYS if had_strays else RESTORED)
    had_strays |= any(
        _has_ours(entity) and not any(map(is_ours, entity.comments)) for entity in text.entities
    )
    return Bare(data, had_strays, _CHANGED if records else _STRAYS)


def _record(entity: Entity) -> dict[str, Any]:
    record = story(entity.comments).get(_RECORD)
    return record if isinstance(record, dict) else {}


def _has_ours(entity: Entity) -> bool:
    return any(pair.key in OWN_PAIRS for pair in entity.pairs) or any(map(is_ours, entity.comments))


def _removals(text: MapText) -> Iterator[Edit]:
    """One edit for each piece of ours: from its first byte up to whatever comes next in the entity."""
    for entity in text.entities:
        if not _has_ours(entity):
            continue
        ours = {pair.start for pair in entity.pairs if pair.key in OWN_PAIRS}
        ours |= {comment.start for comment in entity.comments if is_ours(comment)}
        following = [start for start, _ in entity.items[1:]] + [entity.end]
        for (start, _), end in zip(entity.items, following, strict=True):
            if start in ours:
                yield Edit(start, end, b"")


def _insertion(text: MapText, entity: Entity, one: LightAnnotation, original: Mapping[str, Any]) -> Edit:
    if _RECORD in one.extension:
        raise ValueError(f'extension key "{_RECORD}" is written by the annotation itself')
    assert one.extras.keys() <= OWN_KEYS
    start = entity.pairs[0].start
    separator = _separator(text.source, start)
    # A comment ends with its line, so behind it there must be a new one.
    line_break = separator if b"\n" in separator or b"\r" in separator else _line_break(text.source)
    pieces = [comment_text(one.extension, original) + line_break]
    pieces += [pair_text(key, value) + (separator or b" ") for key, value in one.extras.items()]
    return Edit(start, start, b"".join(pieces))


def _separator(source: bytes, start: int) -> bytes:
    """The blanks before a key: where it stands on a line of its own, one line's end and its indentation."""
    before = source[max(0, start - _LONGEST_INDENT) : start]
    blanks = before[len(before.rstrip(b" \t\r\n")) :]
    for line_break in (b"\r\n", b"\n", b"\r"):
        if line_break in blanks:
            return line_break + blanks.rpartition(line_break)[2]
    return blanks


def _line_break(source: bytes) -> bytes:
    return b"\r\n" if b"\r\n" in source else b"\n"


def _entity(text: MapText, node: int) -> Entity:
    if not 0 <= node < len(text.entities):
        raise LevelError(
            f"The level has no node {node}.",
            known=f"It has {len(text.entities)} entities, counted from 0.",
            remedy="Annotate the file that the lights were read from.",
        )
    entity = text.entities[node]
    if not entity.pairs:
        raise LevelError(
            "This entity has no keys, so it is no light.",
            where=f"line {entity.line}, {entity.where}",
            remedy="Annotate the file that the lights were read from.",
        )
    return entity
