"""What is inside a level: rooms, walls, voids, pools and open ground."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from scenes.playable_space import PlayableSpace
from scenes.ray_caster import RayCaster
from scenes.scene import Camera, Light, LightKind, Mesh, Scene
from scenes.viewpoints import viewpoints
from tests.solids import box, floor

UP = np.array([[0.0, 1.0, 0.0]])
SUN = Light("Sun", LightKind.DIRECTIONAL, direction=(0.0, -1.0, 0.0))


def lamp(x: float, y: float, z: float) -> Light:
    return Light("Lamp", LightKind.POINT, (x, y, z))


def slab(low: npt.ArrayLike, high: npt.ArrayLike, *, casts: bool = True) -> Mesh:
    low, high = np.asarray(low, float), np.asarray(high, float)
    return box((low + high) / 2, (high - low) / 2, casts=casts)


def walled(x: float = 0.0, *, roof: bool = True, roof_casts: bool = True) -> tuple[Mesh, ...]:
    """A room of 8 x 4 x 8 m, of walls 1 m thick, as editors for shooters build them."""
    walls = (
        slab((x - 1, -1, -1), (x + 9, 0, 9)),
        slab((x - 1, 0, -1), (x, 4, 9)),
        slab((x + 8, 0, -1), (x + 9, 4, 9)),
        slab((x, 0, -1), (x + 8, 4, 0)),
        slab((x, 0, 8), (x + 8, 4, 9)),
    )
    return (*walls, slab((x - 1, 4, -1), (x + 9, 5, 9), casts=roof_casts)) if roof else walls


def space(scene: Scene) -> PlayableSpace:
    return PlayableSpace.of(scene, RayCaster(scene, casters_only=False))


def holds(scene: Scene, x: float, y: float, z: float) -> bool:
    return bool(space(scene).holds(np.array([[x, y, z]]), UP)[0])


def test_a_room_is_inside_and_its_roof_is_not() -> None:
    scene = Scene("room", walled(), (lamp(2, 3, 2), lamp(5, 2, 5)))
    assert space(scene).sealed
    assert space(scene).wound_well
    assert holds(scene, 4, 0, 4)
    assert not holds(scene, 4, 5, 4)


def test_without_a_roof_nothing_is_outside() -> None:
    scene = Scene("yard", walled(roof=False), (lamp(2, 3, 2), lamp(5, 2, 5)))
    assert not space(scene).sealed
    assert holds(scene, 4, 0, 4)
    assert holds(scene, -0.5, 4, 4)


def test_without_lamps_and_cameras_nothing_is_known() -> None:
    scene = Scene("room", walled())
    found = space(scene)
    assert not found.sealed
    assert not found.wound_well
    assert holds(scene, 4, 5, 4)


def test_the_lamp_outside_does_not_decide() -> None:
    scene = Scene("room", walled(), (lamp(2, 3, 2), lamp(5, 2, 5), lamp(4, 9, 4)))
    assert space(scene).sealed
    assert viewpoints(scene, scene.lights[2]) == ()
    assert len(viewpoints(scene, scene.lights[0])) == 4


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_lamp_in_a_wall_has_no_views(mirrored: bool) -> None:  # noqa: FBT001
    flip = np.diag([-1.0, 1.0, 1.0, 1.0])[None] if mirrored else np.eye(4)[None]
    # A slab in the wall as well: faces are seen from their front there too.
    meshes = (*walled(), slab((8.2, 0.5, 3), (8.3, 1.5, 5)))
    lights = (lamp(2, 3, 2), lamp(5, 2, 5), lamp(8.5, 2, 4))
    side = -1.0 if mirrored else 1.0
    scene = Scene(
        "room",
        tuple(replace(mesh, placements=flip) for mesh in meshes),
        tuple(replace(one, position=(side * one.position[0], *one.position[1:])) for one in lights),
    )
    assert space(scene).wound_well
    assert viewpoints(scene, scene.lights[2]) == ()
    assert len(viewpoints(scene, scene.lights[0])) == 4


def test_a_lamp_on_a_wall_is_judged_in_the_room() -> None:
    scene = Scene("room", walled(), (lamp(2, 3, 2), lamp(5, 2, 5), lamp(8.0, 2, 4)))
    cameras = viewpoints(scene, scene.lights[2])
    assert len(cameras) == 4
    for camera in cameras:
        assert min(camera.position) > 0
        assert max(camera.position[0], camera.position[2]) < 8


def test_a_closed_shell_with_all_of_the_level_in_it_is_a_room() -> None:
    scene = Scene("shell", (box((0, 2, 0), (5, 2, 5)),), (lamp(1, 3, 1), lamp(-2, 3, 1)))
    assert not space(scene).wound_well
    assert all(len(viewpoints(scene, light)) == 4 for light in scene.lights)


def test_water_has_no_back() -> None:
    water = slab((0, 0, 0), (8, 2, 8), casts=False)
    scene = Scene("pool", (*walled(), water), (lamp(2, 3, 2), lamp(5, 3, 5), lamp(4, 1, 4)))
    cameras = viewpoints(scene, scene.lights[2])
    assert len(cameras) == 4
    assert all(0 < camera.position[1] < 4 for camera in cameras)


def test_a_sun_shines_through_a_sky_that_casts_nothing() -> None:
    scene = Scene("court", walled(roof_casts=False), (lamp(2, 3, 2), SUN))
    cameras = viewpoints(scene, SUN)
    assert len(cameras) == 4
    for camera in cameras:
        assert min(camera.position) > 0
        assert max(camera.position) < 8
        assert camera.position[1] < 4


def test_a_sun_over_a_closed_level_lights_nothing_that_is_seen() -> None:
    scene = Scene("closed", walled(), (lamp(2, 3, 2), SUN))
    assert viewpoints(scene, SUN) == ()


def test_a_closed_gap_between_rooms_is_no_room() -> None:
    """Two rooms, a gap of 4 m between them, closed by sheets, and over it a sky where a sun shines."""
    gap = (
        slab((9, -1, -1), (13, 0, 9)),
        slab((9, 0, -1), (13, 4, 0)),
        slab((9, 0, 8), (13, 4, 9)),
        slab((9, 4, -1), (13, 5, 9), casts=False),
    )
    lights = (lamp(2, 3, 2), lamp(16, 3, 2), SUN)
    scene = Scene("two", (*walled(), *walled(14.0), *gap), lights)
    found = space(scene)
    places = np.array([[11.0, 0, 4], [4, 0, 4], [18, 0, 4]])
    normals = np.repeat(UP, 3, axis=0)
    assert found.sealed
    assert found.joins(places, normals).tolist() == [False, True, True]
    assert viewpoints(scene, SUN) == ()
    # Whoever starts there makes it a part of the level.
    camera = Camera("Start", (11.0, 1.6, 2.0))
    assert len(viewpoints(replace(scene, cameras=(camera,)), SUN)) == 4


def test_round_a_corner_is_in_the_same_level() -> None:
    """An L: the lamp is in one arm, the place in the other, and what it sees sees the lamp."""
    meshes = (
        slab((-1, -1, -1), (13, 0, 13)),
        slab((-1, 4, -1), (13, 5, 13)),
        slab((-1, 0, -1), (0, 4, 13)),
        slab((12, 0, -1), (13, 4, 3)),
        slab((0, 0, -1), (12, 4, 0)),
        slab((3, 0, 3), (13, 4, 13)),
        slab((0, 0, 12), (3, 4, 13)),
    )
    scene = Scene("corner", meshes, (lamp(11, 3, 1.5), lamp(10, 2, 2)))
    found = space(scene)
    assert found.sealed
    assert found.joins(np.array([[1.5, 0.0, 10.0]]), UP).all()


def test_an_empty_scene_and_no_places() -> None:
    empty = Scene("nothing", (), (lamp(0, 1, 0),))
    assert holds(empty, 0, 0, 0)
    scene = Scene("room", walled(), (lamp(2, 3, 2),))
    none = np.zeros((0, 3))
    assert space(scene).holds(none, none).shape == (0,)
    assert space(scene).joins(none, none).shape == (0,)


def test_below_open_ground_the_underside_is_seen() -> None:
    scene = Scene("sheet", (floor(20.0),), (lamp(0, 3, 0), lamp(0, -3, 0)))
    assert all(camera.position[1] < 0 for camera in viewpoints(scene, scene.lights[1]))
    assert all(camera.position[1] > 0 for camera in viewpoints(scene, scene.lights[0]))
