from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.formats import registry
from scenes.ray_caster import RayCaster
from scenes.scene import Array, Camera, Light, LightKind, Mesh, Scene
from scenes.viewpoints import RULES, viewpoints
from tests import tolerances

LEVELS = Path(__file__).parents[2] / "../shared/levels"
CORNERS = np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)])
SIDES = np.array(
    [
        0,
        1,
        3,
        0,
        3,
        2,
        4,
        6,
        7,
        4,
        7,
        5,
        0,
        4,
        5,
        0,
        5,
        1,
        2,
        3,
        7,
        2,
        7,
        6,
        0,
        2,
        6,
        0,
        6,
        4,
        1,
        5,
        7,
        1,
        7,
        3,
    ]
).reshape(-1, 3)


def box(low: npt.ArrayLike, high: npt.ArrayLike) -> Mesh:
    low, high = np.asarray(low, float), np.asarray(high, float)
    return Mesh("box", low + CORNERS * (high - low), SIDES)


def floor(side: float = 40.0, height: float = 0.0) -> Mesh:
    corners = side * (CORNERS[[0, 1, 5, 4]] - [0.5, 0, 0.5]) + [0, height, 0]
    return Mesh("floor", corners, np.array([[0, 1, 2], [0, 2, 3]]))


def unit(vector: npt.ArrayLike) -> tuple[float, float, float]:
    x, y, z = np.asarray(vector, float) / np.linalg.norm(vector)
    return float(x), float(y), float(z)


def spot(position: tuple[float, float, float], direction: npt.ArrayLike, cone: float = 0.5) -> Light:
    return Light("spot", LightKind.SPOT, position, unit(direction), outer_cone_rad=cone)


def lamp(position: tuple[float, float, float], range_m: float = np.inf) -> Light:
    return Light("lamp", LightKind.POINT, position, range_m=range_m)


def sun(direction: npt.ArrayLike) -> Light:
    return Light("sun", LightKind.DIRECTIONAL, direction=unit(direction))


def looked_at(caster: RayCaster, cameras: tuple[Camera, ...]) -> tuple[Array, Array, Array]:
    """What lies in the middle of each picture: points, normals towards the eye, distances."""
    eyes = np.array([camera.position for camera in cameras])
    forward = np.array([camera.forward for camera in cameras])
    distance, triangle = caster.hits(eyes, forward)
    assert (triangle >= 0).all(), "a viewpoint looks at nothing"
    corners = caster.corners(triangle)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    normals *= -np.sign(np.einsum("ij,ij->i", normals, forward))[:, None]
    return eyes + distance[:, None] * forward, normals, distance


def check(scene: Scene, light: Light, cameras: tuple[Camera, ...]) -> None:
    """Everything that every viewpoint promises."""
    assert tuple(camera.name for camera in cameras) == RULES
    caster = RayCaster(scene, casters_only=False)
    points, normals, distances = looked_at(caster, cameras)
    lit = RayCaster(scene).lit(points, normals, light, position_error=tolerances.RAY_HAIR * caster.extent)
    assert lit.all(), "a viewpoint looks at a shadow"
    same_place = np.linalg.norm(points - points[0], axis=1)
    assert (same_place <= tolerances.VIEWED * caster.extent).all()
    if light.kind is not LightKind.DIRECTIONAL:
        ray = points - np.array(light.position)
        assert (np.linalg.norm(ray, axis=1) <= light.range_m * (1 + tolerances.VIEWED)).all()
        if light.kind is LightKind.SPOT:
            along = ray @ np.array(light.direction) / np.linalg.norm(ray, axis=1)
            assert (along > np.cos(light.outer_cone_rad)).all()
    for camera, distance in zip(cameras, distances, strict=True):
        forward, up = np.array(camera.forward), np.array(camera.up)
        assert np.abs([forward @ forward - 1, up @ up - 1, forward @ up]).max() < tolerances.UNIT
        assert up[1] >= 0
        assert 0 < camera.near_m <= 0.0101 * distance
        beyond = np.maximum(scene.bounds[0] - camera.position, camera.position - scene.bounds[1])
        assert beyond.max() <= 0.1 * caster.extent
    assert viewpoints(scene, light) == cameras


