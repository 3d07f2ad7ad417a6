from __future__ import annotations

from collections import Counter

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from scenes.scene import Mesh, Scene
from scenes.shells import Shells

# Twelve vertices: several shells of a few faces, some closed, some crowded, and faces that are none.
FACES = hnp.arrays(np.int32, st.tuples(st.integers(0, 12), st.just(3)), elements=st.integers(0, 11))
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.int32)


def sides(face: list[int]) -> list[tuple[int, int]]:
    return [pair for pair in zip(face, face[1:] + face[:1], strict=True) if pair[0] != pair[1]]


def plain_shells(faces: list[list[int]]) -> tuple[int, int, int]:
    waiting, counts = set(range(len(faces))), [0, 0, 0]
    while waiting:
        shell, reached = set[int](), [waiting.pop()]
        while reached:
            face = reached.pop()
            shell.add(face)
            around = {frozenset(pair) for pair in sides(faces[face])}
            near = {other for other in waiting if around & {frozenset(pair) for pair in sides(faces[other])}}
            waiting -= near
            reached += near
        runs = Counter(pair for face in shell for pair in sides(faces[face]))
        balanced = all(runs[pair] == runs[pair[::-1]] for pair in list(runs))
        closed = balanced and set(runs.values()) <= {1}
        counts[0 if closed else 1 if balanced else 2] += len(shell)
    return counts[0], counts[1], counts[2]


@given(FACES, st.lists(st.integers(0, 8), max_size=3), st.integers(0, 1000))
def test_shells_are_those_that_a_walk_over_shared_edges_finds(
    faces: npt.NDArray[np.int32], solids: list[int], seed: int
) -> None:
    triangles = np.concatenate([faces, *(TETRAHEDRON + first for first in solids)])
    positions = np.random.default_rng(seed).normal(size=(12, 3))
    found = Shells.of(Scene("random", (Mesh("random", positions, triangles),)))
    assert (found.closed, found.balanced, found.open) == plain_shells(triangles.tolist())
