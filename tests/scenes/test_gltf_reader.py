from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.level import Level, Severity
from scenes.scene import Mesh
from tests import tolerances
from tests.scenes.gltf_samples import (
    CORNERS,
    TETRAHEDRON,
    carrying,
    chunk,
    document,
    glb,
    glb_of,
    lit,
    notes_of,
    read,
    tetrahedron,
)

HALF = math.sqrt(0.5)


def only_mesh(level: Level) -> Mesh:
    (mesh,) = level.scene.meshes
    return mesh


def test_reads_positions_triangles_and_node_of_a_data_uri_level(tmp_path: Path) -> None:
    level = read(
        tmp_path, tetrahedron(nodes=[{"mesh": 0, "name": "Rock"}], scenes=[{"nodes": [0], "name": "S"}])
    )
    mesh = only_mesh(level)
    assert (level.scene.name, level.format, mesh.name, mesh.node) == ("S", "glTF 2.0", "Rock", 0)
    np.testing.assert_array_equal(mesh.positions, CORNERS)
    np.testing.assert_array_equal(mesh.triangles, TETRAHEDRON)
    np.testing.assert_array_equal(mesh.placements, np.eye(4)[None])
    assert mesh.casts
    assert mesh.base_color == (1.0, 1.0, 1.0)


@pytest.mark.parametrize("dtype", ["<u1", "<u2", "<u4"])
def test_reads_every_index_type(tmp_path: Path, dtype: str) -> None:
    source = tetrahedron()
    source |= document(CORNERS, TETRAHEDRON.ravel().astype(dtype))
    np.testing.assert_array_equal(only_mesh(read(tmp_path, source)).triangles, TETRAHEDRON)


@pytest.mark.parametrize("dtype", ["<i1", "<u1", "<i2", "<u2", "<u4", "<f4"])
def test_reads_every_position_type(tmp_path: Path, dtype: str) -> None:
    source = tetrahedron() | document(CORNERS.astype(dtype), TETRAHEDRON.ravel())
    np.testing.assert_array_equal(only_mesh(read(tmp_path, source)).positions, CORNERS)


@pytest.mark.parametrize(("dtype", "largest"), [("<i1", 127), ("<u1", 255), ("<i2", 32767), ("<u2", 65535)])
def test_normalised_positions_are_fractions_of_the_largest_value(
    tmp_path: Path, dtype: str, largest: int
) -> None:
    lowest = np.iinfo(dtype).min
    stored = np.array([[largest, 0, 1], [lowest, lowest + (lowest < 0), 2], [3, 4, 5]], dtype)
    source = tetrahedron() | document(stored, np.array([0, 1, 2], np.uint8))
    source["accessors"][0]["normalized"] = True
    expected = [[1, 0, 1 / largest], [-(lowest < 0), -(lowest < 0), 2 / largest]]
    expected.append([3 / largest, 4 / largest, 5 / largest])
    np.testing.assert_array_equal(only_mesh(read(tmp_path, source)).positions, np.array(expected, np.float32))


@pytest.mark.parametrize(("stride", "start"), [(12, 0), (16, 4), (40, 20), (16, 3)])
def test_strided_and_unaligned_accessors(tmp_path: Path, stride: int, start: int) -> None:
    rows = np.full((4, stride), 0xEE, np.uint8)
    rows[:, :12] = CORNERS.view(np.uint8).reshape(4, 12)
    stored = np.concatenate([np.full(start, 0xDD, np.uint8), rows.ravel()[: 3 * stride + 12]])
    source = tetrahedron() | document(CORNERS, TETRAHEDRON.ravel())
    del source["buffers"][0]["uri"]
    source["buffers"][0]["byteLength"] = len(stored)
    source["bufferViews"][0] |= {"byteLength": len(stored), "byteStride": stride}
    source["accessors"][0]["byteOffset"] = start
    mesh = only_mesh(read(tmp_path, glb(source, stored.tobytes())))
    np.testing.assert_array_equal(mesh.positions, CORNERS)
    assert mesh.positions.flags.aligned


