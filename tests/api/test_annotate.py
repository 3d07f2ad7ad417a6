from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from renderers.registry import TECHNIQUES
from renderers.shadow_map import ShadowMap
from scenes.errors import OutputError
from scenes.formats.registry import read_level
from scenes.scene import Light, LightKind, Scene
from selector.measuring import Bench
from tests.api.command import QUICK, answered, files, gnomon, nodes, succeeded
from tests.small_level import POINT, SPOT, SUN, named, small_level, small_scene

SIZE = ("--resolution", "96x64", "-o", "p.png")
NOWHERE = Light("Nowhere", LightKind.POINT, position=(0.0, 900.0, 0.0), range_m=1.0)


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path)


@pytest.fixture(autouse=True)
def _few_candidates(monkeypatch: pytest.MonkeyPatch) -> None:
    few = [{"map_size": size, "filter": "2x2", "focus": "light"} for size in (128, 512)]
    for known in TECHNIQUES:
        chosen = {"SM": few, "SV": [{}]}.get(known.label, [])
        monkeypatch.setattr(type(known), "candidates", lambda *_, chosen=chosen: chosen)


def test_a_level_goes_in_and_comes_out_annotated(level: Path, tmp_path: Path) -> None:
    before = level.read_bytes()
    result = gnomon("annotate", level, "--resolution", "96x64", "--rounds", 1, width=160)
    assert result.exit_code == 0, result.stderr
    output = tmp_path / "small.annotated.glb"
    assert files(tmp_path) == {"small.glb", "small.annotated.glb"}
    assert level.read_bytes() == before
    for name, node in nodes(output).items():
        assert node["extras"]["gnomon_technique"] in ("SM", "SV")
        assert node["extras"]["gnomon_source"] == "measured"
        assert len(node["extensions"]["GNOMON_lights_shadow_technique"]["alternatives"]) == 2
        assert name in result.stdout
    assert read_level(output).scene.digest == read_level(level).scene.digest
    assert "3 lights" in result.stderr
    assert str(output) in result.stdout


def test_json_is_all_there_is_on_stdout(level: Path, tmp_path: Path) -> None:
    record = answered("annotate", level, *QUICK, "--light", "Torch", "--light", "0")
    assert [light["name"] for light in record["lights"]] == ["Lamp", "Torch"]
    lamp = record["lights"][0]
    assert (lamp["chosen"]["technique"], lamp["chosen"]["label"]) == ("shadow_volume", "SV")
    assert (lamp["mobility"], record["lights"][1]["mobility"]) == ("static", "dynamic")
    assert lamp["chosen"]["edge_error_px"] == 0.0
    assert lamp["within_limit"]
    assert lamp["views"] == ["Eye"]
    assert record["output"] == str(tmp_path / "small.annotated.glb")
    assert record["resolution"] == [96, 64]
    assert record["problems"] == []
    assert "gnomon_technique" not in nodes(tmp_path / "small.annotated.glb")["Sun"].get("extras", {})


def test_the_limit_decides(level: Path) -> None:
    def chosen(limit: float) -> dict[str, Any]:
        arguments = ("--resolution", "96x64", "--rounds", 1, "--light", "Torch", "--max-edge-error-px", limit)
        (light,) = answered("annotate", level, *arguments)["lights"]
        return light

    exact = chosen(0.0)
    assert exact["chosen"]["label"] == "SV"
    by_cost = sorted(chosen(1000.0)["candidates"], key=lambda one: one["shadow_ms"])
    assert chosen(1000.0)["within_limit"]
    assert {one["label"] for one in by_cost} == {"SM", "SV"}


def test_mobility_can_be_given(level: Path) -> None:
    record = answered("annotate", level, *QUICK, "--mobility", "static")
    assert {light["mobility"] for light in record["lights"]} == {"static"}


def test_verify_compares_the_truth_with_rays(level: Path) -> None:
    result = gnomon("annotate", level, *QUICK, "--verify", width=160)
    assert "agrees with ray casting" in result.stdout


