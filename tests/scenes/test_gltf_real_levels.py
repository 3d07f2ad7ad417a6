"""Real levels, against trimesh as an independent reader."""

from __future__ import annotations

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
    np.testing.assert_allclose(scene.bounds, other.bounds, rtol=0, atol=tolerances.WORLD_POSITION * extent)


@pytest.mark.parametrize("name", KNOWN)
def test_reading_twice_and_rewriting_gives_the_same_scene(name: str, tmp_path: Path) -> None:
    scene = read_level(LEVELS / name).scene
    assert read_level(LEVELS / name).scene.digest == scene.digest
    write_glb(scene, tmp_path / "again.glb")
    assert read_level(tmp_path / "again.glb").scene.digest == scene.digest


def test_what_is_not_read_yet_is_named() -> None:
    with pytest.raises(LevelError, match="needs Draco decompression, which this version does not read yet"):
        read_level(LEVELS / "gltf/folio_areas_draco_ktx2.glb")


def test_the_cyclic_graph_is_refused() -> None:
    with pytest.raises(LevelError, match="Its descent is 1 > 0 > 1"):
        read_level(LEVELS / "gltf/recursive_nodes/RecursiveNodes.gltf")


def test_instanced_teapots_are_placed_once_with_warnings() -> None:
    level = read_level(LEVELS / "gltf/teapots_galore/teapots_galore.gltf")
    assert [note.where for note in level.notes if "GPU instancing" in note.text] == [
        'node 3 "teapot"',
        'node 4 "teapot0"',
    ]