def test_packed_float_positions_are_not_copied_and_are_read_only(tmp_path: Path) -> None:
    mesh = only_mesh(read(tmp_path, tetrahedron()))
    assert not mesh.positions.flags.writeable
    assert not mesh.positions.flags.owndata
    assert not mesh.triangles.flags.writeable


def test_the_binary_chunk_and_packed_wide_indices_are_not_copied(tmp_path: Path) -> None:
    source, binary = glb_source()
    source["accessors"][1]["componentType"] = 5125
    source["buffers"][0]["byteLength"] = 96
    source["bufferViews"][1]["byteLength"] = 48
    content = glb(source, binary[:48] + TETRAHEDRON.astype("<u4").tobytes())
    mesh = only_mesh(read(tmp_path, content))
    np.testing.assert_array_equal(mesh.triangles, TETRAHEDRON)
    owners = set()
    for array in (mesh.positions, mesh.triangles):
        base: object = array
        while isinstance(base, np.ndarray):
            base = base.base
        assert base == content
        owners.add(id(base))
    assert len(owners) == 1


def orientation(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (positions[triangles[:, corner]].astype(float) for corner in range(3))
    return np.sign(np.cross(b - a, c - a)[:, 2])


ZIGZAG = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0], [2, 1, 0]], np.float32)[::-1].copy()
WHEEL = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 1, 0]], np.float32)


@pytest.mark.parametrize(("mode", "positions", "count"), [(5, ZIGZAG, 4), (6, WHEEL, 3)])
@pytest.mark.parametrize("indexed", [True, False])
def test_strips_and_fans_alternate_so_that_all_faces_look_alike(
    tmp_path: Path, mode: int, positions: npt.NDArray[np.float32], count: int, *, indexed: bool
) -> None:
    primitive = {"attributes": {"POSITION": 0}, "mode": mode} | ({"indices": 1} if indexed else {})
    source = tetrahedron(meshes=[{"primitives": [primitive]}])
    source |= document(positions, np.arange(len(positions), dtype=np.uint8))
    triangles = only_mesh(read(tmp_path, source)).triangles
    sides = orientation(positions, triangles)
    assert len(triangles) == count
    assert len(set(sides)) == 1
    # The first triangle of either runs along its first vertices in order.
    assert set(triangles[0]) == {0, 1, 2}
    assert orientation(positions, np.array([[0, 1, 2]]))[0] == sides[0]


@pytest.mark.parametrize("mode", [4, 5, 6])
@pytest.mark.parametrize("count", [0, 1, 2])
def test_too_few_vertices_make_no_triangle(tmp_path: Path, mode: int, count: int) -> None:
    primitive = {"attributes": {"POSITION": 0}, "mode": mode}
    source = tetrahedron(meshes=[{"primitives": [primitive]}]) | document(CORNERS)
    source["accessors"][0]["count"] = count
    level = read(tmp_path, source)
    assert level.scene.triangle_count == 0
    assert "no triangles" in notes_of(level)


def test_a_list_without_indices_joins_every_three_vertices_and_notes_the_rest(tmp_path: Path) -> None:
    source = tetrahedron(meshes=[{"primitives": [{"attributes": {"POSITION": 0}}]}])
    level = read(tmp_path, source | document(ZIGZAG[:5]))
    np.testing.assert_array_equal(only_mesh(level).triangles, [[0, 1, 2]])
    assert "last 2 of 5 indices" in notes_of(level)


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_points_and_lines_are_skipped_with_a_note(tmp_path: Path, mode: int) -> None:
    primitives = [{"attributes": {"POSITION": 0}, "indices": 1}]
    primitives.append({"attributes": {"POSITION": 0}, "mode": mode})
    level = read(tmp_path, tetrahedron(meshes=[{"name": "Cable", "primitives": primitives}]))
    assert level.scene.triangle_count == 4
    assert 'mesh 0 "Cable", primitive 1: Points and lines' in notes_of(level)


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_json_with_crlf_and_byte_order_mark(tmp_path: Path, newline: str, mark: bytes) -> None:
    text = mark + json.dumps(tetrahedron(), indent=2).replace("\n", newline).encode()
    path = tmp_path / "level.gltf"
    path.write_bytes(text)
    assert read_level(path).scene.triangle_count == 4


