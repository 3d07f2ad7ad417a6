from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import FrozenInstanceError, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes import scene as scene_module
from scenes.scene import Camera, Light, LightKind, Mesh, Mobility, Scene

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 0.1, 0], [0, 0, -3]], np.float32)
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3]])


def small_scene() -> Scene:
    shifted = np.stack([np.eye(4), np.diag([-1, 0.1, 3, 1.0])])
    shifted[1, :3, 3] = (0.1, 0.2, 1e-300)
    return Scene(
        "small",
        (Mesh("a", CORNERS, TRIANGLES, shifted, node=3), Mesh("b", CORNERS, TRIANGLES[:1], casts=False)),
        (
            Light("l", LightKind.SPOT, (0.1, 2.0, 3.0), (0.0, -1.0, 0.0), 0.1, 0.5, 7.5, node=4),
            Light("m", LightKind.POINT, mobility=Mobility.STATIC),
        ),
        (Camera("c", (1.0, 2.0, 3.0), node=5),),
    )


def test_the_digest_is_the_same_on_every_machine() -> None:
    assert small_scene().digest == "c367a48e73c7d8cf737cd0de9dfd2866bb9d2df69c8593357ef6c0f9ec869a61"


def test_names_and_nodes_do_not_change_the_digest() -> None:
    scene = small_scene()
    renamed = Scene(
        "other",
        tuple(replace(mesh, name="x", node=None, promised_closed=True) for mesh in scene.meshes),
        tuple(replace(light, name="y", node=99) for light in scene.lights),
        tuple(replace(camera, name="z", node=None) for camera in scene.cameras),
    )
    assert renamed.digest == scene.digest


def test_a_mesh_placed_twice_has_the_digest_of_two_meshes_placed_once() -> None:
    scene = small_scene()
    twice, other = scene.meshes
    apart = [replace(twice, placements=placement[None], node=None) for placement in twice.placements]
    assert replace(scene, meshes=(*apart, other)).digest == scene.digest
    assert replace(scene, meshes=(apart[0], other, apart[1])).digest != scene.digest
    nothing = (replace(twice, triangles=TRIANGLES[:0]), replace(twice, placements=np.zeros((0, 4, 4))))
    assert replace(scene, meshes=(*scene.meshes, *nothing)).digest == scene.digest


def test_negative_zero_is_zero() -> None:
    corners = CORNERS.copy()
    corners[corners == 0] = -0.0
    assert (
        Scene("", (Mesh("", corners, TRIANGLES),)).digest == Scene("", (Mesh("", CORNERS, TRIANGLES),)).digest
    )


def test_integers_numpy_floats_and_negative_zeros_do_not_change_the_digest() -> None:
    plain = Light("l", LightKind.SPOT, (0.0, 2.0, 3.0), (0.0, -1.0, 0.0), 0.0, 0.5, 7.0, 1.0)
    spelt = Light(
        "l", LightKind.SPOT, (-0.0, 2, np.float64(3)), (0, -1, -0.0), -0.0, np.float64(0.5), 7, np.int64(1)
    )
    camera = Camera("c", (0.0, 1.0, 2.0), near_m=1.0)
    odd = Camera("c", (-0.0, 1, np.float32(2)), (0, -0.0, -1), near_m=1)
    assert Scene("", (), (spelt,), (odd,)).digest == Scene("", (), (plain,), (camera,)).digest


@pytest.mark.parametrize(
    ("kind", "wrong"),
    [
        (LightKind.POINT, {"range_m": 0.0}),
        (LightKind.DIRECTIONAL, {"range_m": -1.0}),
        (LightKind.POINT, {"range_m": np.nan}),
        (LightKind.POINT, {"position": (0.0, np.inf, 0.0)}),
        (LightKind.POINT, {"direction": (0.0, np.nan, 0.0)}),
        (LightKind.POINT, {"intensity": np.inf}),
        (LightKind.POINT, {"color": (0.0, np.nan, 0.0)}),
        (LightKind.SPOT, {"direction": (0.0, 0.0, 0.0)}),
        (LightKind.SPOT, {"direction": (0.0, 0.0, -1.00001)}),
        (LightKind.DIRECTIONAL, {"direction": (0.0, 0.0, -0.99999)}),
        (LightKind.SPOT, {"outer_cone_rad": 0.0}),
        (LightKind.SPOT, {"outer_cone_rad": np.nextafter(np.pi / 2, 2)}),
        (LightKind.SPOT, {"inner_cone_rad": 1.0}),
        (LightKind.SPOT, {"inner_cone_rad": -0.1}),
        (LightKind.SPOT, {"inner_cone_rad": np.nan}),
    ],
)
def test_lights_that_are_none_are_refused(kind: LightKind, wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r'Light "Lamp": .* must be '):
        replace(Light("Lamp", kind), **wrong)


