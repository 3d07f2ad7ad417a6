from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.clusters import Clusters
from scenes.convex import clip_planes
from scenes.frusta import camera_view, reach, reversed_infinite
from scenes.scene import Light, LightKind
from scenes.surface_probes import LEAST_PER_CLUSTER, PROBES, SurfaceProbes
from tests import tolerances
from tests.random_scenes import look_at

SEEDS = st.integers(0, 10**6)


def probes_of(corners: np.ndarray) -> SurfaceProbes:
    positions = corners.reshape(-1, 3).astype(np.float32)
    triangles = np.arange(len(positions), dtype=np.int32).reshape(-1, 3)
    clusters = Clusters.of(positions, triangles)
    return SurfaceProbes.of(positions, triangles[clusters.order], clusters)


@settings(max_examples=20)
@given(st.integers(1, 300), SEEDS)
def test_probes_lie_on_triangles_and_share_their_area(count: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (count, 3, 3)) + random.uniform(-20, 20, (count, 1, 3))
    found = probes_of(corners)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert found.areas.sum() == pytest.approx(area.sum(), rel=tolerances.PROBE_AREA)
    assert (np.diff(found.starts) >= LEAST_PER_CLUSTER).all()
    assert len(found.points) <= PROBES + (LEAST_PER_CLUSTER + 1) * len(found.clusters.low)
    assert np.allclose(np.linalg.norm(found.normals, axis=1), 1, atol=tolerances.UNIT)
    owner = np.repeat(np.arange(len(found.clusters.low)), np.diff(found.starts))
    assert (found.points >= found.clusters.low[owner] - tolerances.PROBE_PLACE).all()
    assert (found.points <= found.clusters.high[owner] + tolerances.PROBE_PLACE).all()


def test_a_square_is_covered_evenly() -> None:
    square = np.array([[[0, 0, 0], [1, 0, 0], [1, 0, 1]], [[0, 0, 0], [1, 0, 1], [0, 0, 1]]], float)
    points = probes_of(square).points
    counts, _, _ = np.histogram2d(points[:, 0], points[:, 2], bins=8, range=[[0, 1], [0, 1]])
    assert counts.min() > 0.7 * counts.mean()
    assert counts.max() < 1.3 * counts.mean()


def test_faces_without_area_have_no_probe() -> None:
    assert not len(probes_of(np.zeros((4, 3, 3))).points)
    assert not len(probes_of(np.zeros((0, 3, 3))).points)


def test_what_is_seen_is_lit_and_weighs_what_it_fills() -> None:
    quad = np.array([[[-9, 0, -9], [-9, 0, 9], [9, 0, 9]], [[-9, 0, -9], [9, 0, 9], [9, 0, -9]]], float)
    found = probes_of(quad)
    camera = look_at((0, 4, 0.01), (0, 0, 0), yfov_rad=1.0)
    view = clip_planes(reversed_infinite(1.0, 1.0, 0.1) @ camera_view(camera))
    eye = np.asarray(camera.position)
    for height, seen in ((5.0, True), (-5.0, False)):
        lamp = Light("lamp", LightKind.POINT, (0.0, height, 0.0))
        points, normals, weights = found.seen(reach(lamp, np.zeros(3)), view, eye, lamp.homogeneous)
        assert bool(len(points)) is seen
        assert len(points) == len(normals) == len(weights)
        if seen:
            # The view is a pyramid of half width tan(0.5) at distance 1: on the floor, a square.
            half = 4 * np.tan(0.5)
            assert (np.abs(points[:, [0, 2]]) < half + 0.05).all()
            solid = 4 * np.arcsin((half / np.hypot(half, 4)) ** 2)
            assert weights.sum() == pytest.approx(solid, rel=tolerances.PROBE_SHARE)
    dim = Light("dim", LightKind.POINT, (0.0, 5.0, 0.0), range_m=5.1)
    points, _, _ = found.seen(reach(dim, np.zeros(3)), view, eye, dim.homogeneous)
    assert (np.linalg.norm(points - [0, 5, 0], axis=1) <= 5.1).all()
    assert len(points)