BOXES = st.lists(
    st.tuples(st.floats(-15, 15), st.floats(0, 3), st.floats(-15, 15), st.floats(0.2, 4), st.floats(0.2, 4)),
    max_size=8,
)
DIRECTIONS = st.tuples(st.floats(-1, 1), st.floats(-1, -0.1), st.floats(-1, 1))


def boxes(places: list[tuple[float, float, float, float, float]]) -> tuple[Mesh, ...]:
    return tuple(box([x, y, z], [x + a, y + b, z + a]) for x, y, z, a, b in places)


def inside_any(meshes: tuple[Mesh, ...], point: tuple[float, float, float], margin: float = 0.0) -> bool:
    bounds = [(mesh.positions.min(axis=0) - margin, mesh.positions.max(axis=0) + margin) for mesh in meshes]
    return any(((low < point) & (point < high)).all() for low, high in bounds)


@settings(max_examples=60, deadline=None)
@given(
    places=BOXES,
    kind=st.sampled_from(list(LightKind)),
    position=st.tuples(st.floats(-18, 18), st.floats(0.5, 12), st.floats(-18, 18)),
    direction=DIRECTIONS,
    cone=st.floats(0.05, 1.4),
)
def test_among_boxes_every_eye_is_outside_them_and_sees_light(
    places: list[tuple[float, float, float, float, float]],
    kind: LightKind,
    position: tuple[float, float, float],
    direction: tuple[float, float, float],
    cone: float,
) -> None:
    solid = boxes(places)
    scene = Scene("yard", (floor(200.0), *solid))
    light = replace(spot(position, direction, cone), kind=kind)
    if kind is not LightKind.DIRECTIONAL and inside_any(solid, position, margin=0.01):
        return
    cameras = viewpoints(scene, light)
    check(scene, light, cameras)
    for camera in cameras:
        assert not inside_any(solid, camera.position), camera.name
        x, y, z = camera.position
        assert y > 0 or max(abs(x), abs(z)) > 100


@settings(max_examples=40, deadline=None)
@given(
    size=st.tuples(st.floats(2, 30), st.floats(2, 8), st.floats(2, 30)),
    at=st.tuples(st.floats(0.05, 0.95), st.floats(0.05, 0.95), st.floats(0.05, 0.95)),
    direction=st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)),
    scale=st.sampled_from([1e-3, 1.0, 1e3]),
    kind=st.sampled_from([LightKind.SPOT, LightKind.POINT]),
)
def test_in_a_closed_room_every_eye_stays_inside(
    size: tuple[float, float, float],
    at: tuple[float, float, float],
    direction: tuple[float, float, float],
    scale: float,
    kind: LightKind,
) -> None:
    if np.linalg.norm(direction) < 0.1:
        return
    walls = scale * np.array(size)
    x, y, z = (float(value) for value in walls * at)
    scene = Scene("room", (box([0, 0, 0], walls),))
    light = replace(spot((x, y, z), direction), kind=kind)
    cameras = viewpoints(scene, light)
    check(scene, light, cameras)
    for camera in cameras:
        assert inside_any(scene.meshes, camera.position), camera.name


def test_a_lamp_is_judged_on_the_floor_below_it() -> None:
    scene = Scene("room", (box([0, 0, 0], [6, 3, 8]),))
    cameras = viewpoints(scene, lamp((2.0, 2.5, 5.0)))
    points, _, _ = looked_at(RayCaster(scene), cameras)
    np.testing.assert_allclose(points, np.tile([2.0, 0, 5.0], (4, 1)), atol=tolerances.VIEWED * 10)


def test_a_lamps_own_shade_is_looked_past() -> None:
    shade = box([1.9, 2.4, 4.9], [2.1, 2.45, 5.1])
    scene = Scene("hall", (box([0, 0, 0], [6, 9, 8]), shade))
    light = lamp((2.0, 2.5, 5.0))
    points, _, _ = looked_at(RayCaster(scene), viewpoints(scene, light))
    assert np.linalg.norm(points - light.position, axis=1).min() > 1


