"""Meshes of a USD stage as triangle lists.

Sources: OpenUSD, "UsdGeomMesh" (faces, holes, orientation). Faces become fans, as in Hydra (HdMeshUtil).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from pxr import UsdGeom

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Array, Positions, Triangles
from scenes.usd.values import MEND, Prim, array, borrowed, path_of, value
from scenes.usd.walk import Item

Numbers = npt.NDArray[np.int32]
_FLOAT, _INT = np.dtype(np.float32), np.dtype(np.int32)
_TURNED = ("holeIndices", "orientation")
LONG = 8192
"""From so many numbers in an array on, a call of its own for each is faster than `reduceat` (as measured)."""
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


class _Lists(NamedTuple):
    """The arrays of a mesh as USD holds them: not to be kept."""

    item: Item
    positions: Positions
    counts: Numbers
    indices: Numbers


def read_meshes(items: Sequence[Item], notes: NoteBook, *, moving: bool) -> list[Faces | None]:
    """The faces of each mesh as triangles; None where it has none. Levels have thousands: all at once.

    Args:
        items: The meshes.
        notes: For what is odd about them.
        moving: Whether the stage has time samples at all.

    Raises:
        LevelError: Their arrays contradict each other, or a position is not finite.
    """
    lists = [_lists(item, notes, moving=moving) for item in items]
    filled = [index for index, one in enumerate(lists) if one is not None]
    kept = [one for one in lists if one is not None]
    found: list[Faces | None] = [None] * len(items)
    if not kept:
        return found
    fewest, most = _face_sizes(kept)
    triangles = _triangles(kept, fewest, most)
    positions = _parted(_joined([one.positions for one in kept]), [len(one.positions) for one in kept])
    reaches = _reaches(kept, positions)
    for index, one, places, corners, least, reach in zip(
        filled, kept, positions, triangles, fewest.tolist(), reaches.tolist(), strict=True
    ):
        if least < 3:
            strays = int(np.count_nonzero(one.counts < 3))
            notes.warning(
                path_of(one.item.prim), f"{strays:,} of its faces have less than 3 corners: they are skipped."
            )
        if not len(corners):
            continue
        faces = Faces(places, corners, one.counts, reach)
        found[index] = faces if one.item.authored.isdisjoint(_TURNED) else _oriented(one.item, faces)
    return found


def _lists(item: Item, notes: NoteBook, *, moving: bool) -> _Lists | None:
    prim = item.prim
    points = prim.GetAttribute("points")
    corners, indices = prim.GetAttribute("faceVertexCounts"), prim.GetAttribute("faceVertexIndices")
    found = _Lists(
        item,
        borrowed(points, _FLOAT, (-1, 3)),
        borrowed(corners, _INT),
        borrowed(indices, _INT),
    )
    if not len(found.counts) and not len(found.indices):
        notes.info(path_of(prim), "This mesh has no faces.")
        return None
    if moving and points.ValueMightBeTimeVarying():
        notes.info(path_of(prim), "Its points move over time: their first time sample is read.")
    if not (len(found.counts) and len(found.indices) and len(found.positions)):
        _refuse(found)
        # Faces without any corner.
        return None
    return found


def _face_sizes(lists: Sequence[_Lists]) -> tuple[Numbers, Numbers]:
    """(m,) the fewest and the most corners of a face of each mesh.

    Raises:
        LevelError: They do not add up to the corners that a mesh has.
    """
    arrays = [one.counts for one in lists]
    lengths = [len(one) for one in arrays]
    counts = arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
    fewest, most = _reduced(np.minimum, counts, lengths), _reduced(np.maximum, counts, lengths)
    total = fewest * np.array(lengths)
    for index in np.flatnonzero(fewest != most).tolist():
        total[index] = arrays[index].sum(dtype=np.int64)
    _require((fewest >= 0) & (total == [len(one.indices) for one in lists]), lists)
    return fewest, most


def _reduced(ufunc: np.ufunc, joined: npt.NDArray[Any], lengths: Sequence[int]) -> npt.NDArray[Any]:
    """(m,) the least or greatest number of each of the arrays that are joined."""
    starts = _starts(lengths)
    if len(joined) > LONG * len(lengths):
        parts = (joined[start : start + length] for start, length in zip(starts, lengths, strict=True))
        return np.array([ufunc.reduce(part) for part in parts])
    found: npt.NDArray[Any] = ufunc.reduceat(joined, starts)
    return found


def _triangles(lists: Sequence[_Lists], fewest: Numbers, most: Numbers) -> list[Triangles]:
    """(t, 3) triangles of each mesh; where all faces are triangles or quadrilaterals, made at once.

    Raises:
        LevelError: One has a corner that does not exist.
    """
    faces = [len(one.counts) for one in lists]
    if (fewest == 3).all() and (most == 3).all():
        triangles = _joined([one.indices for one in lists]).reshape(-1, 3)
    elif (fewest == 4).all() and (most == 4).all():
        triangles = _halved([one.indices for one in lists])
        faces = [2 * count for count in faces]
    else:
        # Copies: what is checked must not change any more.
        copies = [one.indices.copy() for one in lists]
        for one, copied in zip(lists, copies, strict=True):
            _require(copied.view(np.uint32).max(keepdims=True) < len(one.positions), [one])
        parts = [triangulated(one.counts, copied) for one, copied in zip(lists, copies, strict=True)]
        return _parted(_joined(parts), [len(part) for part in parts])
    # Without a sign, what is below 0 is the greatest.
    highest = _reduced(np.maximum, triangles.ravel().view(np.uint32), [3 * count for count in faces])
    _require(highest < [len(one.positions) for one in lists], lists)
    return _parted(triangles, faces)


def _reaches(lists: Sequence[_Lists], positions: Sequence[Positions]) -> Array:
    """(m,) the largest absolute coordinate of each mesh.

    Raises:
        LevelError: One is not finite.
    """
    whole = positions[0].base if len(positions) > 1 else positions[0]
    assert isinstance(whole, np.ndarray)
    numbers, lengths = whole.view(np.float32).ravel(), [3 * len(one) for one in positions]
    # The largest of numbers is finite only where all are.
    reaches = np.maximum(-_reduced(np.minimum, numbers, lengths), _reduced(np.maximum, numbers, lengths))
    _require(np.isfinite(reaches), lists)
    found: Array = reaches.astype(np.float64)
    return found


def _require(sound: Flags, lists: Sequence[_Lists]) -> None:
    if not sound.all():
        _refuse(lists[int(np.argmin(sound))])


def _joined(arrays: Sequence[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """A copy of all of them, one after the other."""
    return np.concatenate(arrays)


def _starts(lengths: Sequence[int]) -> npt.NDArray[np.int64]:
    sums = np.cumsum(lengths, dtype=np.int64)
    return np.concatenate([[0], sums[:-1]])


def _parted(joined: npt.NDArray[Any], lengths: Sequence[int]) -> list[npt.NDArray[Any]]:
    joined.flags.writeable = False
    ends = np.cumsum(lengths).tolist()
    return [joined[end - length : end] for end, length in zip(ends, lengths, strict=True)]


def _halved(arrays: Sequence[Numbers]) -> Triangles:
    """(t, 3) the two triangles of each quadrilateral."""
    halves = np.zeros((sum(map(len, arrays)) // 4, 6), np.int32)
    ends = np.cumsum([len(one) // 4 for one in arrays]).tolist()
    for one, end in zip(arrays, ends, strict=True):
        quads = one.reshape(-1, 4)
        into = halves[end - len(quads) : end]
        for column, corner in enumerate((0, 1, 2, 0, 2, 3)):
            into[:, column] = quads[:, corner]
    return halves.reshape(-1, 3)


def _oriented(item: Item, faces: Faces) -> Faces | None:
    """The faces without the holes, and counter-clockwise."""
    triangles, solid, prim = faces.triangles, None, item.prim
    if "holeIndices" in item.authored and len(holes := array(prim.GetAttribute("holeIndices"), np.int32)):
        solid = ~_in_holes(prim, holes, len(faces.counts))
        triangles = triangles[faces.marked(solid)]
    if (
        "orientation" in item.authored
        and value(prim.GetAttribute("orientation")) == UsdGeom.Tokens.leftHanded
    ):
        triangles = np.ascontiguousarray(triangles[:, ::-1])
    triangles.flags.writeable = False
    return replace(faces, triangles=triangles, solid=solid) if len(triangles) else None


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
        return _halved([indices])
    each = np.maximum(counts.astype(np.int64) - 2, 0)
    face = np.repeat(np.arange(len(each)), each)
    start = np.cumsum(counts, dtype=np.int64) - counts
    # The number of each triangle in its fan.
    turn = np.arange(len(face)) - np.repeat(np.cumsum(each) - each, each)
    first = start[face]
    corners = np.stack([first, first + turn + 1, first + turn + 2], axis=1)
    triangles: Triangles = indices[corners]
    return triangles


def _refuse(lists: _Lists) -> None:
    """Says what is wrong with a mesh whose faces have no corners, or others than they claim.

    Raises:
        LevelError: Something is.
    """
    prim, positions, counts, indices = lists.item.prim, lists.positions, lists.counts, lists.indices
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
    if not np.isfinite(positions).all():
        row = int(np.flatnonzero(~np.isfinite(positions).all(axis=1))[0])
        raise LevelError(
            f"Point {row:,} of this mesh is not finite.",
            where=path_of(prim),
            known=f"It is {tuple(map(float, positions[row]))}.",
            remedy=MEND,
        )


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
