from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.frusta import camera_view, reversed_infinite
from scenes.scene import Array
from scenes.texel_footprint import screen_footprints, weighted_percentile
from tests import tolerances
from tests.random_scenes import look_at

SIZE = (640, 480)
SEEDS = st.integers(0, 10**6)


def clip_of(eye: Array, target: Array) -> Array:
    camera = look_at(eye, target)
    clip: Array = reversed_infinite(camera.yfov_rad, SIZE[0] / SIZE[1], 0.1) @ camera_view(camera)
    return clip


def test_a_light_at_the_eye_with_the_eyes_resolution_has_texels_of_one_pixel() -> None:
    clip = clip_of(np.array([0.0, 2, 8]), np.zeros(3))
    # A map as wide in texels as the screen is in pixels, stretched to a square.
    square = np.diag([1.0, SIZE[0] / SIZE[1], 1, 1]) @ clip
    random = np.random.default_rng(1)
    points, normals = random.uniform(-1, 1, (50, 3)), random.normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.stack([clip[[0, 1, 3]], square[[0, 1, 3]]])
    found = screen_footprints(points, normals, rows[:1], SIZE[0], clip, (SIZE[0], SIZE[0]))
    assert np.allclose(found, 1, rtol=tolerances.FOOTPRINT)


def test_a_sun_straight_down_on_a_floor_straight_below_the_eye() -> None:
    """Texels of 2 m / 64 at 10 m, where a pixel of 480 in 1 rad is 20 m tan(0.5) / 480 wide."""
    clip = clip_of(np.array([0.0, 10, 0]), np.zeros(3))
    rows = np.array([[[1.0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]])
    found = screen_footprints(np.zeros((1, 3)), np.array([[0.0, 1, 0]]), rows, 64, clip, SIZE)
    assert found[0, 0] == pytest.approx((2 / 64) / (20 * np.tan(0.5) / 480), rel=tolerances.FOOTPRINT)


@given(SEEDS)
def test_it_is_the_longest_image_of_a_texel_by_differences(seed: int) -> None:
    random = np.random.default_rng(seed)
    clip = clip_of(random.uniform(3, 6, 3), np.zeros(3))
    rows = clip_of(random.uniform(-6, -3, 3), np.zeros(3))[[0, 1, 3]]
    normal = random.normal(size=3)
    normal /= np.linalg.norm(normal)
    found = screen_footprints(np.zeros((1, 3)), normal[None], rows[None], 512, clip, SIZE)[0, 0]
    across = np.cross(normal, [0.3, 0.5, 0.81])
    across /= np.linalg.norm(across)
    along = np.cross(normal, across)

    def moved(matrix: Array, half: Array, steps: Array) -> Array:
        q = np.vstack([np.zeros(3), steps]) @ matrix[:, :3].T + matrix[:, 3]
        places = q[:, :2] / q[:, 2:] * half
        distance: Array = np.linalg.norm(places[1:] - places[0], axis=1)
        return distance

    def ratios(angles: Array) -> Array:
        """A thousandth of a texel in each direction along the surface: pixels over texels."""
        steps = 1e-6 * (np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * along)
        pixels = moved(clip[[0, 1, 3]], np.array(SIZE) / 2, steps)
        ratio: Array = pixels / moved(rows, np.array([256.0, 256]), steps)
        return ratio

    angles = np.linspace(0, np.pi, 20_001)
    # On a surface that the light grazes the peak is narrower than a step.
    best = angles[np.argmax(ratios(angles))]
    ratio = ratios(best + np.linspace(-1, 1, 20_001) * (angles[1] - angles[0])).max()
    assert found == pytest.approx(ratio, rel=tolerances.FOOTPRINT_DIFFERENCES)


def test_a_surface_edge_on_to_the_light_has_texels_without_end_but_no_infinity() -> None:
    clip = clip_of(np.array([0.0, 10, 1]), np.zeros(3))
    rows = np.array([[[1.0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]])
    found = screen_footprints(np.zeros((1, 3)), np.array([[1.0, 0, 0]]), rows, 64, clip, SIZE)
    assert np.isfinite(found).all()
    assert found[0, 0] > 1e5


@given(SEEDS)
def test_percentiles_with_equal_weights_are_values_at_their_rank(seed: int) -> None:
    random = np.random.default_rng(seed)
    values = random.random((3, 200))
    found = weighted_percentile(values, np.ones(200), 95)
    assert np.array_equal(found, np.sort(values, axis=1)[:, 189])