def test_the_rules_keep_their_names() -> None:
    scene = Scene("yard", (floor(), box([-1, 0, -1], [1, 3, 1])))
    light = sun([1, -1, 0])
    shoulder, facing, side, overview = (np.array(camera.forward) for camera in viewpoints(scene, light))
    shines = np.array([1.0, 0, 0])
    assert shoulder @ shines > 0.8
    assert facing @ shines < -0.8
    assert abs(side @ shines) < 0.1
    assert overview[1] == pytest.approx(-np.sqrt(0.5), abs=tolerances.VIEWED)


@pytest.mark.parametrize(
    ("scale", "expected"),
    # In other units than metres: 10 % and 1 % of the diagonal.
    [(1.0, 1.6), (5.0, 1.6), (0.25, 1.6), (1e-3, 4.543e-3), (100.0, 45.43)],
)
def test_the_eye_is_a_mans_height_over_the_floor_where_the_scene_has_a_mans_size(
    scale: float, expected: float
) -> None:
    scene = Scene("room", (box([0, 0, 0], scale * np.array([20, 8, 40])),))
    light = lamp((scale * 10, scale * 3, scale * 20))
    for camera in viewpoints(scene, light)[1:3]:
        assert camera.position[1] == pytest.approx(expected, rel=tolerances.EYE_HEIGHT)


def test_the_eye_stays_under_a_low_ceiling() -> None:
    scene = Scene("crawl space", (box([0, 0, 0], [20, 1, 40]),))
    for camera in viewpoints(scene, lamp((10.0, 0.5, 20.0))):
        assert camera.position[1] <= 0.91
    assert viewpoints(scene, lamp((10.0, 0.5, 20.0)))[1].position[1] == pytest.approx(0.9, abs=1e-3)


def test_who_looks_at_a_lit_wall_stands_on_the_floor() -> None:
    scene = Scene("room", (box([0, 0, 0], [12, 5, 16]),))
    cameras = viewpoints(scene, spot((6, 2.5, 8), (1, 0, 0)))
    points, normals, _ = looked_at(RayCaster(scene), cameras)
    assert np.abs(normals[:, 0]).min() > 0.99
    for camera in cameras[1:3]:
        assert camera.position[1] == pytest.approx(1.6, rel=tolerances.EYE_HEIGHT)
    assert cameras[3].position[1] > points[3, 1] + 1
    assert cameras[3].forward[1] < -0.1


@pytest.mark.parametrize("light", [sun([1, -1, 0.3]), lamp((0, 4, 3)), spot((-2, 5, 3), (0.3, -1, 0))])
def test_an_overview_is_higher_than_who_stands(light: Light) -> None:
    scene = Scene("yard", (floor(), box([-1, 0, -1], [1, 3, 1])))
    _, facing, side, overview = viewpoints(scene, light)
    assert overview.position[1] > 1.5 * max(facing.position[1], side.position[1])
    assert overview.forward[1] < min(facing.forward[1], side.forward[1])


def test_eyes_keep_above_steps() -> None:
    steps = tuple(box([0, 0, -step - 1], [6, 0.2 * step, -step]) for step in range(1, 9))
    scene = Scene("stairs", (box([-2, -1, -12], [8, 8, 6]), *steps))
    for camera in viewpoints(scene, lamp((3.0, 5.0, -4.5)))[1:3]:
        down, _ = RayCaster(scene).hits(np.array([camera.position]), np.array([[0.0, -1.0, 0.0]]))
        assert down[0] == pytest.approx(1.6, rel=tolerances.EYE_HEIGHT)


@pytest.mark.parametrize("light", [spot((1, 5, 1), (0, -1, 0)), sun([0, -1, 0]), lamp((1, 5, 1))])
def test_a_light_straight_above_is_seen_from_four_places(light: Light) -> None:
    scene = Scene("yard", (floor(), box([-3, 0, -3], [-1, 3, -1])))
    cameras = viewpoints(scene, light)
    check(scene, light, cameras)
    assert len({camera.position for camera in cameras}) == 4


