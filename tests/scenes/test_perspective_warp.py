"""Properties P1 to P3, P7 and P8 of warped maps, wherever the light stands as the camera sees it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scenes.convex import clip_planes
from scenes.frusta import camera_view, reach, reversed_infinite
from scenes.light_space_warp import light_space_warps
from scenes.perspective_warp import Warps, ahead_of, universal_depth, warps, with_depth
from scenes.receivers import receiver_body
from scenes.scene import Array, Camera, Light, LightKind
from scenes.virtual_camera import virtual_cameras
from scenes.warped_map import WIDEST_CONE_RAD
from tests import tolerances
from tests.random_scenes import look_at

SEEDS = st.integers(0, 10**6)
FEW = settings(max_examples=25)
SLIDES = np.array([0.0, 0.25, 1.0, 8.0])
BOUNDS = np.array([[-4.0, 0, -4], [4, 3, 4]])
SHRINK = 1 - 4 / 512
EYE_PLANE = "on the eye's plane"
PLACES = ("beside", "behind", EYE_PLANE, "facing", "in view")


def camera_of(seed: int) -> Camera:
    random = np.random.default_rng(seed)
    angle = random.uniform(0, 2 * np.pi)
    eye = np.array([9 * np.cos(angle), random.uniform(1, 5), 9 * np.sin(angle)])
    return look_at(eye, random.uniform((-1, 0, -1), (1, 1, 1)))


def light_of(place: str, kind: LightKind, camera: Camera, seed: int) -> Light:
    """A light at one of PLACES as `camera` sees it; above the floor, and shining at the middle."""
    random = np.random.default_rng([seed, len(place)])
    forward, up = np.asarray(camera.forward), np.asarray(camera.up)
    right = np.cross(forward, up)
    eye = np.asarray(camera.position)
    position = {
        "beside": 6 * right + random.uniform(2, 6) * up + 3 * forward,
        "behind": random.uniform(-2, 2) * right + 5 * up - random.uniform(1, 9) * forward,
        EYE_PLANE: random.uniform(2, 6) * right + random.uniform(3, 6) * up,
        "facing": random.uniform(-1, 1) * right + 6 * up + 20 * forward,
        "in view": random.uniform(-1, 1) * right + random.uniform(1, 3) * up + 8 * forward,
    }[place] + eye
    position[1] = max(position[1], 3.5)
    if place == EYE_PLANE:
        position -= ((position - eye) @ forward) * forward
    direction = -position / np.linalg.norm(position)
    return Light("any", kind, tuple(position), tuple(direction), 0.3, 0.6)


def warped(place: str, kind: LightKind, seed: int, slides: Array = SLIDES) -> tuple[Light, Array, Warps]:
    camera = camera_of(seed)
    light = light_of(place, kind, camera, seed)
    view = clip_planes(reversed_infinite(camera.yfov_rad, 4 / 3, camera.near_m) @ camera_view(camera))
    view[-1, 3] -= camera.near_m
    body = receiver_body(BOUNDS[:1], BOUNDS[1:], reach(light, np.zeros(3)), view)
    assume(len(body.corners) >= 4)
    corners = ahead_of(light.homogeneous, body.corners)
    cameras = virtual_cameras(camera_view(camera), corners, slides)
    return light, corners, warps(cameras, light.homogeneous, SHRINK)


def homogeneous(points: Array) -> Array:
    return np.hstack([points, np.ones((len(points), 1))])


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", [LightKind.SPOT, LightKind.DIRECTIONAL])
@FEW
@given(seed=SEEDS)
def test_x_y_and_w_vanish_at_the_light(place: str, kind: LightKind, seed: int) -> None:
    light, corners, found = warped(place, kind, seed)
    for rows in found.rows[found.half_angles < WIDEST_CONE_RAD]:
        matrix = with_depth(rows, universal_depth(light.homogeneous, corners), light.homogeneous, corners)
        there = matrix @ light.homogeneous
        size = np.abs(matrix) @ np.abs(light.homogeneous)
        assert (np.abs(there[[0, 1, 3]]) <= tolerances.LIGHT_VANISHES * size[[0, 1, 3]].max()).all()
        assert there[2] > 0


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", [LightKind.SPOT, LightKind.DIRECTIONAL])
@FEW
@given(seed=SEEDS)
def test_a_ray_keeps_its_place_and_its_depth_falls_even_from_behind_the_eye(
    place: str, kind: LightKind, seed: int
) -> None:
    light, corners, found = warped(place, kind, seed)
    middle = corners.mean(axis=0)
    targets = middle + 0.9 * (corners - middle)
    start = (
        np.asarray(light.position) if kind is LightKind.SPOT else targets - 40 * np.asarray(light.direction)
    )
    steps = np.array([0.05, 0.2, 0.5, 0.8, 1.0])
    for rows, half, depth, inverted in zip(
        found.rows, found.half_angles, found.camera_depths, found.inverted, strict=True
    ):
        if half >= WIDEST_CONE_RAD:
            continue
        for along, turned in ((universal_depth(light.homogeneous, corners), False), (depth, bool(inverted))):
            matrix = with_depth(rows, along, light.homogeneous, corners, inverted=turned)
            rays = (start + steps[:, None, None] * (targets - start)).reshape(-1, 3)
            q = homogeneous(rays) @ matrix.T
            place_on_map = (q[:, :3] / q[:, 3:]).reshape(len(steps), -1, 3)
            assert (q[:, 3] > 0).all()
            assert np.abs(place_on_map[..., :2] - place_on_map[-1, :, :2]).max() <= tolerances.RAY_ON_MAP
            assert (np.diff(place_on_map[..., 2], axis=0) < 0).all()


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", [LightKind.SPOT, LightKind.DIRECTIONAL])
@FEW
@given(seed=SEEDS)
def test_receivers_fill_the_map_between_its_guards(place: str, kind: LightKind, seed: int) -> None:
    light, corners, found = warped(place, kind, seed)
    for rows in found.rows[found.half_angles < WIDEST_CONE_RAD]:
        q = (
            homogeneous(corners)
            @ with_depth(rows, universal_depth(light.homogeneous, corners), light.homogeneous, corners).T
        )
        ratios = q[:, :3] / q[:, 3:]
        assert (q[:, 3] > 0).all()
        assert np.allclose(ratios[:, :2].max(axis=0), SHRINK, atol=tolerances.MAP_PLACE)
        assert np.allclose(ratios[:, :2].min(axis=0), -SHRINK, atol=tolerances.MAP_PLACE)
        assert ratios[:, 2].min() > -tolerances.MAP_PLACE
        assert ratios[:, 2].max() < 1 + tolerances.MAP_PLACE


@FEW
@given(seed=SEEDS, place=st.sampled_from(PLACES))
def test_far_back_the_warp_is_gone(seed: int, place: str) -> None:
    """P7: a sun's map takes a square to a parallelogram, as a map without perspective does."""
    _, corners, found = warped(place, LightKind.DIRECTIONAL, seed, np.array([0.0, 1e6]))
    random = np.random.default_rng(seed)
    side, up = random.normal(size=(2, 3))
    square = corners.mean(axis=0) + 0.1 * np.array([-side, -up, side, up])
    bent = []
    for rows in found.rows:
        q = homogeneous(square) @ rows.T
        places = q[:, :2] / q[:, 2:]
        bent.append(np.abs(places[0] + places[2] - places[1] - places[3]).max() / np.ptp(places))
    assert bent[1] <= tolerances.FAR_BACK
    assert bent[0] > bent[1]


