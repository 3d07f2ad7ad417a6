from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from scenes.camera_path import STEP_PX, camera_path
from scenes.frusta import camera_view, reversed_infinite
from scenes.scene import Array, Camera
from tests import tolerances

WIDTH, HEIGHT = 64, 48


@st.composite
def cameras(draw: st.DrawFn) -> Camera:
    turn = Rotation.from_rotvec([draw(st.floats(-3, 3)) for _ in range(3)]).as_matrix()
    position = tuple(draw(st.floats(-100, 100)) for _ in range(3))
    return Camera("Eye", position, tuple(turn[:, 0]), tuple(turn[:, 1]), draw(st.floats(0.2, 1.6)))


def axes(camera: Camera) -> Array:
    return camera_view(camera)[:3, :3]


def pixels(camera: Camera, points: Array) -> Array:
    clip_from_world = reversed_infinite(camera.yfov_rad, WIDTH / HEIGHT, camera.near_m) @ camera_view(camera)
    clip = np.hstack([points, np.ones((len(points), 1))]) @ clip_from_world.T
    return (clip[:, :2] / clip[:, 3:] + 1) / 2 * np.array([WIDTH, HEIGHT])


def seen_at(camera: Camera, distance_m: float) -> Array:
    """Places all over the picture at one distance along the line of sight."""
    half = np.tan(camera.yfov_rad / 2) * distance_m
    x, y = np.meshgrid(np.linspace(-1, 1, 15) * half * WIDTH / HEIGHT, np.linspace(-1, 1, 11) * half)
    local = np.stack([x, y, np.full_like(x, -distance_m)], axis=-1).reshape(-1, 3)
    return np.asarray(camera.position) + local @ axes(camera)


def motion_px(path: tuple[Camera, ...], points: Array) -> Array:
    """(steps, points): how far each place moves in the picture."""
    places = np.stack([pixels(camera, points) for camera in path])
    return np.linalg.norm(np.diff(places, axis=0), axis=2)


@given(cameras(), st.floats(0.5, 100), st.integers(1, 12))
def test_a_path_begins_at_the_camera_and_all_its_steps_are_equal(
    camera: Camera, distance_m: float, steps: int
) -> None:
    path = camera_path(camera, distance_m, HEIGHT, steps)
    assert path[0] is camera
    assert len(path) == steps + 1
    moves = np.diff([one.position for one in path], axis=0)
    assert np.abs(moves - moves[0]).max() <= tolerances.PATH_STEP
    turns = [axes(now) @ axes(last).T for last, now in pairwise(path)]
    assert np.abs(np.array(turns) - turns[0]).max() <= tolerances.PATH_STEP
    assert not np.allclose(moves, 0)
    assert not np.allclose(turns[0], np.eye(3), atol=tolerances.PATH_STEP)
    for one in path:
        assert abs(np.dot(one.forward, one.up)) <= tolerances.PATH_STEP
        assert np.linalg.norm([one.forward, one.up], axis=1) == pytest.approx(1, abs=tolerances.PATH_STEP)
        assert (one.yfov_rad, one.near_m) == (camera.yfov_rad, camera.near_m)


@given(cameras(), st.floats(0.5, 100), st.floats(0.1, 1.0))
def test_what_is_at_the_given_distance_moves_by_the_given_pixels(
    camera: Camera, distance_m: float, step_px: float
) -> None:
    path = camera_path(camera, distance_m, HEIGHT, 7, step_px=step_px)
    middle = np.asarray(camera.position) + distance_m * np.asarray(camera.forward)
    assert motion_px(path[:2], middle[None])[0] == pytest.approx(step_px, rel=tolerances.IMAGE_MOTION)
    median = np.median(motion_px(path, seen_at(camera, distance_m)))
    # Away from the middle a turn moves the picture faster: at the corners by 1 / cos^2 of the angle.
    assert step_px * (1 - tolerances.IMAGE_MOTION) <= median <= 1.3 * step_px


def test_near_things_move_faster_and_far_ones_never_stand_still() -> None:
    camera = Camera("Eye", (1.0, 2.0, 3.0))
    path = camera_path(camera, 10.0, HEIGHT, 3)
    medians = [np.median(motion_px(path, seen_at(camera, distance))) for distance in (5, 10, 100, 1e6)]
    assert medians == sorted(medians, reverse=True)
    assert 0.2 * STEP_PX <= medians[-1] < medians[0] < 2 * STEP_PX


def test_no_edge_along_rows_or_columns_is_moved_along_itself() -> None:
    camera = Camera("Eye", (0.0, 0.0, 0.0))
    first, second = (
        pixels(one, np.array([[0.0, 0.0, -10.0]])) for one in camera_path(camera, 10.0, HEIGHT, 1)
    )
    assert (np.abs(second - first) > 0.2 * STEP_PX).all()
