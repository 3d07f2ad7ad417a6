from __future__ import annotations

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st

from scenes.clusters import FACES_PER_CLUSTER, Clusters, without
from tests.solids import floor, soup

COUNTS = st.sampled_from([0, 1, FACES_PER_CLUSTER, FACES_PER_CLUSTER + 1, 700])


def clustered(count: int, seed: int) -> tuple[Clusters, npt.NDArray[np.float64]]:
    corners = np.random.default_rng(seed).normal(size=(count, 3, 3)).astype(np.float32)
    mesh = soup(corners.astype(np.float64))
    return Clusters.of(mesh.positions, mesh.triangles), corners.astype(np.float64)


@given(COUNTS, st.integers(0, 1000))
def test_clusters_hold_every_triangle_once_inside_their_boxes(count: int, seed: int) -> None:
    clusters, corners = clustered(count, seed)
    assert sorted(clusters.order.tolist()) == list(range(count))
    assert len(clusters.low) == len(clusters.high) == -(-count // FACES_PER_CLUSTER)
    owner = np.arange(count) // FACES_PER_CLUSTER
    ordered = corners[clusters.order]
    assert (ordered >= clusters.low[owner][:, None]).all()
    assert (ordered <= clusters.high[owner][:, None]).all()


@given(COUNTS, st.integers(0, 1000), st.booleans())
def test_clusters_are_those_of_the_plain_formulas(count: int, seed: int, coarse: bool) -> None:  # noqa: FBT001
    random = np.random.default_rng(seed)
    positions = random.normal(size=(max(count, 1), 3)).astype(np.float32)
    positions = np.round(positions) if coarse else positions
    triangles = random.integers(0, len(positions), (count, 3)).astype(np.int32)
    clusters = Clusters.of(positions, triangles)
    corners = positions.astype(np.float64)[triangles]
    order = np.argsort(plain_morton(corners.mean(axis=1)), kind="stable")
    assert clusters.order.tolist() == order.tolist()
    starts = np.arange(0, count, FACES_PER_CLUSTER)
    assert clusters.starts.tolist() == [*starts.tolist(), count]
    runs = [corners[order][start : start + FACES_PER_CLUSTER].reshape(-1, 3) for start in starts]
    assert clusters.low.tolist() == [run.min(axis=0).tolist() for run in runs]
    assert clusters.high.tolist() == [run.max(axis=0).tolist() for run in runs]


def plain_morton(points: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    """Bit by bit."""
    keys = np.zeros(len(points), np.int64)
    if len(points):
        extent = max((points.max(axis=0) - points.min(axis=0)).max(), np.finfo(np.float64).tiny)
        cells = ((points - points.min(axis=0)) / extent * 1023).astype(np.int64)
        for bit in range(10):
            for axis in range(3):
                keys |= (cells[:, axis] >> bit & 1) << (3 * bit + axis)
    return keys


@given(COUNTS, st.integers(0, 1000), st.floats(0, 1))
def test_runs_are_exactly_the_faces_of_the_kept_clusters(count: int, seed: int, share: float) -> None:
    clusters, _ = clustered(count, seed)
    kept = np.random.default_rng(seed).random(len(clusters.low)) < share
    runs = clusters.runs(kept)
    covered = np.zeros(count, np.int64)
    for first, length in runs.tolist():
        assert length > 0
        covered[first : first + length] += 1
    assert covered.tolist() == kept[np.arange(count) // FACES_PER_CLUSTER].astype(int).tolist()
    # Maximal: between two runs stands a cluster that is left out.
    assert (runs[1:, 0] > runs[:-1].sum(axis=1)).all()


def test_neighbours_share_clusters() -> None:
    # 32 x 32 cells, 2048 triangles: compact clusters cover the floor little more than once.
    mesh = floor(8.0, cells=32)
    clusters = Clusters.of(mesh.positions, mesh.triangles)
    sides = clusters.high - clusters.low
    areas = sides[:, 0] * sides[:, 2]
    assert 1 <= areas.sum() / 16**2 < 2


def test_triangles_in_one_place_are_clustered_all_the_same() -> None:
    clusters = Clusters.of(np.ones((3, 3), np.float32), np.tile(np.arange(3, dtype=np.int32), (200, 1)))
    assert sorted(clusters.order.tolist()) == list(range(200))
    assert (clusters.low == 1).all()


def test_faces_whose_planes_hold_a_light_beside_them_are_edge_on() -> None:
    corners = np.array(
        [
            [[-1, 0, -1], [1, 0, -1], [0, 0, 2]],  # holds the light
            [[-1, 0.5, -1], [1, 0.5, -1], [0, 0.5, 2]],  # above it
            [[5, 0, 0], [6, 0, 0], [5, 0, 1]],  # in its plane, far away
            [[0, 0, 0], [1, 1, 0], [0, 1, 1]],  # has it for a corner
        ],
        np.float32,
    )
    positions = corners.reshape(-1, 3)
    triangles = np.arange(12, dtype=np.int32).reshape(-1, 3)
    clusters = Clusters.of(positions, triangles)
    ordered = triangles[clusters.order]
    for place in (np.zeros(3), np.array([1e-7, -1e-7, 1e-7])):
        found = clusters.edge_on(positions, ordered, place)
        assert sorted(clusters.order[found]) == [0, 3]
    assert not len(clusters.edge_on(positions, ordered, np.array([0.0, 0.25, 0.0])))
    assert not len(Clusters.of(positions, triangles[:0]).edge_on(positions, triangles[:0], np.zeros(3)))


@given(st.integers(0, 10**6))
def test_runs_are_cut_around_single_faces(seed: int) -> None:
    random = np.random.default_rng(seed)
    kept = random.random(60) < 0.7
    edges = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]]).astype(np.int8)))
    runs = np.stack([edges[::2], edges[1::2] - edges[::2]], axis=1)
    taken_out = np.flatnonzero(random.random(60) < 0.2)
    found = without(runs, taken_out)
    left = np.concatenate([np.arange(first, first + count) for first, count in found] or [np.zeros(0, int)])
    assert np.array_equal(left, np.setdiff1d(np.flatnonzero(kept), taken_out))
