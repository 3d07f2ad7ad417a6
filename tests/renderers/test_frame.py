from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from renderers.context import Gpu
from renderers.frame import Frame
from scenes.frusta import camera_view
from scenes.ray_caster import RayCaster
from scenes.scene import Array, Camera, Light, LightKind, Scene
from tests import tolerances
from tests.gl_state import live_objects
from tests.oracle import incidence
from tests.random_scenes import CLASSES, look_at, random_camera, random_light, random_scene
from tests.rendering import framed
from tests.solids import axes_beside, box, floor, moved, placed, plane

SIZE = (96, 64)
KINDS = list(LightKind)
SUN = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1.0, 0.0))


def rolled(camera: Camera, angle: float) -> Camera:
    return replace(camera, up=tuple(Rotation.from_rotvec(angle * np.array(camera.forward)).apply(camera.up)))


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 10**6),
    st.sampled_from([1e-3, 1.0, 1e3]),
    st.sampled_from([0.0, 1e4]),
    st.floats(0.2, 2.4),
    st.floats(-3, 3),
)
def test_positions_from_depth_lie_on_the_plane_that_is_seen(
    gpu: Gpu, seed: int, scale: float, offset: float, yfov: float, roll: float
) -> None:
    random = np.random.default_rng(seed)
    normal = random.normal(size=3)
    normal /= np.linalg.norm(normal)
    middle = scale * np.array([offset, -offset, 2 * offset])
    mesh = moved(plane(normal, 5 * scale, cells=2), placed(offset=middle))
    across = axes_beside(normal)[0]
    eye = middle + scale * (random.uniform(1, 4) * normal + random.uniform(0, 2) * across)
    camera = rolled(look_at(eye, middle, yfov_rad=yfov, near_m=0.1 * scale), roll)
    with framed(gpu, Scene("plane", (mesh,)), SUN, camera, SIZE) as frame:
        seen = frame.read_surfaces()
    on_plane = seen.positions[seen.covered]
    assert len(on_plane)
    distances = np.linalg.norm(on_plane - eye, axis=1)
    # The plane itself is stored in float32, about its middle.
    bound = tolerances.DEPTH_POSITION * (5 * scale + distances)
    assert (np.abs((on_plane - middle) @ normal) <= bound).all()
    assert np.linalg.norm(seen.normals[seen.covered] - normal, axis=1).max() <= tolerances.PACKED_NORMAL


def test_positions_project_back_to_the_middle_of_their_pixels(gpu: Gpu) -> None:
    camera = rolled(look_at((3, 2, 5), (0, 0, 0)), 0.4)
    with framed(gpu, Scene("floor", (floor(50.0),)), SUN, camera, SIZE) as frame:
        seen = frame.read_surfaces()
    rows, columns = np.nonzero(seen.covered)
    eye = seen.positions[rows, columns] @ camera_view(camera)[:3, :3].T + camera_view(camera)[:3, 3]
    half = np.tan(camera.yfov_rad / 2)
    x = (eye[:, 0] / -eye[:, 2] / half / (SIZE[0] / SIZE[1]) + 1) / 2 * SIZE[0]
    y = (1 - eye[:, 1] / -eye[:, 2] / half) / 2 * SIZE[1]
    assert np.abs(x - columns - 0.5).max() <= tolerances.PIXEL_MIDDLE
    assert np.abs(y - rows - 0.5).max() <= tolerances.PIXEL_MIDDLE


@pytest.mark.parametrize("geometry", CLASSES)
def test_every_pixel_shows_the_face_that_its_ray_strikes(gpu: Gpu, geometry: str) -> None:
    # The camera stands among the casters, so that whole clusters of faces are left out of the draw.
    scene, camera = random_scene(geometry, 5), look_at((1, 1.5, 1), (-4, 0.5, -2), yfov_rad=0.7)
    with framed(gpu, scene, SUN, camera, SIZE) as frame:
        seen = frame.read_surfaces()
    offsets = np.stack(np.meshgrid(*(2 * (np.arange(n) + 0.5) / n - 1 for n in SIZE)), axis=-1).reshape(-1, 2)
    half = np.tan(camera.yfov_rad / 2) * np.array([SIZE[0] / SIZE[1], -1.0])
    right, up, forward = np.cross(camera.forward, camera.up), np.array(camera.up), np.array(camera.forward)
    directions = forward + offsets[:, :1] * half[0] * right + offsets[:, 1:] * half[1] * up
    rays = RayCaster(scene, casters_only=False)
    start = np.asarray(camera.position) + camera.near_m * directions
    distance, triangle = rays.hits(start, directions)
    struck = triangle >= 0
    depth = camera.near_m + distance / np.linalg.norm(directions, axis=1)
    corners = rays.corners(triangle[struck])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[np.einsum("ij,ij->i", normals, directions[struck]) > 0] *= -1
    found = seen.normals.reshape(-1, 3)[struck]
    view_depth = (seen.positions.reshape(-1, 3)[struck] - camera.position) @ forward
    same = np.linalg.norm(found - normals, axis=1) <= tolerances.PACKED_NORMAL
    same &= np.abs(view_depth - depth[struck]) <= tolerances.RAY_DISTANCE * rays.extent
    # Along outlines the rasteriser's snapped edges may show the neighbour.
    assert (~same).sum() + (struck != seen.covered.ravel()).sum() <= tolerances.OUTLINE_SHARE * len(offsets)


