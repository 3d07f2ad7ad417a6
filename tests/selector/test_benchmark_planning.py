from __future__ import annotations

from pathlib import Path

import pytest

from scenes.corpus.spec import Spec
from scenes.errors import LevelError
from scenes.scene import Light, LightKind
from selector.benchmark.code_version import code_version, code_versions, commit, source_files
from selector.benchmark.planning import HUGE, corpus_questions, level_questions, planned, spread
from selector.benchmark.questions import LevelQuestion, SpecQuestion, level_row, posed
from selector.evidence.rows import Role
from tests.small_level import CAMERA, POINT, SPOT, SUN, small_level, small_scene


def test_every_prefix_of_the_plan_is_balanced_over_families() -> None:
    plan = planned(corpus_questions("standard"))
    families = {question.family for question in plan}
    for end in range(0, len(plan), 7):
        counts = [sum(one.family == family for one in plan[:end]) for family in families]
        assert max(counts) - min(counts) <= 1


def test_huge_scenes_come_last_in_their_family_and_the_others_keep_their_order() -> None:
    huge = SpecQuestion(Spec("cave", triangles=HUGE + 1))
    small = [SpecQuestion(Spec("cave", seed=seed, triangles=seed)) for seed in (900, 500, 700)]
    assert planned([huge, *small]) == [*small, huge]


def test_lights_are_spread_evenly_over_the_list() -> None:
    assert spread(range(10), 5) == [1, 3, 5, 7, 9]
    assert spread(range(3), None) == spread(range(3), 5) == [0, 1, 2]
    assert spread(range(198), 1) == [99]


def test_a_light_that_strikes_nothing_gives_its_place_to_another(tmp_path: Path) -> None:
    lost = Light("Lost", LightKind.POINT, position=(0.0, 900.0, 0.0), range_m=1.0)
    level = small_level(tmp_path, scene=small_scene((SPOT, lost, POINT)))
    found = level_questions(level, Role.TEST, 2, 1)
    assert all(isinstance(one, LevelQuestion) for one in found)
    assert [one.index for one in found if isinstance(one, LevelQuestion)] == [0, 2]


def test_first_views_of_all_lights_come_first(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((SPOT, SUN), ()))
    found = [one for one in level_questions(level, Role.TRAINING, None, 2) if isinstance(one, LevelQuestion)]
    assert [one.index for one in found] == [0, 1, 0, 1]
    assert found[0].camera != found[2].camera


def test_a_level_without_lights_is_refused(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene(()))
    with pytest.raises(LevelError, match="no lights"):
        level_questions(level, Role.TEST, None, None)


def test_a_question_about_a_level_is_the_same_row_read_again(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((SPOT,), (CAMERA,)))
    (question,) = level_questions(level, Role.TEST, None, None)
    assert isinstance(question, LevelQuestion)
    row = level_row(question, 64, 48)
    assert posed(question, 64, 48).row == row
    assert (row.family, row.origin, row.role) == ("small", "small.glb", Role.TEST)
    assert row.light["index"] == 0
    assert posed(question, 32, 48).row.key != row.key


def test_a_light_without_range_is_null_in_its_row() -> None:
    found = posed(SpecQuestion(Spec("box_grid", triangles=178)), 64, 48)
    assert found.row.light["range_m"] is None
    assert found.row.origin == Spec("box_grid", triangles=178).text


def tree(folder: Path) -> Path:
    texts = {
        "renderers/one.py": 'from renderers import two\nSOURCE = "one.glsl"\n',
        "renderers/two.py": "import scenes.three\nimport numpy\n",
        "renderers/other.py": "NOTHING = 0\n",
        "renderers/one.glsl": '#include "shared.glsl"\n',
        "renderers/shared.glsl": "float half;\n",
        "scenes/three.py": "THREE = 3\n",
    }
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def test_what_decides_the_picture_is_found_through_imports_and_includes(tmp_path: Path) -> None:
    names = [path.name for path in source_files("renderers.one", tree(tmp_path))]
    assert sorted(names) == ["one.glsl", "one.py", "shared.glsl", "three.py", "two.py"]


@pytest.mark.parametrize(
    ("changed", "stale"),
    [("scenes/three.py", True), ("renderers/shared.glsl", True), ("renderers/other.py", False)],
)
def test_only_what_decides_the_picture_makes_it_stale(tmp_path: Path, changed: str, *, stale: bool) -> None:
    root = tree(tmp_path)
    before = code_version("renderers.one", root)
    code_version.cache_clear()
    with (root / changed).open("a", encoding="utf-8") as file:
        file.write("# changed\n")
    assert (code_version("renderers.one", root) != before) == stale


def test_every_technique_has_a_version_of_its_own() -> None:
    versions = code_versions()
    assert len(set(versions.values())) == len(versions)
    names = [path.name for path in source_files("renderers.chan_hybrid")]
    assert {"chan_hybrid.glsl", "shadow_volume.glsl", "frame.py", "world.py", "scene.py"} <= set(names)


def test_without_a_repository_the_version_stands_for_the_commit(tmp_path: Path) -> None:
    assert commit(tmp_path)[0].isdigit()
