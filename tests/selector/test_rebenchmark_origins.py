"""Stored instances are asked again as what they were: under the same key, or not at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from scenes.corpus.corpora import corpus
from selector.benchmark.planning import level_questions
from selector.benchmark.questions import LevelQuestion, SpecQuestion, level_row, posed
from selector.evidence.rows import InstanceRow, Role
from selector.rebenchmark.origins import asking
from tests.small_level import CAMERA, SPOT, named, small_level, small_scene

WIDTH, HEIGHT = 96, 64


def rows(path: Path) -> list[InstanceRow]:
    """What a benchmark of a level keeps of its lights and views."""
    questions = level_questions(path, Role.TRAINING, None, None)
    return [level_row(one, WIDTH, HEIGHT) for one in questions if isinstance(one, LevelQuestion)]


@pytest.mark.parametrize("cameras", [(CAMERA,), (CAMERA, replace(CAMERA, name="Other")), ()])
def test_every_light_and_view_of_a_level_keeps_its_key(tmp_path: Path, cameras: tuple[object, ...]) -> None:
    path = small_level(tmp_path, "yard.glb", small_scene(cameras=cameras))  # type: ignore[arg-type]
    kept = rows(path)
    assert len(kept) >= 3
    # Cameras of the file are nodes of it, and those that were made are none.
    assert all((one.camera["node"] is None) == (not cameras) for one in kept)
    found = asking(kept, [tmp_path])
    assert found.problems == {}
    assert set(found.questions) == {one.key for one in kept}
    for key, question in found.questions.items():
        assert posed(question, WIDTH, HEIGHT).row.key == key


def test_a_generated_scene_keeps_its_key() -> None:
    spec = min(corpus("quick"), key=lambda one: one.triangles)
    row = posed(SpecQuestion(spec), WIDTH, HEIGHT).row
    found = asking([row], [])
    assert posed(found.questions[row.key], WIDTH, HEIGHT).row.key == row.key


def test_of_levels_of_one_name_the_right_one_is_asked(tmp_path: Path) -> None:
    kept = []
    for folder, light in (("a", "Lamp"), ("b", "Other lamp")):
        (tmp_path / folder).mkdir()
        scene = small_scene((named(replace(SPOT, intensity=100.0 + len(light)), light),))
        kept += rows(small_level(tmp_path / folder, "yard.glb", scene))
    found = asking(kept, [tmp_path])
    assert set(found.questions) == {one.key for one in kept}
    folders = [one.path.parent.name for one in found.questions.values() if isinstance(one, LevelQuestion)]
    assert set(folders) == {"a", "b"}


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (lambda path: path.unlink(), "not among those that --levels names"),
        (lambda path: path.write_bytes(b"glTF"), "ends inside its header"),
        (lambda path: small_level(path.parent, path.name, small_scene((SPOT,))), "has changed"),
    ],
    ids=["gone", "broken", "changed"],
)
def test_what_cannot_be_asked_again_is_said(
    tmp_path: Path, harm: Callable[[Path], object], words: str
) -> None:
    path = small_level(tmp_path, "yard.glb")
    kept = rows(path)
    harm(path)
    found = asking(kept, [tmp_path])
    assert found.questions == {}
    ((problem, count),) = found.problems.items()
    assert words in problem
    assert count == len(kept)