def test_external_buffers_with_percent_encoded_names_in_subfolders(tmp_path: Path) -> None:
    (tmp_path / "my data").mkdir()
    (tmp_path / "my data" / "mesh #1.bin").write_bytes(CORNERS.tobytes() + b"more")
    source = tetrahedron()
    source["buffers"][0]["uri"] = "my%20data/../my%20data/mesh%20%231.bin"
    np.testing.assert_array_equal(only_mesh(read(tmp_path, source)).positions, CORNERS)


def test_plain_data_uri(tmp_path: Path) -> None:
    source = tetrahedron() | document(CORNERS.astype(np.int8), TETRAHEDRON.ravel().astype(np.uint8))
    source["buffers"][1]["uri"] = "data:," + "".join(f"%{value:02x}" for value in TETRAHEDRON.ravel())
    np.testing.assert_array_equal(only_mesh(read(tmp_path, source)).triangles, TETRAHEDRON)


def glb_source() -> tuple[dict, bytes]:
    source = tetrahedron()
    binary = CORNERS.tobytes() + TETRAHEDRON.tobytes()
    source["buffers"] = [{"byteLength": len(binary)}]
    source["bufferViews"] = [
        {"buffer": 0, "byteLength": 48},
        {"buffer": 0, "byteOffset": 48, "byteLength": 24},
    ]
    return source, binary


def test_glb_with_binary_chunk(tmp_path: Path) -> None:
    np.testing.assert_array_equal(only_mesh(read(tmp_path, glb(*glb_source()))).positions, CORNERS)


def test_glb_without_binary_chunk(tmp_path: Path) -> None:
    assert read(tmp_path, glb(tetrahedron())).scene.triangle_count == 4


@pytest.mark.parametrize("padding", [b"", b" ", b"\0\0\0"])
def test_glb_with_unaligned_json_nul_padding_unknown_chunks_and_trailing_bytes(
    tmp_path: Path, padding: bytes
) -> None:
    source, binary = glb_source()
    text = json.dumps(source).encode() + padding
    chunks = [chunk(b"JSON", text), chunk(b"XYZ1", b"?"), chunk(b"BIN\0", binary), chunk(b"BIN\0", b"")]
    level = read(tmp_path, glb_of(*chunks) + b"tail")
    np.testing.assert_array_equal(only_mesh(level).positions, CORNERS)
    assert "4 bytes after the stated length" in notes_of(level)


def test_the_content_of_a_gltf_file_may_be_binary(tmp_path: Path) -> None:
    assert read(tmp_path, glb(*glb_source()), "level.gltf").scene.triangle_count == 4


def test_suffixes_in_any_case(tmp_path: Path) -> None:
    assert read(tmp_path, glb(*glb_source()), "LEVEL.GLB").scene.name == "LEVEL"


def test_translation_rotation_scale(tmp_path: Path) -> None:
    node = {
        "mesh": 0,
        "translation": [1, 2, 3],
        "rotation": [0, 0, HALF, HALF],
        "scale": [2, -3, 4],
    }
    (world,) = only_mesh(read(tmp_path, tetrahedron(nodes=[node]))).placements
    # A quarter turn about z takes x to y and y to -x.
    expected = [[0, 3, 0, 1], [2, 0, 0, 2], [0, 0, 4, 3], [0, 0, 0, 1]]
    np.testing.assert_allclose(world, expected, rtol=0, atol=tolerances.QUATERNION)


