"""Transforms of the prims of a tree: those of one depth are multiplied at once.

Source: OpenUSD, "UsdGeomXformable" and "UsdGeomXformCache" of its API documentation.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from pxr import Gf, UsdGeom, Vt

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Array
from scenes.usd.values import FIRST_TIME, Prim, path_of

_MOVES = "It moves over time: it stands where its first time sample puts it."


class Transforms:
    """The transforms of one tree, by number; 0 is that of its root, the identity."""

    def __init__(self, notes: NoteBook, *, moving: bool) -> None:
        self._notes = notes
        self._moving = moving
        self._cache = UsdGeom.XformCache(FIRST_TIME)
        self._prims: list[Prim] = [None]
        self._locals = [Gf.Matrix4d(1.0)]
        self._above = [0]
        self._depth = [0]

    def add(self, prim: Prim, above: int, authored: frozenset[str]) -> int:
        """The number of a prim's transform: the one above it where it has none of its own.

        Args:
            prim: The prim.
            above: The number of its parent's.
            authored: The names of its properties that a layer says something of.
        """
        if "xformOpOrder" not in authored:
            return above
        if self._moving and UsdGeom.Xformable(prim).TransformMightBeTimeVarying():
            self._notes.info(path_of(prim), _MOVES)
        local, resets = self._cache.GetLocalTransformation(prim)
        self._prims.append(prim)
        self._locals.append(local)
        self._above.append(0 if resets else above)
        self._depth.append(self._depth[self._above[-1]] + 1)
        return len(self._prims) - 1

    def worlds(self) -> Array:
        """(n, 4, 4) float64, read-only: by number, from the space of the prim to that of its tree.

        Raises:
            LevelError: One is not finite.
        """
        worlds: Array = np.array(Vt.Matrix4dArray(self._locals)).swapaxes(1, 2).copy()
        above, depth = np.array(self._above), np.array(self._depth)
        order = np.argsort(depth, kind="stable")
        ends = np.cumsum(np.bincount(depth))
        for first, last in pairwise(ends[1:]):
            rows = order[first:last]
            worlds[rows] = product(worlds[above[rows]], worlds[rows])
        finite = np.isfinite(worlds).all(axis=(1, 2))
        if not finite.all():
            raise LevelError(
                "The transform of this prim is not finite.",
                where=path_of(self._prims[int(np.argmin(finite))]),
                remedy="Check the xformOps of the prim and of those above it.",
            )
        worlds.flags.writeable = False
        return worlds


def product(above: Array, local: Array) -> Array:
    """(..., 4, 4) float64 products of affine matrices, elementwise: `@` may fuse or reorder them."""
    with np.errstate(over="ignore", invalid="ignore"):
        terms = [above[..., :, axis, None] * local[..., None, axis, :] for axis in range(4)]
        result: Array = ((terms[0] + terms[1]) + terms[2]) + terms[3]
    return result
