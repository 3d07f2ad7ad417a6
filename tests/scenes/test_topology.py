from __future__ import annotations

from collections import Counter

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from scenes.scene import Array, Mesh
from scenes.topology import Topology, face_signs, weld
from tests.solids import box, fan, klein_bottle, moebius_strip

Faces = npt.NDArray[np.int32]

# Six vertices: most edges are shared by many faces, in both directions, and many faces are degenerate.
FACES = hnp.arrays(np.int32, st.tuples(st.integers(0, 30), st.just(3)), elements=st.integers(0, 5))
SIGNS = st.integers(-1, 1)


def welded(mesh: Mesh) -> tuple[Array, Topology]:
    positions, index = weld(mesh.positions)
    triangles = index.astype(np.int32)[mesh.triangles]
    return positions.astype(np.float64)[triangles], Topology.of(triangles)


def brute_multiplicities(triangles: Faces, signs: npt.NDArray[np.int8]) -> Counter[tuple[int, int]]:
    total: Counter[tuple[int, int]] = Counter()
    for corners, sign in zip(triangles.tolist(), signs.tolist(), strict=True):
        for tail, head in zip(corners, corners[1:] + corners[:1], strict=True):
            if tail != head:
                total[min(tail, head), max(tail, head)] += sign if tail < head else -sign
    return total


@given(FACES, st.data())
def test_multiplicities_are_the_sums_that_a_loop_over_all_corners_gives(
    triangles: Faces, data: st.DataObject
) -> None:
    signs = data.draw(hnp.arrays(np.int8, len(triangles), elements=SIGNS))
    topology = Topology.of(triangles)
    expected = brute_multiplicities(triangles, signs)
    found = dict(
        zip(map(tuple, topology.edges.tolist()), topology.multiplicities(signs).tolist(), strict=True)
    )
    assert found == dict(expected)


@given(FACES, st.data())
def test_what_the_side_quads_close_has_no_boundary_of_its_own(triangles: Faces, data: st.DataObject) -> None:
    # The boundary of a boundary is zero: at every vertex as much arrives as leaves.
    signs = data.draw(hnp.arrays(np.int8, len(triangles), elements=SIGNS))
    topology = Topology.of(triangles)
    multiplicities = topology.multiplicities(signs)
    flow = np.zeros(6, np.int64)
    np.add.at(flow, topology.edges[:, 0], -multiplicities)
    np.add.at(flow, topology.edges[:, 1], multiplicities)
    assert not flow.any()


@given(FACES)
def test_edges_are_distinct_sorted_and_own_every_half_edge_once(triangles: Faces) -> None:
    topology = Topology.of(triangles)
    assert (topology.edges[:, 0] < topology.edges[:, 1]).all()
    pairs = [tuple(edge) for edge in topology.edges.tolist()]
    assert pairs == sorted(set(pairs))
    assert topology.offsets[0] == 0
    assert topology.offsets[-1] == len(topology.faces)
    assert (topology.valences >= 1).all()
    proper = sum(tail != head for face in triangles.tolist() for tail, head in _sides(face))
    assert len(topology.faces) == proper


def _sides(face: list[int]) -> list[tuple[int, int]]:
    return [(face[0], face[1]), (face[1], face[2]), (face[2], face[0])]


@given(
    hnp.arrays(
        np.float32, st.tuples(st.integers(1, 20), st.just(3)), elements=st.sampled_from([-0.0, 0, 1, 2])
    )
)
def test_welding_keeps_every_position_and_none_twice(positions: npt.NDArray[np.float32]) -> None:
    distinct, index = weld(positions)
    assert np.array_equal(distinct[index], positions)
    assert len(set(map(tuple, distinct.tolist()))) == len(distinct)


@given(
    hnp.arrays(
        np.float32,
        st.tuples(st.integers(0, 40), st.just(3)),
        elements=st.sampled_from([-0.0, 0, 1, -1, 1 + 2**-23, 2**-149, -3e38, 1e-3]),
    )
)
def test_welding_gives_what_one_sort_of_all_bytes_gives(positions: npt.NDArray[np.float32]) -> None:
    whole = np.ascontiguousarray(positions + np.float32(0)).view(np.dtype((np.void, 12))).ravel()
    _, first, wanted = np.unique(whole, return_index=True, return_inverse=True)
    distinct, index = weld(positions)
    assert distinct.tobytes() == positions[first].tobytes()
    assert index.tolist() == wanted.ravel().tolist()


