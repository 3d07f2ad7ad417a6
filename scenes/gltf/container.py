"""GLB and glTF files: bytes into one JSON object and the binary chunk that comes with it.

Source: glTF 2.0 specification (Khronos), sections 3.2 "Asset" and 4 "GLB File Format Specification".
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any, NoReturn

from scenes.errors import LevelError
from scenes.gltf.entry import Entry

MAGIC = b"glTF"
HEADER_BYTES = 12
CHUNK_HEADER_BYTES = 8
JSON_CHUNK = 0x4E4F534A
BINARY_CHUNK = 0x004E4942


@dataclass(frozen=True)
class Container:
    """What a GLB holds.

    Attributes:
        json_text: The JSON chunk, with its padding.
        binary: The BIN chunk, if there is one.
        trailing_bytes: Bytes after the length that the header states.
    """

    json_text: bytes
    binary: bytes | None
    trailing_bytes: int = 0


def open_container(source: bytes, *, binary_expected: bool) -> Container:
    """The JSON text and the binary chunk of a file.

    Args:
        source: The whole file.
        binary_expected: Whether its name promises a GLB.

    Raises:
        LevelError: It should be a GLB and is none, or is a broken one.
    """
    if source.startswith(MAGIC):
        return split_glb(source)
    if binary_expected:
        looks_like_json = source.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{")
        raise LevelError(
            "This is not a binary glTF file.",
            where="byte 0",
            known=f"It starts with {source[:4]!r}, a GLB with {MAGIC!r}.",
            remedy="It looks like JSON: name it .gltf." if looks_like_json else "Export the level again.",
        )
    return Container(source, None)


def split_glb(source: bytes) -> Container:
    """The chunks of a GLB; chunks of other kinds are ignored, as the specification asks.

    Raises:
        LevelError: The header or a chunk is cut off, the version is not 2, or the first chunk is not JSON.
    """
    if len(source) < HEADER_BYTES:
        raise _truncated("inside its header", len(source), HEADER_BYTES)
    version, length = struct.unpack_from("<II", source, 4)
    if version != 2:
        raise LevelError(
            f"This is binary glTF version {version}; only version 2 is read.",
            where="byte 4",
            remedy="Export the level as glTF 2.0.",
        )
    if length > len(source):
        raise _truncated("before the length that its header states", len(source), length)
    chunks = _chunks(source, length)
    if not chunks or chunks[0][0] != JSON_CHUNK:
        raise LevelError("The first chunk of this GLB is not its JSON.", where=f"byte {HEADER_BYTES}")
    binary = next((content for kind, content in chunks if kind == BINARY_CHUNK), None)
    return Container(chunks[0][1], binary, len(source) - length)


def _chunks(source: bytes, length: int) -> list[tuple[int, bytes]]:
    chunks = []
    offset = HEADER_BYTES
    while offset < length:
        start = offset + CHUNK_HEADER_BYTES
        if start > length:
            raise _truncated(f"inside the chunk header at byte {offset}", length, start)
        size, kind = struct.unpack_from("<II", source, offset)
        if start + size > length:
            raise _truncated(f"inside the chunk at byte {offset}", length, start + size)
        chunks.append((kind, source[start : start + size]))
        # Real files have JSON chunks of unaligned length with the next chunk right behind.
        offset = start + size
    return chunks


def _truncated(place: str, found: int, needed: int) -> LevelError:
    return LevelError(
        f"This GLB ends {place}.",
        where=f"byte {found}",
        known=f"It has {found} bytes and needs {needed}.",
        remedy="It was cut off: copy or export it again.",
    )


def parse_json(text: bytes) -> Entry:
    """The root object of a glTF 2.0 file.

    Raises:
        LevelError: The text is not UTF-8, not JSON, nested too deep, no object, or not glTF 2.
    """
    root = _decoded(text)
    if not isinstance(root, dict):
        raise LevelError("The JSON of a glTF file must be an object.", where="JSON")
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
        # Some exporters pad with NUL, and some editors write a byte order mark.
        return json.loads(text.rstrip(b"\0").decode("utf-8-sig"), parse_constant=_refuse_constant)
    except UnicodeDecodeError as error:
        raise LevelError(
            "The JSON is not UTF-8.",
            where=f"JSON byte {error.start}",
            remedy="Save the file as UTF-8.",
        ) from None
    except json.JSONDecodeError as error:
        raise LevelError(
            "The JSON is not valid.",
            where=f"JSON line {error.lineno}, column {error.colno}",
            known=f"{error.msg}.",
        ) from None
    except RecursionError:
        raise LevelError("The JSON is nested too deep.", where="JSON") from None
    except ValueError as error:
        raise LevelError("The JSON is not valid.", where="JSON", known=f"{error}.") from None


def _refuse_constant(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not a JSON number")
