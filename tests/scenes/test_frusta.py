from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from scenes.frusta import any_up, boxes_inside, camera_view, light_axes, look_along, reach, reversed_infinite
from scenes.scene import Array, Light, LightKind
from tests import tolerances
from tests.random_scenes import look_at

VECTORS = hnp.arrays(np.float64, 3, elements=st.floats(-10, 10))
DIRECTIONS = VECTORS.filter(lambda vector: np.linalg.norm(vector) > 0.1).map(lambda v: v / np.linalg.norm(v))
SPREADS = st.floats(0.01, np.pi / 2)


def spot(position: Array, direction: Array, outer: float, range_m: float = np.inf) -> Light:
    return Light(
        "spot",
        LightKind.SPOT,
        position=tuple(position),
        direction=tuple(direction),
        outer_cone_rad=outer,
        range_m=range_m,
    )


@given(VECTORS, DIRECTIONS)
def test_a_view_is_a_rotation_that_puts_the_eye_at_zero_looking_down_z(eye: Array, forward: Array) -> None:
    view = look_along(eye, forward, any_up(forward))
    rotation = view[:3, :3]
    exact = tolerances.ROTATION
    assert np.abs(rotation @ rotation.T - np.eye(3)).max() <= exact
    assert np.linalg.det(rotation) > 0
    assert np.abs(view @ np.append(eye, 1) - [0, 0, 0, 1]).max() <= exact * (1 + np.abs(eye).max())
    assert np.abs(rotation @ forward - [0, 0, -1]).max() <= exact


@given(DIRECTIONS)
def test_any_up_is_never_along_the_view(forward: Array) -> None:
    assert abs(any_up(forward) @ forward) < 0.95


@given(st.floats(0.1, 3.0), st.floats(0.2, 5), st.floats(1e-3, 10), st.floats(1, 1e6))
def test_reversed_depth_is_near_over_distance(yfov: float, aspect: float, near: float, times: float) -> None:
    matrix = reversed_infinite(yfov, aspect, near)
    distance = near * times
    half = np.tan(yfov / 2) * distance
    x, y, z, w = matrix @ [half * aspect, half, -distance, 1]
    assert np.allclose([x / w, y / w, z / w], [1, 1, near / distance], rtol=tolerances.PROJECTION, atol=0)
    # A direction ends at depth zero exactly: no far plane cuts volumes off.
    assert (matrix @ [half, -half, -distance, 0])[2] == 0


def test_a_camera_sees_its_target_in_the_middle() -> None:
    camera = look_at((1, 2, 3), (4, -5, 6))
    x, y, z, w = camera_view(camera) @ [4, -5, 6, 1]
    assert np.hypot(x, y) <= tolerances.ROTATION * abs(z)
    assert z < 0
    assert w == 1


@given(DIRECTIONS)
def test_light_axes_are_right_up_forward(direction: Array) -> None:
    right, up, forward = light_axes(spot(np.zeros(3), direction, 0.5))
    assert np.abs(forward - direction).max() <= tolerances.ROTATION
    assert np.abs(np.cross(right, up) + forward).max() <= tolerances.ROTATION


def within_light(light: Light, points: Array) -> Array:
    """What the light lights by definition: (n,) bool."""
    offsets = points - np.asarray(light.position)
    if light.kind is LightKind.DIRECTIONAL:
        return np.ones(len(points), bool)
    distances = np.linalg.norm(offsets, axis=1)
    inside = distances <= light.range_m
    if light.kind is LightKind.SPOT:
        inside &= offsets @ np.asarray(light.direction) >= np.cos(light.outer_cone_rad) * distances
    return inside


@given(
    st.sampled_from(list(LightKind)),
    VECTORS,
    DIRECTIONS,
    SPREADS,
    st.sampled_from([0.5, 5.0, np.inf]),
    VECTORS,
    st.integers(0, 10**6),
)
def test_reach_keeps_every_box_that_holds_a_lit_point(
    kind: LightKind, position: Array, direction: Array, outer: float, range_m: float, origin: Array, seed: int
) -> None:
    light = replace(spot(position, direction, outer, range_m), kind=kind)
    random = np.random.default_rng(seed)
    points = position + random.normal(size=(200, 3)) * random.choice([0.1, 1, 10], size=(200, 1))
    # On the cone's very edge float64 may decide either way.
    inner = replace(light, outer_cone_rad=outer * (1 - tolerances.CONE_EDGE), range_m=range_m * (1 - 1e-12))
    lit = points[within_light(inner, points)] - origin
    low = lit - random.random(lit.shape)
    high = lit + random.random(lit.shape)
    body = reach(light, origin)
    assert body.touches(low, high).all()
    assert (lit @ body.planes[:, :3].T + body.planes[:, 3] >= -tolerances.REACH_PLANE).all()


def test_reach_culls_boxes_behind_beside_and_beyond() -> None:
    light = spot(np.array([1.0, 1, 1]), np.array([0.0, 0, -1]), np.pi / 4, 10)
    body = reach(light, np.array([1.0, 0, 0]))
    boxes = {
        "ahead": ([-1, 0, -3], [1, 2, -2], True),
        "behind": ([-9, -9, 1.01], [9, 9, 2], False),
        "beside": ([4.1, 0, -3], [5, 2, -2], False),
        "beyond": ([-1, 0, -12], [1, 2, -9.1], False),
        "around": ([-9, -9, -9], [9, 9, 9], True),
    }
    for name, (low, high, kept) in boxes.items():
        assert body.touches(np.array([low], float), np.array([high], float)).tolist() == [kept], name


def test_a_right_angle_spot_reaches_the_half_space_ahead() -> None:
    body = reach(spot(np.zeros(3), np.array([0.0, -1, 0]), np.pi / 2), np.zeros(3))
    low = np.array([[-100.0, -0.2, 0], [-100, 0.1, 0]])
    assert body.touches(low, low + np.array([1, 0.1, 1])).tolist() == [True, False]


@pytest.mark.parametrize("kind", list(LightKind))
def test_nothing_touches_when_there_are_no_boxes(kind: LightKind) -> None:
    light = replace(spot(np.zeros(3), np.array([0.0, -1, 0]), 0.5), kind=kind)
    assert reach(light, np.zeros(3)).touches(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)


@given(st.integers(0, 10**6))
def test_a_box_with_a_point_inside_all_planes_is_kept(seed: int) -> None:
    random = np.random.default_rng(seed)
    planes = random.normal(size=(5, 4))
    points = random.uniform(-2, 2, (300, 3))
    inside = points[(points @ planes[:, :3].T + planes[:, 3] >= 0).all(axis=1)]
    assume(len(inside))
    assert boxes_inside(planes, inside - random.random(3), inside + random.random(3)).all()