def test_flicker_is_measured_on_request(level: Path) -> None:
    def flickers(*arguments: str) -> set[float | None]:
        lights = answered("annotate", level, *QUICK, *arguments)["lights"]
        return {one["flicker"] for light in lights for one in light["candidates"] if one["status"] == "ok"}

    assert flickers() == {None}
    # Shadow volumes are exact in every frame.
    assert flickers("--flicker") == {0.0}


def test_clear_gives_the_original_back(level: Path, tmp_path: Path) -> None:
    original, output, cleared = level.read_bytes(), tmp_path / "out.glb", tmp_path / "cleared.glb"
    succeeded("annotate", level, *QUICK, "-o", output)
    assert output.read_bytes() != original
    result = gnomon("annotate", output, "--clear", "-o", cleared)
    assert result.exit_code == 0
    assert "byte for byte" in result.stdout
    assert cleared.read_bytes() == original
    # Again: what would be written is there already.
    assert gnomon("annotate", output, "--clear", "-o", cleared).exit_code == 0
    record = answered("annotate", output, "--clear", "--in-place")
    assert record["restored"] is True
    assert output.read_bytes() == original
    again = answered("annotate", output, "--clear", "--in-place")
    assert again["output"] is None


def test_in_place_overwrites_the_level(level: Path, tmp_path: Path) -> None:
    original = level.read_bytes()
    assert gnomon("annotate", level, *QUICK, "--in-place").exit_code == 0
    assert files(tmp_path) == {"small.glb"}
    assert "gnomon_technique" in nodes(level)["Lamp"]["extras"]
    # And again, over an annotation of its own.
    assert gnomon("annotate", level, *QUICK, "--in-place").exit_code == 0
    succeeded("annotate", level, "--clear", "--in-place")
    assert level.read_bytes() == original


def test_a_second_run_replaces_the_first_output(level: Path, tmp_path: Path) -> None:
    succeeded("annotate", level, *QUICK, "--light", "Sun")
    assert gnomon("annotate", level, *QUICK, "--light", "Torch").exit_code == 0
    # The level is not annotated itself, so there is nothing of the Sun to keep.
    extras = nodes(tmp_path / "small.annotated.glb")
    assert "gnomon_technique" in extras["Torch"]["extras"]
    assert "extras" not in extras["Sun"]


def test_lights_that_are_not_measured_keep_their_annotations(level: Path) -> None:
    original = level.read_bytes()
    succeeded("annotate", level, *QUICK, "--in-place", "--light", "Lamp", "--light", "Torch")
    before = nodes(level)
    again = ("--resolution", "80x64", "--rounds", 1, "--technique", "SM", "--max-edge-error-px", 1000)
    succeeded("annotate", level, *again, "--in-place", "--light", "Sun", "--light", "Torch")
    after = nodes(level)
    assert json.dumps(after["Lamp"]) == json.dumps(before["Lamp"])
    assert [after[name]["extras"]["gnomon_technique"] for name in after] == ["SV", "SM", "SM"]
    assert gnomon("annotate", level, "--clear", "--in-place").exit_code == 0
    assert level.read_bytes() == original


