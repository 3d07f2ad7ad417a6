"""Stored instances as questions that can be asked again."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from scenes.corpus.spec import Spec
from scenes.errors import GnomonError
from scenes.formats.registry import level_formats, read_level
from scenes.scene import Scene
from selector.benchmark.questions import LevelQuestion, Question, SpecQuestion, level_row
from selector.evidence.rows import InstanceRow
from selector.learning.featuring import camera_of


@dataclass(frozen=True)
class Asking:
    """What can be asked again.

    Attributes:
        questions: Instance's key -> question.
        problems: Why others cannot -> how many.
    """

    questions: Mapping[str, Question]
    problems: Mapping[str, int]


def asking(rows: Iterable[InstanceRow], places: Sequence[Path]) -> Asking:
    """Questions for stored instances.

    Args:
        rows: The instances.
        places: Files and folders in which the levels are that some come from.
    """
    scenes: dict[Path, Scene | str] = {}
    questions: dict[str, Question] = {}
    problems: dict[str, int] = {}
    files: dict[str, list[Path]] = {}
    for path in level_paths(places):
        files.setdefault(path.name, []).append(path)
    for row in rows:
        try:
            asked = _question(row, files, scenes)
        except GnomonError as error:
            asked = str(error)
        if isinstance(asked, str):
            problems[asked] = problems.get(asked, 0) + 1
        else:
            questions[row.key] = asked
    return Asking(questions, problems)


def level_paths(places: Iterable[Path]) -> list[Path]:
    """Every level file among some files and folders, in order."""
    suffixes = set(level_formats())
    found: list[Path] = []
    for place in places:
        if not place.is_dir():
            found.append(place)
            continue
        # What goes away meanwhile is no level, nor is what is no file.
        inside = (Path(folder, name) for folder, _, names in os.walk(place) for name in names)
        found += sorted(path for path in inside if path.suffix.lower() in suffixes and path.is_file())
    return list(dict.fromkeys(found))


def _question(
    row: InstanceRow, files: Mapping[str, Sequence[Path]], scenes: dict[Path, Scene | str]
) -> Question | str:
    """What the row asked; or why that cannot be asked again."""
    if row.origin.startswith("{"):
        return SpecQuestion(Spec.from_text(row.origin), row.role)
    found: str = f"The level {row.origin} is not among those that --levels names."
    # Folders may hold levels of the same name.
    for path in files.get(row.origin, ()):
        if path not in scenes:
            scenes[path] = _scene(path)
        scene = scenes[path]
        if isinstance(scene, str):
            found = scene
        elif scene.digest != row.scene_digest:
            found = f"The level {row.origin} has changed since it was measured."
        else:
            return _level_question(row, path, scene)
    return found


def _level_question(row: InstanceRow, path: Path, scene: Scene) -> LevelQuestion:
    index = int(row.light["index"])
    camera, light = camera_of(row.camera), scene.lights[index]
    asked = LevelQuestion(
        path, scene.digest, scene.name, scene.triangle_count, light, index, camera, row.role
    )
    # Under another key, what is measured would be compared with nothing.
    assert level_row(asked, row.width, row.height).key == row.key, f"{row.origin} is asked otherwise"
    return asked


def _scene(path: Path) -> Scene | str:
    try:
        return read_level(path).scene
    except GnomonError as error:
        return str(error)