@pytest.mark.parametrize(
    "wrong",
    [
        {"position": (np.nan, 0.0, 0.0)},
        {"forward": (0.0, 0.0, -2.0)},
        {"up": (0.0, 0.99999, 0.0)},
        {"up": (0.0, 0.8, 0.6)},
        {"yfov_rad": 0.0},
        {"yfov_rad": np.pi},
        {"near_m": 0.0},
        {"near_m": np.inf},
    ],
)
def test_cameras_that_are_none_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r'Camera "Eye": .* must be '):
        replace(Camera("Eye", (0.0, 1.0, 2.0)), **wrong)


def test_lights_and_cameras_at_the_limits_are_some() -> None:
    near_unit = (0.0, 0.0, -1.0 - 9e-7)
    Light("a", LightKind.SPOT, direction=near_unit, inner_cone_rad=np.pi / 2, outer_cone_rad=np.pi / 2)
    # What a kind ignores may be anything finite.
    Light("b", LightKind.POINT, direction=(0.0, 0.0, 0.0), inner_cone_rad=9.0, range_m=5e-324)
    Light("c", LightKind.DIRECTIONAL, direction=near_unit, outer_cone_rad=0.0, intensity=-1.0)
    Camera("d", (0.0, 0.0, 0.0), near_unit, (0.0, 1.0, 9e-7), np.nextafter(np.pi, 0), 5e-324)


def with_mesh(**changes: object) -> Callable[[Scene], Scene]:
    return lambda scene: replace(scene, meshes=(replace(scene.meshes[0], **changes), scene.meshes[1]))


def with_light(**changes: object) -> Callable[[Scene], Scene]:
    return lambda scene: replace(scene, lights=(replace(scene.lights[0], **changes), scene.lights[1]))


def with_camera(**changes: object) -> Callable[[Scene], Scene]:
    return lambda scene: replace(scene, cameras=(replace(scene.cameras[0], **changes),))


MOVED_CORNERS = np.nextafter(CORNERS, np.float32(9), dtype=np.float32)
CHANGES = {
    "a vertex by one bit": with_mesh(positions=np.where(np.arange(4)[:, None] == 1, MOVED_CORNERS, CORNERS)),
    "a triangle": with_mesh(triangles=[[0, 1, 2], [0, 1, 3]]),
    "the winding": with_mesh(triangles=TRIANGLES[:, ::-1]),
    "a placement": with_mesh(placements=np.stack([np.eye(4), np.diag([1, 1, math.nextafter(1, 2), 1])])),
    "the number of placements": with_mesh(placements=np.eye(4)[None]),
    "casting": with_mesh(casts=False),
    "a surface's colour": with_mesh(base_color=(0.8, 0.8, 0.7)),
    "the order of meshes": lambda scene: replace(scene, meshes=scene.meshes[::-1]),
    "a light's position": with_light(position=(math.nextafter(0.1, 1), 2.0, 3.0)),
    "a light's kind": with_light(kind=LightKind.POINT),
    "a light's direction": with_light(direction=(0.0, -0.6, 0.8)),
    "an outer cone": with_light(outer_cone_rad=0.6),
    "an inner cone": with_light(inner_cone_rad=0.2),
    "a range": with_light(range_m=math.inf),
    "an intensity": with_light(intensity=2.0),
    "a colour": with_light(color=(1.0, 1.0, 0.5)),
    "mobility": with_light(mobility=Mobility.STATIC),
    "the number of lights": lambda scene: replace(scene, lights=scene.lights[:1]),
    "a camera's position": with_camera(position=(1.0, 2.0, 3.5)),
    "a camera's lens": with_camera(yfov_rad=1.0),
    "a near plane": with_camera(near_m=0.2),
    "the number of cameras": lambda scene: replace(scene, cameras=()),
}


