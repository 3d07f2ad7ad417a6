from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from scenes.scene import Light, LightKind
from tests.api.command import answered, gnomon, succeeded
from tests.small_level import POINT, SPOT, small_level, small_scene

SMALL = ("--resolution", "96x64")


def pixels(path: Path) -> np.ndarray:
    return OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8)


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path)


def test_it_renders_the_first_light_from_the_first_camera(level: Path, tmp_path: Path) -> None:
    picture = tmp_path / "out.png"
    result = gnomon("render", level, *SMALL, "-o", picture, width=160)
    assert result.exit_code == 0
    assert pixels(picture).shape == (64, 96, 3)
    said = (
        "SM 1024 2x2",
        "shadow_map",
        "Lamp",
        "Eye",
        "dynamic light",
        "static light",
        "edge off by",
        "4.0 MiB",
    )
    for words in (*said, "map fragments"):
        assert words in result.stdout, words
    assert str(picture) in result.stdout


def test_json_says_what_was_done(level: Path, tmp_path: Path) -> None:
    picture = tmp_path / "out.png"
    record = answered("render", level, "-t", "shadow_volume", "--light", "Torch", *SMALL, "-o", picture)
    assert (record["technique"], record["label"], record["settings"]) == ("shadow_volume", "SV", {})
    assert record["light"]["name"] == "Torch"
    assert (record["camera"], record["resolution"]) == ("Eye", [96, 64])
    assert record["figures"]["wrong_share"] == 0.0
    assert record["counters"]["silhouette_edges"] > 0
    assert record["memory_bytes"] > 0
    assert {sample["mobility"] for sample in record["samples"]} == {"static", "dynamic"}
    assert record["picture"] == str(picture)


def test_the_truth_against_itself_is_exact(level: Path, tmp_path: Path) -> None:
    said = succeeded("render", level, "-t", "SV", *SMALL, "-o", tmp_path / "p.png", width=160).stdout
    assert re.search(r"error \(against shadow_volume\) +exact", said)
    assert "edge off by" not in said


@pytest.mark.parametrize("label", ["SM", "PSM", "LiSPSM", "Chan"])
@pytest.mark.parametrize("light", ["Lamp", "Torch", "Sun"])
def test_maps_are_alike_unless_somebody_asks(level: Path, tmp_path: Path, label: str, light: str) -> None:
    picture = tmp_path / "p.png"
    record = answered("render", level, "-t", label, "--light", light, *SMALL, "-o", picture)
    assert record["settings"]["map_size"] == 1024


def test_what_fell_back_is_said_once_and_the_figures_are_those_of_what_was_drawn(
    level: Path, tmp_path: Path
) -> None:
    order = ("render", level, "-t", "PSM", "--light", "Torch", *SMALL, "-o", tmp_path / "p.png")
    result = succeeded(*order, width=200)
    assert re.search(r"fell back +SM was drawn in view Eye, because ", result.stdout)
    for words in ("; SM was drawn", "--set fall_back=never draws the warp", "error of the SM (against"):
        assert words in result.stdout, words
    record = answered(*order)
    assert (record["status"], record["fallback"], record["note"]) == ("refused", "shadow_map", "")
    who, _, why = record["reason"].partition(", because ")
    assert who == "SM was drawn in view Eye"
    assert why
    assert result.stdout.count(why) == 1
    forced = succeeded(*order, "--set", "fall_back=never", width=200).stdout
    assert "fell back" not in forced
    assert "--set" not in forced


def test_settings_change_the_picture(level: Path, tmp_path: Path) -> None:
    coarse, fine, truth = tmp_path / "coarse.png", tmp_path / "fine.png", tmp_path / "truth.png"
    options = ("--map-size", 128, "--filter", "1x1", "--focus", "light")
    record = answered("render", level, *SMALL, *options, "-o", coarse)
    assert record["settings"] == {"map_size": 128, "filter": "1x1", "focus": "light"}
    succeeded("render", level, *SMALL, "--map-size", 4096, "-o", fine)
    succeeded("render", level, *SMALL, "-t", "SV", "-o", truth)
    wrong = [np.abs(pixels(one).astype(int) - pixels(truth)).sum() for one in (coarse, fine)]
    assert wrong[0] > wrong[1]