def test_each_face_has_its_own_color(gpu: Gpu) -> None:
    colors = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    meshes = tuple(
        replace(moved(floor(1.0, cells=9), placed(offset=(3.0 * i - 3, 0, 0))), base_color=color)
        for i, color in enumerate(colors)
    )
    camera = look_at((0, 9, 0.01), (0, 0, 0))
    with framed(gpu, Scene("tiles", meshes), SUN, camera, SIZE) as frame:
        frame.write_mask(np.ones(SIZE[::-1], bool))
        frame.shade()
        picture, seen = frame.read_picture(), frame.read_surfaces()
    tile = np.round(seen.positions[seen.covered][:, 0] / 3 + 1).astype(int)
    assert set(tile) == {0, 1, 2}
    assert (picture[seen.covered].argmax(axis=1) == tile).all()


def overhead(height: float = 8.0) -> Camera:
    """Looks straight down at the middle of the floor."""
    return look_at((0, height, 0), (0, 0, 0))


def domain_on_floor(gpu: Gpu, light: Light, camera: Camera) -> tuple[Array, Array]:
    """Distance from the middle, and whether a technique has to answer, of pixels of a large floor."""
    with framed(gpu, Scene("floor", (floor(20.0),)), light, camera, (160, 120)) as frame:
        seen, domain = frame.read_surfaces(), frame.read_domain()
    assert seen.covered.all()
    return np.hypot(seen.positions[..., 0], seen.positions[..., 2]), domain


def assert_disc(distance: Array, domain: Array, radius: float) -> None:
    hair = tolerances.DOMAIN_EDGE * radius
    assert domain[distance < radius - hair].all()
    assert not domain[distance > radius + hair].any()
    assert domain.any()
    assert not domain.all()


@pytest.mark.parametrize("outer", [0.2, 0.6, 1.0])
def test_a_spot_lights_a_disc_as_wide_as_its_cone(gpu: Gpu, outer: float) -> None:
    spot = Light("spot", LightKind.SPOT, (0.0, 2.0, 0.0), (0.0, -1, 0), outer_cone_rad=outer)
    assert_disc(*domain_on_floor(gpu, spot, overhead()), 2 * np.tan(outer))


@pytest.mark.parametrize("kind", [LightKind.POINT, LightKind.SPOT])
def test_a_range_ends_in_a_disc(gpu: Gpu, kind: LightKind) -> None:
    lamp = Light("lamp", kind, (0.0, 1.5, 0.0), (0.0, -1, 0), outer_cone_rad=float(np.pi / 2), range_m=2.5)
    assert_disc(*domain_on_floor(gpu, lamp, overhead()), 2.0)


def test_a_right_angle_spot_lights_all_that_is_ahead_of_it(gpu: Gpu) -> None:
    spot = Light("spot", LightKind.SPOT, (0.5, 1, 0), (1.0, 0, 0), outer_cone_rad=float(np.pi / 2))
    with framed(gpu, Scene("floor", (floor(20.0),)), spot, overhead(), SIZE) as frame:
        seen, domain = frame.read_surfaces(), frame.read_domain()
    ahead = seen.positions[..., 0] - 0.5
    assert domain[ahead > 1e-3].all()
    assert not domain[ahead < -1e-3].any()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("side", [1, -1])
def test_only_the_side_that_is_seen_counts(gpu: Gpu, kind: LightKind, side: int) -> None:
    # The normal faces the eye whatever the winding, so the domain is there only with the light on that side.
    sheet = Scene("sheet", (plane((0, side, 0), 3.0),))
    above = Light("above", kind, (0.0, 5.0, 0.0), (0.0, -1, 0))
    below = replace(above, position=(0.0, -5.0, 0.0), direction=(0.0, 1, 0))
    for light, whole in ((above, True), (below, False)):
        with framed(gpu, sheet, light, overhead(2.0), SIZE) as frame:
            assert frame.read_surfaces().covered.all()
            assert (frame.read_domain() == whole).all()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_the_domain_is_what_its_definition_says(gpu: Gpu, kind: LightKind, seed: int) -> None:
    scene, light = random_scene("closed boxes", seed), random_light(kind, seed)
    with framed(gpu, scene, light, random_camera(seed), (160, 120)) as frame:
        seen, domain = frame.read_surfaces(), frame.read_domain()
    to_light = light.homogeneous[:3] - light.homogeneous[3] * seen.positions
    distance = np.linalg.norm(to_light, axis=-1)
    expected = seen.covered & (np.einsum("ijk,ijk->ij", seen.normals, to_light) > 0)
    clear = incidence(seen, light) > tolerances.DOMAIN_EDGE
    if kind is not LightKind.DIRECTIONAL:
        expected &= distance <= light.range_m
        clear &= np.abs(distance - light.range_m) > tolerances.DOMAIN_EDGE * distance
    if kind is LightKind.SPOT:
        cosine = -to_light @ np.array(light.direction) / distance
        expected &= cosine >= np.cos(light.outer_cone_rad)
        clear &= np.abs(cosine - np.cos(light.outer_cone_rad)) > tolerances.DOMAIN_EDGE
    assert (domain == expected)[clear].all()
    assert clear.mean() > 0.9
    assert domain.any()


