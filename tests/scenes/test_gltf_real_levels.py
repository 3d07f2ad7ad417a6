"""Real levels, against trimesh as an independent reader."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.gltf.writer import write_glb
from scenes.scene import LightKind
from tests import tolerances

LEVELS = Path(__file__).parents[2] / "../shared/levels"

pytestmark = pytest.mark.skipif(not LEVELS.is_dir(), reason="the folder of real levels is not here")

# triangles, point lights, spots, directional lights: as the folder's README counts them.
KNOWN = {
    "quake/start.glb": (14450, 267, 0, 0),
    "quake/e1m1.glb": (14542, 198, 0, 0),
    "quake/dm4.glb": (8360, 78, 0, 0),
    "quake/dm6.glb": (5502, 87, 0, 0),
    "gltf/blenvy_start_level.glb": (306, 3, 1, 1),
    "gltf/animation_pointer/24_animation_pointer.gltf": (14436, 0, 3, 1),
    "gltf/tps_demo_lights.glb": (5440, 7, 13, 0),
    "gltf/godot_lights_and_shadows.glb": (3366, 6, 6, 0),
    "gltf/kenney_fps.glb": (7892, 0, 0, 1),
    "gltf/kenney_platformer.glb": (4960, 0, 0, 1),
    "gltf/wicked_lights_punctual_test.glb": (14, 1, 1, 1),
    "gltf/playcanvas_lights.glb": (12, 1, 2, 1),
}


@pytest.mark.parametrize("name", KNOWN)
def test_counts_of_triangles_and_lights(name: str) -> None:
    scene = read_level(LEVELS / name).scene
    kinds = Counter(light.kind for light in scene.lights)
    lights = (kinds[LightKind.POINT], kinds[LightKind.SPOT], kinds[LightKind.DIRECTIONAL])
    assert (scene.triangle_count, *lights) == KNOWN[name]


@pytest.mark.parametrize("name", KNOWN)
def test_triangles_and_world_bounds_as_trimesh_reads_them(name: str) -> None:
    scene = read_level(LEVELS / name).scene
    other = trimesh.load_scene(LEVELS / name, process=False)
    drawn = [
        other.geometry[geometry]
        for geometry in other.graph.geometry_nodes
        for _ in other.graph.geometry_nodes[geometry]
    ]
    assert scene.triangle_count == sum(len(mesh.faces) for mesh in drawn)
    extent = float(np.ptp(other.bounds, axis=0).max())
    # That level's highest corner is one of its skinned cylinder, which trimesh puts where its node stands.
    skinned = name == "gltf/animation_pointer/24_animation_pointer.gltf"
    tolerance = tolerances.INVERSE_BIND if skinned else tolerances.WORLD_POSITION
    np.testing.assert_allclose(scene.bounds, other.bounds, rtol=0, atol=tolerance * extent)


@pytest.mark.parametrize("name", KNOWN)
def test_reading_twice_and_rewriting_gives_the_same_scene(name: str, tmp_path: Path) -> None:
    scene = read_level(LEVELS / name).scene
    assert read_level(LEVELS / name).scene.digest == scene.digest
    write_glb(scene, tmp_path / "again.glb")
    assert read_level(tmp_path / "again.glb").scene.digest == scene.digest


def test_the_cyclic_graph_is_refused() -> None:
    with pytest.raises(LevelError, match="Its descent is 1 > 0 > 1"):
        read_level(LEVELS / "gltf/recursive_nodes/RecursiveNodes.gltf")


def test_instanced_teapots_are_read_without_being_expanded() -> None:
    level = read_level(LEVELS / "gltf/teapots_galore/teapots_galore.gltf")
    plane, first, second = level.scene.meshes
    assert [len(mesh.placements) for mesh in (plane, first, second)] == [1, 958, 941]
    assert first.positions is second.positions
    assert first.triangles is second.triangles
    assert (first.triangle_count, level.scene.triangle_count) == (958 * 4032, 7_656_770)
    arrays = (*(mesh.placements for mesh in (first, second, plane)), first.positions, first.triangles)
    assert sum(array.nbytes for array in arrays) < 400_000


def test_the_draco_level_is_read_as_dracopy_decodes_it() -> None:
    dracopy = pytest.importorskip("DracoPy")
    path = LEVELS / "gltf/folio_areas_draco_ktx2.glb"
    scene = read_level(path).scene
    source = path.read_bytes()
    length = int.from_bytes(source[12:16], "little")
    document, binary = json.loads(source[20 : 20 + length]), source[28 + length :]
    decoded = {}
    for index, mesh in enumerate(document["meshes"]):
        extensions = [primitive.get("extensions", {}) for primitive in mesh["primitives"]]
        named = [extension["KHR_draco_mesh_compression"] for extension in extensions if extension]
        views = [document["bufferViews"][extension["bufferView"]] for extension in named]
        starts = [view.get("byteOffset", 0) for view in views]
        blocks = [
            binary[start : start + view["byteLength"]] for start, view in zip(starts, views, strict=True)
        ]
        decoded[index] = [dracopy.decode(block) for block in blocks]
    expected = [
        (node, mesh)
        for node, values in enumerate(document["nodes"])
        if "mesh" in values
        for mesh in decoded[values["mesh"]]
    ]
    assert Counter(mesh.node for mesh in scene.meshes) == Counter(node for node, _ in expected)
    by_node = sorted(scene.meshes, key=lambda mesh: mesh.node or 0)
    for mesh, (_, other) in zip(by_node, expected, strict=True):
        np.testing.assert_array_equal(mesh.triangles, other.faces)
        np.testing.assert_array_equal(mesh.positions, other.points)
    assert scene.triangle_count == sum(len(mesh.faces) for _, mesh in expected) == 60825


def test_teapots_stand_where_trimesh_turns_them() -> None:
    folder = LEVELS / "gltf/teapots_galore"
    document = json.loads((folder / "teapots_galore.gltf").read_text())
    binary = (folder / document["buffers"][1]["uri"]).read_bytes()

    def rows(accessor: int, width: int) -> np.ndarray:
        entry = document["accessors"][accessor]
        view = document["bufferViews"][entry["bufferView"]]
        start = view.get("byteOffset", 0)
        return np.frombuffer(binary, "<f4", entry["count"] * width, start).reshape(-1, width).astype(float)

    turn, raise_ = (np.array(document["nodes"][node]["matrix"]).reshape(4, 4).T for node in (2, 3))
    expected = [
        trimesh.transformations.translation_matrix(place)
        @ trimesh.transformations.quaternion_matrix([w, x, y, z])
        @ np.diag([*size, 1.0])
        for place, (x, y, z, w), size in zip(rows(3, 3), rows(4, 4), rows(5, 3), strict=True)
    ]
    scene = read_level(folder / "teapots_galore.gltf").scene
    (found,) = (mesh.placements for mesh in scene.meshes if mesh.node == 3)
    above = turn if 3 in document["nodes"][2]["children"] else np.eye(4)
    tolerance = tolerances.QUATERNION * float(np.ptp(scene.bounds))
    np.testing.assert_allclose(found, [above @ raise_ @ local for local in expected], rtol=0, atol=tolerance)