@pytest.mark.parametrize("name", ["Torch", "torch", "1", "node:4"])
def test_a_light_goes_by_name_number_or_node(level: Path, tmp_path: Path, name: str) -> None:
    options = ("-t", "SV", "--light", name, *SMALL, "-o", tmp_path / "p.png")
    assert answered("render", level, *options)["light"]["name"] == "Torch"


def test_of_several_lights_of_a_name_the_first_is_taken_and_said(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((SPOT, POINT, POINT)))
    result = gnomon(
        "render", level, "--light", "Torch", *SMALL, "-t", "SV", "-o", tmp_path / "p.png", width=160
    )
    assert "the first of 2 of this name" in result.stdout


def test_a_level_without_cameras_is_seen_from_a_viewpoint(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene(cameras=()))
    record = answered("render", level, "-t", "SV", *SMALL, "-o", tmp_path / "p.png")
    assert record["camera"] == "over the shoulder"


def test_the_picture_is_named_after_what_it_shows(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    succeeded("render", level, *SMALL, "-t", "SV")
    assert [path.name for path in folder.iterdir()] == ["small.Lamp.SV.png"]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("-t", "PCSS"), 2, "SM (shadow_map), PSM (perspective_shadow_map), "),
        (("-t", "SV", "--map-size", "512"), 2, 'SV has no setting "map_size"'),
        (("--map-size", "8"), 2, 'SM cannot have map_size "8"'),
        (("--resolution", "640"), 2, "not a resolution"),
        (("--resolution", "4x4"), 2, "between"),
        (("--filter", "5x5"), 2, "It may be 1x1, 2x2, 3x3, 4x4."),
        (("--light", "Moon"), 3, 'the lights "Lamp", "Torch", "Sun"'),
        (("--light", "9"), 3, 'no light "9"'),
        (("--camera", "Drone"), 3, 'the camera "Eye"'),
        (("--device", "99"), 4, "EGL device 99"),
        (("--device", "Voodoo"), 4, "Voodoo"),
        (("-o", "missing/p.png"), 5, "folder does not exist"),
        (("-o", "p.jpg"), 5, ".png"),
        (("--light", "Torch", "--map-size", "4096"), 1, "at most 2048"),
    ],
    ids=lambda value: "_".join(value) if isinstance(value, tuple) else "",
)
def test_what_cannot_be_done_is_said(
    level: Path, arguments: tuple[str, ...], code: int, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(level.parent)
    result = gnomon("render", level, *SMALL, *arguments, width=200)
    assert result.exit_code == code, result.stderr
    assert words in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert [path.name for path in level.parent.iterdir()] == ["small.glb"]


def test_a_light_that_strikes_nothing_has_no_view(tmp_path: Path) -> None:
    far = Light("Far", LightKind.POINT, position=(0.0, 900.0, 0.0), range_m=1.0)
    level = small_level(tmp_path, scene=small_scene((far,), cameras=()))
    result = gnomon("render", level, *SMALL, "-o", tmp_path / "p.png")
    assert result.exit_code == 3
    assert "strikes no surface" in result.stderr


def test_a_level_without_triangles_is_refused(tmp_path: Path) -> None:
    from scenes.scene import Scene  # noqa: PLC0415

    level = small_level(tmp_path, scene=Scene("Void", (), (POINT,)))
    result = gnomon("render", level, "-o", tmp_path / "p.png")
    assert result.exit_code == 3
    assert "no triangles" in result.stderr


def test_a_picture_takes_no_texture_s_place(level: Path, tmp_path: Path) -> None:
    source = level.read_bytes()
    length = int.from_bytes(source[12:16], "little")
    document = json.loads(source[20 : 20 + length])
    document["buffers"][0]["uri"] = "small.bin"
    document["images"] = [{"uri": "wood.png"}]
    (tmp_path / "wood.png").write_bytes(b"png")
    (tmp_path / "small.bin").write_bytes(source[28 + length :])
    (tmp_path / "small.gltf").write_text(json.dumps(document))
    result = gnomon("render", tmp_path / "small.gltf", *SMALL, "-o", tmp_path / "wood.png")
    assert result.exit_code == 5
    assert "a file that the level needs" in result.stderr.replace("\n", " ")
    assert (tmp_path / "wood.png").read_bytes() == b"png"