@FEW
@given(seed=SEEDS)
def test_kozlovs_depth_runs_from_near_behind_the_eye_through_infinity_to_far(seed: int) -> None:
    """P8, with depth 1 at near and 0 at far: 1 at -a, the same from both sides of infinity, 0 at +a."""
    light, corners, found = warped("behind", LightKind.SPOT, seed)
    for rows, depth, inverted, half in zip(
        found.rows, found.camera_depths, found.inverted, found.half_angles, strict=True
    ):
        if half >= WIDEST_CONE_RAD or not inverted:
            continue
        matrix = with_depth(rows, depth, light.homogeneous, corners, inverted=True)
        # Depth is (far - u) / (2 far) with u the camera's depth over w: zero where the eye's plane is.
        reach_of = homogeneous(corners)
        u = (reach_of @ depth) / (reach_of @ rows[2])
        z = (reach_of @ matrix[2]) / (reach_of @ matrix[3])
        far = 1.02 * u.max()
        assert np.allclose(z, (far - u) / (2 * far), atol=tolerances.MAP_PLACE)
        assert (u > 0).all()
        on_eye_plane = np.linalg.lstsq(depth[None, :3], [-depth[3]], rcond=None)[0]
        at_eye = matrix @ [*on_eye_plane, 1.0]
        assert np.isclose(at_eye[2] / at_eye[3], 0.5, atol=tolerances.MAP_PLACE)


@FEW
@given(
    seed=SEEDS,
    kind=st.sampled_from([LightKind.SPOT, LightKind.DIRECTIONAL]),
    place=st.sampled_from(PLACES),
)
def test_light_space_warps_hold_the_same_properties(seed: int, kind: LightKind, place: str) -> None:
    camera = camera_of(seed)
    light, corners, _ = warped(place, kind, seed)
    parameters = np.array([0.05, 0.5, 1e6])
    for rows in light_space_warps(light.homogeneous, corners, np.asarray(camera.forward), parameters, SHRINK):
        q = homogeneous(corners) @ rows.T
        assume((q[:, 2] > 1e-3 * q[:, 2].max()).all())
        ratios = q[:, :2] / q[:, 2:]
        assert np.allclose(np.abs(ratios).max(axis=0), SHRINK, atol=tolerances.MAP_PLACE)
        size = np.abs(rows) @ np.abs(light.homogeneous)
        assert (np.abs(rows @ light.homogeneous) <= tolerances.LIGHT_VANISHES * size.max()).all()