def test_a_light_without_an_answer_keeps_its_annotation(level: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    succeeded("annotate", level, *QUICK, "--in-place", "--light", "Torch")
    before = nodes(level)["Torch"]
    measure = Bench.measure

    def failing(self: Bench, light: Light, *args: object, **options: object) -> object:
        if light.name != "Sun":
            raise ZeroDivisionError("a bug")
        return measure(self, light, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Bench, "measure", failing)
    result = gnomon("annotate", level, *QUICK, "--in-place", width=200)
    assert result.exit_code == 6
    assert result.stdout.count("Its earlier annotation stays.") == 1
    assert json.dumps(nodes(level)["Torch"]) == json.dumps(before)
    assert "gnomon_technique" in nodes(level)["Sun"]["extras"]


def test_lights_of_one_name_are_all_meant(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((SPOT, POINT, named(SUN, "Torch"))))
    record = answered("annotate", level, *QUICK, "--light", "Torch")
    assert [light["node"] for light in record["lights"]] == [4, 5]
    record = answered("annotate", level, *QUICK, "--light", "node:5")
    assert [light["kind"] for light in record["lights"]] == ["directional"]


def test_many_lights_are_not_all_listed(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene(tuple(named(SPOT, f"L{n}") for n in range(25))))
    result = gnomon("annotate", level, "--light", "Moon", width=400)
    assert result.exit_code == 3
    assert '"L9" ... and 15 more' in result.stderr
    assert "L10" not in result.stderr


def test_lights_without_a_shadow_in_any_view_are_counted(level: Path, tmp_path: Path) -> None:
    dark = small_level(tmp_path, "one.glb", small_scene((SPOT, named(NOWHERE, "Far"))))
    # No camera shows what the other lights, so that one has to be named.
    lights = answered("annotate", dark, *QUICK, "--camera", "Eye")["lights"]
    assert [light["shadow_edge_seen"] for light in lights] == [True, False]
    result = succeeded("annotate", dark, *QUICK, "--camera", "Eye", width=200)
    assert "1 of 2 lights casts no shadow whose edge any view shows" in result.stdout
    assert "casts no shadow" not in succeeded("annotate", level, *QUICK, width=200).stdout


def test_a_level_that_is_not_there_is_said_before_its_name_is_judged(tmp_path: Path) -> None:
    for command in (("annotate",), ("inspect",), ("render",), ("annotate", "--clear", "--in-place")):
        result = gnomon(command[0], tmp_path / "street", *command[1:])
        assert result.exit_code == 3
        assert "There is no such file" in result.stderr


def test_pictures_show_every_candidate_and_a_sheet(level: Path, tmp_path: Path) -> None:
    folder = tmp_path / "deep/pictures"
    arguments = ("--resolution", "96x64", "--rounds", 1, "--light", "Torch", "--pictures", folder)
    result = gnomon("annotate", level, *arguments)
    assert result.exit_code == 0
    assert files(folder) == {
        "Torch.truth.png",
        "Torch.SM-128-2x2.png",
        "Torch.SM-512-2x2.png",
        "Torch.SV.png",
        "Torch.sheet.png",
    }
    assert (folder / "Torch.truth.png").read_bytes() == (folder / "Torch.SV.png").read_bytes()
    assert (folder / "Torch.truth.png").read_bytes() != (folder / "Torch.SM-128-2x2.png").read_bytes()


def test_measurements_hold_every_sample(level: Path, tmp_path: Path) -> None:
    path = tmp_path / "raw.json"
    succeeded("annotate", level, "--resolution", "96x64", "--rounds", 2, "--measurements", path)
    record = json.loads(path.read_text())
    assert record["digest"] == read_level(level).scene.digest
    assert [light["light"]["name"] for light in record["lights"]] == ["Lamp", "Torch", "Sun"]
    assert record["lights"][2]["light"]["range_m"] is None
    for light in record["lights"]:
        assert light["device"]["renderer"]
        assert [len(times) for times in light["canary_ms"]] == [2]
        for candidate in light["candidates"]:
            (view,) = candidate["views"]
            assert len(view["samples"]) == 4
            assert view["counters"]
            assert view["figures"]["pixels"] > 0


def test_lights_without_an_answer_are_named_and_exit_6(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((NOWHERE, SPOT), cameras=()))
    result = gnomon("annotate", level, *QUICK, width=160)
    assert result.exit_code == 6
    assert "no recommendation Nowhere (node 3): It strikes no surface" in result.stdout
    written = nodes(tmp_path / "small.annotated.glb")
    assert "extras" not in written["Nowhere"]
    assert "gnomon_technique" in written["Lamp"]["extras"]


def test_a_failing_light_costs_no_other_its_result(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measure = Bench.measure

    def failing(self: Bench, light: Light, *args: object, **options: object) -> object:
        if light.name == "Torch":
            raise ZeroDivisionError("a bug")
        return measure(self, light, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Bench, "measure", failing)
    lights = answered("annotate", level, *QUICK, exit_code=6)["lights"]
    assert ["problem" in light for light in lights] == [False, True, False]
    assert "ZeroDivisionError" in lights[1]["problem"]
    assert set(nodes(tmp_path / "small.annotated.glb")) == {"Lamp", "Torch", "Sun"}


def test_nothing_is_written_where_nothing_was_found(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((NOWHERE,), cameras=()))
    result = gnomon("annotate", level, *QUICK)
    assert result.exit_code == 6
    assert files(tmp_path) == {"small.glb"}
    assert "No level was written" in result.stdout


def test_a_candidate_that_crashed_is_told(level: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ShadowMap, "refuses", Mock(side_effect=ZeroDivisionError("a bug")))
    result = gnomon("annotate", level, "--resolution", "96x64", "--rounds", 1, "--light", "Sun", width=200)
    assert result.exit_code == 0
    assert "not weighed Sun: SM 128 2x2, SM 512 2x2: crashed: ZeroDivisionError: a bug" in result.stdout


def test_results_survive_an_output_that_fails(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = Mock(side_effect=OutputError("The disk is full.", where="there"))
    monkeypatch.setattr("api.annotating.write_level", full)
    result = gnomon("annotate", level, *QUICK, "--json", "--measurements", tmp_path / "raw.json")
    assert result.exit_code == 5
    record = json.loads(result.stdout)
    assert record["output"] is None
    assert record["problems"] == ["there: The disk is full."]
    assert len(record["lights"]) == 3
    assert "The disk is full." in result.stderr
    assert files(tmp_path) == {"small.glb", "raw.json"}


def test_a_picture_that_fails_costs_no_level(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = Mock(side_effect=OutputError("The disk is full.", where="there"))
    monkeypatch.setattr("api.picture_folder.write_png", full)
    result = gnomon("annotate", level, *QUICK, "--pictures", tmp_path / "pictures")
    assert result.exit_code == 5
    assert full.call_count == 1
    assert len(nodes(tmp_path / "small.annotated.glb")) == 3
    assert "error: there: The disk is full." in result.stderr


def test_a_level_that_changed_meanwhile_is_not_overwritten(
    level: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measure = Bench.measure

    def meddling(self: Bench, *args: object, **options: object) -> object:
        level.write_bytes(changed)
        return measure(self, *args, **options)  # type: ignore[arg-type]

    changed = level.read_bytes() + b"    "
    monkeypatch.setattr(Bench, "measure", meddling)
    result = gnomon("annotate", level, *QUICK, "--in-place")
    assert result.exit_code == 5
    assert "has changed" in result.stderr
    assert level.read_bytes() == changed


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("-o", "small.glb"), 5, "would overwrite the level itself"),
        (("-o", "./link.glb"), 5, "would overwrite the level itself"),
        (("-o", "out.gltf"), 5, "must end in .glb"),
        (("-o", "missing/out.glb"), 5, "folder does not exist"),
        (("-o", "other.glb"), 5, "no annotated level"),
        (("-o", "folder.glb"), 5, "a folder"),
        (("-o", "other.glb/out.glb"), 5, "not a folder"),
        (("-o", "x" * 300 + ".glb"), 5, "too long"),
        (("-o", "out.glb", "--in-place"), 2, "contradict"),
        (("--clear",), 2, "--in-place or -o"),
        (("--clear", "--in-place", "--light", "Sun"), 2, "Leave --light out"),
        (("--clear", "-o", "small.glb"), 5, "would overwrite the level itself"),
        (("--clear", "-o", "other.glb"), 5, "no annotated level"),
        (("--measurements", "small.glb"), 5, "would overwrite the level"),
        (("--measurements", "missing/raw.json"), 5, "folder does not exist"),
        (("--pictures", "other.glb"), 5, "Name a folder with --pictures"),
        (("--pictures", "other.glb/deep"), 5, "another path with --pictures"),
        (("--light", "Moon"), 3, '"Lamp", "Torch", "Sun"'),
        (("--camera", "Drone"), 3, '"Eye"'),
        (("-t", "SM", "-t", "PCSS"), 2, "PCSS"),
        (("--technique", ","), 2, "no technique"),
        (("--rounds", "0"), 2, "--rounds"),
        (("--max-edge-error-px", "-1"), 2, "--max-edge-error-px"),
        (("--max-edge-error-px", "nan"), 2, "--max-edge-error-px"),
        (("--max-edge-error-px", "inf"), 2, "not a finite number of pixels"),
        (("--max-edge-error-px", "50%"), 2, '"50%" is not a number of pixels such as 1.5'),
        (("--rounds", "two"), 2, '"two" is not a whole number from 1 to 1000'),
        (("--mode", "guess"), 2, '"guess" is not "measure" or "predict"'),
        (("--mobility", "floating"), 2, "floating"),
        (("--resolution", "big"), 2, "not a resolution"),
        (("--device", "Voodoo"), 4, "Voodoo"),
        (("--scene", "Other"), 3, "Other"),
    ],
    ids=lambda value: "_".join(value)[:40] if isinstance(value, tuple) else "",
)
def test_what_cannot_be_done_is_said_before_anything_is_measured(
    level: Path, arguments: tuple[str, ...], code: int, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = level.parent
    monkeypatch.chdir(folder)
    monkeypatch.setattr(Bench, "measure", Mock(side_effect=AssertionError("it was measured")))
    (folder / "other.glb").write_bytes(b"somebody's work")
    (folder / "folder.glb").mkdir()
    (folder / "link.glb").symlink_to("small.glb")
    original, before = level.read_bytes(), files(folder)
    result = gnomon("annotate", level, *arguments, width=400)
    assert result.exit_code == code, result.stderr
    assert words in result.stderr.replace("\n", " ")
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert files(folder) == before
    assert level.read_bytes() == original
    assert (folder / "other.glb").read_bytes() == b"somebody's work"


@pytest.mark.parametrize(
    ("scene", "words"),
    [(small_scene(lights=()), "no lights"), (Scene("Void", (), (POINT,)), "no triangles")],
    ids=["no lights", "no triangles"],
)
def test_a_level_with_nothing_to_measure_is_refused(tmp_path: Path, scene: Scene, words: str) -> None:
    result = gnomon("annotate", small_level(tmp_path, scene=scene))
    assert result.exit_code == 3
    assert words in result.stderr


def test_an_annotated_level_is_not_annotated_over_by_default(level: Path, tmp_path: Path) -> None:
    shutil.copy(level, tmp_path / "town.annotated.glb")
    result = gnomon("annotate", tmp_path / "town.annotated.glb", *QUICK)
    assert result.exit_code == 5
    assert "--in-place" in result.stderr


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is forbidden to root")
def test_a_folder_without_permission_is_exit_5(level: Path, tmp_path: Path) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    result = gnomon("annotate", level, "-o", locked / "out.glb")
    assert result.exit_code == 5
    assert "permission" in result.stderr


def test_an_interrupt_says_how_far_it_was(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measure: Callable[..., object] = Bench.measure
    lights: list[str] = []

    def interrupted(self: Bench, light: Light, *args: object, **options: object) -> object:
        lights.append(light.name)
        if light.name == "Sun":
            raise KeyboardInterrupt
        return measure(self, light, *args, **options)

    monkeypatch.setattr(Bench, "measure", interrupted)
    result = gnomon("annotate", level, *QUICK, width=300)
    assert result.exit_code == 130
    assert "interrupted: 2 of 3 lights were measured" in result.stderr
    assert "small.annotated.glb was not written" in result.stderr
    assert result.stdout == ""
    assert files(tmp_path) == {"small.glb"}


def test_what_the_reader_warns_of_is_told_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    level = small_level(tmp_path)
    source = level.read_bytes()
    # The same length, so that the file stays whole.
    level.write_bytes(source.replace(b'"intensity":300.0', b'"intensity":-99.0'))
    for command in (("annotate", level, *QUICK, "--light", "Lamp"), ("render", level, "-t", "SV", *SIZE)):
        result = gnomon(*command, width=200)
        assert result.exit_code == 0, result.stderr
        assert "warning: " in result.stderr
        assert "Lamp" in result.stderr
