"""Brushes of Quake maps against geometry that is known otherwise."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, HalfspaceIntersection

from scenes.quake.brushes import polygons
from scenes.quake.map_parser import parse_map
from scenes.topology import Topology
from tests import tolerances
from tests.scenes.quake_samples import (
    CUBE,
    VALVE,
    WORLD,
    box,
    brush,
    corners,
    entity,
    face,
    plane,
    read,
    volume,
)

OCTAHEDRON = [((x, y, z), 64.0) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]


def test_a_cube_of_32_units_is_a_metre(tmp_path: Path) -> None:
    scene = read(tmp_path, WORLD).scene
    assert scene.triangle_count == 12
    assert len(scene.meshes) == 1
    assert len(scene.meshes[0].positions) == 8
    assert volume(scene) == 1.0
    # North is -Z, up is Y.
    assert scene.bounds.tolist() == [[0, 0, -1], [1, 1, 0]]


def test_faces_wind_counter_clockwise_from_outside(tmp_path: Path) -> None:
    a, b, c = np.moveaxis(corners(read(tmp_path, WORLD).scene), 1, 0)
    outward = (a + b + c) / 3 - np.array([0.5, 0.5, -0.5])
    assert (np.einsum("td,td->t", np.cross(b - a, c - a), outward) > 0).all()


def test_corners_where_four_planes_meet_are_one(tmp_path: Path) -> None:
    scene = read(tmp_path, entity(brush(OCTAHEDRON), classname="worldspawn")).scene
    assert len(scene.meshes[0].positions) == 6
    assert scene.triangle_count == 8
    radius = 64 * math.sqrt(3) / 32
    assert volume(scene) == pytest.approx(4 / 3 * radius**3, rel=tolerances.BRUSH_VOLUME)


@pytest.mark.parametrize("sides", [3, 8, 64, 500])
def test_prisms_of_many_sides(tmp_path: Path, sides: int) -> None:
    turns = 2 * np.pi * np.arange(sides) / sides
    planes = [((math.cos(turn), math.sin(turn), 0.0), 128.0) for turn in turns]
    planes += [((0, 0, 1), 16.0), ((0, 0, -1), 16.0)]
    scene = read(tmp_path, entity(brush(planes), classname="worldspawn")).scene
    assert scene.triangle_count == 2 * (sides - 2) + 2 * sides
    assert volume(scene) == pytest.approx(sides * math.tan(np.pi / sides) * 16, rel=tolerances.BRUSH_VOLUME)
    assert not Topology.of(scene.meshes[0].triangles).balances.any()


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(4, 24), st.integers(0, 2**32 - 1), st.integers(-4096, 4096))
def test_random_convex_brushes_have_the_volume_that_qhull_gives(sides: int, seed: int, shift: int) -> None:
    random = np.random.default_rng(seed)
    normals = np.vstack([np.eye(3), -np.eye(3), random.normal(size=(sides, 3))])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    distances = np.concatenate([np.full(6, 200.0), random.uniform(32, 128, sides)])
    hull = ConvexHull(
        HalfspaceIntersection(np.column_stack([normals, -distances]), np.zeros(3)).intersections
    )
    offsets = distances + normals @ np.full(3, float(shift))
    text = parse_map(entity(brush(zip(normals.tolist(), offsets.tolist(), strict=True))).encode())
    shapes = polygons(text)
    assert shapes.volumes[0] == pytest.approx(hull.volume, rel=tolerances.BRUSH_VOLUME)


@pytest.mark.parametrize("shift", [0, 1000, 100_000])
def test_a_brush_is_the_same_wherever_it_stands(tmp_path: Path, shift: int) -> None:
    near = read(tmp_path, entity(box((0, 0, 0), (8, 24, 40)), classname="worldspawn")).scene
    far = entity(box((shift, -shift, 0), (shift + 8, 24 - shift, 40)), classname="worldspawn")
    moved = read(tmp_path, far).scene
    assert moved.triangle_count == near.triangle_count
    np.testing.assert_array_equal(
        np.sort(
            np.unique(moved.meshes[0].positions - np.float32([shift / 32, 0, shift / 32]), axis=0), axis=0
        ),
        np.sort(np.unique(near.meshes[0].positions, axis=0), axis=0),
    )


def test_every_notation_of_a_face_gives_the_same_level(tmp_path: Path) -> None:
    digest = read(tmp_path, WORLD).scene.digest
    notations = [
        entity(box((0, 0, 0), (32, 32, 32), placement=VALVE), classname="worldspawn"),
        entity(box((0, 0, 0), (32, 32, 32), '"a wall"', "0 0 0 1 1 1 64 0"), classname="worldspawn"),
        entity(box((0, 0, 0), (32, 32, 32), "base/wall", "-8.5 nan 0 1e-3 -1"), classname="worldspawn"),
        WORLD.replace("\n", "\r\n"),
        WORLD.replace("\n", " "),
        WORLD.replace("( ", "(").replace(" )", ")").replace(") (", ")("),
        "// Game: Quake\n// entity 0\n" + WORLD.replace("{\n(", '// brush 0 "{\n{ // here\n('),
        "\ufeff" + WORLD,
        WORLD + "\0",
        WORLD.replace("{\n( ", "{\nbrushDef\n{\n( ")
        .replace("}\n}", "}\n}\n}")
        .replace(" wall", " ( ( 1 0 0 ) ( 0 1 0 ) ) common/wall"),
    ]
    for text in notations:
        assert read(tmp_path, text).scene.digest == digest, text


def test_planes_said_twice_and_planes_that_only_touch_change_nothing(tmp_path: Path) -> None:
    digest = read(tmp_path, WORLD).scene.digest
    again = face(plane((1, 0, 0), 32)) + face(plane((1, 1, 0), 64 / math.sqrt(2)))
    level = read(tmp_path, entity(CUBE[:-2] + again + "}\n", classname="worldspawn"))
    assert level.scene.digest == digest
    assert [note.where for note in level.notes] == ["entities"]  # no lights


def test_touching_brushes_meet_in_the_same_bits(tmp_path: Path) -> None:
    # A block cut in two by an oblique plane, whose corners have no exact numbers.
    block = [((1, 0, 0), 200.0), ((-1, 0, 0), 50.0), ((0, 1, 0.1), 40.0), ((0, -1, 0), 40.0)]
    block += [((0, 0, 1), 40.0), ((0, 0, -1), 40.0)]
    left, right = [*block, ((1, 2, 3), 10.0)], [*block, ((-1, -2, -3), -10.0)]
    scene = read(tmp_path, entity(brush(left) + brush(right), classname="worldspawn")).scene
    assert not Topology.of(scene.meshes[0].triangles).balances.any()
    unit = np.array([1, 3, -2]) / math.sqrt(14)
    on_plane = np.abs(scene.meshes[0].positions.astype(float) @ unit - 10 / 32) < tolerances.BRUSH_VOLUME
    cut = scene.meshes[0].positions[on_plane]
    assert len(cut) == 2 * len(np.unique(cut, axis=0)) > 0


@pytest.mark.parametrize(
    ("faulty", "words"),
    [
        (brush([((1, 0, 0), 8), ((-1, 0, 0), 8), ((0, 1, 0), 8), ((0, -1, 0), 8), ((0, 0, 1), 8)]), "open"),
        (brush([((1, 0, 0), 8), ((-1, 0, 0), -9), ((0, 1, 0), 8), ((0, -1, 0), 8)]), "without volume"),
        (box((0, 0, 0), (0, 8, 8)), "without volume"),
        (box((8, 8, 8), (0, 0, 0)), "without volume"),
        (box((0, 0, 0), (8, 8, 8))[:-2] + face([(0, 0, 0), (1, 1, 1), (2, 2, 2)]) + "}\n", "in a line"),
        (box((0, 0, 0), (8, 8, 8))[:-2] + face([(0, 0, 0), (0, 0, 0), (2, 2, 2)]) + "}\n", "in a line"),
        ("{\n patchDef2 { base/wall ( 3 3 0 0 0 ) ( ( ( 0 0 0 0 0 ) ) ) }\n}\n", "1 x patchDef2 left out"),
        (
            '{\n brushDef3 {\n ( 0 0 1 -8 ) ( ( 1 0 0 ) ( 0 1 0 ) ) "a" 0 0 0\n }\n}\n',
            "1 x brushDef3 left out",
        ),
    ],
)
def test_faulty_brushes_are_noted_and_the_others_are_read(tmp_path: Path, faulty: str, words: str) -> None:
    level = read(tmp_path, entity(CUBE + faulty, classname="worldspawn"))
    assert [note.severity for note in level.notes] == ["warning", "warning"]  # and no lights
    assert words in level.notes[0].text
    assert "left out" in words or "at line 11" in level.notes[0].text
    extra = 12 if "in a line" in words else 0
    assert level.scene.triangle_count == 12 + extra


@pytest.mark.parametrize(
    ("texture", "suffix", "casts"),
    [
        ("sky4", " sky", False),
        ("SKY1", " sky", False),
        ("*water0", " liquid", False),
        ("*TELEPORT", " liquid", False),
        ("!lava", " liquid", False),
        ("{fence", "", True),
        ("wall", "", True),
    ],
)
def test_the_texture_says_what_a_brush_is(tmp_path: Path, texture: str, suffix: str, casts: bool) -> None:  # noqa: FBT001
    level = read(tmp_path, entity(box((0, 0, 0), (32, 32, 32), texture), classname="worldspawn"))
    [mesh] = level.scene.meshes
    assert (mesh.name, mesh.casts, mesh.node) == (f"worldspawn{suffix}", casts, 0)
    assert any("cut-out" in note.text.lower() for note in level.notes) == texture.startswith("{")


@pytest.mark.parametrize("texture", ["clip", "CLIP", "common/clip", "trigger", "skip", "hint", "origin"])
def test_tool_brushes_are_left_out_and_counted(tmp_path: Path, texture: str) -> None:
    level = read(tmp_path, entity(CUBE + box((0, 0, 0), (8, 8, 8), texture), classname="worldspawn"))
    assert level.scene.triangle_count == 12
    name = texture.rpartition("/")[2].lower()
    assert f"1 brush that nobody sees left out: {name}." in [note.text for note in level.notes]


def test_a_wall_with_a_hidden_face_stays_closed(tmp_path: Path) -> None:
    mixed = CUBE.replace(" wall", " skip", 1)
    assert volume(read(tmp_path, entity(mixed, classname="worldspawn")).scene) == 1.0


def test_one_face_of_sky_makes_the_brush_sky(tmp_path: Path) -> None:
    [mesh] = read(tmp_path, entity(CUBE.replace(" wall", " sky1", 1), classname="worldspawn")).scene.meshes
    assert not mesh.casts


def test_each_entity_is_a_mesh_and_triggers_are_none(tmp_path: Path) -> None:
    text = WORLD + entity(CUBE, classname="trigger_once") + entity(CUBE + CUBE, classname="func_door")
    level = read(tmp_path, text)
    assert [(mesh.name, mesh.node, mesh.triangle_count) for mesh in level.scene.meshes] == [
        ("worldspawn", 0, 12),
        ("func_door 2", 2, 24),
    ]
    assert "1 brush of invisible entities left out: trigger_once." in [note.text for note in level.notes]
