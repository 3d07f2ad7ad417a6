"""GLB and glTF files: bytes into one JSON object and the binary chunk that comes with it.

Source: glTF 2.0 specification (Khronos), sections 3.2 "Asset" and 4 "GLB File Format Specification".
"""

from __future__ import annotations

import json
import reprlib
import sys
from dataclasses import dataclass
from typing import Any, NoReturn

from scenes.entry import Entry, printable
from scenes.errors import LevelError
from scenes.gltf.json_chunk import BINARY_CHUNK, CHUNK, MAGIC, PADDING, JsonChunk, chunk_at, find_json


@dataclass(frozen=True)
class Container:
    """What a GLB holds.

    Attributes:
        json_text: The JSON chunk, with its padding.
        binary: The BIN chunk, if there is one: a view of the file, which is not copied.
        trailing_bytes: Bytes after the length that the header states.
    """

    json_text: bytes
    binary: memoryview | None
    trailing_bytes: int = 0


def open_container(source: bytes, *, binary_expected: bool) -> Container:
    """The JSON text and the binary chunk of a file.

    Args:
        source: The whole file.
        binary_expected: Whether its name promises a GLB.

    Raises:
        LevelError: It should be a GLB and is none, or is a broken one.
    """
    chunk = find_json(source)
    if chunk.binary:
        return Container(chunk.text, _binary(chunk), len(source) - chunk.total)
    if binary_expected:
        looks_like_json = source.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{")
        raise LevelError(
            "This is not a binary glTF file.",
            where="byte 0",
            known=f"It starts with {source[:4]!r}, a GLB with {MAGIC!r}.",
            remedy="It looks like JSON: name it .gltf." if looks_like_json else "Export the level again.",
        )
    return Container(source, None)


def _binary(json_chunk: JsonChunk) -> memoryview | None:
    """The first BIN chunk; chunks of other kinds are ignored, as the specification asks."""
    found = None
    offset = json_chunk.end
    # Real files have JSON chunks of unaligned length with the next chunk right behind.
    while offset < json_chunk.total:
        kind, end = chunk_at(json_chunk.source, offset, json_chunk.total)
        if kind == BINARY_CHUNK and found is None:
            found = memoryview(json_chunk.source)[offset + CHUNK.size : end]
        offset = end
    return found


def parse_json(text: bytes) -> Entry:
    """The root object of a glTF 2.0 file.

    Raises:
        LevelError: The text is not UTF-8, not JSON, nested too deep, no object, or not glTF 2.
    """
    root = _decoded(text)
    if not isinstance(root, dict):
        raise LevelError(
            "The JSON of a glTF file must be an object.",
            where="JSON",
            known=f"It is {printable(reprlib.repr(root))}.",
            remedy="Is this a glTF file? If so, export it again.",
        )
    entry = Entry(root, "JSON root")
    asset = entry.child("asset", "asset")
    version = asset.text("version")
    if not version.startswith("2.") or asset.text("minVersion") not in ("", "2.0"):
        found = asset.text("minVersion") or version
        raise LevelError(
            "Only glTF 2.0 is read.",
            where="asset",
            known=f'This file asks for version "{found}".' if found else "This file states no version.",
            remedy="Export the level as glTF 2.0.",
        )
    return entry


def _decoded(text: bytes) -> Any:
    try:
        # Some editors write a byte order mark.
        return json.loads(text.rstrip(PADDING).decode("utf-8-sig"), parse_constant=_refuse_constant)
    except UnicodeDecodeError as error:
        raise LevelError(
            "The JSON is not UTF-8.",
            where=f"JSON byte {error.start}",
            known=f"Found {text[error.start : error.start + 8]!r} there.",
            remedy="Export the level again, or save the text as UTF-8.",
        ) from None
    except json.JSONDecodeError as error:
        excerpt = error.doc[error.pos : error.pos + 24]
        raise LevelError(
            "The JSON is not valid.",
            where=f"JSON line {error.lineno}, column {error.colno}",
            known=f"{error.msg}: found {excerpt!r}." if excerpt else f"{error.msg}: the text ends there.",
            remedy="Export the level again, or repair the text at that place.",
        ) from None
    except RecursionError:
        raise LevelError(
            "The JSON is nested too deep.", where="JSON", remedy="No exporter writes this: export it again."
        ) from None
    except ValueError:
        # Nothing else is left that `json` refuses so.
        raise LevelError(
            "A number in the JSON has too many digits.",
            where="JSON",
            known=f"At most {sys.get_int_max_str_digits()} digits are read.",
            remedy="No exporter writes this: export it again.",
        ) from None


def _refuse_constant(constant: str) -> NoReturn:
    raise LevelError("The JSON is not valid.", where="JSON", known=f"{constant} is not a JSON number.")
