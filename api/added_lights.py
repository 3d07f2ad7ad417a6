"""Lights that the command line adds to a level: to its scene in memory, or beside plain geometry."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from api.choosing import require_triangles
from scenes.atomic_file import write_atomically
from scenes.errors import GnomonError
from scenes.formats.registry import read_level
from scenes.level import Level
from scenes.light_words import light_in_words, light_values, lights_file
from scenes.plain.lights_file import GEOMETRY_SUFFIXES, lights_path

OPTION = "--add-light"


class AddedLightError(GnomonError):
    """A light for which there is no place."""

    exit_code = 2


def level_with_lights(path: Path, scene_name: str | None, words: Sequence[str]) -> Level:
    """The level in a file, its lights followed by those in words; the file stays as it is.

    Args:
        path: The file, of any known format.
        scene_name: Which of its scenes; the default one where None.
        words: Each a light as `light_in_words` takes it. These lights have no node.

    Raises:
        LevelError: Words describe no light, or the level cannot be read.
    """
    added = tuple(light_in_words(one) for one in words)
    level = read_level(path, scene_name)
    if not added:
        return level
    scene = replace(level.scene, lights=(*level.scene.lights, *added))
    return replace(level, scene=scene, notes=tuple(note for note in level.notes if not note.lightless))


def check_place(path: Path, words: Sequence[str]) -> None:
    """Refuse lights that could not be written beside a level.

    Raises:
        LevelError: Words describe no light.
        AddedLightError: The level is no plain geometry, or has a lights file already.
    """
    for one in words:
        light_in_words(one)
    if path.suffix.lower() not in GEOMETRY_SUFFIXES:
        raise AddedLightError(
            f"annotate adds lights only beside plain geometry ({', '.join(GEOMETRY_SUFFIXES)}).",
            where=str(path),
            known="A level of any other format holds its lights itself.",
            remedy=f"Add the light to {path.name} (docs/level-formats.md), and leave {OPTION} out.",
        )
    beside = lights_path(path)
    if beside.exists():
        entries = ", ".join(json.dumps(light_values(one)) for one in words)
        raise AddedLightError(
            f"There is {beside.name} already, which is not overwritten.",
            where=str(path),
            known="The level's lights are read from there.",
            remedy=f'Leave {OPTION} out, or add this to the list "lights" there: {entries}.',
        )


def write_lights_beside(path: Path, scene_name: str | None, words: Sequence[str]) -> Path:
    """Writes the lights in words into `NAME.lights.json` beside plain geometry; gives that file.

    Args:
        path: The geometry.
        scene_name: Which of its scenes; the default one where None.
        words: Each a light as `light_in_words` takes it.

    Raises:
        LevelError: Words describe no light, or the geometry cannot be read or has no triangles.
        AddedLightError: The level is no plain geometry, or has a lights file already.
        OutputError: The system refuses to write there.
    """
    check_place(path, words)
    # A lights file for geometry that cannot be read would be in the way when it is exported again.
    require_triangles(read_level(path, scene_name))
    beside = lights_path(path)
    write_atomically(beside, lights_file(path.name, map(light_in_words, words)))
    return beside
