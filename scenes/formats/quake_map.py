"""Quake and TrenchBroom .map: the text that level editors write and compilers read."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from scenes.errors import LevelError
from scenes.level import Level, NoteBook
from scenes.level_file import read_level_file
from scenes.light_annotation import Cleared, LightAnnotation
from scenes.quake import annotation
from scenes.quake.cameras import read_cameras
from scenes.quake.lights import read_lights
from scenes.quake.map_parser import parse_map
from scenes.quake.meshes import read_meshes
from scenes.scene import Scene

NAME = "Quake map"
SUFFIXES = (".map",)
MEND = "Mend it in the map's editor, and save it again."


def read(path: Path, scene_name: str | None = None) -> Level:
    """The scene of a .map: a mesh for each entity and kind of brush, lights, and player starts as cameras.

    Args:
        path: The file.
        scene_name: A map holds one scene, of the file's name or 0; None means it as well.

    Raises:
        LevelError: The file cannot be read, is no map, or holds no such scene.
    """
    source = read_level_file(path)
    try:
        return _read(source, path, scene_name)
    except LevelError as error:
        error.where = f"{path}, {error.where}" if error.where else str(path)
        error.remedy = error.remedy or MEND
        raise


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation]) -> bytes:
    """The file with these annotations, by entity index, in place of any earlier ones of ours.

    Raises:
        LevelError: The file is no map, or has no such entity.
    """
    return annotation.annotate(source, annotations)


def read_annotations(source: bytes) -> dict[int, LightAnnotation]:
    """What our annotations in the file say, by entity index: given to `annotate`, the same once more.

    Raises:
        LevelError: The file is no map.
    """
    return annotation.read_annotations(source)


def clear(source: bytes) -> Cleared:
    """The file without our annotations.

    Raises:
        LevelError: The file is no map.
    """
    return annotation.clear(source)


def companions(source: bytes, path: Path) -> tuple[Path, ...]:
    """No files: a map names textures in the game's folders, and shadows need none of them.

    Raises:
        LevelError: The file is no map.
    """
    del path
    parse_map(source)
    return ()


def _read(source: bytes, path: Path, scene_name: str | None) -> Level:
    if scene_name not in (None, path.stem, "0"):
        raise LevelError(
            f'There is no scene "{scene_name}".',
            known=f'A map holds one scene, "{path.stem}".',
            remedy="Leave --scene out.",
        )
    notes = NoteBook()
    text = parse_map(source)
    scene = Scene(
        path.stem,
        read_meshes(text, notes),
        read_lights(text.entities, notes),
        read_cameras(text.entities, notes),
    )
    if not scene.triangle_count:
        notes.warning("brushes", "This level has no brushes that are drawn: nothing casts a shadow.")
    if not scene.lights:
        notes.lightless("entities", "This level has no lights.")
    return Level(path, NAME, scene, tuple(notes.notes))