@pytest.mark.parametrize("what", CHANGES)
def test_every_change_that_can_change_a_shadow_changes_the_digest(what: str) -> None:
    scene = small_scene()
    assert CHANGES[what](scene).digest != scene.digest


def test_arrays_are_read_only_copies() -> None:
    corners = CORNERS.copy()
    mesh = Mesh("a", corners, TRIANGLES)
    corners[0] = 9
    np.testing.assert_array_equal(mesh.positions, CORNERS)
    for array in (mesh.positions, mesh.triangles, mesh.placements):
        assert not array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    with pytest.raises(FrozenInstanceError):
        mesh.casts = False  # type: ignore[misc]


def test_read_only_arrays_of_the_right_type_are_the_same_objects() -> None:
    mesh = Mesh("a", CORNERS, TRIANGLES)
    again = Mesh("b", mesh.positions, mesh.triangles)
    assert again.positions is mesh.positions
    assert again.triangles is mesh.triangles
    assert replace(mesh, name="c").placements is mesh.placements


def test_triangles_are_counted_over_placements() -> None:
    assert small_scene().meshes[0].triangle_count == 4
    assert small_scene().triangle_count == 5


coordinates = st.floats(-1e3, 1e3)


@given(st.lists(coordinates, min_size=12, max_size=12), st.tuples(*[st.floats(-1e3, 1e3, width=32)] * 3))
def test_world_positions_have_the_bits_of_a_fixed_order(
    values: list[float], point: tuple[float, float, float]
) -> None:
    placement = np.vstack([np.array(values).reshape(3, 4), [0, 0, 0, 1]])
    x, y, z = point
    expected = [((row[0] * x + row[1] * y) + row[2] * z) + row[3] for row in placement[:3].tolist()]
    world = Mesh("a", [point], np.zeros((0, 3)), placement[None]).world_positions()
    assert world.tolist() == [[expected]]


def test_bounds_hold_all_placements_of_drawn_vertices_only() -> None:
    stray = np.vstack([CORNERS, [[100, 100, 100]]])
    placed = np.stack([np.eye(4), np.eye(4)])
    placed[1, :3, 3] = (10, 0, 0)
    scene = Scene("s", (Mesh("a", stray, TRIANGLES, placed), Mesh("dust", stray, np.zeros((0, 3)))))
    np.testing.assert_array_equal(scene.bounds, [[0, 0, -3], [11, np.float32(0.1), 0]])
    np.testing.assert_array_equal(Scene("empty", ()).bounds, np.zeros((2, 3)))
    unplaced = Mesh("a", CORNERS, TRIANGLES, np.zeros((0, 4, 4)))
    np.testing.assert_array_equal(Scene("unplaced", (unplaced,)).bounds, np.zeros((2, 3)))


@pytest.mark.parametrize("at_once", [1, 5, 8, 10_000])
def test_bounds_of_many_placements_are_those_of_all_expanded(
    monkeypatch: pytest.MonkeyPatch, at_once: int
) -> None:
    monkeypatch.setattr(scene_module, "EXPANDED_AT_ONCE", at_once)
    placements = np.tile(np.eye(4), (9, 1, 1))
    placements[:, :3, :] += np.sin(np.arange(9 * 12)).reshape(9, 3, 4)
    mesh = Mesh("many", CORNERS, TRIANGLES, placements)
    drawn = mesh.world_positions()[:, np.unique(TRIANGLES)].reshape(-1, 3)
    np.testing.assert_array_equal(Scene("s", (mesh,)).bounds, [drawn.min(axis=0), drawn.max(axis=0)])


def test_lights_as_homogeneous_points() -> None:
    sun = Light("sun", LightKind.DIRECTIONAL, (5.0, 5.0, 5.0), (0.0, -1.0, 0.0))
    np.testing.assert_array_equal(sun.homogeneous, [0, 1, 0, 0])
    np.testing.assert_array_equal(Light("l", LightKind.SPOT, (1.0, 2.0, 3.0)).homogeneous, [1, 2, 3, 1])
