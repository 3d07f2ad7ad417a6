"""USD, as text, binary or package; an annotation is a layer of its own over the level.

What reads it, usd-core, is an optional dependency, and takes half a second to import: only when it is needed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from scenes.errors import LevelError
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.light_annotation import Cleared, LightAnnotation
from scenes.usd import layer_mark

NAME = "USD"
SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
LAYER_SUFFIX = ".usda"


def read(path: Path, scene_name: str | None = None) -> Level:
    """The scene of a USD stage, in world space; instances share their meshes.

    Args:
        path: The root layer.
        scene_name: There is one scene, without a name.

    Raises:
        LevelError: usd-core is not installed, or the file or one of its layers cannot be read.
    """
    read_level_file(path, 1)
    with _usd(path):
        from scenes.usd.reader import read_scene  # noqa: PLC0415

        scene, notes = read_scene(path, scene_name)
    return Level(path, NAME, scene, notes)


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation], path: Path) -> bytes:
    """The layer over the level at `path` with these annotations, by `Light.node`.

    Raises:
        LevelError: usd-core is not installed, the level cannot be read, or has no such light.
    """
    with _usd(path):
        from scenes.usd import layer  # noqa: PLC0415

        return layer.annotate(source, annotations, path)


def read_annotations(source: bytes, path: Path) -> dict[int, LightAnnotation]:
    """What the level at `path`, or a layer over it, says of its lights, by `Light.node`.

    Raises:
        LevelError: usd-core is not installed, or the level cannot be read.
    """
    with _usd(path):
        from scenes.usd import layer  # noqa: PLC0415

        return layer.read_annotations(source, path)


def clear(source: bytes, path: Path) -> Cleared:
    """A layer over the level at `path` that says nothing of ours.

    Raises:
        LevelError: usd-core is not installed, or the level cannot be read.
    """
    with _usd(path):
        from scenes.usd import layer  # noqa: PLC0415

        return layer.clear(source, path)


def companions(source: bytes, path: Path) -> tuple[Path, ...]:
    """The existing files of which the level at `path` is made, relative to its folder.

    Raises:
        LevelError: usd-core is not installed, or the level cannot be read.
    """
    with _usd(path):
        from scenes.usd.companions import companions as named_files  # noqa: PLC0415

        return named_files(source, path)


def is_layer(source: bytes) -> bool:
    """Whether a file is such a layer itself."""
    return layer_mark.is_layer(source)


@contextmanager
def _usd(path: Path) -> Iterator[None]:
    """Names the level in errors, usd-core where it is missing."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != "pxr":
            raise
        raise LevelError(
            "USD levels need usd-core, which is not installed.",
            where=str(path),
            remedy='Install it as the extra "usd": pip install "gnomon[usd]", or pip install usd-core.',
        ) from None
    except LevelError as error:
        if str(path) not in error.where:
            error.where = f"{path}, {error.where}" if error.where else str(path)
        raise
