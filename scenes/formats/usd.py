"""USD, as text, binary or package; an annotation is a layer of its own over the level.

What reads it, usd-core, is an optional dependency. A damaged file can keep it busy without end, or crash it:
it works in a program of its own, with limits on its time and memory (`scenes/limited_process.py`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from scenes.errors import LevelError
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.light_annotation import Cleared, LightAnnotation
from scenes.limited_process import EndedError, LimitedProcess
from scenes.usd import layer_mark
from scenes.usd.parcel import unpacked

NAME = "USD"
SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
LAYER_SUFFIX = ".usda"

# A level of a million triangles takes a quarter of a second and a quarter of a gigabyte; eight are read.
MOST_SECONDS = 120.0
MOST_BYTES = 16 * 2**30
_PROCESS = LimitedProcess(MOST_BYTES, MOST_SECONDS)


def read(path: Path, scene_name: str | None = None) -> Level:
    """The scene of a USD stage, in world space; instances share their meshes.

    Args:
        path: The root layer.
        scene_name: There is one scene, without a name.

    Raises:
        LevelError: usd-core is not installed, or the file or one of its layers cannot be read.
    """
    read_level_file(path, 1)
    with _usd(path) as usd:
        scene, notes = unpacked(usd.call("scenes.usd.reader", "read_parcel", path, scene_name))
    return Level(path, NAME, scene, notes)


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation], path: Path) -> bytes:
    """The layer over the level at `path` with these annotations, by `Light.node`.

    Raises:
        LevelError: usd-core is not installed, the level cannot be read, or has no such light.
    """
    with _usd(path) as usd:
        found: bytes = usd.call("scenes.usd.layer", "annotate", source, dict(annotations), path)
        return found


def read_annotations(source: bytes, path: Path) -> dict[int, LightAnnotation]:
    """What the level at `path`, or a layer over it, says of its lights, by `Light.node`.

    Raises:
        LevelError: usd-core is not installed, or the level cannot be read.
    """
    with _usd(path) as usd:
        found: dict[int, LightAnnotation] = usd.call("scenes.usd.layer", "read_annotations", source, path)
        return found


def clear(source: bytes, path: Path) -> Cleared:
    """A layer over the level at `path` that says nothing of ours.

    Raises:
        LevelError: usd-core is not installed, or the level cannot be read.
    """
    with _usd(path) as usd:
        found: Cleared = usd.call("scenes.usd.layer", "clear", source, path)
        return found


def companions(source: bytes, path: Path) -> tuple[Path, ...]:
    """The existing files of which the level at `path` is made, relative to its folder.

    Raises:
        LevelError: usd-core is not installed, or the level cannot be read.
    """
    with _usd(path) as usd:
        found: tuple[Path, ...] = usd.call("scenes.usd.companions", "companions", source, path)
        return found


def is_layer(source: bytes) -> bool:
    """Whether a file is such a layer itself."""
    return layer_mark.is_layer(source)


@contextmanager
def _usd(path: Path) -> Iterator[LimitedProcess]:
    """The program that knows USD; names the level in errors, and usd-core where it is missing."""
    if find_spec("pxr") is None:
        raise LevelError(
            "USD levels need usd-core, which is not installed.",
            where=str(path),
            remedy='Install it as the extra "usd": pip install "gnomon[usd]", or pip install usd-core.',
        )
    _require_utf8(path)
    try:
        yield _PROCESS
    except EndedError as error:
        raise LevelError(
            "USD gave up on this level: the file is damaged, or far too large.",
            where=str(path),
            known=f"{error} That is as much as reading a level may take.",
            remedy="Export it again; usdchecker may tell what is wrong with it.",
        ) from error
    except LevelError as error:
        if str(path) not in error.where:
            error.where = f"{path}, {error.where}" if error.where else str(path)
        raise


def _require_utf8(path: Path) -> None:
    # Elsewhere a name may be any bytes; USD finds files by text.
    try:
        os.path.abspath(path).encode()  # noqa: PTH100 - `resolve` would follow links
    except UnicodeEncodeError as error:
        raise LevelError(
            "The name of this file, or of a folder above it, is no UTF-8, and USD reads no other.",
            where=str(path),
            remedy="Rename it.",
        ) from error