def test_a_quaternion_of_any_length_rotates(tmp_path: Path) -> None:
    nodes = [{"mesh": 0, "rotation": [0.5, 0.5, 0.5, 0.5]}, {"mesh": 0, "rotation": [3, 3, 3, 3]}]
    level = read(tmp_path, tetrahedron(nodes=nodes, scenes=[{"nodes": [0, 1]}]))
    first, second = level.scene.meshes
    np.testing.assert_array_equal(first.placements, second.placements)
    np.testing.assert_array_equal(first.placements[0, :3, :3], [[0, 0, 1], [1, 0, 0], [0, 1, 0]])


def test_matrices_are_column_major_and_a_mirror_keeps_the_winding(tmp_path: Path) -> None:
    matrix = np.array([[-1, 0, 0, 5], [0, 2, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1.0]])
    mesh = only_mesh(read(tmp_path, tetrahedron(nodes=[{"mesh": 0, "matrix": matrix.T.ravel().tolist()}])))
    np.testing.assert_array_equal(mesh.placements, matrix[None])
    np.testing.assert_array_equal(mesh.triangles, TETRAHEDRON)


def exact_product(parent: np.ndarray, local: np.ndarray) -> np.ndarray:
    """The same fixed order in plain Python floats, which never fuse."""
    rows = [
        [
            ((p[0] * local[0, j] + p[1] * local[1, j]) + p[2] * local[2, j]) + p[3] * local[3, j]
            for j in range(4)
        ]
        for p in parent.tolist()
    ]
    return np.array(rows)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.lists(st.floats(-8, 8), min_size=12, max_size=12), min_size=3, max_size=3))
def test_world_matrices_have_the_bits_of_a_fixed_order(
    tmp_path_factory: pytest.TempPathFactory, values: list[list[float]]
) -> None:
    locals_ = [np.vstack([np.array(v).reshape(3, 4) + 3 * np.eye(3, 4), [0, 0, 0, 1]]) for v in values]
    nodes = [{"matrix": m.T.ravel().tolist(), "children": [i + 1]} for i, m in enumerate(locals_)]
    nodes[-1] = carrying(0, matrix=nodes[-1]["matrix"])
    world = exact_product(exact_product(locals_[0], locals_[1]), locals_[2])
    source = lit({"type": "point"}, nodes=nodes) | {"scenes": [{"nodes": [0]}]}
    (light,) = read(tmp_path_factory.mktemp("m"), source).scene.lights
    assert light.position == tuple((world[:3, 3] + 0.0).tolist())


def test_a_hierarchy_of_10000_levels(tmp_path: Path) -> None:
    depth = 10_000
    assert depth > sys.getrecursionlimit()
    nodes = [{"translation": [1, 0, 0], "children": [index + 1]} for index in range(depth)]
    nodes.append({"mesh": 0})
    mesh = only_mesh(read(tmp_path, tetrahedron(nodes=nodes)))
    assert mesh.placements[0, 0, 3] == depth
    assert mesh.node == depth


def test_nodes_share_the_arrays_of_a_shared_mesh(tmp_path: Path) -> None:
    nodes = [{"mesh": 0}, {"mesh": 0, "translation": [9, 0, 0]}]
    first, second = read(tmp_path, tetrahedron(nodes=nodes, scenes=[{"nodes": [0, 1]}])).scene.meshes
    assert np.shares_memory(first.positions, second.positions)
    assert np.shares_memory(first.triangles, second.triangles)
    assert (first.node, second.node) == (0, 1)
    np.testing.assert_array_equal(second.placements[0, :3, 3], [9, 0, 0])


