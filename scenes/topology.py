"""Edges of a triangle set, and how often a shadow volume must close each of them.

Vertices are one vertex if their positions have the same bits, whatever their index: files split vertices at
hard edges and texture seams, and an index-based edge would call every such seam open.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from scenes.scene import Array, Positions, Triangles

Counts = npt.NDArray[np.int64]
Signs = npt.NDArray[np.int8]
Keys = npt.NDArray[np.uint64]

_HALF = np.uint64(32)
_LOWER = np.uint64(0xFFFFFFFF)


def weld(positions: Positions) -> tuple[Positions, npt.NDArray[np.int64]]:
    """Distinct positions (u, 3) float32, and for each of the given ones its index among them.

    They stand in the order of their bytes in memory.
    """
    # Adding zero turns -0.0 into 0.0, which has other bits but is the same place.
    bits = np.ascontiguousarray((positions + np.float32(0)).T).view(np.dtype(">u4"))
    # Two sorts of 64 bits, the second of what is nearly in order: a third of the time of one sort of 96.
    keys = _paired(bits[0], bits[1])
    order = np.argsort(keys, kind="stable")
    keys = _paired(_ranks(keys[order]), bits[2][order])
    again = np.argsort(keys, kind="stable")
    order = order[again]
    ranks = _ranks(keys[again])
    index = np.zeros(len(order), np.int64)
    index[order] = ranks
    return positions[order[_starts(ranks)]], index


@dataclass(frozen=True)
class Topology:
    """The undirected edges of a triangle set, with the faces around each.

    Attributes:
        edges: (e, 2) int32 vertex indices, first < second, sorted.
        offsets: (e + 1,) int32: edge i owns half-edges offsets[i] .. offsets[i + 1].
        faces: (h,) int32 face of each half-edge.
        orientations: (h,) int8: +1 where the face's stored winding runs first to second, else -1.
    """

    edges: Triangles
    offsets: npt.NDArray[np.int32]
    faces: npt.NDArray[np.int32]
    orientations: Signs

    @classmethod
    def of(cls, triangles: Triangles) -> Topology:
        """The edges of (t, 3) welded triangles. An edge from a vertex to itself is no edge."""
        tails = triangles.ravel()
        heads = triangles[:, [1, 2, 0]].ravel()
        sides = np.arange(len(tails), dtype=np.int32)
        if not (tails != heads).all():
            sides = sides[tails != heads]
            tails, heads = tails[sides], heads[sides]
        keys = _paired(np.minimum(tails, heads), np.maximum(tails, heads))
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
        first = _starts(keys)
        return cls(
            edges=np.stack([keys[first] >> _HALF, keys[first] & _LOWER], axis=1).astype(np.int32),
            offsets=np.append(first, len(order)).astype(np.int32),
            faces=sides[order] // np.int32(3),
            orientations=np.where(tails < heads, np.int8(1), np.int8(-1))[order],
        )

    @cached_property
    def valences(self) -> Counts:
        """(e,) int64: faces around each edge."""
        return np.diff(self.offsets).astype(np.int64)

    @cached_property
    def balances(self) -> Counts:
        """(e,) int64: sum of orientations; 0 where every face that runs one way meets one that runs back."""
        return self._sum(self.orientations.astype(np.int64))

    def multiplicities(self, signs: Signs) -> Counts:
        """(e,) int64: how many side quads each edge needs, signed, for (t,) face signs of one light.

        The boundary of the sum of all faces' shadow solids; zero where neighbours cancel. Same idea as
        Kim, Kim and Turk 2008, here for triangle sets that bound nothing.
        """
        return self._sum(self.orientations.astype(np.int64) * signs[self.faces])

    def _sum(self, values: Counts) -> Counts:
        if not len(values):
            return np.zeros(0, np.int64)
        return np.add.reduceat(values, self.offsets[:-1])


def face_signs(corners: Array, light: Array) -> Signs:
    """(t,) int8: +1 where the light is on the side from which (t, 3, 3) corners wind counter-clockwise.

    `light` is homogeneous (4,): a position, or the direction towards it. 0 for an edge-on or empty face.
    """
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    heights: Array = np.einsum("ij,ij->i", normals, light[:3] - light[3] * corners[:, 0])
    return np.sign(heights).astype(np.int8)


def _paired(upper: npt.NDArray[Any], lower: npt.NDArray[Any]) -> Keys:
    """(n,) uint64 that sort by (n,) numbers of up to 32 bits, none negative, and then by others."""
    keys: Keys = upper.astype(np.uint64)
    keys <<= _HALF
    keys |= lower.astype(np.uint64)
    return keys


def _begins(ordered: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """(n,) bool: whether another value begins here."""
    begins = np.ones(len(ordered), bool)
    np.not_equal(ordered[1:], ordered[:-1], out=begins[1:])
    return begins


def _starts(ordered: npt.NDArray[Any]) -> Counts:
    """(u,) int64: where each distinct value of an ordered array begins."""
    return np.flatnonzero(_begins(ordered))


def _ranks(ordered: npt.NDArray[Any]) -> Counts:
    """(n,) int64: how many distinct values of an ordered array come before each."""
    return np.cumsum(_begins(ordered)) - 1