def test_a_light_that_lies_on_a_surface_is_judged_where_it_shines() -> None:
    scene = Scene("room", (box([0, 0, 0], [6, 3, 8]),))
    for light in (lamp((2.0, 3.0, 5.0)), spot((2, 3, 5), (0.1, -1, 0))):
        points, _, _ = looked_at(RayCaster(scene), viewpoints(scene, light))
        assert np.abs(points[:, 1]).max() < tolerances.VIEWED * 10


def test_what_no_ray_of_the_fan_meets_is_found_by_its_triangles() -> None:
    speck = Mesh("speck", np.array([[30.0, -20, 0], [30.01, -20, 0], [30, -20, 0.01]]), np.array([[0, 2, 1]]))
    far = Mesh("far", np.array([[0.0, 50, 0], [1, 50, 0], [0, 50, 1]]), np.array([[0, 1, 2]]))
    scene = Scene("specks", (speck, far))
    light = spot((0, 0, 0), (1, -1, 0), 0.7)
    check(scene, light, viewpoints(scene, light))


@pytest.mark.parametrize(
    ("scene", "light"),
    [
        (Scene("nothing", ()), lamp((0, 1, 0))),
        (Scene("no triangles", (Mesh("m", CORNERS, SIDES[:0]),)), sun([0, -1, 0])),
        (Scene("a point", (Mesh("m", np.ones((3, 3)), np.array([[0, 1, 2]])),)), sun([0, -1, 0])),
        (Scene("a line", (Mesh("m", CORNERS[[0, 1, 0]], np.array([[0, 1, 2]])),)), sun([0, -1, 0])),
        (Scene("floor", (floor(),)), spot((0, 3, 0), (0, 1, 0))),
        (Scene("floor", (floor(),)), lamp((0, 3, 0), range_m=2.9)),
        (Scene("floor", (floor(),)), spot((900, 3, 0), (1, 0, 0), 0.2)),
    ],
)
def test_where_a_light_strikes_nothing_there_is_nothing_to_see(scene: Scene, light: Light) -> None:
    assert viewpoints(scene, light) == ()


@pytest.mark.parametrize(
    ("scene", "light"),
    [
        (Scene("a triangle", (Mesh("m", CORNERS[[0, 1, 5]], np.array([[0, 1, 2]])),)), lamp((0.3, 0.4, 2.0))),
        (Scene("a triangle", (Mesh("m", CORNERS[[0, 1, 5]], np.array([[0, 1, 2]])),)), sun([0.1, -0.3, -1])),
        (Scene("a wall", (box([-5, 0, -1], [5, 4, 0]),)), lamp((0.0, 2.0, 4.0))),
        (Scene("a box with its lamp", (box([0, 0, 0], [4, 3, 5]),), (lamp((1, 2, 1)),)), lamp((1, 2, 1))),
        (Scene("a far lamp", (floor(),)), spot((0, 900, 0), (0, -1, 0), 0.01)),
    ],
    ids=lambda value: value.name,
)
def test_odd_scenes_have_views_as_well(scene: Scene, light: Light) -> None:
    cameras = viewpoints(scene, light)
    check(scene, light, cameras)


def test_a_caster_that_is_handed_in_changes_nothing() -> None:
    glass = replace(box([-3, 2, -3], [3, 2.1, 3]), casts=False)
    scene = Scene("yard", (floor(), glass))
    light = lamp((0.5, 4, 0.2))
    assert viewpoints(scene, light) == viewpoints(scene, light, RayCaster(scene, casters_only=False))


def test_a_real_level_without_cameras_gets_viewpoints_for_its_lights() -> None:
    path = LEVELS / "quake" / "e1m1.glb"
    if not path.exists():
        pytest.skip("the sample levels are not here")
    scene = registry.read_level(path).scene
    for light in scene.lights[::12]:
        check(scene, light, viewpoints(scene, light))
