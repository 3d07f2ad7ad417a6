from __future__ import annotations

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st

from scenes.clusters import FACES_PER_CLUSTER, Clusters
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
