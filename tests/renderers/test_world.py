from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from renderers.context import Gpu
from renderers.frame import decode_octahedral
from renderers.registry import technique
from renderers.world import World, encode_octahedral
from scenes.scene import Array, LightKind, Mesh, Scene
from tests import tolerances
from tests.random_scenes import random_camera, random_light, random_scene
from tests.rendering import framed, prepared
from tests.solids import box, floor, moved, placed


@given(st.integers(0, 10**6))
def test_packed_normals_are_nearly_what_they_were(seed: int) -> None:
    normals = np.random.default_rng(seed).normal(size=(100, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    found = decode_octahedral(encode_octahedral(normals.T))
    assert np.linalg.norm(found - normals, axis=1).max() <= tolerances.PACKED_NORMAL


def test_axes_are_packed_exactly() -> None:
    axes = np.vstack([np.eye(3), -np.eye(3)])
    assert decode_octahedral(encode_octahedral(axes.T)).tolist() == axes.tolist()


def read(buffer_bytes: bytes, dtype: npt.DTypeLike, width: int) -> npt.NDArray[np.generic]:
    return np.frombuffer(buffer_bytes, dtype).reshape(-1, width)


def triangles_of(world: World) -> Array:
    positions = read(world.vertex_buffer.read(), np.float32, 3)
    indices = read(world.index_buffer.read(), np.int32, 3)
    return np.asarray(positions)[indices].astype(np.float64)


def test_every_face_is_there_once_in_its_own_winding_casters_first(gpu: Gpu) -> None:
    silent = box((0, 1, 0), (1, 2, 1), casts=False)
    # Powers of two: every position is exact in float32, recentred or not.
    lower, upper = floor(4.0, cells=3), moved(box((2, 1, 0), (0.5, 0.5, 0.5)), placed(offset=(0, 2.0, 0)))
    scene = Scene("mixed", (silent, lower, upper))
    world = World.of(gpu, scene)
    found = triangles_of(world) + world.origin
    casting = [*lower.world_positions()[0][lower.triangles], *upper.world_positions()[0][upper.triangles]]
    still = silent.world_positions()[0][silent.triangles]
    assert world.caster_count == len(casting)
    # Welding and clusters reorder vertices and faces, not the corners of a face.
    near = np.round(found * 2**16).astype(np.int64).reshape(-1, 9)
    wanted = np.round(np.array([*casting, *still]) * 2**16).astype(np.int64).reshape(-1, 9)
    count = world.caster_count
    assert sorted(near[:count].tolist()) == sorted(wanted[:count].tolist())
    assert sorted(near[count:].tolist()) == sorted(wanted[count:].tolist())
    world.release()


def test_the_face_table_holds_each_faces_normal_and_color(gpu: Gpu) -> None:
    red = Mesh("red", [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], base_color=(1.0, 0.5, 0.0))
    scene = Scene("two", (red, floor(2.0)))
    world = World.of(gpu, scene)
    table = read(world.face_buffer.read(), np.uint32, 2).astype(np.uint32)
    corners = triangles_of(world)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.abs(decode_octahedral(table[:, 0]) - normals).max() <= tolerances.PACKED_NORMAL
    facing = normals[:, 2] > 0.5
    assert facing.sum() == 1
    assert int(table[facing, 1][0]) == 0xFF | 0x80 << 8 | 0xFF << 24
    world.release()


def test_only_casting_faces_have_edges(gpu: Gpu) -> None:
    scene = Scene("mixed", (floor(4.0, casts=False), box((0, 1, 0), (0.5, 0.5, 0.5))))
    world = World.of(gpu, scene)
    assert len(world.topology.edges) == 18
    assert world.topology.faces.max() < world.caster_count
    assert (world.topology.valences == 2).all()
    edges = read(world.edges.vertices.read(), np.int32, 2)
    assert np.array_equal(edges, world.topology.edges)
    world.release()


@pytest.mark.parametrize(
    "name", ["shadow_map", "perspective_shadow_map", "light_space_perspective_shadow_map"]
)
def test_maps_are_drawn_without_edges(gpu: Gpu, name: str) -> None:
    scene, light = random_scene("closed boxes", 1), random_light(LightKind.SPOT, 1)
    with framed(gpu, scene, light, random_camera(1), (32, 24)) as frame:
        with prepared(frame, name, {}):
            assert frame.read_mask().any()
        assert "edges" not in vars(frame.world)


@pytest.mark.parametrize("name", ["shadow_volume", "chan_hybrid"])
def test_edges_are_made_before_anything_is_timed(gpu: Gpu, name: str) -> None:
    scene, light = random_scene("closed boxes", 1), random_light(LightKind.SPOT, 1)
    with framed(gpu, scene, light, random_camera(1), (32, 24)) as frame:
        assert "edges" not in vars(frame.world)
        with technique(name).prepare(frame, frame.light, {}):
            assert "edges" in vars(frame.world)


def test_many_placements_are_expanded_a_few_at_a_time(gpu: Gpu, monkeypatch: pytest.MonkeyPatch) -> None:
    placements = np.stack([placed(offset=(3.0 * step, 0, step)) for step in range(7)])
    scene = Scene("row", (replace(box((0, 1, 0), (1, 1, 1)), placements=placements), floor(4.0)))
    at_once = World.of(gpu, scene)
    monkeypatch.setattr("renderers.world.EXPANDED_AT_ONCE", 17)
    by_twos = World.of(gpu, scene)
    assert np.array_equal(at_once.positions, by_twos.positions)
    assert np.array_equal(at_once.triangles, by_twos.triangles)
    assert len(at_once.triangles) == scene.triangle_count
    at_once.release()
    by_twos.release()


@pytest.mark.parametrize("geometry", ["triangle soup", "duplicates and degenerates"])
def test_half_edges_say_which_face_runs_which_way(gpu: Gpu, geometry: str) -> None:
    world = World.of(gpu, random_scene(geometry, 1))
    half_edges = np.frombuffer(world.edges.half_edges.read(), np.int32)
    offsets = np.frombuffer(world.edges.offsets.read(), np.int32)
    triangles = read(world.index_buffer.read(), np.int32, 3)
    edge = np.repeat(np.arange(len(world.topology.edges)), np.diff(offsets))
    first, second = world.topology.edges[edge].T
    tail, head = np.where(half_edges & 1, first, second), np.where(half_edges & 1, second, first)
    faces = np.asarray(triangles)[half_edges >> 1]
    runs = (faces == tail[:, None]) & (np.roll(faces, -1, axis=1) == head[:, None])
    assert runs.any(axis=1).all()
    world.release()


def test_a_scene_far_away_keeps_its_shape(gpu: Gpu) -> None:
    away = (1e6, -2e6, 5e5)
    near = World.of(gpu, Scene("near", (box((0, 0, 0), (1, 2, 3)),)))
    far = World.of(gpu, Scene("far", (moved(box((0, 0, 0), (1, 2, 3)), placed(offset=away)),)))
    assert far.origin.tolist() == list(away)
    assert np.array_equal(near.positions, far.positions)
    near.release()
    far.release()


@pytest.mark.parametrize("meshes", [(), (Mesh("no faces", np.ones((3, 3)), np.zeros((0, 3))),)])
def test_a_scene_without_faces_is_a_world(gpu: Gpu, meshes: tuple[Mesh, ...]) -> None:
    world = World.of(gpu, Scene("empty", meshes))
    assert world.caster_count == 0
    assert len(world.triangles) == 0
    world.release()
