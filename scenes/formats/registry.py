"""The level formats: every module of this folder is one, and is found by being here."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Protocol, runtime_checkable

import scenes.formats
from scenes.errors import LevelError
from scenes.level import Level
from scenes.level_file import is_folder
from scenes.light_annotation import Cleared, LightAnnotation

OWN_NAME = __name__.rpartition(".")[2]


@runtime_checkable
class LevelFormat(Protocol):
    """What a module of this folder holds.

    Attributes:
        NAME: What users call the format.
        SUFFIXES: Its file name suffixes, in lower case with their dots.
    """

    NAME: str
    SUFFIXES: tuple[str, ...]

    def read(self, path: Path, scene_name: str | None = None) -> Level:
        """The level in that file; `scene_name` picks one where a file holds several.

        Raises:
            LevelError: The file cannot be read, or holds no such scene.
        """

    def annotate(self, source: bytes, annotations: Mapping[int, LightAnnotation]) -> bytes:
        """The bytes of a level file with these annotations, by `Light.node`, in place of earlier ones.

        The same annotations give the same bytes.

        Raises:
            LevelError: The file is broken, or has no such node.
        """

    def read_annotations(self, source: bytes) -> dict[int, LightAnnotation]:
        """What a level file says now, by `Light.node`: given to `annotate`, it is written the same again.

        Raises:
            LevelError: The file is broken.
        """

    def clear(self, source: bytes) -> Cleared:
        """The bytes of a level file without our annotations: the original ones where that is possible.

        Raises:
            LevelError: The file is broken.
        """

    def companions(self, source: bytes, path: Path) -> tuple[Path, ...]:
        """The existing files that the level at `path` names, relative to its folder.

        Those outside the folder begin with `..`.

        Raises:
            LevelError: The file is broken.
        """


@runtime_checkable
class LayeredFormat(Protocol):
    """A module of this folder whose annotation is a file of its own over the level, which stays as it is.

    Attributes:
        NAME: What users call the format.
        SUFFIXES: The suffixes of its levels.
        LAYER_SUFFIX: One of them, which its layers have.
    """

    NAME: str
    SUFFIXES: tuple[str, ...]
    LAYER_SUFFIX: str

    def read(self, path: Path, scene_name: str | None = None) -> Level:
        """As `LevelFormat.read`; a layer is read together with the level below it."""

    def annotate(self, source: bytes, annotations: Mapping[int, LightAnnotation], path: Path) -> bytes:
        """The bytes of a layer over the level at `path`, whose bytes are `source`; a layer is written anew.

        Raises:
            LevelError: The file is broken, or has no such node.
        """

    def read_annotations(self, source: bytes, path: Path) -> dict[int, LightAnnotation]:
        """As `LevelFormat.read_annotations`.

        Raises:
            LevelError: The file is broken.
        """

    def clear(self, source: bytes, path: Path) -> Cleared:
        """A layer that says nothing of ours; `restored` where nothing of ours is left below it either.

        Raises:
            LevelError: The file is broken.
        """

    def companions(self, source: bytes, path: Path) -> tuple[Path, ...]:
        """As `LevelFormat.companions`; a layer names the level below it.

        Raises:
            LevelError: The file is broken.
        """

    def is_layer(self, source: bytes) -> bool:
        """Whether a file is one of our layers."""


class PlacedFormat:
    """A layered format at the path of one level: a `LevelFormat` for that level and the layers beside it."""

    def __init__(self, layered: LayeredFormat, path: Path) -> None:
        self.NAME = layered.NAME
        self.SUFFIXES = layered.SUFFIXES
        self.LAYER_SUFFIX = layered.LAYER_SUFFIX
        self.is_layer = layered.is_layer
        self.read = layered.read
        self._layered = layered
        self._path = path

    def annotate(self, source: bytes, annotations: Mapping[int, LightAnnotation]) -> bytes:
        """See `LevelFormat.annotate`."""
        return self._layered.annotate(source, annotations, self._path)

    def read_annotations(self, source: bytes) -> dict[int, LightAnnotation]:
        """See `LevelFormat.read_annotations`."""
        return self._layered.read_annotations(source, self._path)

    def clear(self, source: bytes) -> Cleared:
        """See `LevelFormat.clear`."""
        return self._layered.clear(source, self._path)

    def companions(self, source: bytes, path: Path) -> tuple[Path, ...]:
        """See `LevelFormat.companions`."""
        return self._layered.companions(source, path)


AnyFormat = LevelFormat | LayeredFormat


def load_formats(folders: Iterable[str], package: str) -> dict[str, AnyFormat]:
    """Suffix -> format, for every module in the folders; one that is broken stops the program.

    Raises:
        TypeError: A module is no level format, or two claim the same suffix.
    """
    formats: dict[str, AnyFormat] = {}
    for info in sorted(pkgutil.iter_modules(folders), key=lambda info: info.name):
        if info.name == OWN_NAME:
            continue
        module = importlib.import_module(f"{package}.{info.name}")
        if not isinstance(module, LevelFormat):
            raise TypeError(
                f"{module.__name__} is no level format: it lacks NAME, SUFFIXES, read(), annotate(),"
                " read_annotations(), clear() or companions()."
            )
        if hasattr(module, "LAYER_SUFFIX") and (
            not isinstance(module, LayeredFormat) or module.LAYER_SUFFIX not in module.SUFFIXES
        ):
            raise TypeError(f"{module.__name__} lacks is_layer(), or its LAYER_SUFFIX among its SUFFIXES.")
        for suffix in module.SUFFIXES:
            if suffix in formats:
                raise TypeError(f"{module.__name__} claims {suffix}, which {formats[suffix].NAME} has.")
            formats[suffix] = module
    return formats


@cache
def level_formats() -> dict[str, AnyFormat]:
    """Suffix -> format, for all formats that Gnomon knows."""
    return load_formats(scenes.formats.__path__, scenes.formats.__name__)


def format_of(path: Path) -> LevelFormat:
    """The format that the suffix of a file name stands for: for that one file where the format is layered.

    Raises:
        LevelError: No format has this suffix.
    """
    formats = level_formats()
    found = formats.get(path.suffix.lower())
    if found is None:
        raise LevelError(
            f'No level format has the suffix "{path.suffix}".' if path.suffix else "This name has no suffix.",
            where=str(path),
            known=f"Known are {', '.join(sorted(formats))}.",
            remedy="Export the level as one of these.",
        )
    return PlacedFormat(found, path) if isinstance(found, LayeredFormat) else found


def annotated_suffix(path: Path) -> str:
    """The suffix of the annotation of a level: that of a layer where its format is layered, else its own."""
    found = level_formats().get(path.suffix.lower())
    return found.LAYER_SUFFIX if isinstance(found, LayeredFormat) else path.suffix


def read_level(path: Path, scene_name: str | None = None) -> Level:
    """The level in a file of any known format.

    Args:
        path: The file; its suffix says the format.
        scene_name: Name or index of a scene, where the file holds several; its default scene where None.

    Raises:
        LevelError: The file is missing, broken or of no known format, or holds no such scene.
    """
    if is_folder(path):
        raise LevelError("This is a folder, not a file.", where=str(path), remedy="Name a file in it.")
    return format_of(path).read(path, scene_name)
