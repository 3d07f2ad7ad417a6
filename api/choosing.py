"""Lights and cameras of a level by what users call them: a name, `node:12`, or a place in the list."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from api.wording import shortened
from scenes.errors import LevelError
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.scene import Camera, Light

MOST_NAMES_LISTED = 10
LONGEST_NAME = 100
MOST_DIGITS = 9
NODE_PREFIX = "node:"

Named = TypeVar("Named", Light, Camera)


def chosen_lights(level: Level, wanted: Sequence[str]) -> tuple[Light, ...]:
    """The lights that are meant, in the level's order; all of them where nothing is wanted.

    Raises:
        LevelError: The level has no lights, or none of that name; the message lists those there are.
    """
    if not level.scene.lights:
        raise LevelError(
            "This level has no lights that cast shadows.",
            where=str(level.path),
            remedy="Export it with its lights (in glTF: KHR_lights_punctual); plain geometry takes them from "
            "a lights file or --add-light.",
        )
    return _chosen(level, level.scene.lights, "light", wanted)


def chosen_cameras(level: Level, wanted: Sequence[str]) -> tuple[Camera, ...]:
    """The cameras that are meant, in the level's order.

    None where nothing is wanted: each light is then judged over views of its own.

    Raises:
        LevelError: There is none of that name; the message lists those there are.
    """
    if wanted and not level.scene.cameras:
        raise LevelError(
            "This level has no cameras to choose from.",
            where=str(level.path),
            remedy="Leave --camera out: each light is then seen from four viewpoints made for it.",
        )
    return _chosen(level, level.scene.cameras, "camera", wanted) if wanted else ()


def require_file(path: Path) -> None:
    """Refuse a level that is not there, before anything is said about its name.

    Raises:
        LevelError: There is no such file, or it cannot be read.
    """
    read_level_file(path, 1)


def require_triangles(level: Level) -> None:
    """Refuse a level in which there is nothing to see.

    Raises:
        LevelError: It has no triangles.
    """
    if level.scene.triangle_count == 0:
        raise LevelError(
            "This level has no triangles: nothing casts a shadow and nothing shows one.",
            where=str(level.path),
            remedy="Export it with its geometry.",
        )


def _chosen(level: Level, known: tuple[Named, ...], what: str, wanted: Sequence[str]) -> tuple[Named, ...]:
    if not wanted:
        return known
    meant = {index for name in wanted for index in _meant(level, known, what, name)}
    return tuple(known[index] for index in sorted(meant))


def _meant(level: Level, known: tuple[Named, ...], what: str, name: str) -> list[int]:
    exact = [index for index, one in enumerate(known) if one.name == name]
    if exact:
        return exact
    if name.startswith(NODE_PREFIX) and _is_number(name.removeprefix(NODE_PREFIX)):
        node = int(name.removeprefix(NODE_PREFIX))
        found = [index for index, one in enumerate(known) if one.node == node]
    elif _is_number(name):
        found = [int(name)] if int(name) < len(known) else []
    else:
        found = [index for index, one in enumerate(known) if one.name.casefold() == name.casefold()]
    if found:
        return found
    raise LevelError(
        f'There is no {what} "{shortened(name, LONGEST_NAME)}".',
        where=str(level.path),
        known=f"It has {_listed(known, what)}.",
        remedy=f"A {what} is chosen by its name, its number from 0 on, or node:NUMBER; "
        "`gnomon inspect` lists all.",
    )


def _is_number(text: str) -> bool:
    # Longer ones are no place in any list, and Python refuses to read them.
    return text.isdecimal() and len(text) <= MOST_DIGITS


def _listed(known: tuple[Named, ...], what: str) -> str:
    names = [
        f'"{shortened(one.name, LONGEST_NAME)}"' if one.name else f"{NODE_PREFIX}{one.node}" for one in known
    ]
    more = len(names) - MOST_NAMES_LISTED
    listed = ", ".join(names[:MOST_NAMES_LISTED])
    plural = what if len(names) == 1 else f"{what}s"
    return f"the {plural} {listed}" + (f" ... and {more} more" if more > 0 else "")
