"""The bytes behind a glTF buffer: the BIN chunk, a data URI or a file in the level's folder.

Source: glTF 2.0 specification (Khronos), sections 3.6.1 and 2.8 (URIs); RFC 2397 (data URIs).
"""

from __future__ import annotations

import base64
import binascii
import os
import re
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.entry import Entry
from scenes.level_file import read_level_file

SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


def load_buffer(asset: Asset, index: int, referrer: str) -> memoryview:
    """The `byteLength` bytes of a buffer.

    Raises:
        LevelError: The buffer does not exist, has no data, names a file that is missing, not local or
            outside the level's folder, or its data is shorter than it states.
    """
    buffer = asset.entry("buffers", index, referrer)
    length = buffer.integer("byteLength")
    content = _content(asset, index, buffer, length)
    if len(content) < length:
        raise LevelError(
            f"The data of this buffer has {len(content)} bytes.",
            where=buffer.where,
            known=f"Its byteLength is {length}.",
            remedy="It was cut off, or belongs to another version of the level: export both again.",
        )
    return memoryview(content)[:length]


def has_data(asset: Asset, index: int, referrer: str) -> bool:
    """Whether a buffer names data at all; fallback buffers of compressed files need not."""
    buffer = asset.entry("buffers", index, referrer)
    return buffer.has("uri") or (index == 0 and asset.binary is not None)


def _content(asset: Asset, index: int, buffer: Entry, length: int) -> bytes:
    uri = buffer.text("uri")
    if not uri:
        if index == 0 and asset.binary is not None:
            return asset.binary
        raise LevelError(
            "This buffer has no data.",
            where=buffer.where,
            known="It names no uri, and only the first buffer of a GLB with a binary chunk may do so.",
        )
    if uri.startswith("data:"):
        return _data_uri(uri, buffer)
    path = _local_path(uri, asset.folder, buffer)
    try:
        return read_level_file(path, limit=length)
    except LevelError as error:
        raise LevelError(
            f"The buffer file {uri} cannot be used.",
            where=buffer.where,
            known=str(error),
            remedy="Put it beside the level, under this name.",
        ) from None


def _data_uri(uri: str, buffer: Entry) -> bytes:
    header, comma, payload = uri.partition(",")
    if not comma:
        raise LevelError("The data URI has no data.", where=buffer.where, known="It has no comma.")
    content = unquote_to_bytes(payload)
    if not header.endswith(";base64"):
        return content
    try:
        return base64.b64decode(content, validate=True)
    except binascii.Error as error:
        raise LevelError("The data URI is not valid base64.", where=buffer.where, known=f"{error}.") from None


def _local_path(uri: str, folder: Path, buffer: Entry) -> Path:
    if SCHEME.match(uri) or uri.startswith(("/", "\\")):
        raise LevelError(
            f"The uri {uri[:80]} is absolute; only files beside the level are read.",
            where=buffer.where,
            remedy="Put the file into the level's folder and name it relative to the level.",
        )
    # By its text, not by what links on disk point to: those were made by the user, not by the level.
    relative = Path(os.path.normpath(unquote(uri)))
    if os.pardir in relative.parts or relative.is_absolute():
        raise LevelError(
            f"The uri {uri[:80]} leaves the level's folder.",
            where=buffer.where,
            remedy="Put the file into the level's folder.",
        )
    return folder / relative
