"""What goes up with a request: JSON, a level file, or a .gltf together with the files that it names."""

from __future__ import annotations

import json
import os
import re
import secrets
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from .errors import LevelFileError

GLB, GLTF = "model/gltf-binary", "model/gltf+json"
CHUNK = 1 << 20
SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


@dataclass(frozen=True)
class Upload:
    """A body: its media type, and the pieces it is made of, bytes or files with their lengths."""

    media_type: str
    pieces: tuple[bytes | tuple[Path, int], ...]

    @property
    def length(self) -> int:
        """In bytes."""
        return sum(len(piece) if isinstance(piece, bytes) else piece[1] for piece in self.pieces)

    def chunks(self) -> Iterator[bytes]:
        """The body, bit by bit.

        Raises:
            LevelFileError: A file cannot be read, or is not as long as it was.
        """
        for piece in self.pieces:
            if isinstance(piece, bytes):
                yield from (piece[start : start + CHUNK] for start in range(0, len(piece), CHUNK))
            else:
                yield from _file_chunks(*piece)


def json_upload(value: object) -> Upload:
    """A JSON value."""
    return Upload("application/json", (json.dumps(value, allow_nan=False).encode(),))


def level_upload(level: Path | bytes) -> Upload:
    """A level: a file on disk, with those that it names if it is a .gltf, or the bytes of one.

    Raises:
        LevelFileError: It cannot be read, is no glTF, or names files that cannot go with it.
    """
    if isinstance(level, bytes):
        return Upload(GLB if level[:4] == b"glTF" else GLTF, (level,))
    size = _size(level)
    if level.suffix.lower() != ".gltf":
        return Upload(GLB, ((level, size),))
    companions = _companions(level)
    if not companions:
        return Upload(GLTF, ((level, size),))
    return _multipart([(level.name, GLTF, level), *companions])


def _companions(level: Path) -> list[tuple[str, str, Path]]:
    """Name, media type and path of each buffer that lies in a file. Pictures cast no shadow, and stay."""
    try:
        buffers = json.loads(level.read_bytes()).get("buffers", [])
        uris = [buffer.get("uri") for buffer in buffers]
    except OSError as error:
        raise LevelFileError(f"{level} cannot be read: {error.strerror}.") from error
    except (ValueError, AttributeError, TypeError, RecursionError):
        raise LevelFileError(
            f"{level} is not a glTF file: it is no JSON, or its buffers are no list."
        ) from None
    named = dict.fromkeys(uri for uri in uris if isinstance(uri, str) and not uri.startswith("data:"))
    relatives = [_relative(level, uri) for uri in named]
    return [(one.as_posix(), "application/octet-stream", level.parent / one) for one in relatives]


def _relative(level: Path, uri: str) -> Path:
    relative = os.path.normpath(unquote(uri))
    outside = Path(relative).is_absolute() or Path(relative).parts[:1] == (os.pardir,)
    if SCHEME.match(uri) or uri.startswith(("/", "\\")) or outside or "\0" in relative:
        raise LevelFileError(
            f"{level} names the file {uri[:80]}, which lies outside its folder and is not sent. "
            "Put it into the level's folder, or save the level as .glb."
        )
    return Path(relative)


def _multipart(parts: Sequence[tuple[str, str, Path]]) -> Upload:
    boundary = secrets.token_hex(16)
    pieces: list[bytes | tuple[Path, int]] = []
    for name, media_type, path in parts:
        # As browsers do (HTML standard, "multipart/form-data"): nothing else may end the name.
        safe = name.replace('"', "%22").replace("\r", "%0D").replace("\n", "%0A")
        head = f'--{boundary}\r\nContent-Disposition: form-data; name="files"; filename="{safe}"\r\n'
        pieces += [
            f"{head}Content-Type: {media_type}\r\n\r\n".encode(errors="replace"),
            (path, _size(path)),
            b"\r\n",
        ]
    pieces.append(f"--{boundary}--\r\n".encode())
    return Upload(f"multipart/form-data; boundary={boundary}", tuple(pieces))


def _size(path: Path) -> int:
    try:
        if not path.is_file():
            raise LevelFileError(f"There is no file {path}.")
        return path.stat().st_size
    except (OSError, ValueError) as error:
        raise LevelFileError(f"{path} cannot be read: {error}.") from error


def _file_chunks(path: Path, size: int) -> Iterator[bytes]:
    left = size
    try:
        with path.open("rb") as file:
            while left and (chunk := file.read(min(CHUNK, left))):
                left -= len(chunk)
                yield chunk
    except OSError as error:
        raise LevelFileError(f"{path} cannot be read: {error.strerror}.") from error
    if left:
        raise LevelFileError(f"{path} was changed while it was sent.")
