"""Where the JSON text lies in a glTF or GLB file, and the same file around another text.

Layout of a GLB: glTF 2.0 specification, section 4.4 (magic, version, length; chunks of length, type, data).
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from scenes.errors import LevelError

_HEADER = struct.Struct("<4sII")
_CHUNK = struct.Struct("<I4s")
_TEXT_START = _HEADER.size + _CHUNK.size
_LONGEST_GLB = 2**32 - 1


@dataclass(frozen=True)
class JsonChunk:
    """The place of the JSON text in a file.

    Attributes:
        source: The whole file.
        binary: Whether the file is a GLB; otherwise all of it is JSON text.
        start: First byte of the text.
        end: First byte after the text and its padding.
    """

    source: bytes
    binary: bool
    start: int
    end: int

    @property
    def text(self) -> bytes:
        """The JSON text with its padding."""
        return self.source[self.start : self.end]

    def holding(self, text: bytes) -> bytes:
        """The file with this text, padded or not as given, in place of the old one; GLB lengths follow.

        Raises:
            LevelError: The file would be longer than a GLB can be.
        """
        if not self.binary:
            return text
        magic, version, total = _HEADER.unpack_from(self.source)
        _, kind = _CHUNK.unpack_from(self.source, _HEADER.size)
        total += len(text) - (self.end - self.start)
        if total > _LONGEST_GLB:
            raise LevelError(
                "The annotated level does not fit into a GLB file.",
                known=f"It would be {total} bytes long, a GLB is at most {_LONGEST_GLB}.",
                remedy="Export the level as .gltf with separate buffers.",
            )
        head = _HEADER.pack(magic, version, total) + _CHUNK.pack(len(text), kind)
        return b"".join([head, text, self.source[self.end :]])


def padded(text: bytes) -> bytes:
    """The text with the padding that a GLB chunk needs behind it: spaces.

    Where the text already ends in zeros, against the specification, zeros follow: a program that read
    the file before can still read it.
    """
    filler = b"\0" if text.endswith(b"\0") else b" "
    return text + filler * (-len(text) % 4)


def find_json(source: bytes, *, where: str = "") -> JsonChunk:
    """The JSON text of a glTF or GLB file; only the GLB header and its first chunk are looked at.

    Raises:
        LevelError: A GLB of another version, cut short, or with another first chunk than JSON.
    """
    if not source.startswith(b"glTF"):
        return JsonChunk(source, binary=False, start=0, end=len(source))
    if len(source) < _TEXT_START:
        raise _broken("The GLB file is cut short.", where, len(source), f"It has {len(source)} bytes.")
    _, version, total = _HEADER.unpack_from(source)
    length, kind = _CHUNK.unpack_from(source, _HEADER.size)
    if version != 2:
        raise _broken("This is not a glTF 2.0 file.", where, 4, f"Its GLB version is {version}.")
    if total > len(source):
        known = f"Its header says {total} bytes, the file has {len(source)}."
        raise _broken("The GLB file is cut short.", where, 8, known)
    if kind != b"JSON":
        raise _broken("The first chunk of the GLB file is not JSON.", where, 16, f"Its type is {kind!r}.")
    if length > total - _TEXT_START:
        known = f"It claims {length} bytes, the file's header leaves {max(total - _TEXT_START, 0)}."
        raise _broken("The JSON chunk is longer than the GLB file.", where, 12, known)
    return JsonChunk(source, binary=True, start=_TEXT_START, end=_TEXT_START + length)


def _broken(what: str, where: str, byte: int, known: str) -> LevelError:
    place = f"{where}, byte {byte}" if where else f"byte {byte}"
    return LevelError(what, where=place, known=known, remedy="Export the level again as glTF 2.0.")
