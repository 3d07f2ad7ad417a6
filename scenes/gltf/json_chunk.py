"""Where the JSON text lies in a glTF or GLB file, and the same file around another text.

Layout of a GLB: glTF 2.0 specification, section 4.4 (magic, version, length; chunks of length, type, data).
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from scenes.errors import LevelError

MAGIC = b"glTF"
JSON_CHUNK = b"JSON"
BINARY_CHUNK = b"BIN\0"
# Some exporters pad with zeros, against the specification.
PADDING = b" \t\n\r\0"
HEADER = struct.Struct("<4sII")
CHUNK = struct.Struct("<I4s")
_LONGEST_GLB = 2**32 - 1


@dataclass(frozen=True)
class JsonChunk:
    """The place of the JSON text in a file.

    Attributes:
        source: The whole file.
        binary: Whether the file is a GLB; otherwise all of it is JSON text.
        start: First byte of the text.
        end: First byte after the text and its padding.
        total: Bytes of the file as its header states them; what follows is ignored by readers.
    """

    source: bytes
    binary: bool
    start: int
    end: int
    total: int

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
        magic, version, total = HEADER.unpack_from(self.source)
        _, kind = CHUNK.unpack_from(self.source, HEADER.size)
        total += len(text) - (self.end - self.start)
        if total > _LONGEST_GLB:
            raise LevelError(
                "The annotated level does not fit into a GLB file.",
                known=f"It would be {total} bytes long, a GLB is at most {_LONGEST_GLB}.",
                remedy="Export the level as .gltf with separate buffers.",
            )
        head = HEADER.pack(magic, version, total) + CHUNK.pack(len(text), kind)
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
    if not source.startswith(MAGIC):
        return JsonChunk(source, binary=False, start=0, end=len(source), total=len(source))
    if len(source) < HEADER.size:
        raise _truncated("inside its header", len(source), HEADER.size, where)
    _, version, total = HEADER.unpack_from(source)
    if version != 2:
        raise LevelError(
            "Only version 2 of binary glTF is read.",
            where=_place(where, 4),
            known=f"This is binary glTF version {version}.",
            remedy="Export the level as glTF 2.0.",
        )
    if total > len(source):
        raise _truncated("before the length that its header states", len(source), total, where)
    kind, end = chunk_at(source, HEADER.size, total, where) if total > HEADER.size else (b"", 0)
    if kind != JSON_CHUNK:
        raise LevelError(
            "The first chunk of this GLB is not its JSON.",
            where=_place(where, HEADER.size),
            known=f"Its type is {kind!r}." if kind else "It has no chunk at all.",
            remedy="Export the level again.",
        )
    return JsonChunk(source, binary=True, start=HEADER.size + CHUNK.size, end=end, total=total)


def chunk_at(source: bytes, offset: int, total: int, where: str = "") -> tuple[bytes, int]:
    """Type of the chunk at a byte of a GLB, and the first byte after the chunk.

    Raises:
        LevelError: The chunk goes beyond `total`, the length of the GLB.
    """
    start = offset + CHUNK.size
    if start > total:
        raise _truncated(f"inside the chunk header at byte {offset}", total, start, where)
    size, kind = CHUNK.unpack_from(source, offset)
    if start + size > total:
        raise _truncated(f"inside the chunk at byte {offset}", total, start + size, where)
    return kind, start + size


def _truncated(inside: str, found: int, needed: int, where: str) -> LevelError:
    return LevelError(
        f"This GLB ends {inside}.",
        where=_place(where, found),
        known=f"It has {found} bytes and needs {needed}.",
        remedy="It was cut off: copy or export it again.",
    )


def _place(where: str, byte: int) -> str:
    return f"{where}, byte {byte}" if where else f"byte {byte}"
