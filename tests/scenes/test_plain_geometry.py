"""OBJ, PLY and STL geometry, and the lights files that go with it."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from api.inspection import Inspection
from scenes.errors import LevelError
from scenes.formats.plain_geometry import companions
from scenes.formats.registry import read_level
from scenes.level import Level
from scenes.scene import LightKind, Mobility
from tests import tolerances

LAMP = {"kind": "point", "position_m": [0, 3, 0]}
TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def box_level(tmp_path: Path, suffix: str, lights: Any = None) -> Level:
    box = trimesh.creation.box(bounds=[[0, 0, 0], [1, 2, 3]])
    content = box.export(file_type=suffix)
    path = tmp_path / f"level.{suffix}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    if lights is not None:
        (tmp_path / "level.lights.json").write_text(json.dumps(lights))
    return read_level(path)


def obj(tmp_path: Path, content: bytes, name: str = "level.obj") -> Level:
    (tmp_path / name).write_bytes(content)
    return read_level(tmp_path / name)


@pytest.mark.parametrize("suffix", ["obj", "ply", "stl"])
def test_a_box_is_a_box_in_every_format(tmp_path: Path, suffix: str) -> None:
    level = box_level(tmp_path, suffix)
    assert level.scene.triangle_count == 12
    assert level.scene.bounds.tolist() == [[0, 0, 0], [1, 2, 3]]
    assert "No lights of its own: write them into level.lights.json" in level.notes[-1].text


def test_unit_and_axis_are_those_of_the_lights_file(tmp_path: Path) -> None:
    level = box_level(tmp_path, "ply", {"unit_m": 0.01, "up": "Z", "lights": [LAMP]})
    np.testing.assert_allclose(
        level.scene.bounds, [[0, 0, -0.02], [0.01, 0.03, 0]], atol=tolerances.BRUSH_VOLUME * 0.01
    )
    # Lights are in metres with Y up already.
    assert level.scene.lights[0].position == (0.0, 3.0, 0.0)
    corners = level.scene.meshes[0].world_positions()[0][level.scene.meshes[0].triangles]
    volume = np.einsum("td,td->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(6e-6, rel=tolerances.BRUSH_VOLUME)


def test_objects_of_an_obj_are_meshes(tmp_path: Path) -> None:
    text = (
        b"mtllib x.mtl\no one\n"
        + TRIANGLE
        + b"o two\nusemtl red\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 5 6 7\n"
    )
    level = obj(tmp_path, text)
    assert [mesh.triangle_count for mesh in level.scene.meshes] == [1, 2]
    assert level.scene.meshes[0].name == "one"
    assert "Materials are not read: every surface is opaque." in [note.text for note in level.notes]
    assert all(mesh.casts for mesh in level.scene.meshes)


def test_polygons_line_ends_and_colors_of_an_obj(tmp_path: Path) -> None:
    corners = ("0 0", "1 0", "2 1", "1 2", "0 1")
    text = "".join(f"v {corner} 0 1 0 0\r\n" for corner in corners).encode() + b"f 1 2 3 4 5\r\n"
    assert obj(tmp_path, text).scene.triangle_count == 3
    for odd in (TRIANGLE.replace(b"f ", b"\tf  "), TRIANGLE.replace(b"v ", b"v\t"), b"  " + TRIANGLE):
        assert obj(tmp_path, odd).scene.digest == obj(tmp_path, TRIANGLE).scene.digest
    relative = TRIANGLE.replace(b"f 1 2 3", b"f -3 -2 -1")
    assert obj(tmp_path, relative).scene.digest == obj(tmp_path, TRIANGLE).scene.digest


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("level.obj", b"hello\n", "no OBJ file"),
        ("level.obj", b"v 0 0 0\n", "no triangles"),
        ("level.obj", b"{\n" + TRIANGLE, "no OBJ file"),
        ("level.obj", b"v 0 0 0\nf 1 2 3\n", "cannot be read"),
        ("level.obj", TRIANGLE.replace(b"f 1", b"f 0"), "corner 0"),
        ("level.obj", TRIANGLE.replace(b"f 1", b"f 99999999999999999999"), "cannot be read"),
        ("level.obj", TRIANGLE.replace(b"f 1 2 3", b"f -3 -2 -1\nv 5 5 5"), "backwards"),
        ("level.obj", TRIANGLE.replace(b"v 1", b"v nan"), "no number"),
        ("level.obj", TRIANGLE.replace(b"v 1", b"v 1e39"), "no number"),
        ("level.obj", b"v 0 0\nv 1 0\nv 1 1\nf 1 2 3\n", "three numbers"),
        ("level.ply", b"hello\n", "no PLY file"),
        ("level.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "no PLY file"),
        ("level.ply", b"ply\nformat ascii 1.0\nelement vertex 9999999999\nend_header\n", "no PLY file"),
        ("level.ply", b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", "no triangles"),
        ("level.stl", b"hello\n", "no STL file"),
        ("level.stl", bytes(80) + b"\xff\xff\xff\x7f", "no STL file"),
        ("level.stl", bytes(84), "no triangles"),
        ("level.stl", b"solid\nendsolid\n", "no triangles"),
    ],
)
def test_broken_geometry_is_refused(tmp_path: Path, name: str, content: bytes, words: str) -> None:
    with pytest.raises(LevelError) as caught:
        obj(tmp_path, content, name)
    assert words in str(caught.value)
    assert str(tmp_path / name) in caught.value.where
    assert caught.value.remedy


def test_lights_and_cameras_of_a_lights_file(tmp_path: Path) -> None:
    spot = {"name": "Lamp", "kind": "spot", "position_m": [0, 4, 0], "target_m": [0, 0, 0], "range_m": 9}
    spot |= {"outer_cone_deg": 30, "inner_cone_rad": 0.1, "intensity": 5, "color": [1, 0.5, 0]}
    sun = {"kind": "directional", "direction": [0, -2, 0], "mobility": "static"}
    gate = {"name": "Gate", "position_m": [0, 2, 9], "target_m": [0, 2, 0], "yfov_deg": 60}
    down = {"position_m": [0, 9, 0], "forward": [0, -1, 0]}
    level = box_level(tmp_path, "stl", {"lights": [spot, sun, LAMP], "cameras": [gate, down]})
    first, second, third = level.scene.lights
    assert (first.name, first.kind, first.node) == ("Lamp", LightKind.SPOT, 0)
    assert first.direction == (0.0, -1.0, 0.0)
    assert first.outer_cone_rad == pytest.approx(math.pi / 6)
    assert (first.inner_cone_rad, first.range_m, first.intensity) == (0.1, 9.0, 5.0)
    assert (second.name, second.direction, second.mobility) == ("light 1", (0.0, -1.0, 0.0), Mobility.STATIC)
    assert (third.range_m, third.kind) == (math.inf, LightKind.POINT)
    assert level.scene.cameras[0].forward == (0.0, 0.0, -1.0)
    assert level.scene.cameras[1].up == (0.0, 0.0, -1.0)
    assert not level.notes


def test_the_lights_file_is_a_level_itself(tmp_path: Path) -> None:
    beside = box_level(tmp_path, "obj", {"lights": [LAMP]})
    by_name = read_level(tmp_path / "level.lights.json")
    assert by_name.scene.digest == beside.scene.digest
    (tmp_path / "other.json").write_text(json.dumps({"geometry": "level.obj", "lights": [LAMP]}))
    assert read_level(tmp_path / "other.json").scene.digest == beside.scene.digest


def test_the_lights_file_of_the_documentation_is_one(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/level-formats.md").read_text()
    section = page.partition("## Plain geometry")[2]
    (example,) = re.findall(r"```json\n(.*?)```", section, re.DOTALL)[:1]
    (tmp_path / "yard.lights.json").write_text(example)
    level = obj(tmp_path, TRIANGLE, "yard.obj")
    assert [light.kind for light in level.scene.lights] == [LightKind.SPOT, LightKind.DIRECTIONAL]
    assert len(level.scene.cameras) == 1
    assert not level.notes


def test_a_light_that_inspect_prints_can_be_pasted(tmp_path: Path) -> None:
    spot = {"kind": "spot", "position_m": [0, 4, 0], "target_m": [1, 0, 0], "outer_cone_deg": 30}
    level = box_level(tmp_path, "ply", {"lights": [spot, LAMP]})
    printed = Inspection.of(level).record()["lights"]
    again = box_level(tmp_path, "ply", {"lights": json.loads(json.dumps(printed))})
    assert again.scene.lights == level.scene.lights
    assert not again.notes


def test_unknown_keys_are_noted_and_printed_ones_are_not(tmp_path: Path) -> None:
    lights = [{**LAMP, "index": 0, "node": 7, "radius": 2}]
    level = box_level(tmp_path, "obj", {"lights": lights, "exporter": "x"})
    assert [note.text for note in level.notes] == [
        "Not known, and ignored: exporter.",
        "Not known, and ignored: radius.",
    ]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("[]", "JSON object"),
        ("{", "not valid"),
        ("5", "JSON object"),
        ({"lights": 5}, '"lights" must be a list'),
        ({"lights": [5]}, "not a JSON object"),
        ({"lights": [{}]}, '"kind" is missing'),
        ({"lights": [{"kind": "area"}]}, '"kind" must be'),
        ({"lights": [{"kind": "point"}]}, '"position_m" is missing'),
        ({"lights": [{"kind": "point", "position_m": [0, 0]}]}, '"position_m" must be'),
        ({"lights": [{"kind": "point", "position_m": [0, 0, "1"]}]}, '"position_m" must be'),
        ({"lights": [{"kind": "point", "position_m": [0, 0, 1e300]}]}, "farther than"),
        ({"lights": [{"kind": "directional"}]}, '"direction" is missing'),
        ({"lights": [{"kind": "directional", "direction": [0, 0, 0]}]}, "with a length"),
        ({"lights": [{**LAMP, "kind": "spot", "target_m": [0, 3, 0]}]}, '"target_m" must be'),
        ({"lights": [{**LAMP, "range_m": 0}]}, '"range_m" must be'),
        ({"lights": [{**LAMP, "range_m": -1}]}, '"range_m" must be'),
        ({"lights": [{**LAMP, "color": [1, 1]}]}, '"color" must be'),
        ({"lights": [{**LAMP, "intensity": "much"}]}, '"intensity" must be'),
        ({"lights": [{**LAMP, "mobility": "often"}]}, '"mobility" must be'),
        ({"lights": [{**LAMP, "kind": "spot", "direction": [1, 0, 0], "outer_cone_deg": 91}]}, "half angle"),
        ({"lights": [{**LAMP, "kind": "spot", "direction": [1, 0, 0], "outer_cone_deg": 0}]}, "half angle"),
        ({"lights": [{**LAMP, "kind": "spot", "direction": [1, 0, 0], "inner_cone_deg": 50}]}, "half angle"),
        ({"cameras": [{"position_m": [0, 0, 0]}]}, '"forward" is missing'),
        ({"cameras": [{"position_m": [0, 0, 0], "forward": [1, 0, 0], "yfov_deg": 180}]}, '"yfov_deg" must'),
        ({"cameras": [{"position_m": [0, 0, 0], "forward": [1, 0, 0], "near_m": 0}]}, '"near_m" must'),
        ({"unit_m": 0}, '"unit_m" must be'),
        ({"unit_m": "cm"}, '"unit_m" must be'),
        ({"up": "X"}, '"up" must be'),
        ({"geometry": "other.obj"}, "are for other.obj, not for level.obj"),
    ],
)
def test_broken_lights_files_are_refused_with_their_place(tmp_path: Path, content: Any, words: str) -> None:
    path = tmp_path / "level.lights.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    with pytest.raises(LevelError) as caught:
        obj(tmp_path, TRIANGLE)
    assert words in str(caught.value)
    assert caught.value.where.startswith(str(path))


@pytest.mark.parametrize(
    ("geometry", "words"),
    [
        (None, "does not say which geometry"),
        (5, "must be the name"),
        ("level.blend", "must be the name"),
        ("../level.obj", "does not lie in the folder"),
        ("/level.obj", "does not lie in the folder"),
        ("file:level.obj", "does not lie in the folder"),
        ("missing.obj", "no such file"),
        ("a" * 400 + ".obj", "cannot be read"),
        ("\0.obj", "cannot be read"),
    ],
)
def test_the_geometry_of_a_lights_file_must_be_there(tmp_path: Path, geometry: Any, words: str) -> None:
    (tmp_path / "alone.json").write_text(json.dumps({"geometry": geometry, "lights": [LAMP]}))
    with pytest.raises(LevelError) as caught:
        read_level(tmp_path / "alone.json")
    assert words in str(caught.value)
    assert str(tmp_path) in caught.value.where


def test_what_goes_with_a_level_is_named(tmp_path: Path) -> None:
    level = tmp_path / "level.obj"
    level.write_bytes(b"mtllib level.mtl\nmtllib gone.mtl\nmtllib ../up.mtl\n" + TRIANGLE)
    lights = tmp_path / "level.lights.json"
    lights.write_text(json.dumps({"lights": [LAMP]}))
    (tmp_path / "level.mtl").touch()
    assert companions(level.read_bytes(), level) == (Path("level.lights.json"), Path("level.mtl"))
    assert companions(lights.read_bytes(), lights) == (Path("level.obj"), Path("level.mtl"))


def test_an_obj_of_windows_and_of_an_old_mac_is_the_same(tmp_path: Path) -> None:
    digest = obj(tmp_path, TRIANGLE).scene.digest
    assert obj(tmp_path, b"\xef\xbb\xbf" + TRIANGLE).scene.digest == digest
    assert obj(tmp_path, TRIANGLE.replace(b"\n", b"\r")).scene.digest == digest


def test_lights_whose_link_leads_nowhere_are_told(tmp_path: Path) -> None:
    (tmp_path / "level.lights.json").symlink_to("gone.json")
    with pytest.raises(LevelError, match="no such file") as caught:
        obj(tmp_path, TRIANGLE)
    assert "level.lights.json" in caught.value.where


def test_an_angle_is_named_as_the_file_writes_it(tmp_path: Path) -> None:
    light = {"kind": "spot", "position_m": [0, 2, 0], "direction": [0, -1, 0], "outer_cone_deg": 1e-300}
    (tmp_path / "level.lights.json").write_text(json.dumps({"lights": [light]}))
    with pytest.raises(LevelError, match='"outer_cone_deg" must be'):
        obj(tmp_path, TRIANGLE)
