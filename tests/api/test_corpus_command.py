"""`gnomon corpus` lists, counts and writes."""

from __future__ import annotations

from pathlib import Path

import pytest

from api.corpus import Coverage, LevelRows, level_files, surveyed_levels
from scenes.corpus.axes import Surveyed
from scenes.corpus.bins import AXES
from scenes.corpus.corpora import corpus
from scenes.corpus.registry import families
from scenes.corpus.showcase import showcase
from scenes.corpus.staging import instance
from scenes.errors import LevelError
from scenes.formats.registry import read_level
from tests.api.command import answered, gnomon, succeeded
from tests.small_level import small_level


def test_the_list_names_every_family() -> None:
    listed = answered("corpus")
    assert [one["family"] for one in listed] == list(families())
    text = succeeded("corpus", width=160).stdout
    for name, family in families().items():
        assert name in text
        assert family.SUMMARY in text


def test_an_exported_family_reads_back(tmp_path: Path) -> None:
    (one,) = answered("corpus", "--export", tmp_path / "made", "--family", "cave", "--seed", "3")
    assert one["spec"]["family"] == "cave"
    path = tmp_path / "made" / "cave-3.glb"
    assert one["file"] == str(path)
    scene = instance(showcase("cave", 3))
    level = read_level(path)
    assert level.scene.triangle_count == scene.triangle_count
    assert [light.name for light in level.scene.lights] == [light.name for light in scene.lights]
    assert level.scene.cameras[0].position == scene.cameras[0].position
    first = path.read_bytes()
    succeeded("corpus", "--export", tmp_path / "made", "--family", "cave", "--seed", "3")
    assert path.read_bytes() == first


def test_stats_count_a_corpus_and_the_levels_beside_it(tmp_path: Path) -> None:
    level = small_level(tmp_path)
    (tmp_path / "broken.glb").write_bytes(b"nothing")
    found = answered("corpus", "--stats", "--corpus", "thesis", "--levels", tmp_path)
    assert found["corpus"] == "thesis"
    assert found["instances"] == len(corpus("thesis"))
    assert [axis["axis"] for axis in found["axes"]] == [axis.name for axis in AXES]
    rows = sum(level["rows"] for level in found["levels"])
    assert rows > 0
    assert [level["failure"] != "" for level in found["levels"]] == [True, False]
    for axis in found["axes"]:
        assert sum(one["corpus"] for one in axis["bins"]) == found["instances"]
        assert sum(one["levels"] for one in axis["bins"]) == rows
    outside = next(axis["outside"] for axis in found["axes"] if axis["axis"] == "kind")
    # The thesis has spots only; the level has a point light and a sun too.
    assert list(outside) == [str(level)]


def test_what_no_instance_is_like_lies_outside() -> None:
    scene = instance(corpus("thesis")[0])
    row = Surveyed.of(scene).axes(scene.lights[0], scene.cameras[0])
    axis = next(axis for axis in AXES if axis.name == "triangles")
    assert Coverage("x", (row,), (LevelRows(Path("a.glb"), (row,)),)).outside(axis) == {}
    assert Coverage("x", (), (LevelRows(Path("a.glb"), (row, row)),)).outside(axis) == {"a.glb": 2}


def test_a_folder_without_levels_is_refused(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(LevelError):
            level_files(folder)
    result = gnomon("corpus", "--stats", "--corpus", "thesis", "--levels", tmp_path / "nowhere")
    assert result.exit_code == LevelError.exit_code
    assert "no folder" in result.stderr


def test_a_level_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    path = tmp_path / "broken.glb"
    path.write_bytes(b"nothing")
    (rows,) = surveyed_levels([path], lambda _: None)
    assert rows.rows == ()
    assert rows.failure


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--levels", "x"), "--levels goes with --stats"),
        (("--family", "cave"), "go with --export"),
        (("--seed", "3"), "go with --export"),
        (("--stats", "--export", "x"), "one at a time"),
        (("--stats", "--corpus", "huge"), "huge"),
        (("--export", "x", "--seed", "-1"), "whole number"),
    ],
)
def test_options_that_make_no_sense_are_refused(arguments: tuple[str, ...], words: str) -> None:
    result = gnomon("corpus", *arguments, width=200)
    assert result.exit_code == 2
    assert words in result.stderr


def test_an_unknown_family_is_refused_with_those_that_there_are(tmp_path: Path) -> None:
    result = gnomon("corpus", "--export", tmp_path / "made", "--family", "atlantis")
    assert result.exit_code == 2
    assert "atlantis" in result.stderr
    assert "forest" in result.stderr
    assert not (tmp_path / "made").exists()
