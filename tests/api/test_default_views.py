"""Which views a light is judged over where nobody names a camera."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tests.api.command import QUICK, answered
from tests.small_level import CAMERA, POINT, small_level, small_scene

SKYWARD = replace(CAMERA, name="Sky", forward=(0.0, 1.0, 0.0), up=(0.0, 0.0, 1.0))


def level_seen_by(folder: Path, *cameras: object) -> Path:
    return small_level(folder, scene=replace(small_scene(lights=(POINT,)), cameras=cameras))


def test_annotate_leaves_cameras_out_that_do_not_show_the_light(tmp_path: Path) -> None:
    level = level_seen_by(tmp_path, SKYWARD, CAMERA)
    (light,) = answered("annotate", level, *QUICK)["lights"]
    assert light["views"] == ["Eye"]
    (light,) = answered("annotate", level, *QUICK, "--camera", "Sky", "--camera", "Eye")["lights"]
    assert light["views"] == ["Sky", "Eye"]


def test_annotate_makes_viewpoints_where_no_camera_shows_the_light(tmp_path: Path) -> None:
    (light,) = answered("annotate", level_seen_by(tmp_path, SKYWARD), *QUICK)["lights"]
    assert len(light["views"]) == 4
    assert "Sky" not in light["views"]


def test_compare_judges_over_the_same_views(tmp_path: Path) -> None:
    level = level_seen_by(tmp_path, SKYWARD, CAMERA)
    (light,) = answered("compare", level, "-t", "SV", "--rounds", "1", "--resolution", "96x64")["lights"]
    assert light["views"] == ["Eye"]


def test_render_takes_the_first_camera_that_shows_the_light(tmp_path: Path) -> None:
    render = ("render", level_seen_by(tmp_path, SKYWARD, CAMERA), "-t", "SV", "--resolution", "96x64")
    output = ("-o", tmp_path / "p.png")
    assert answered(*render, *output)["camera"] == "Eye"
    assert answered(*render, *output, "--camera", "Sky")["camera"] == "Sky"