def test_where_nothing_is_seen_there_is_nothing_to_answer(gpu: Gpu) -> None:
    away = look_at((0, 2, 0), (0, 9, 0.1))
    with framed(gpu, Scene("floor", (floor(3.0),)), SUN, away, SIZE) as frame:
        assert not frame.read_surfaces().covered.any()
        assert not frame.read_domain().any()


def test_a_mask_that_is_written_is_read_back_in_the_domain_top_row_first(gpu: Gpu) -> None:
    lit = np.random.default_rng(1).random(SIZE[::-1]) < 0.5
    with framed(gpu, Scene("floor", (floor(3.0),)), SUN, overhead(), SIZE) as frame:
        frame.write_mask(lit)
        domain = frame.read_domain()
        assert domain.any()
        assert np.array_equal(frame.read_mask() == 1, lit & domain)


def test_the_picture_is_brighter_where_the_mask_is_lit(gpu: Gpu) -> None:
    lit = np.zeros(SIZE[::-1], bool)
    lit[:, : SIZE[0] // 2] = True
    with framed(gpu, Scene("floor", (floor(30.0),)), SUN, overhead(), SIZE) as frame:
        frame.write_mask(lit)
        frame.shade()
        picture = frame.read_picture().astype(int).sum(axis=2)
    assert picture[lit].min() > 1.5 * picture[~lit].max()
    assert picture[~lit].min() > 0


def test_an_upright_picture_shows_what_is_above_above(gpu: Gpu) -> None:
    scene = Scene("box", (box((-2, 2, 0), (0.5, 0.5, 0.5)),))
    with framed(gpu, scene, SUN, look_at((0, 0, 8), (0, 0, 0)), SIZE) as frame:
        rows, columns = np.nonzero(frame.read_surfaces().covered)
    assert rows.max() < SIZE[1] / 2
    assert columns.max() < SIZE[0] / 2


@pytest.mark.parametrize("kind", KINDS)
def test_one_frame_may_look_and_shine_again(gpu: Gpu, kind: LightKind) -> None:
    scene = random_scene("closed boxes", 2)
    with framed(gpu, scene, random_light(kind, 2), random_camera(2), SIZE) as fresh:
        expected = fresh.read_domain(), fresh.read_surfaces().positions
    with framed(gpu, scene, SUN, overhead(), SIZE) as frame:
        frame.look(random_camera(2))
        frame.shine(random_light(kind, 2))
        frame.draw_surfaces()
        frame.draw_domain()
        assert np.array_equal(frame.read_domain(), expected[0])
        assert np.array_equal(frame.read_surfaces().positions, expected[1])


def test_the_window_holds_every_pixel_of_the_domain(gpu: Gpu) -> None:
    for seed in range(12):
        for kind in KINDS:
            light = replace(random_light(kind, seed), inner_cone_rad=0.1, outer_cone_rad=0.15, range_m=5.0)
            with framed(gpu, random_scene("fans", seed), light, random_camera(seed), SIZE) as frame:
                assert inside(frame)


def inside(frame: Frame) -> bool:
    """Whether the window holds all pixels that a float64 test of reach finds."""
    seen, light = frame.read_surfaces(), frame.light
    to_light = light.homogeneous[:3] - light.homogeneous[3] * seen.positions
    distance = np.linalg.norm(to_light, axis=-1)
    reached = seen.covered.copy()
    if light.kind is not LightKind.DIRECTIONAL:
        reached &= distance <= light.range_m
    if light.kind is LightKind.SPOT:
        reached &= -to_light @ np.array(light.direction) >= np.cos(light.outer_cone_rad) * distance
    x, y, width, height = frame.window
    window = np.zeros_like(reached)
    window[frame.height - y - height : frame.height - y, x : x + width] = True
    return not (reached & ~window).any()


def test_frames_and_worlds_give_everything_back(gpu: Gpu) -> None:
    scene, light, camera = random_scene("fans", 0), random_light(LightKind.SPOT, 0), random_camera(0)
    counts = []
    for _ in range(3):
        with framed(gpu, scene, light, camera, SIZE) as frame:
            frame.shade()
        del frame
        gc.collect()
        counts.append(live_objects())
    assert counts[0] == counts[1] == counts[2]