def test_one_mesh_per_node_and_primitive_in_the_order_of_the_graph(tmp_path: Path) -> None:
    primitive = {"attributes": {"POSITION": 0}, "indices": 1}
    nodes = [{"mesh": 0, "children": [3]}, {"mesh": 0}, {}, {"mesh": 1}]
    source = tetrahedron(nodes=nodes, scenes=[{"nodes": [1, 0, 2]}])
    source["meshes"] = [{"primitives": [primitive, primitive]}, {"primitives": [primitive]}]
    meshes = read(tmp_path, source).scene.meshes
    assert [mesh.node for mesh in meshes] == [1, 1, 0, 0, 3]
    assert all(np.shares_memory(mesh.positions, meshes[0].positions) for mesh in meshes)


def test_a_missing_default_scene_means_the_first(tmp_path: Path) -> None:
    source = tetrahedron(scenes=[{"nodes": [0]}, {"nodes": []}])
    del source["scene"]
    level = read(tmp_path, source)
    assert level.scene.triangle_count == 4
    assert "no default scene" in notes_of(level)


def test_a_file_without_scenes_means_all_its_trees(tmp_path: Path) -> None:
    source = tetrahedron(nodes=[{}, {"mesh": 0, "children": [2]}, {"mesh": 0}])
    del source["scene"], source["scenes"]
    level = read(tmp_path, source)
    assert [mesh.node for mesh in level.scene.meshes] == [1, 2]
    assert level.scene.name == "level"


def test_scenes_are_chosen_by_name_before_index(tmp_path: Path) -> None:
    scenes = [{"nodes": [0], "name": "1"}, {"nodes": [1], "name": "cellar"}]
    source = tetrahedron(nodes=[{"mesh": 0}, {"mesh": 0}], scenes=scenes)
    picked = {
        wanted: read(tmp_path, source, scene=wanted).scene.meshes[0].node for wanted in ("cellar", "1", "0")
    }
    assert picked == {"cellar": 1, "1": 0, "0": 0}


@pytest.mark.parametrize("wanted", ["attic", "2", "-1", "00"])
def test_an_unknown_scene_is_refused_with_the_list_of_scenes(tmp_path: Path, wanted: str) -> None:
    scenes = [{"nodes": [0]}, {"nodes": [0], "name": "cellar"}]
    with pytest.raises(LevelError, match='The file has: 0, 1 "cellar"'):
        read(tmp_path, tetrahedron(scenes=scenes), scene=wanted)


def test_materials(tmp_path: Path) -> None:
    primitives = [{"attributes": {"POSITION": 0}, "indices": 1, "material": index} for index in range(3)]
    materials = [
        {"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 0.1]}},
        {"alphaMode": "MASK", "name": "Leaves"},
        {"alphaMode": "BLEND", "name": "Glass"},
    ]
    level = read(tmp_path, tetrahedron(meshes=[{"primitives": primitives}], materials=materials))
    assert [mesh.casts for mesh in level.scene.meshes] == [True, True, False]
    assert level.scene.meshes[0].base_color == (0.25, 0.5, 0.75)
    assert 'warning material 1 "Leaves": alphaMode MASK' in notes_of(level)
    assert 'warning material 2 "Glass": alphaMode BLEND' in notes_of(level)


def test_a_node_scaled_to_nothing_hides_its_mesh(tmp_path: Path) -> None:
    nodes = [{"scale": [0, 0, 0], "children": [1]}, {"mesh": 0, "name": "Hidden"}]
    level = read(tmp_path, tetrahedron(nodes=nodes))
    assert level.scene.meshes == ()
    assert 'node 1 "Hidden": Hidden by a scale of 0' in notes_of(level)


def test_levels_without_lights_and_triangles_are_read_with_warnings(tmp_path: Path) -> None:
    level = read(tmp_path, {"asset": {"version": "2.0"}})
    assert (level.scene.meshes, level.scene.lights, level.scene.cameras) == ((), (), ())
    assert [note.text[:18] for note in level.notes if note.severity is Severity.WARNING] == [
        "This level has no ",
        "This level has no ",
    ]
