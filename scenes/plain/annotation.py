"""Annotations in a lights file: members of the light objects, put in and taken out byte for byte.

A light gets the flat keys and, under `gnomon`, the whole story, which keeps under `original` what `clear`
needs: the SHA-256 of the file without annotation, whether `geometry` was `absent` and was added, and
`hadStrays` where the file held keys of ours already but no record of them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from scenes.bare_level import NOTHING, RESTORED, Bare
from scenes.errors import LevelError
from scenes.json_splice import Edit, Item, RawJson, Span, spliced
from scenes.light_annotation import OWN_KEYS, Cleared, LightAnnotation, Scalar
from scenes.plain.entries import STORY

_RECORD = "original"
_GEOMETRY = "geometry"

_CHANGED = (
    "Gnomon's annotation is removed, but another program has changed the file since it was annotated,"
    " so the bytes of the original cannot be restored."
)
_STRAYS = (
    "Gnomon's keys are removed, but another program has dropped the record of what the file was before,"
    " so the bytes of the original cannot be restored."
)


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation], geometry: str) -> bytes:
    """The lights file with these annotations, by light, in place of any earlier ones of ours.

    Args:
        source: The lights file; every byte of it that is not ours stays as it is.
        annotations: Number of the light to annotation.
        geometry: Name of the geometry, to be added where the file names none.

    Raises:
        LevelError: It is not valid JSON, or has no such light.
        ValueError: An extension holds a key that is written here: our own bug.
    """
    bare = _bare(RawJson(source))
    if not annotations:
        return bare.data
    raw = RawJson(bare.data)
    original: dict[str, Any] = {"sha256": hashlib.sha256(bare.data).hexdigest()}
    edits = []
    if raw.member(raw.root, _GEOMETRY) is None:
        original["absent"] = [_GEOMETRY]
        edits.append(raw.appending(raw.root, [_member(raw, _GEOMETRY, geometry)]))
    if bare.had_strays:
        original["hadStrays"] = True
    lights = _lights(raw)
    for node, one in annotations.items():
        if _RECORD in one.extension:
            raise ValueError(f'extension key "{_RECORD}" is written by the annotation itself')
        members = [_member(raw, key, value) for key, value in one.extras.items()]
        members.append(_member(raw, STORY, {**one.extension, _RECORD: original}))
        edits.append(raw.appending(_light(raw, lights, node), members))
    return spliced(raw.text, edits)


def read_annotations(source: bytes) -> dict[int, LightAnnotation]:
    """What our annotations in the lights file say, by light, without what `clear` needs.

    Raises:
        LevelError: It is not valid JSON.
    """
    raw = RawJson(source)
    found = {}
    for index, light in enumerate(_lights(raw)):
        if not (ours := _ours(raw, light)):
            continue
        scalars = {item.name: _decoded(raw, item.value) for item in ours if item.name != STORY}
        found[index] = LightAnnotation(
            {key: value for key, value in scalars.items() if isinstance(value, Scalar)},
            {key: value for key, value in _story(raw, ours).items() if key != _RECORD},
        )
    return found


def clear(source: bytes) -> Cleared:
    """The lights file without our annotations.

    Raises:
        LevelError: It is not valid JSON.
    """
    return _bare(RawJson(source)).cleared()


def _bare(raw: RawJson) -> Bare:
    edits: list[Edit] = []
    records: list[dict[str, Any]] = []
    unrecorded = False
    for light in _lights(raw):
        ours = _ours(raw, light)
        edits += raw.removing(light, ours)
        record = _story(raw, ours).get(_RECORD)
        if isinstance(record, dict):
            records.append(record)
        unrecorded |= bool(ours) and not isinstance(record, dict)
    if not edits:
        return Bare(raw.text, had_strays=False, note=NOTHING)
    if any(record.get("absent") == [_GEOMETRY] for record in records):
        geometry = raw.member(raw.root, _GEOMETRY)
        edits += raw.removing(raw.root, [geometry]) if geometry else []
    data = spliced(raw.text, edits)
    had_strays = not records or any(record.get("hadStrays") is True for record in records)
    if records and records[0].get("sha256") == hashlib.sha256(data).hexdigest():
        return Bare(data, had_strays, _STRAYS if had_strays else RESTORED)
    return Bare(data, had_strays or unrecorded, _CHANGED if records else _STRAYS)


def _lights(raw: RawJson) -> list[Span]:
    lights = raw.member(raw.root, "lights")
    if lights is None or raw.kind(lights.value) != "[":
        return []
    return [item.value for item in raw.items(lights.value)]


def _light(raw: RawJson, lights: list[Span], node: int) -> Span:
    if not 0 <= node < len(lights):
        raise LevelError(
            f"The level has no node {node}.",
            known=f"Its lights file has {len(lights)} lights, counted from 0.",
            remedy="Annotate the file that the lights were read from.",
        )
    if raw.kind(lights[node]) != "{":
        raise LevelError("This entry is not a JSON object.", where=f"light {node}")
    return lights[node]


def _ours(raw: RawJson, light: Span) -> list[Item]:
    if raw.kind(light) != "{":
        return []
    return [item for item in raw.items(light) if item.name == STORY or item.name in OWN_KEYS]


def _story(raw: RawJson, ours: list[Item]) -> dict[str, Any]:
    stories = [_decoded(raw, item.value) for item in ours if item.name == STORY]
    return stories[-1] if stories and isinstance(stories[-1], dict) else {}


def _decoded(raw: RawJson, span: Span) -> Any:
    """A value that we may have written; None where it is nested or longer than anything of ours."""
    try:
        value = raw.value(span)
        json.dumps(value, allow_nan=False)
    except (RecursionError, ValueError):
        return None
    return value


def _member(raw: RawJson, name: str, value: object) -> bytes:
    """A member in one line, spaced like the first of the file."""
    members = raw.items(raw.root)
    spaced = not members or raw.text[members[0].value.start - 1 : members[0].value.start] != b":"
    separators = (", ", ": ") if spaced else (",", ":")
    return json.dumps({name: value}, allow_nan=False, separators=separators)[1:-1].encode()
