from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.extrusion import MARGIN, end_plane
from scenes.scene import Array, Light, LightKind
from tests import tolerances

SEEDS = st.integers(0, 10**6)
SCALES = st.sampled_from([1e-3, 1.0, 1e3])


def casters(random: np.random.Generator, bounds: Array) -> tuple[Array, Array]:
    """Boxes inside `bounds`."""
    ends = random.uniform(bounds[0], bounds[1], (2, 6, 3))
    return ends.min(axis=0), ends.max(axis=0)


@given(st.sampled_from(list(LightKind)), SCALES, SEEDS)
def test_every_ray_through_a_caster_reaches_the_plane_and_everything_stands_before_it(
    kind: LightKind, scale: float, seed: int
) -> None:
    random = np.random.default_rng(seed)
    bounds = scale * np.array([[-2.0, 0, -2], [2, 2, 2]])
    low, high = casters(random, bounds)
    position = scale * random.uniform(-4, 4, 3)
    direction = random.normal(size=3)
    light = Light("any", kind, tuple(position), tuple(direction / np.linalg.norm(direction)))
    end = end_plane(light, position, bounds, low, high)
    if end is None:
        return
    corners = np.array(
        [[bounds[i, 0], bounds[j, 1], bounds[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    )
    assert (corners @ end.normal <= end.distance - MARGIN * scale).all()
    points = random.uniform(low, high, (50, 6, 3)).reshape(-1, 3)
    along = points - position if kind is not LightKind.DIRECTIONAL else np.asarray(light.direction)
    steps = (end.distance - points @ end.normal) / (along @ end.normal)
    assert (steps > 0).all()
    assert np.isfinite(steps).all()


def test_a_sun_from_above_ends_its_volumes_just_below_the_floor() -> None:
    sun = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1, 0))
    bounds = np.array([[-5.0, 0, -5], [5, 3, 5]])
    end = end_plane(sun, np.zeros(3), bounds, np.array([[0.0, 1, 0]]), np.array([[1.0, 2, 1]]))
    assert end is not None
    assert end.normal.tolist() == [0, -1, 0]
    assert np.isclose(end.distance, MARGIN * 10, rtol=tolerances.PROJECTION)


def test_a_lamp_among_its_casters_needs_infinity() -> None:
    bounds = np.array([[-5.0, -5, -5], [5, 5, 5]])
    around = np.array([[x, y, z] for x in (-3.0, 3) for y in (-3.0, 3) for z in (-3.0, 3)])
    lamp = Light("lamp", LightKind.POINT)
    assert end_plane(lamp, np.zeros(3), bounds, around - 0.5, around + 0.5) is None


@pytest.mark.parametrize("kind", list(LightKind))
def test_no_casters_need_no_plane(kind: LightKind) -> None:
    empty = np.zeros((0, 3))
    assert end_plane(Light("light", kind), np.zeros(3), np.zeros((2, 3)), empty, empty) is None


def test_a_scene_in_one_point_needs_no_plane_that_cannot_be() -> None:
    point = np.ones((1, 3))
    lamp = Light("lamp", LightKind.POINT, position=(1.0, 3, 1))
    end = end_plane(lamp, np.array(lamp.position), np.ones((2, 3)), point, point)
    assert end is None or np.isfinite(end.distance)
