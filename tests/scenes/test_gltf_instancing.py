"""EXT_mesh_gpu_instancing: one mesh with many placements, as if as many nodes drew it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.gltf import amounts
from scenes.gltf.transforms import all_flat, is_flat
from tests.scenes.gltf_samples import (
    CORNERS,
    TETRAHEDRON,
    Json,
    document,
    notes_of,
    read,
    tetrahedron,
)

PLACES = np.array([[0, 0, 0], [5, 6, 7], [-1, 0.1, 1e3]], np.float32)
TURNS = np.array([[0, 0, 0, 1], [0.5, -0.5, 0.5, 0.5], [0.1, 0.2, -0.3, 0.9]], np.float32)
SIZES = np.array([[1, 1, 1], [2, -3, 0.5], [0.1, 0.2, 0.3]], np.float32)
POSE = {"translation": [1.5, 0.25, -3], "rotation": [0.1, 0.7, 0.1, 0.7], "scale": [1, 2.5, 0.3]}


def instanced(node: Json | None = None, **attributes: np.ndarray) -> Json:
    """The tetrahedron drawn by one node with those instance attributes."""
    source = tetrahedron() | document(CORNERS, TETRAHEDRON.ravel(), *attributes.values())
    named = {name: 2 + index for index, name in enumerate(attributes)}
    extension = {"EXT_mesh_gpu_instancing": {"attributes": named}}
    source["nodes"] = [{"mesh": 0, "name": "Grass", "extensions": extension, **(node or {})}]
    source["extensionsUsed"] = source["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    return source


def expanded(node: Json, **attributes: np.ndarray) -> Json:
    """The same by as many nodes below one."""
    keys = {"TRANSLATION": "translation", "ROTATION": "rotation", "SCALE": "scale"}
    rows = zip(*(array.astype(float).tolist() for array in attributes.values()), strict=True)
    children = [
        {"mesh": 0, **dict(zip([keys[name] for name in attributes], row, strict=True))} for row in rows
    ]
    parent = {"children": list(range(1, len(children) + 1)), **node}
    return tetrahedron(nodes=[parent, *children])


ALL = {"TRANSLATION": PLACES, "ROTATION": TURNS, "SCALE": SIZES}


@pytest.mark.parametrize(
    "names", [["TRANSLATION"], ["ROTATION"], ["SCALE"], list(ALL), ["SCALE", "TRANSLATION"]]
)
def test_instances_are_placements_of_one_mesh_and_spell_as_so_many_nodes(
    tmp_path: Path, names: list[str]
) -> None:
    attributes = {name: ALL[name] for name in names}
    level = read(tmp_path, instanced(POSE, **attributes))
    (mesh,) = level.scene.meshes
    assert (mesh.name, mesh.node, len(mesh.placements), len(mesh.triangles)) == ("Grass", 0, 3, 4)
    assert level.scene.triangle_count == 12
    other = read(tmp_path, expanded(POSE, **attributes))
    np.testing.assert_array_equal(
        mesh.placements, np.concatenate([one.placements for one in other.scene.meshes])
    )
    assert level.scene.digest == other.scene.digest


numbers = st.floats(-1e3, 1e3, width=32)


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.tuples(*[numbers] * 10), min_size=1, max_size=5),
    st.tuples(*[st.floats(-9, 9)] * 7),
)
def test_the_bits_of_random_instances_are_those_of_nodes(
    tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[float, ...]], pose: tuple[float, ...]
) -> None:
    folder = tmp_path_factory.mktemp("instances")
    values = np.array(rows, np.float32)
    values[:, 6] += np.where(np.abs(values[:, 3:7]).sum(axis=1) < 1e-3, 1.0, 0.0)
    values[:, 7:] += np.where(np.abs(values[:, 7:]) < 1e-2, 1.0, 0.0)
    attributes = {"TRANSLATION": values[:, :3], "ROTATION": values[:, 3:7], "SCALE": values[:, 7:]}
    attributes = {name: np.ascontiguousarray(array) for name, array in attributes.items()}
    node = {"translation": pose[:3], "rotation": [*pose[3:6], 20.0], "scale": [1 + abs(pose[6]), -1, 2]}
    one, many = read(folder, instanced(node, **attributes)), read(folder, expanded(node, **attributes))
    np.testing.assert_array_equal(
        one.scene.meshes[0].placements, np.concatenate([mesh.placements for mesh in many.scene.meshes])
    )
    assert one.scene.digest == many.scene.digest


def test_instances_are_flat_where_nodes_are() -> None:
    random = np.random.default_rng(1)
    matrices = np.tile(np.eye(4), (200, 1, 1))
    matrices[:, :3, :3] = random.normal(size=(200, 3, 3)) * 10.0 ** random.integers(-12, 12, (200, 1, 1))
    matrices[::3, :3, 2] = matrices[::3, :3, 0] * 3 - matrices[::3, :3, 1]
    matrices[::7, :3, 1] = 0
    flat = all_flat(matrices)
    assert flat.tolist() == [is_flat(matrix) for matrix in matrices]
    assert 80 < flat.sum() < 120


def test_primitives_of_an_instanced_mesh_share_their_placements(tmp_path: Path) -> None:
    source = instanced(TRANSLATION=PLACES)
    source["meshes"][0]["primitives"] *= 2
    first, second = read(tmp_path, source).scene.meshes
    assert first.placements is second.placements
    assert first.positions is second.positions


@pytest.mark.parametrize(("dtype", "largest"), [(np.int8, 127), (np.int16, 32767)])
def test_normalised_rotations(tmp_path: Path, dtype: type, largest: int) -> None:
    stored = np.array([[0, 0, 0, largest], [largest, 0, 0, 0]], dtype)
    source = instanced(ROTATION=stored)
    source["accessors"][2]["normalized"] = True
    (mesh,) = read(tmp_path, source).scene.meshes
    np.testing.assert_array_equal(mesh.placements, [np.eye(4), np.diag([1.0, -1, -1, 1])])


def test_instances_without_size_are_hidden_with_a_note(tmp_path: Path) -> None:
    sizes = SIZES.copy()
    sizes[1] = 0
    level = read(tmp_path, instanced(TRANSLATION=PLACES, SCALE=sizes))
    (mesh,) = level.scene.meshes
    np.testing.assert_array_equal(mesh.placements[:, :3, 3], PLACES[[0, 2]])
    assert 'node 0 "Grass": 1 of its instances are hidden' in notes_of(level)
    none = read(tmp_path, instanced(TRANSLATION=PLACES, SCALE=sizes * 0))
    assert none.scene.triangle_count == 0
    assert "no triangles" in notes_of(none)


def test_no_instances_draw_nothing_and_no_attributes_draw_once(tmp_path: Path) -> None:
    assert read(tmp_path, instanced(TRANSLATION=PLACES[:0])).scene.triangle_count == 0
    assert read(tmp_path, instanced()).scene.triangle_count == 4


def test_own_attributes_of_applications_are_ignored(tmp_path: Path) -> None:
    level = read(tmp_path, instanced(TRANSLATION=PLACES, _ID=np.arange(3, dtype=np.uint16)))
    assert level.scene.triangle_count == 12


def test_sparse_instances(tmp_path: Path) -> None:
    source = instanced(TRANSLATION=PLACES)
    places = document(np.array([2], np.uint8), PLACES[1:2])
    source["buffers"] += places["buffers"]
    source["bufferViews"] += [{**view, "buffer": 3 + i} for i, view in enumerate(places["bufferViews"])]
    source["accessors"][2]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": 3, "componentType": 5121},
        "values": {"bufferView": 4},
    }
    (mesh,) = read(tmp_path, source).scene.meshes
    np.testing.assert_array_equal(mesh.placements[:, :3, 3], PLACES[[0, 1, 1]])


def test_what_is_drawn_is_limited_before_any_of_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = instanced(TRANSLATION=PLACES)
    monkeypatch.setattr(amounts, "MOST_TRIANGLES", 12)
    assert read(tmp_path, source).scene.triangle_count == 12
    monkeypatch.setattr(amounts, "MOST_TRIANGLES", 11)
    with pytest.raises(LevelError, match="draws 12 triangles; at most 11 are read") as error:
        read(tmp_path, source)
    assert "instances draw it 3 times; the file stores 4." in error.value.known
    source["accessors"][2]["count"] = 2**50
    with pytest.raises(LevelError, match="draws 4,503,599,627,370,496 triangles"):
        read(tmp_path, source)


def changed(name: str, row: int, value: Any) -> dict[str, np.ndarray]:
    attributes = {key: array.copy() for key, array in ALL.items()}
    attributes[name][row] = value
    return attributes


NAN = np.nan


@pytest.mark.parametrize(
    ("attributes", "said"),
    [
        (
            changed("ROTATION", 1, (0, NAN, 0, 1)),
            "Instance 1 of this node is none: its ROTATION is not finite",
        ),
        (changed("ROTATION", 2, (np.inf, 0, 0, 1)), "ROTATION is not finite. It is (inf, 0, 0, 1); 1 of 3"),
        (changed("ROTATION", 0, 0), "Instance 0 of this node is none: its ROTATION has no direction"),
        (changed("TRANSLATION", 1, NAN), "TRANSLATION is not finite"),
        (changed("TRANSLATION", 1, -np.inf), "TRANSLATION is not finite"),
        (changed("TRANSLATION", 2, (3e38, 0, 0)), "farther than 1e+30 metres"),
        (changed("SCALE", 2, (NAN, 1, 1)), "SCALE is not finite"),
        (
            changed("SCALE", 2, (1, 0, 1)),
            "Instance 2 of this node is none: its transform squashes its mesh flat",
        ),
        (changed("SCALE", 2, (1e-20, 0, 0)), "squashes its mesh flat"),
        (changed("SCALE", 2, 3e38), "farther than 1e+30 metres"),
        ({"TRANSLATION": PLACES, "SCALE": SIZES[:2]}, "TRANSLATION has 3, SCALE has 2"),
        ({"TRANSLATION": PLACES, "_ID": np.arange(4, dtype=np.uint16)}, "TRANSLATION has 3, _ID has 4"),
        ({"TRANSLATION": PLACES[:, :2].copy()}, '"VEC3" for this use'),
        ({"ROTATION": TURNS[:, :3].copy()}, '"VEC4" for this use'),
        ({"TRANSLATION": PLACES.astype(np.int16)}, '"componentType" must be 5126 (float)'),
        ({"SCALE": SIZES.astype(np.uint8)}, '"componentType" must be 5126 (float)'),
        ({"ROTATION": TURNS.astype(np.int8)}, "or one of 5120, 5122, normalised"),
        ({"ROTATION": TURNS.astype(np.uint16)}, "or one of 5120, 5122, normalised"),
    ],
)
def test_bad_instances_are_refused(tmp_path: Path, attributes: dict[str, np.ndarray], said: str) -> None:
    with pytest.raises(LevelError) as error:
        read(tmp_path, instanced(**attributes))
    assert said in str(error.value)
    assert 'node 0 "Grass"' in error.value.where
    assert error.value.remedy


def extension(value: Any) -> Callable[[Json], None]:
    def change(source: Json) -> None:
        source["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = value

    return change


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (5, '"EXT_mesh_gpu_instancing" must be an object'),
        ({"attributes": []}, '"attributes" must be an object'),
        ({"attributes": {"TRANSLATION": 99}}, "accessor 99 does not exist"),
        ({"attributes": {"TRANSLATION": "0"}}, '"TRANSLATION" must be a whole number'),
        ({"attributes": {"TRANSLATION": None}}, '"TRANSLATION" is missing'),
    ],
)
def test_malformed_extensions_are_refused(tmp_path: Path, value: Any, said: str) -> None:
    source = instanced(TRANSLATION=PLACES)
    extension(value)(source)
    with pytest.raises(LevelError) as error:
        read(tmp_path, source)
    assert said in str(error.value)


def test_instances_beyond_the_file_are_refused(tmp_path: Path) -> None:
    source = instanced(TRANSLATION=PLACES)
    source["accessors"][2]["count"] = 4
    with pytest.raises(LevelError, match="ends at byte 48 of its buffer view"):
        read(tmp_path, source)
