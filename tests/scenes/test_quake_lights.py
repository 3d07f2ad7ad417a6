"""Lights and cameras of Quake maps, key by key."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenes.scene import Camera, Light, LightKind, Mobility
from tests.scenes.quake_samples import WORLD, entity, read

GOAL = entity(classname="info_null", targetname="goal", origin="0 0 -64")


def lights(tmp_path: Path, text: str) -> tuple[Light, ...]:
    return read(tmp_path, WORLD + text).scene.lights


def one(tmp_path: Path, **keys: str) -> Light:
    [light] = lights(tmp_path, entity(**{"classname": "light", "origin": "32 64 96", **keys}) + GOAL)
    return light


def test_a_plain_light(tmp_path: Path) -> None:
    light = one(tmp_path)
    assert (light.name, light.kind, light.node) == ("light 1", LightKind.POINT, 1)
    assert light.position == (1.0, 3.0, -2.0)
    assert light.range_m == 300 / 32
    assert light.intensity == pytest.approx((300 / 32) ** 2 / 10)
    assert light.color == (1.0, 1.0, 1.0)
    assert light.mobility is Mobility.DYNAMIC


@pytest.mark.parametrize(
    ("keys", "units"),
    [
        ({"light": "200"}, 200),
        ({"_light": "200"}, 200),
        ({"LIGHT": "200"}, 200),
        ({"light": "200", "wait": "2"}, 100),
        ({"light": "200", "_falloff": "640"}, 640),
        ({"light": "200", "delay": "1"}, 200 * 128),
        ({"light": "400", "delay": "2"}, 20 * 128),
        ({"light": "400", "delay": "5", "wait": "0.5"}, 19 * 128 * 2),
        ({"light": "200", "delay": "3"}, math.inf),
        ({"_light": "255 128 0 160"}, 160),
        ({"_light": "255 128 0"}, 300),
        ({"classname": "light_torch_small_walltorch", "style": "1"}, 300),
        ({"angle": "45"}, 300),
    ],
)
def test_how_far_a_light_reaches(tmp_path: Path, keys: dict[str, str], units: float) -> None:
    light = one(tmp_path, **keys)
    assert light.range_m == units / 32
    assert light.kind is LightKind.POINT
    assert math.isfinite(light.intensity)


def test_worldspawn_shortens_all_lights(tmp_path: Path) -> None:
    world = WORLD.replace('"classname"', '"_dist" "2"\n"classname"')
    [light] = read(tmp_path, world + entity(classname="light", origin="0 0 0")).scene.lights
    assert light.range_m == 150 / 32


@pytest.mark.parametrize(
    ("keys", "color"),
    [
        ({"_color": "255 127.5 0"}, (1.0, 0.5, 0.0)),
        ({"_color": "1 0.5 0"}, (1.0, 0.5, 0.0)),
        ({"color": "0 0 255"}, (0.0, 0.0, 1.0)),
        ({"_light": "51 102 255 200"}, (0.2, 0.4, 1.0)),
    ],
)
def test_colors_from_0_to_1_or_to_255(tmp_path: Path, keys: dict[str, str], color: tuple[float, ...]) -> None:
    assert one(tmp_path, **keys).color == color


@pytest.mark.parametrize(
    ("keys", "direction"),
    [
        ({"mangle": "0 -90 0"}, (0, -1, 0)),
        ({"mangle": "90 0 0"}, (0, 0, -1)),
        ({"mangle": "180 0 0"}, (-1, 0, 0)),
        ({"mangle": "0 30 0"}, (math.sqrt(0.75), 0.5, 0)),
        ({"mangle": "-45 0 0"}, (math.sqrt(0.5), 0, math.sqrt(0.5))),
        ({"target": "goal", "origin": "0 0 64"}, (0, -1, 0)),
        ({"target": "goal", "origin": "0 64 -64"}, (0, 0, 1)),
    ],
)
def test_spots_shine_along_their_angles_or_at_their_target(
    tmp_path: Path, keys: dict[str, str], direction: tuple[float, ...]
) -> None:
    light = one(tmp_path, **keys)
    assert light.kind is LightKind.SPOT
    assert light.direction == pytest.approx(direction, abs=1e-12)
    assert math.degrees(light.outer_cone_rad) == pytest.approx(20)
    assert light.inner_cone_rad == light.outer_cone_rad


def test_the_cone_of_a_spot(tmp_path: Path) -> None:
    light = one(tmp_path, mangle="0 0 0", angle="60", _softangle="30")
    assert math.degrees(light.outer_cone_rad) == pytest.approx(30)
    assert math.degrees(light.inner_cone_rad) == pytest.approx(15)
    widest = one(tmp_path, mangle="0 0 0", angle="180")
    assert widest.outer_cone_rad == math.pi / 2


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"target": "nowhere"}, 'Nothing has its target "nowhere"'),
        ({"target": "goal", "origin": "0 0 -64"}, "where it stands itself"),
        ({"mangle": "0 0 0", "angle": "270"}, "No cone has 270 degrees"),
        ({"_gnomon_mobility": "sometimes"}, 'it is "sometimes": ignored'),
    ],
)
def test_what_is_odd_about_a_light_is_noted(tmp_path: Path, keys: dict[str, str], words: str) -> None:
    text = entity(**{"classname": "light", "origin": "0 0 0", **keys}) + GOAL
    level = read(tmp_path, WORLD + text)
    assert len(level.scene.lights) == 1
    [note] = level.notes
    assert words in note.text
    assert note.where == 'line 12, entity 1 "light"'


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"light": "0"}, "no light"),
        ({"light": "-200"}, "no light"),
        ({"light": "0.01"}, "less than a millimetre"),
        ({"_nostaticlight": "1"}, "_nostaticlight"),
        ({"_surface": "lamp"}, "template"),
        ({"_sunlight2": "1"}, "dome"),
    ],
)
def test_lights_that_are_none_are_left_out_with_a_note(
    tmp_path: Path, keys: dict[str, str], words: str
) -> None:
    level = read(tmp_path, WORLD + entity(**{"classname": "light", "origin": "0 0 0", **keys}))
    assert not level.scene.lights
    assert any(words in note.text for note in level.notes)


def test_a_light_without_an_origin_stands_at_zero(tmp_path: Path) -> None:
    level = read(tmp_path, WORLD + entity(classname="light"))
    assert level.scene.lights[0].position == (0.0, 0.0, 0.0)
    assert "no origin" in level.notes[0].text


@pytest.mark.parametrize(
    "keys",
    [
        {"_sunlight": "200", "_sunlight_mangle": "90 -45 0", "_sunlight_color": "255 255 0"},
        {"_sun_light": "200", "_sun_mangle": "90 -45 0", "_sun_color": "1 1 0"},
    ],
)
def test_the_sun_of_worldspawn(tmp_path: Path, keys: dict[str, str]) -> None:
    [sun] = read(tmp_path, WORLD[:-2] + entity(**keys)[2:]).scene.lights
    assert (sun.kind, sun.node, sun.name) == (LightKind.DIRECTIONAL, 0, "sun")
    assert sun.direction == pytest.approx((0, -math.sqrt(0.5), -math.sqrt(0.5)), abs=1e-12)
    assert sun.color == (1.0, 1.0, 0.0)
    assert sun.range_m == math.inf


def test_the_sun_shines_straight_down_by_itself(tmp_path: Path) -> None:
    [sun] = read(tmp_path, WORLD[:-2] + entity(_sunlight="200", _sun2="100")[2:]).scene.lights
    assert sun.direction == (0.0, -1.0, 0.0)


@pytest.mark.parametrize(
    ("keys", "direction"),
    [
        ({"_sun": "1", "target": "goal", "origin": "0 0 64"}, (0, -1, 0)),
        ({"_sun": "1", "mangle": "0 -90 0"}, (0, -1, 0)),
        ({"_sun": "1"}, (0, -1, 0)),
        ({"classname": "light_environment", "pitch": "-90", "angle": "10"}, (0, -1, 0)),
        ({"classname": "light_environment", "angles": "-30 180 0"}, (-math.sqrt(0.75), -0.5, 0)),
    ],
)
def test_entities_that_are_suns(tmp_path: Path, keys: dict[str, str], direction: tuple[float, ...]) -> None:
    sun = one(tmp_path, **keys)
    assert sun.kind is LightKind.DIRECTIONAL
    assert sun.direction == pytest.approx(direction, abs=1e-12)


def test_mobility_is_what_the_author_says(tmp_path: Path) -> None:
    assert one(tmp_path, _gnomon_mobility="static").mobility is Mobility.STATIC


def cameras(tmp_path: Path, *starts: str) -> tuple[Camera, ...]:
    return read(tmp_path, WORLD + "".join(starts)).scene.cameras


def start(kind: str, origin: str, **keys: str) -> str:
    return entity(classname=kind, origin=origin, **keys)


def test_a_player_looks_from_his_eyes(tmp_path: Path) -> None:
    [camera] = cameras(tmp_path, start("info_player_start", "32 0 24", angle="90"))
    assert camera.position == (1.0, (24 + 22) / 32, 0.0)
    assert camera.forward == (0.0, 0.0, -1.0)
    assert (camera.node, camera.name) == (1, "info_player_start 1")
    # 90 degrees across a screen of 4 to 3.
    assert 4 / 3 * math.tan(camera.yfov_rad / 2) == pytest.approx(1)


def test_an_intermission_looks_from_where_it_is_along_its_mangle(tmp_path: Path) -> None:
    [camera] = cameras(tmp_path, start("info_intermission", "0 0 64", mangle="30 180 0"))
    assert camera.position == (0.0, 2.0, 0.0)
    assert camera.forward == pytest.approx((-math.sqrt(0.75), -0.5, 0), abs=1e-12)


def test_a_camera_may_look_straight_down(tmp_path: Path) -> None:
    [camera] = cameras(tmp_path, start("info_intermission", "0 0 64", mangle="90 0 0"))
    assert camera.forward == (0.0, -1.0, 0.0)
    assert camera.up == (0.0, 0.0, -1.0)


def test_four_starts_far_from_each_other_are_kept(tmp_path: Path) -> None:
    ends = ["0 0 0", "1000 0 0", "0 1000 0", "1000 1000 0"]
    starts = [start("info_player_deathmatch", f"{step} {step} 0") for step in (10, 20, 30)]
    starts += [start("info_player_deathmatch", end) for end in ends[1:]]
    starts.append(start("info_player_start", ends[0]))
    level = read(tmp_path, WORLD + "".join(starts))
    assert [camera.node for camera in level.scene.cameras] == [4, 5, 6, 7]
    assert any("4 of 7 are cameras" in note.text for note in level.notes)


def test_starts_in_one_place_are_one_camera(tmp_path: Path) -> None:
    assert len(cameras(tmp_path, *[start("info_player_coop", "0 0 0")] * 9)) == 1
