"""What a benchmark asks about: a light of a generated scene, or of a level file, in one view."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from math import isfinite
from pathlib import Path
from typing import Any

from scenes.corpus.spec import Spec
from scenes.corpus.staging import instance
from scenes.formats.registry import read_level
from scenes.scene import Camera, Light, Scene
from selector.evidence.rows import InstanceRow, Role

_SCENES_KEPT = 4
"""Levels take turns, and some take seconds to read."""


@dataclass(frozen=True)
class SpecQuestion:
    """The first light of a generated scene in its first camera.

    Attributes:
        spec: What the scene is made from.
        role: What the answer may be used for.
    """

    spec: Spec
    role: Role = Role.TRAINING

    @property
    def family(self) -> str:
        """What it shares with its like."""
        return self.spec.family

    @property
    def origin(self) -> str:
        """What makes the scene again."""
        return self.spec.text

    @property
    def triangles(self) -> int:
        """About how many."""
        return self.spec.triangles


@dataclass(frozen=True)
class LevelQuestion:
    """A light of a level file in one view.

    Attributes:
        path: The file.
        scene_digest: Of its scene, as it was read for the plan.
        scene: The scene's name.
        triangles: Of the whole level.
        light: The light.
        index: Its number.
        camera: The view: one of the level's own, or one made for the light.
        role: What the answer may be used for.
    """

    path: Path
    scene_digest: str
    scene: str
    triangles: int
    light: Light
    index: int
    camera: Camera
    role: Role

    @property
    def family(self) -> str:
        """The level's name: its lights are never parted."""
        return self.path.stem

    @property
    def origin(self) -> str:
        """The file's name, without its folder."""
        return self.path.name


Question = SpecQuestion | LevelQuestion


@dataclass(frozen=True)
class Posed:
    """A question with all that it takes to answer it.

    Attributes:
        row: As the store keeps it.
        scene: The scene.
        light: The light that is asked about.
        camera: The view.
    """

    row: InstanceRow
    scene: Scene
    light: Light
    camera: Camera


def posed(question: Question, width: int, height: int) -> Posed:
    """A question with its scene, which is generated or read.

    Raises:
        SpecError: No scene can be made from the spec.
        LevelError: The file cannot be read.
    """
    if isinstance(question, LevelQuestion):
        scene = _level_scene(question.path)
        # The file may have changed since the plan was made.
        asked = replace(question, scene_digest=scene.digest, light=scene.lights[question.index])
        return Posed(level_row(asked, width, height), scene, asked.light, asked.camera)
    scene = instance(question.spec)
    light, camera = scene.lights[0], scene.cameras[0]
    row = InstanceRow(
        scene_digest=scene.digest,
        scene=scene.name,
        family=question.family,
        origin=question.origin,
        role=question.role,
        light={**_values(light), "index": 0},
        camera=_values(camera),
        width=width,
        height=height,
    )
    return Posed(row, scene, light, camera)


def level_row(question: LevelQuestion, width: int, height: int) -> InstanceRow:
    """A question about a level as the store keeps it; the file is not read again."""
    return InstanceRow(
        scene_digest=question.scene_digest,
        scene=question.scene,
        family=question.family,
        origin=question.origin,
        role=question.role,
        light={**_values(question.light), "index": question.index},
        camera=_values(question.camera),
        width=width,
        height=height,
    )


@lru_cache(maxsize=_SCENES_KEPT)
def _level_scene(path: Path) -> Scene:
    return read_level(path).scene


def _values(thing: Light | Camera) -> dict[str, Any]:
    """Every field as a JSON value; JSON has no infinity, so null stands for a light without range."""
    values = asdict(thing)
    endless = isinstance(thing, Light) and not isfinite(thing.range_m)
    plain: dict[str, Any] = json.loads(json.dumps({**values, "range_m": None} if endless else values))
    return plain
