"""The files that a .gltf names: where its URIs point, and which of them are there.

Source: glTF 2.0 specification (Khronos), section 2.8 "URIs".
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from urllib.parse import unquote

from scenes.errors import LevelError
from scenes.gltf.container import parse_json
from scenes.gltf.json_chunk import find_json

SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


def local_path(uri: str, where: str) -> Path:
    """The path that a relative URI stands for, relative to the level's folder.

    Raises:
        LevelError: The URI is absolute or leaves the folder.
    """
    # By its text, not by what links on disk point to: those were made by the user, not by the level.
    relative = _relative(uri)
    if relative is None:
        raise LevelError(
            f"The uri {uri[:80]} is absolute; only files beside the level are read.",
            where=where,
            remedy="Put the file into the level's folder and name it relative to the level.",
        )
    if os.pardir in relative.parts:
        raise LevelError(
            f"The uri {uri[:80]} leaves the level's folder.",
            where=where,
            remedy="Put the file into the level's folder.",
        )
    return relative


def companions(source: bytes, path: Path) -> tuple[Path, ...]:
    """The existing files that the buffers and images of a .gltf name, relative to its folder.

    Those outside it begin with `..`. Absolute ones are not among them, nor any that a GLB names: it is meant
    to stand alone.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    if find_json(source).binary:
        return ()
    root = parse_json(source)
    owners = [*root.items("buffers"), *root.items("images")]
    uris = [owner.get("uri") for owner in owners if isinstance(owner, dict)]
    named = {name for uri in uris if isinstance(uri, str) and (name := _relative(uri)) is not None}
    return tuple(sorted(name for name in named if _is_file(path.parent / name)))


def _relative(uri: str) -> Path | None:
    """The path that a URI stands for, or None where it is absolute."""
    if SCHEME.match(uri) or uri.startswith(("/", "\\")):
        return None
    path = Path(os.path.normpath(unquote(uri)))
    return None if path.is_absolute() else path


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        # A name that no file can have: too long, or with a NUL.
        return False