@given(FACES)
def test_half_edges_stand_by_edge_and_then_by_face_corner(triangles: Faces) -> None:
    tails, heads = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    sides = [
        (min(tail, head), max(tail, head), number)
        for number, (tail, head) in enumerate(zip(tails.tolist(), heads.tolist(), strict=True))
        if tail != head
    ]
    topology = Topology.of(triangles)
    owner = np.repeat(np.arange(len(topology.edges)), np.diff(topology.offsets))
    ends = topology.edges[owner].tolist()
    numbers = [number for _, _, number in sorted(sides)]
    assert ends == [list(side[:2]) for side in sorted(sides)]
    assert topology.faces.tolist() == [number // 3 for number in numbers]
    assert topology.orientations.tolist() == [
        1 if tails[number] < heads[number] else -1 for number in numbers
    ]


def test_a_box_with_split_corners_is_closed() -> None:
    closed = box((0, 0, 0), (1, 2, 3))
    split = Mesh("split", closed.positions[closed.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    _, topology = welded(split)
    assert len(topology.edges) == 18
    assert (topology.valences == 2).all()
    assert not topology.balances.any()


@pytest.mark.parametrize("light", [[5, 4, 3, 1], [0.3, 1, 0.2, 0], [0, 9, 0, 1]])
def test_a_box_has_sides_only_along_its_outline_and_each_counts_twice(light: list[float]) -> None:
    corners, topology = welded(box((0, 0, 0), (1, 1, 1)))
    signs = face_signs(corners, np.array(light, float))
    multiplicities = topology.multiplicities(signs)
    assert set(np.abs(multiplicities)) == {0, 2}
    outline = 6 if np.count_nonzero(light[:3]) == 3 else 4
    assert np.count_nonzero(multiplicities) == outline


def test_a_fan_of_k_faces_counts_k_at_its_edge_when_all_face_one_way() -> None:
    tips = np.array([[np.cos(a), 2.0, np.sin(a)] for a in np.linspace(0.1, 1.4, 7)])
    corners, topology = welded(fan(np.zeros(3), np.array([0.0, 0, 1e-3]), tips))
    signs = np.ones(len(corners), np.int8)
    assert np.abs(topology.multiplicities(signs)).max() == 7


def test_a_klein_bottle_is_closed_and_has_no_side_and_a_moebius_strip_has_one_rim() -> None:
    _, bottle = welded(klein_bottle())
    assert (bottle.valences == 2).all()
    assert bottle.balances.any()
    _, strip = welded(moebius_strip())
    rim = bottle.edges[:0] if (strip.valences == 2).all() else strip.edges[strip.valences == 1]
    assert len(rim) == 2 * 24
    assert (np.bincount(rim.ravel()) <= 2).all()


@given(
    hnp.arrays(np.float64, (4, 3, 3), elements=st.integers(-9, 9).map(float)),
    hnp.arrays(np.float64, 3, elements=st.integers(-9, 9).map(float)),
    st.sampled_from([0.0, 1.0]),
)
def test_a_face_sign_is_that_of_the_determinant_and_turns_with_the_winding(
    corners: Array, light: Array, weight: float
) -> None:
    # Whole numbers: every product is exact, so that zero means zero.
    homogeneous = np.append(light, weight)
    signs = face_signs(corners, homogeneous)
    edges = np.stack(
        [corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], light - weight * corners[:, 0]], axis=1
    ).astype(np.int64)
    determinants = [_determinant(rows.tolist()) for rows in edges]
    assert signs.tolist() == np.sign(determinants).tolist()
    assert face_signs(corners[:, ::-1], homogeneous).tolist() == (-signs).tolist()
    assert face_signs(np.roll(corners, 1, axis=1), homogeneous).tolist() == signs.tolist()


def _determinant(rows: list[list[int]]) -> int:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def test_no_triangles_have_no_edges() -> None:
    topology = Topology.of(np.zeros((0, 3), np.int32))
    assert topology.edges.shape == (0, 2)
    assert topology.offsets.tolist() == [0]
    assert topology.multiplicities(np.zeros(0, np.int8)).shape == (0,)
    assert face_signs(np.zeros((0, 3, 3)), np.array([0.0, 1, 0, 0])).shape == (0,)
