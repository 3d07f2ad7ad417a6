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


def load_formats(folders: Iterable[str], package: str) -> dict[str, LevelFormat]:
    """Suffix -> format, for every module in the folders; one that is broken stops the program.

    Raises:
        TypeError: A module is no level format, or two claim the same suffix.
    """
    formats: dict[str, LevelFormat] = {}
    for info in sorted(pkgutil.iter_modules(folders), key=lambda info: info.name):
        if info.name == OWN_NAME:
            continue
        module = importlib.import_module(f"{package}.{info.name}")
        if not isinstance(module, LevelFormat):
            raise TypeError(
                f"{module.__name__} is no level format: it lacks NAME, SUFFIXES, read(), annotate(),"
                " read_annotations(), clear() or companions()."
            )
        for suffix in module.SUFFIXES:
            if suffix in formats:
                raise TypeError(f"{module.__name__} claims {suffix}, which {formats[suffix].NAME} has.")
            formats[suffix] = module
    return formats


@cache
def level_formats() -> dict[str, LevelFormat]:
    """Suffix -> format, for all formats that Gnomon knows."""
    return load_formats(scenes.formats.__path__, scenes.formats.__name__)


def format_of(path: Path) -> LevelFormat:
    """The format that the suffix of a file name stands for.

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
    return found


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
