from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.formats.registry import read_level
from scenes.gltf.writer import glb_bytes, write_glb
from scenes.scene import Camera, Light, LightKind, Mesh, Mobility, Scene
from tests.scenes.gltf_samples import (
    CORNERS,
    TETRAHEDRON,
    read,
)

TRIANGLE = Mesh("wall", CORNERS, TETRAHEDRON)
UNIT = st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)).filter(
    lambda v: math.dist(v, (0, 0, 0)) > 1e-3
)
POINTS = st.tuples(*[st.floats(-1e6, 1e6)] * 3)


def normalised(v: tuple[float, float, float]) -> tuple[float, float, float]:
    length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return v[0] / length + 0.0, v[1] / length + 0.0, v[2] / length + 0.0


@settings(max_examples=50, deadline=None)
@given(
    st.sampled_from(LightKind),
    POINTS,
    UNIT,
    st.floats(0.01, math.pi / 2),
    st.one_of(st.just(math.inf), st.floats(1e-3, 1e6)),
    st.sampled_from(Mobility),
)
def test_written_lights_read_back_bit_for_bit(
    tmp_path_factory: pytest.TempPathFactory,
    kind: LightKind,
    position: tuple[float, float, float],
    direction: tuple[float, float, float],
    cone: float,
    range_m: float,
    mobility: Mobility,
) -> None:
    light = Light(
        "l", kind, tuple(v + 0.0 for v in position), range_m=range_m, mobility=mobility, color=(0.1, 1.0, 0.0)
    )
    if kind is not LightKind.POINT:
        light = replace(light, direction=normalised(direction))
    if kind is LightKind.SPOT:
        light = replace(light, inner_cone_rad=cone / 3, outer_cone_rad=cone)
    scene = Scene("s", (TRIANGLE,), (light,))
    level = read(tmp_path_factory.mktemp("w"), glb_bytes(scene))
    assert level.scene.digest == scene.digest
    assert replace(level.scene.lights[0], node=None) == light


def test_written_scenes_read_back(tmp_path: Path) -> None:
    placements = np.stack([np.eye(4), np.diag([-1, 2, 3, 1.0]), np.eye(4)])
    placements[2, :3, 3] = (0.1, 1e-300, -1e5)
    camera = Camera("c", (1.5, 2.0, 3.0), (0.6, 0.0, -0.8), (0.0, 1.0, 0.0), yfov_rad=0.9, near_m=0.05)
    many = replace(TRIANGLE, placements=placements, base_color=(0.1, 0.2, 0.3))
    glass = replace(TRIANGLE, name="glass", casts=False)
    empty = Mesh("empty", np.zeros((0, 3)), np.zeros((0, 3)))
    scene = Scene("demo", (many, empty, glass), (Light("sun", LightKind.DIRECTIONAL),), (camera,))
    path = tmp_path / "demo.glb"
    write_glb(scene, path)
    found = read_level(path).scene
    assert (found.name, found.triangle_count) == ("demo", scene.triangle_count)
    assert [mesh.casts for mesh in found.meshes] == [True, True, True, False]
    assert [mesh.name for mesh in found.meshes] == ["wall", "wall", "wall", "glass"]
    assert found.meshes[1].base_color == (0.1, 0.2, 0.3)
    for mesh, placement in zip(found.meshes, [*placements, np.eye(4)], strict=True):
        np.testing.assert_array_equal(mesh.positions, TRIANGLE.positions)
        np.testing.assert_array_equal(mesh.triangles, TRIANGLE.triangles)
        np.testing.assert_array_equal(mesh.placements[0], placement)
    assert replace(found.cameras[0], node=None) == camera
    assert path.read_bytes() == glb_bytes(scene)
    document_text = json.loads(path.read_bytes()[20:].split(b"\0")[0].rsplit(b"}", 1)[0] + b"}")
    # Three placements and the glass share two accessors: positions and indices.
    assert len(document_text["accessors"]) == 2


def test_an_empty_scene_is_a_glb_without_binary_chunk(tmp_path: Path) -> None:
    content = glb_bytes(Scene("nothing", ()))
    assert b"BIN" not in content
    assert read(tmp_path, content).scene.digest == Scene("nothing", ()).digest
