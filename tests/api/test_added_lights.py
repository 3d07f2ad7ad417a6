"""Lights on the command line: in memory for every level, as a lights file beside plain geometry."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from api.added_lights import level_with_lights
from api.comparing import MOST_LIGHTS
from scenes.formats.registry import read_level
from scenes.light_words import light_values
from tests.api.command import QUICK, answered, gnomon, succeeded
from tests.small_level import POINT, SPOT, SUN, named, small_level, small_scene

SMALL = ("--resolution", "96x64")
WORDS = "spot position_m=3,4,2 target_m=0,0.5,0 outer_cone_deg=30 range_m=12 intensity=80"
NAMED = 'point position_m=-2,3,1 range_m=9 name="Left lamp"'
OBJ = """o floor
v -5 0 -5
v -5 0 5
v 5 0 5
v 5 0 -5
f 1 2 3 4
o tent
v -1 0.5 -1
v -1 0.5 1
v 1 1.5 1
v 1 1.5 -1
f 5 6 7 8
"""


def yard(folder: Path) -> Path:
    path = folder / "yard.obj"
    path.write_text(OBJ)
    return path


def named_files(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_inspect_lists_added_lights_after_the_levels_own(tmp_path: Path) -> None:
    level = small_level(tmp_path)
    record = answered("inspect", level, "--add-light", WORDS, "--add-light", NAMED)
    own = [light.name for light in (SPOT, POINT, SUN)]
    assert [light["name"] for light in record["lights"]] == [*own, "spot", "Left lamp"]
    spot = record["lights"][3]
    assert (spot["index"], spot["node"], spot["position_m"]) == (3, None, [3.0, 4.0, 2.0])
    assert math.degrees(spot["outer_cone_rad"]) == pytest.approx(30)
    assert record["digest"] != answered("inspect", level)["digest"]


def test_an_added_light_gives_the_digest_of_a_level_that_has_it(tmp_path: Path) -> None:
    bare = small_level(tmp_path, scene=small_scene(lights=()))
    words = "point position_m=-3,4,1.5 range_m=15 intensity=100"
    assert level_with_lights(bare, None, [words]).scene.digest == small_scene(lights=(POINT,)).digest
    assert level_with_lights(bare, None, []).scene.digest == small_scene(lights=()).digest


def test_readers_do_not_miss_lights_that_were_added(tmp_path: Path) -> None:
    quake = tmp_path / "yard.map"
    quake.write_text('{ "classname" "worldspawn" }\n')
    stage = tmp_path / "yard.usda"
    stage.write_text('#usda 1.0\ndef Cube "C" { }\n')
    for level in (yard(tmp_path), small_level(tmp_path, scene=small_scene(lights=())), quake, stage):
        missed = [note for note in level_with_lights(level, None, []).notes if note.lightless]
        assert len(missed) == 1, level
        kept = [note for note in level_with_lights(level, None, []).notes if not note.lightless]
        assert list(level_with_lights(level, None, [WORDS]).notes) == kept


def test_inspect_shows_a_light_without_a_node(tmp_path: Path) -> None:
    text = succeeded("inspect", yard(tmp_path), "--add-light", WORDS).stdout
    assert "1 light" in text
    assert "No lights: annotate has nothing to do" not in text
    assert named_files(tmp_path) == {"yard.obj"}


def test_render_takes_an_added_light_in_a_level_that_has_none(tmp_path: Path) -> None:
    picture = tmp_path / "p.png"
    render = ("render", yard(tmp_path), "-t", "SV", *SMALL, "-o", picture)
    assert gnomon(*render).exit_code == 3
    record = answered(*render, "--add-light", WORDS)
    assert record["light"] == {"node": None, "name": "spot", "kind": "spot"}
    assert record["figures"]["pixels"] > 0
    text = succeeded(*render, "--add-light", NAMED).stdout
    assert "Left lamp (point)" in text
    assert named_files(tmp_path) == {"yard.obj", "p.png"}


def test_render_chooses_among_own_and_added_lights(tmp_path: Path) -> None:
    render = (
        "render",
        small_level(tmp_path),
        "-t",
        "SV",
        *SMALL,
        "-o",
        tmp_path / "p.png",
        "--add-light",
        NAMED,
    )
    assert answered(*render)["light"]["name"] == SPOT.name
    assert answered(*render, "--light", "left lamp")["light"]["node"] is None
    assert answered(*render, "--light", "3")["light"]["name"] == "Left lamp"


def test_compare_takes_added_lights(tmp_path: Path) -> None:
    record = answered(
        *("compare", yard(tmp_path), "-t", "SV", "--rounds", "1", *SMALL),
        *("--add-light", WORDS, "--add-light", NAMED),
    )
    assert [(light["node"], light["name"]) for light in record["lights"]] == [
        (None, "spot"),
        (None, "Left lamp"),
    ]
    assert "Left lamp" in (tmp_path / "yard.compare.html").read_text()
    assert named_files(tmp_path) == {"yard.obj", "yard.compare.html"}


def test_added_lights_are_on_a_page_that_leaves_lights_out(tmp_path: Path) -> None:
    lights = tuple(named(POINT, f"Lamp {number}") for number in range(MOST_LIGHTS + 1))
    level = small_level(tmp_path, scene=small_scene(lights=lights))
    record = answered("compare", level, "-t", "SV", "--rounds", "1", *SMALL, "--add-light", NAMED)
    names = [light["name"] for light in record["lights"]]
    assert names == [*(light.name for light in lights[: MOST_LIGHTS - 1]), "Left lamp"]
    assert record["lights_left_out"] == 2


def test_annotate_writes_the_lights_beside_plain_geometry(tmp_path: Path) -> None:
    level = yard(tmp_path)
    result = succeeded("annotate", level, *QUICK, "--add-light", WORDS, "--add-light", NAMED)
    lights, annotated = tmp_path / "yard.lights.json", tmp_path / "yard.annotated.json"
    assert "yard.lights.json with the lights added" in " ".join(result.stderr.split())
    assert level.read_text() == OBJ
    assert named_files(tmp_path) == {level.name, lights.name, annotated.name}
    entries: list[dict[str, Any]] = json.loads(annotated.read_text())["lights"]
    assert [entry["gnomon_technique"] for entry in entries] == ["SV", "SV"]
    digest = level_with_lights(lights, None, []).scene.digest
    assert read_level(annotated).scene.digest == read_level(level).scene.digest == digest


def test_annotate_tells_as_json_which_files_it_wrote(tmp_path: Path) -> None:
    record = answered("annotate", yard(tmp_path), *QUICK, "--add-light", NAMED)
    assert [Path(path).name for path in record["written"]] == ["yard.lights.json", "yard.annotated.json"]
    assert Path(record["output"]).name == "yard.annotated.json"
    assert [(light["node"], light["name"]) for light in record["lights"]] == [(0, "Left lamp")]


def test_annotate_keeps_a_lights_file_that_is_there(tmp_path: Path) -> None:
    level, lights = yard(tmp_path), tmp_path / "yard.lights.json"
    lights.write_text('{"lights": []}')
    result = gnomon("annotate", level, *QUICK, "--add-light", NAMED)
    assert result.exit_code == 2
    assert "yard.lights.json already" in result.stderr
    assert lights.read_text() == '{"lights": []}'
    # What the error says to add is a light of a lights file.
    assert json.dumps(light_values(NAMED)) in result.stderr
    lights.write_text(json.dumps({"lights": [light_values(NAMED)]}))
    assert [light["name"] for light in answered("annotate", level, *QUICK)["lights"]] == ["Left lamp"]


@pytest.mark.parametrize("name", ["small.glb", "lights.json"])
def test_annotate_says_where_the_light_of_another_format_goes(tmp_path: Path, name: str) -> None:
    small_level(tmp_path)
    yard(tmp_path)
    (tmp_path / "lights.json").write_text('{"geometry": "yard.obj"}')
    before = named_files(tmp_path)
    result = gnomon("annotate", tmp_path / name, *QUICK, "--add-light", NAMED)
    assert result.exit_code == 2
    assert f"Add the light to {name}" in result.stderr
    assert named_files(tmp_path) == before


@pytest.mark.parametrize(
    ("options", "exit_code"),
    [(["--in-place"], 5), (["-o", "there/out.json"], 5), (["--clear", "-o", "out.json"], 2)],
)
def test_a_refused_annotate_leaves_no_lights_file(tmp_path: Path, options: list[str], exit_code: int) -> None:
    level = yard(tmp_path)
    options = [str(tmp_path / one) if one.endswith(".json") else one for one in options]
    assert gnomon("annotate", level, *QUICK, "--add-light", NAMED, *options).exit_code == exit_code
    assert named_files(tmp_path) == {"yard.obj"}


def test_broken_geometry_gets_no_lights_file(tmp_path: Path) -> None:
    level = tmp_path / "yard.obj"
    level.write_text("v 0 0 0\n")
    assert gnomon("annotate", level, *QUICK, "--add-light", NAMED).exit_code == 3
    assert named_files(tmp_path) == {"yard.obj"}


@pytest.mark.parametrize("command", ["inspect", "render", "compare", "annotate"])
@pytest.mark.parametrize(
    ("words", "wrong"),
    [
        ("lamp position_m=0,3,0", "kind"),
        ("point position_m=0,3,0 radius=4", "radius"),
        ("point position_m=0,3", "position_m"),
        ("point position_m=0,3,0 range_m", "range_m"),
        ("", "kind"),
    ],
)
def test_bad_words_are_named(tmp_path: Path, command: str, words: str, wrong: str) -> None:
    result = gnomon(command, yard(tmp_path), "--add-light", words)
    assert result.exit_code == 3
    assert wrong in result.stderr
    assert named_files(tmp_path) == {"yard.obj"}
