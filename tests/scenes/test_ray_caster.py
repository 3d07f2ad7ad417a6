from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from scenes.ray_caster import RayCaster
from scenes.scene import Array, Light, LightKind, Mesh, Scene
from tests import tolerances

Bools = npt.NDArray[np.bool_]

BOX = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
BOX_TRIANGLES = np.array(
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
QUAD = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
QUAD_TRIANGLES = np.array([[0, 2, 1], [0, 3, 2]])
UP = np.array([0.0, 1.0, 0.0])


def placed(scale: float = 1.0, offset: float = 0.0) -> Array:
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = offset
    return matrix[None]


def box_over_floor(placement: Array, *, box_casts: bool = True) -> Scene:
    """A box of side 2, its underside at height 3, over a floor of side 40."""
    floor = Mesh("floor", 20 * QUAD, QUAD_TRIANGLES, placements=placement)
    box = Mesh("box", BOX + 4 * UP, BOX_TRIANGLES, placements=placement, casts=box_casts)
    return Scene("box over floor", (floor, box))


def spot(position: npt.ArrayLike) -> Light:
    return Light("light", LightKind.POINT, position=tuple(np.asarray(position, float)))


def sun(direction: npt.ArrayLike) -> Light:
    unit = np.asarray(direction, float) / np.linalg.norm(direction)
    return Light("sun", LightKind.DIRECTIONAL, direction=tuple(unit))


def lit_on_floor(scene: Scene, points: Array, light: Light) -> Bools:
    return RayCaster(scene).lit(points, np.broadcast_to(UP, points.shape), light)


PLACES = [(1e-3, 0.0), (1.0, 0.0), (1e3, 0.0), (1.0, 1e5), (1e-3, 10.0)]


@pytest.mark.parametrize(("scale", "offset"), PLACES)
def test_a_box_shadows_the_floor_up_to_the_edge_that_similar_triangles_give(
    scale: float, offset: float
) -> None:
    scene = box_over_floor(placed(scale, offset))
    light = spot(scale * np.array([0.0, 9, 0]) + offset)
    # From height 9, the upper face (height 5, half width 1) is cast to 9/4, and the lower one to less.
    edge = 9 / 4
    near = np.array([edge * (1 - tolerances.RAY_EDGE), edge * (1 + tolerances.RAY_EDGE)])
    points = np.zeros((8, 3))
    points[:4, 0] = [*near, *-near]
    points[4:, 2] = [*near, *-near]
    lit = lit_on_floor(scene, scale * points + offset, light)
    assert lit.tolist() == [False, True] * 4


@pytest.mark.parametrize(("scale", "offset"), PLACES)
def test_a_sun_casts_the_box_along_its_direction(scale: float, offset: float) -> None:
    scene = box_over_floor(placed(scale, offset))
    # At 45 degrees the box, between heights 3 and 5 and half a width of 1, covers 2 < x < 6.
    error = tolerances.RAY_EDGE
    points = np.zeros((4, 3))
    points[:, 0] = [2 - error, 2 + error, 6 - error, 6 + error]
    lit = lit_on_floor(scene, scale * points + offset, sun([1, -1, 0]))
    assert lit.tolist() == [True, False, False, True]


@pytest.mark.parametrize("winding", [QUAD_TRIANGLES, QUAD_TRIANGLES[:, ::-1]])
@pytest.mark.parametrize("light", [spot([0.1, 5, 0.2]), sun([0.1, -1, 0])])
def test_an_open_quad_casts_from_both_its_sides(winding: npt.NDArray[np.int64], light: Light) -> None:
    scene = Scene("quad", (Mesh("quad", QUAD + UP, winding),))
    points = np.array([[0.0, 0, 0], [3.0, 0, 0]])
    assert lit_on_floor(scene, points, light).tolist() == [False, True]


def test_what_stands_behind_the_light_casts_nothing() -> None:
    caster = RayCaster(box_over_floor(placed()))
    floor = np.array([[0.5, 0.0, 0.5]])
    assert caster.lit(floor, UP[None], spot([0, 2, 0])).tolist() == [True]
    assert caster.lit(floor, UP[None], spot([0, 2.999, 0])).tolist() == [True]
    assert caster.lit(floor, UP[None], spot([0, 3.001, 0])).tolist() == [False]


def test_a_light_in_the_plane_of_a_face_is_not_shadowed_by_it() -> None:
    # The shadow volume of a face is empty where the light lies in its plane.
    scene = Scene("ceiling", (Mesh("ceiling", 5 * QUAD + 3 * UP, QUAD_TRIANGLES),))
    points = np.array([[x, 0.0, z] for x in (-4.0, 0, 0.3) for z in (-2.0, 0, 1.7)])
    assert lit_on_floor(scene, points, spot([0.3, 3.0, 0.1])).all()


def test_two_sides_of_a_sheet_are_not_both_lit() -> None:
    scene = Scene("sheet", (Mesh("sheet", 5 * QUAD, QUAD_TRIANGLES),))
    points = np.array([[1.0, 0, 1], [1.0, 0, 1], [-2.0, 0, 3]])
    normals = np.array([UP, -UP, UP])
    assert RayCaster(scene).lit(points, normals, spot([0, 2, 0])).tolist() == [True, False, True]
    assert RayCaster(scene).lit(points, normals, sun([0, 1, 0.2])).tolist() == [False, True, False]


def test_only_casters_cast_and_a_scene_without_them_has_only_attached_shadows() -> None:
    glass = box_over_floor(placed(), box_casts=False)
    floor = np.zeros((1, 3))
    assert RayCaster(glass).lit(floor, UP[None], spot([0, 9, 0])).tolist() == [True]
    assert RayCaster(glass, casters_only=False).lit(floor, UP[None], spot([0, 9, 0])).tolist() == [False]
    empty = RayCaster(Scene("empty", ()))
    assert empty.extent == 0
    assert empty.lit(np.zeros((2, 3)), np.array([UP, -UP]), spot([0, 9, 0])).tolist() == [True, False]
    distance, triangle = empty.hits(np.zeros((1, 3)), UP[None])
    assert np.isinf(distance).all()
    assert triangle.tolist() == [-1]


def test_no_ray_slips_through_the_edge_between_two_triangles() -> None:
    # A fan around the point above; the rays are aimed at its spokes.
    angle = np.linspace(0, 2 * np.pi, 97)[:-1]
    rim = np.stack([np.cos(angle), np.full(96, 2.0), np.sin(angle)], axis=1)
    fan = np.stack([np.zeros(96, int), 1 + np.arange(96), 1 + (np.arange(96) + 1) % 96], axis=1)
    scene = Scene("fan", (Mesh("fan", np.concatenate([[2 * UP], rim]), fan),))
    on_spokes = rim * np.array([0.7, 1, 0.7])
    light = np.array([0.1, 7.0, -0.2])
    floor = light + (on_spokes - light) * (7 / 5)
    assert not lit_on_floor(scene, floor, spot(light)).any()


def test_points_off_their_surface_need_their_error_told() -> None:
    scene = box_over_floor(placed())
    x = np.linspace(6, 15, 500)
    sunken = np.stack([x, np.full(500, -1e-3), np.sin(x)], axis=1)
    normals = np.broadcast_to(UP, sunken.shape)
    caster, light = RayCaster(scene), spot([0, 9, 0])
    assert not caster.lit(sunken, normals, light).any()
    assert caster.lit(sunken, normals, light, position_error=2e-3).all()
    assert caster.lit(sunken, normals, light, position_error=np.full(500, 2e-3)).all()


def test_a_process_may_build_as_many_as_it_likes() -> None:
    # Embree dies silently at the 1024th device.
    scene = Scene("quad", (Mesh("quad", QUAD, QUAD_TRIANGLES),))
    casters = [RayCaster(scene) for _ in range(1100)]
    _, triangle = casters[-1].hits(np.array([[0.5, 1.0, 0]]), -UP[None])
    assert triangle.tolist() == [0]


def test_points_without_a_surface_are_refused() -> None:
    with pytest.raises(AssertionError):
        lit_on_floor(box_over_floor(placed()), np.full((1, 3), np.nan), spot([0, 9, 0]))


@pytest.mark.parametrize(("scale", "offset"), PLACES)
def test_the_nearest_triangle_is_found_at_its_distance(scale: float, offset: float) -> None:
    scene = box_over_floor(placed(scale, offset))
    caster = RayCaster(scene)
    origins = scale * np.array([[0.3, 9, 0.1], [5.0, 9, 5.0], [0.0, 9, 0], [0.3, 4, 0.1]]) + offset
    directions = np.array([-UP, -7 * UP, UP, -UP])
    distance, triangle = caster.hits(origins, directions)
    expected = scale * np.array([4, 9, np.inf, 1])
    np.testing.assert_allclose(distance, expected, rtol=tolerances.RAY_DISTANCE, atol=0)
    assert triangle[2] == -1
    heights = caster.corners(triangle[[0, 1, 3]])[:, :, 1]
    assert (heights == scale * np.array([[5.0], [0.0], [3.0]]) + offset).all()


def test_instances_are_numbered_after_one_another() -> None:
    placements = np.concatenate([placed(offset=o) for o in (0.0, 10.0, 20.0)])
    meshes = (Mesh("none", QUAD, QUAD_TRIANGLES[:0]), Mesh("many", QUAD, QUAD_TRIANGLES, placements))
    scene = Scene("instances", meshes)
    origins = np.array([[o + 0.5, o + 1, o - 0.5] for o in (0.0, 10, 20)])
    _, triangle = RayCaster(scene).hits(origins, np.tile(-UP, (3, 1)))
    assert triangle.tolist() == [0, 2, 4]


def random_scene(rng: np.random.Generator, scale: float, offset: float) -> Scene:
    """Boxes on a floor, an open sheet, loose triangles and degenerate ones; turned at random."""
    matrix = placed(scale, offset)[0]
    matrix[:3, :3] = scale * Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
    meshes = [Mesh("floor", 50 * QUAD, QUAD_TRIANGLES, matrix[None])]
    for _ in range(12):
        half = rng.uniform(0.3, 4, 3)
        turn = Rotation.from_euler("y", rng.uniform(0, 6)).as_matrix()
        centre = [rng.uniform(-30, 30), half[1], rng.uniform(-30, 30)]
        meshes.append(Mesh("box", (BOX * half) @ turn.T + centre, BOX_TRIANGLES, matrix[None]))
    soup = rng.uniform([-30, 0, -30], [30, 8, 30], (40, 1, 3)) + rng.normal(size=(40, 3, 3))
    soup[:5, 1] = soup[:5, 0]
    meshes.append(Mesh("soup", soup.reshape(-1, 3), np.arange(120).reshape(-1, 3), matrix[None]))
    return Scene("random", tuple(meshes))


def surface_points(rng: np.random.Generator, corners: Array, count: int) -> tuple[Array, Array]:
    edges = corners[:, 1:] - corners[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    area = np.linalg.norm(normals, axis=1)
    chosen = rng.choice(len(corners), count, p=np.sqrt(area) / np.sqrt(area).sum())
    weights = rng.dirichlet([1, 1, 1], count)
    side = rng.choice([-1, 1], count)[:, None]
    points = np.einsum("ij,ijk->ik", weights, corners[chosen])
    return points, side * normals[chosen] / area[chosen, None]


def lit_by_brute_force(corners: Array, points: Array, normals: Array, light: Light) -> Bools:
    """Cramer's rule for point + t * to_light = corner + u * first + v * second, all rays, all triangles."""
    toward, weight = light.homogeneous[:3], light.homogeneous[3]
    to_light = toward - weight * points
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(first, second)
    between = points[:, None] - corners[None, :, 0]
    crossed = np.cross(between, to_light[:, None])
    with np.errstate(divide="ignore", invalid="ignore"):
        determinant = -(to_light @ normal.T)
        u = np.einsum("ijk,jk->ij", crossed, second) / determinant
        v = -np.einsum("ijk,jk->ij", crossed, first) / determinant
        t = np.einsum("ijk,jk->ij", between, normal) / determinant
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & ((t < 1) | (weight == 0))
    return (np.einsum("ij,ij->i", normals, to_light) > 0) & ~hit.any(axis=1)


@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 2**31 - 1),
    place=st.sampled_from(PLACES),
    kind=st.sampled_from([LightKind.POINT, LightKind.DIRECTIONAL]),
)
def test_embree_agrees_with_brute_force_except_within_a_hair_of_an_edge(
    seed: int, place: tuple[float, float], kind: LightKind
) -> None:
    rng = np.random.default_rng(seed)
    scene = random_scene(rng, *place)
    scale, offset = place
    corners = np.concatenate([mesh.world_positions()[0][mesh.triangles] for mesh in scene.meshes])
    points, normals = surface_points(rng, corners, 1500)
    far = kind is LightKind.DIRECTIONAL
    light = sun(rng.normal(size=3)) if far else spot(offset + scale * rng.uniform(-15, 15, 3))
    caster = RayCaster(scene)
    found = caster.lit(points, normals, light)
    truth = lit_by_brute_force(corners, points + 1e-7 * caster.extent * normals, normals, light)
    wrong = np.flatnonzero(found != truth)
    assert len(wrong) <= tolerances.RAY_MISMATCH_SHARE * len(points)
    # Whoever disagrees must stand where a hair's breadth decides.
    jitter = rng.uniform(0, tolerances.RAY_HAIR * caster.extent, (len(wrong), 64, 1)) * normals[wrong, None]
    jitter += rng.normal(size=jitter.shape) * tolerances.RAY_HAIR * caster.extent
    around = (points[wrong, None] + jitter).reshape(-1, 3)
    verdicts = lit_by_brute_force(corners, around, np.repeat(normals[wrong], 64, axis=0), light)
    assert (verdicts.reshape(-1, 64) == found[wrong, None]).any(axis=1).all()


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**31 - 1))
def test_size_does_not_matter(seed: int) -> None:
    answers = []
    for scale in (2.0**-10, 1.0, 2.0**10):
        rng = np.random.default_rng(seed)
        scene = random_scene(rng, scale, 0.0)
        corners = np.concatenate([mesh.world_positions()[0][mesh.triangles] for mesh in scene.meshes])
        points, normals = surface_points(rng, corners, 1000)
        answers.append(RayCaster(scene).lit(points, normals, spot(scale * rng.uniform(-15, 15, 3))))
    assert (answers[0] == answers[1]).all()
    assert (answers[1] == answers[2]).all()
