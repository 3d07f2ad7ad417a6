from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial import HalfspaceIntersection, cKDTree

from scenes.convex import box_planes, clip_planes, corners
from scenes.frusta import reversed_infinite
from scenes.scene import Array
from tests import tolerances

SCALES = st.sampled_from([1e-3, 1.0, 1e3])


@given(hnp.arrays(np.float64, 3, elements=st.floats(-5, 5)), st.floats(0.1, 7), SCALES)
def test_a_box_has_its_eight_corners(low: Array, side: float, scale: float) -> None:
    extent = side * np.array([1.0, 2.0, 0.5])
    found = corners(box_planes(scale * low, scale * (low + extent)))
    expected = scale * np.array([low + extent * [x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    assert len(found) == 8
    distance, _ = cKDTree(found).query(expected)
    assert distance.max() <= tolerances.CONVEX_CORNER * scale * (np.abs(low).max() + side)


@given(st.integers(0, 10**6), st.integers(1, 12), SCALES)
def test_a_box_cut_by_random_planes_has_the_corners_that_qhull_finds(
    seed: int, cuts: int, scale: float
) -> None:
    random = np.random.default_rng(seed)
    normals = random.normal(size=(cuts, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    # Every cut keeps the middle, so that the middle is the inner point that qhull wants.
    middle = scale * random.uniform(-1, 1, 3)
    cut_planes = np.hstack([normals, (scale * random.uniform(0.2, 1.5, cuts) - normals @ middle)[:, None]])
    planes = np.vstack([box_planes(middle - scale, middle + scale), cut_planes])
    found = corners(planes)
    expected = HalfspaceIntersection(-planes, middle).intersections
    bound = tolerances.CONVEX_AGAINST_QHULL * scale
    assert cKDTree(found).query(expected)[0].max() <= bound
    assert cKDTree(expected).query(found)[0].max() <= bound


def test_a_body_without_points_has_no_corners() -> None:
    apart = np.vstack([box_planes(np.zeros(3), np.ones(3)), [[1.0, 0, 0, -2]]])
    assert corners(apart).shape == (0, 3)


def test_planes_that_touch_a_corner_keep_it() -> None:
    touching = np.vstack([box_planes(np.zeros(3), np.ones(3)), [[1.0, 1, 1, -3]]])
    found = corners(touching)
    assert len(found)
    assert np.abs(found - 1).max() <= tolerances.CONVEX_CORNER


@given(hnp.arrays(np.float64, 3, elements=st.floats(-20, 20)), st.floats(0.2, 2.5), st.floats(0.3, 3))
def test_clip_planes_keep_what_the_projection_shows(point: Array, yfov: float, aspect: float) -> None:
    matrix = reversed_infinite(yfov, aspect, 0.1)
    x, y, _, w = matrix @ np.append(point, 1)
    heights = clip_planes(matrix) @ np.append(point, 1)
    assert (heights.min() >= 0) == (abs(x) <= w and abs(y) <= w)
