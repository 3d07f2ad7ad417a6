"""Meshes of a USD stage as triangle lists.

Sources: OpenUSD, "UsdGeomMesh" (faces, holes, orientation). Faces become fans, as in Hydra (HdMeshUtil).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from pxr import UsdGeom

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Positions, Triangles
from scenes.usd.values import MEND, Prim, array, path_of, value

Numbers = npt.NDArray[np.int32]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Faces:
    """A mesh without its looks.

    Attributes:
        positions: (v, 3) float32, local space, stage units, read-only.
        triangles: (t, 3) int32, counter-clockwise seen from outside, read-only.
        counts: (f,) int32, the corners of each face.
        reach: The largest absolute coordinate.
        solid: (f,) whether a face is there; None where all are.
    """

    positions: Positions
    triangles: Triangles
    counts: Numbers
    reach: float
    solid: Flags | None = None

    def marked(self, faces: Flags) -> Flags:
        """(t,) whether each triangle is of a marked face; `faces`, (f,), marks them."""
        each = np.maximum(self.counts - 2, 0)
        if self.solid is not None:
            each = np.where(self.solid, each, 0)
        return np.repeat(faces, each)


def read_mesh(prim: Prim, notes: NoteBook) -> Faces | None:
    """The faces of a mesh as triangles; None where it has none.

    Raises:
        LevelError: Its arrays contradict each other, or a position is not finite.
    """
    mesh = UsdGeom.Mesh(prim)
    points = mesh.GetPointsAttr()
    positions = array(points, np.float32, (-1, 3))
    counts = array(mesh.GetFaceVertexCountsAttr(), np.int32)
    indices = array(mesh.GetFaceVertexIndicesAttr(), np.int32)
    if not len(counts) and not len(indices):
        notes.info(path_of(prim), "This mesh has no faces.")
        return None
    if points.ValueMightBeTimeVarying():
        notes.info(path_of(prim), "Its points move over time: their first time sample is read.")
    reach = _checked_reach(prim, positions, counts, indices)
    triangles = triangulated(counts, indices)
    if counts.min() < 3:
        strays = int(np.count_nonzero(counts < 3))
        notes.warning(path_of(prim), f"{strays:,} of its faces have less than 3 corners: they are skipped.")
    holes = mesh.GetHoleIndicesAttr()
    solid = None
    if holes.HasAuthoredValue() and len(found := array(holes, np.int32)):
        solid = ~_in_holes(prim, found, len(counts))
        triangles = triangles[Faces(positions, triangles, counts, reach).marked(solid)]
    orientation = mesh.GetOrientationAttr()
    if orientation.HasAuthoredValue() and value(orientation) == UsdGeom.Tokens.leftHanded:
        triangles = np.ascontiguousarray(triangles[:, ::-1])
    triangles.flags.writeable = False
    return Faces(positions, triangles, counts, reach, solid) if len(triangles) else None


def triangulated(counts: Numbers, indices: Numbers) -> Triangles:
    """(t, 3) triangles: every face as a fan about its first corner.

    Args:
        counts: (f,) corners of each face; those with less than 3 make no triangle.
        indices: (sum of counts,) their corners.
    """
    fewest, most = (counts.min(), counts.max()) if len(counts) else (3, 3)
    if fewest == most == 3:
        return indices.reshape(-1, 3)
    if fewest == most == 4:
        quads = indices.reshape(-1, 4)
        halves = np.zeros((len(quads), 2, 3), np.int32)
        halves[:, 0], halves[:, 1, 0], halves[:, 1, 1:] = quads[:, :3], quads[:, 0], quads[:, 2:]
        return halves.reshape(-1, 3)
    each = np.maximum(counts.astype(np.int64) - 2, 0)
    face = np.repeat(np.arange(len(each)), each)
    start = np.cumsum(counts, dtype=np.int64) - counts
    # The number of each triangle in its fan.
    turn = np.arange(len(face)) - np.repeat(np.cumsum(each) - each, each)
    first = start[face]
    corners = np.stack([first, first + turn + 1, first + turn + 2], axis=1)
    triangles: Triangles = indices[corners]
    return triangles


def _checked_reach(prim: Prim, positions: Positions, counts: Numbers, indices: Numbers) -> float:
    total = int(counts.sum(dtype=np.int64))
    if counts.min(initial=0) < 0 or total != len(indices):
        raise LevelError(
            "The faces of this mesh claim more or fewer corners than it has.",
            where=path_of(prim),
            known=f"faceVertexCounts adds up to {total:,}, and there are {len(indices):,} faceVertexIndices.",
            remedy=MEND,
        )
    if len(indices) and (indices.min() < 0 or indices.max() >= len(positions)):
        worst = int(indices.min() if indices.min() < 0 else indices.max())
        raise LevelError(
            f"A face of this mesh has the corner {worst}, which does not exist.",
            where=path_of(prim),
            known=f"The mesh has {len(positions):,} points, counted from 0.",
            remedy=MEND,
        )
    # The largest of numbers is finite only where all are.
    reach = float(np.abs(positions).max(initial=0.0))
    if not math.isfinite(reach):
        row = int(np.flatnonzero(~np.isfinite(positions).all(axis=1))[0])
        raise LevelError(
            f"Point {row:,} of this mesh is not finite.",
            where=path_of(prim),
            known=f"It is {tuple(map(float, positions[row]))}.",
            remedy=MEND,
        )
    return reach


def _in_holes(prim: Prim, holes: Numbers, count: int) -> Flags:
    if holes.min() < 0 or holes.max() >= count:
        raise LevelError(
            f"holeIndices names face {int(holes.max())}, which does not exist.",
            where=path_of(prim),
            known=f"The mesh has {count:,} faces, counted from 0.",
            remedy=MEND,
        )
    marked = np.zeros(count, bool)
    marked[holes] = True
    return marked
