"""The bytes behind a glTF buffer: the BIN chunk, a data URI or a file in the level's folder.

Source: glTF 2.0 specification (Khronos), section 3.6.1; RFC 2397 (data URIs).
"""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from urllib.parse import unquote_to_bytes

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.companions import local_path
from scenes.level_file import read_level_file

# As many as a GLB can hold.
MOST_BYTES = 2**32

_SLASHES = "Write / instead of \\ in the uri: glTF knows no other way to name a folder."


class BufferReader:
    """Reads the buffers of one asset; a file that several buffers name is read once."""

    def __init__(self, asset: Asset) -> None:
        self._asset = asset
        self._files: dict[Path, bytes] = {}
        self._bytes_read = 0

    def content(self, index: int, referrer: str) -> memoryview:
        """The `byteLength` bytes of a buffer.

        Raises:
            LevelError: The buffer does not exist, has no data, names a file that is missing, not local or
                outside the level's folder, its data is shorter than it states, or with it more than 4 GiB
                would be read.
        """
        buffer = self._asset.entry("buffers", index, referrer)
        length = buffer.integer("byteLength")
        content = self._content(index, buffer, length)
        if len(content) < length:
            raise LevelError(
                f"The data of this buffer has {len(content)} bytes.",
                where=buffer.where,
                known=f"Its byteLength is {length}.",
                remedy="It was cut off, or belongs to another version of the level: export both again.",
            )
        return memoryview(content)[:length]

    def _content(self, index: int, buffer: Entry, length: int) -> bytes | memoryview:
        uri = buffer.text("uri")
        if not uri:
            if index == 0 and self._asset.binary is not None:
                return self._asset.binary
            raise LevelError(
                "This buffer has no data.",
                where=buffer.where,
                known="It names no uri, and only the first buffer of a GLB with a binary chunk may do so.",
            )
        if uri.startswith("data:"):
            return _data_uri(uri, buffer)
        path = self._asset.folder / local_path(uri, buffer.where)
        if len(self._files.get(path, b"")) < length or path not in self._files:
            self._files[path] = self._read(path, uri, buffer, length)
        return self._files[path]

    def _read(self, path: Path, uri: str, buffer: Entry, length: int) -> bytes:
        rest = MOST_BYTES - self._bytes_read
        try:
            content = read_level_file(path, limit=min(length, rest + 1))
        except LevelError as error:
            raise LevelError(
                f"The buffer file {uri} cannot be used.",
                where=buffer.where,
                known=f"{error.where}: {error.what} {error.known}".strip(),
                remedy=_SLASHES
                if "\\" in uri
                else error.remedy or "Put it beside the level, under this name.",
            ) from None
        if len(content) > rest:
            raise LevelError(
                f"The buffer files of this level hold more than {MOST_BYTES:,} bytes.",
                where=buffer.where,
                known=f"{self._bytes_read:,} bytes were read before {uri}.",
                remedy="Split the level, or keep in its buffers only what it draws.",
            )
        self._bytes_read += len(content)
        return content


def has_data(asset: Asset, index: int, referrer: str) -> bool:
    """Whether a buffer names data at all; fallback buffers of compressed files need not."""
    buffer = asset.entry("buffers", index, referrer)
    return buffer.has("uri") or (index == 0 and asset.binary is not None)


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
