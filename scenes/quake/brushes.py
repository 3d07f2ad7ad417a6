"""Convex polygons of brushes: each face's plane, clipped by all other planes of its brush.

Source: the winding clipping of id Software's qbsp (`CreateBrushFaces`, 1996), which is Sutherland and
Hodgman's (1974), here for all faces of all brushes of one size at once and in double precision.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.quake.map_parser import FARTHEST_UNITS
from scenes.quake.map_text import Indices, MapText
from scenes.quake.welding import brush_volumes, clusters, dot, without_repeats
from scenes.scene import Array

Flags = npt.NDArray[np.bool_]

# Half a side of the square that is clipped: a corner that is left this far out was clipped by nothing.
_OUTERMOST = 8.0 * FARTHEST_UNITS
_ENDLESS = 2.0 * FARTHEST_UNITS
# Coordinates nearer than this to a 256th of a unit were meant to be there.
_SNAP, _GRID = 1e-6, 256.0
# Two planes of a brush are the same where their normals and distances differ by less.
_SAME_NORMAL, _SAME_DISTANCE = 1e-9, 1e-4
# Sine between two edges of the three points: flatter ones say nothing of the plane.
_FLATTEST = 1e-6
# Cubic units: ten units square and a ten thousandth thick, which is less than corners are welded by.
THINNEST = 1e-2
# Bounds rows of a block, and so its memory to about 100 MB.
_BLOCK_NUMBERS = 1_000_000
# As qbsp's heirs allow; rounder cylinders than this were never seen.
MOST_SIDES = 512


@dataclass(frozen=True)
class Polygons:
    """Faces of brushes as convex polygons.

    Attributes:
        corners: (v, 3) float64, in Quake's units and axes; each corner of a brush once.
        loops: (l,) int64 indices into `corners`: the polygons one after the other, counter-clockwise from
            outside.
        offsets: (p + 1,) int64: polygon i has loops offsets[i] .. offsets[i + 1].
        faces: (p,) int64: the face of the file that each polygon is.
        volumes: (b,) float64 cubic units of each brush; 0 where it is none.
        endless: (b,) bool: its planes leave a side open.
        flat_faces: (f,) bool: the face's three points lie in a line.
    """

    corners: Array
    loops: Indices
    offsets: Indices
    faces: Indices
    volumes: Array
    endless: Flags
    flat_faces: Flags


def polygons(text: MapText) -> Polygons:
    """The polygons of all brushes with a volume, in the order of the file.

    Faces that say the same plane twice, and those that touch their brush in an edge only, have none.
    """
    sizes = np.diff(text.face_offsets)
    owners = np.repeat(np.arange(len(sizes)), sizes)
    # Near its brush a plane is told with more digits; whole units keep that exact.
    centres = np.zeros((len(sizes), 3))
    np.add.at(centres, owners, text.points.mean(axis=1))
    centres = np.round(centres / np.maximum(sizes, 1)[:, None])
    points = text.points - centres[owners, None]
    normals, distances, flat = _planes(points)
    windings: list[Array] = []
    order: list[Indices] = []
    for size in np.unique(sizes[sizes >= 4]):
        faces = (text.face_offsets[:-1][sizes == size][:, None] + np.arange(size)).astype(np.int64)
        for block in np.array_split(faces, 1 + faces.size * int(size) // _BLOCK_NUMBERS):
            chosen = block.ravel()
            clipped, kept = _clipped(normals[block], distances[block], flat[block])
            order.append(np.repeat(chosen, kept))
            windings.append(clipped[np.arange(clipped.shape[1]) < kept[:, None]])
    faces_of = np.concatenate([np.zeros(0, np.int64), *order])
    corners = np.concatenate([np.zeros((0, 3)), *windings])
    in_order = np.argsort(faces_of, kind="stable")
    faces_of, corners = faces_of[in_order], corners[in_order]
    endless = np.zeros(len(sizes), bool)
    endless[owners[faces_of[(np.abs(corners) > _ENDLESS).any(axis=1)]]] = True
    bounded = ~endless[owners[faces_of]]
    return _welded(corners[bounded], faces_of[bounded], owners, centres, endless, flat)


def _planes(points: Array) -> tuple[Array, Array, Flags]:
    """Unit outward normals (f, 3), distances (f,), and which of the faces have no plane."""
    first, second = points[:, 0] - points[:, 1], points[:, 2] - points[:, 1]
    normals = np.cross(first, second)
    lengths = np.linalg.norm(normals, axis=1)
    flat = lengths <= _FLATTEST * np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
    normals /= np.where(flat, 1.0, lengths)[:, None]
    distances: Array = (normals * points[:, 1]).sum(axis=1)
    return normals, distances, flat


def _clipped(normals: Array, distances: Array, flat: Flags) -> tuple[Array, Indices]:
    """(b * n, k, 3) corners and (b * n,) their numbers, for (b, n) planes of b brushes of n sides."""
    brushes, sides = distances.shape
    aligned = dot(normals[:, :, None], normals[:, None]) > 1.0 - _SAME_NORMAL
    near = np.abs(distances[:, :, None] - distances[:, None, :]) < _SAME_DISTANCE
    earlier = np.tri(sides, sides, -1, dtype=bool)
    repeated = (aligned & near & earlier).any(axis=2)
    flat_normals = normals.reshape(-1, 3)
    corners = _squares(flat_normals, distances.ravel())
    counts = np.full(brushes * sides, 4)
    counts[(flat | repeated).ravel()] = 0
    for side in range(sides):
        normal = np.repeat(normals[:, side], sides, axis=0)
        distance = np.repeat(np.where(flat[:, side] | repeated[:, side], np.inf, distances[:, side]), sides)
        distance[side::sides] = np.inf
        corners, counts = _cut(corners, counts, normal, distance)
    return corners, counts


def _squares(normals: Array, distances: Array) -> Array:
    """(f, 4, 3): on each plane a square that is larger than any map, counter-clockwise from outside."""
    least = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    along = np.cross(normals, least)
    along *= _OUTERMOST / np.maximum(np.linalg.norm(along, axis=1), 1e-30)[:, None]
    across = np.cross(normals, along)
    middle = normals * distances[:, None]
    return np.stack(
        [middle - along - across, middle + along - across, middle + along + across, middle - along + across],
        axis=1,
    )


def _cut(corners: Array, counts: Indices, normal: Array, distance: Array) -> tuple[Array, Indices]:
    """What is left of (f, k, 3) convex polygons behind one plane each."""
    places = np.arange(corners.shape[1])
    there = places < counts[:, None]
    heights = dot(corners, normal[:, None]) - np.where(np.isinf(distance), 1e30, distance)[:, None]
    inside = heights <= 0.0
    if inside[there].all():
        return corners, counts
    following = np.where(places + 1 < counts[:, None], places + 1, 0)
    next_heights = np.take_along_axis(heights, following, axis=1)
    crossing = there & (inside != (next_heights <= 0.0))
    share = np.where(crossing, heights, 0.0) / np.where(crossing, heights - next_heights, 1.0)
    nexts = np.take_along_axis(corners, following[..., None], axis=1)
    cuts = corners + share[..., None] * (nexts - corners)
    both = np.stack([corners, cuts], axis=2).reshape(len(corners), -1, 3)
    kept = np.stack([there & inside, crossing], axis=2).reshape(len(corners), -1)
    counts = kept.sum(axis=1)
    order = np.argsort(~kept, axis=1, kind="stable")[:, : max(int(counts.max(initial=0)), 1)]
    return np.take_along_axis(both, order[..., None], axis=1), counts


def _welded(
    corners: Array, faces_of: Indices, owners: Indices, centres: Array, endless: Flags, flat: Flags
) -> Polygons:
    brush_of = owners[faces_of]
    labels = clusters(corners, brush_of)
    count = int(labels.max(initial=-1)) + 1
    sizes = np.maximum(np.bincount(labels, minlength=count), 1)
    means = (
        np.stack([np.bincount(labels, corners[:, axis], count) for axis in range(3)], axis=1) / sizes[:, None]
    )
    meant = np.round(means * _GRID) / _GRID
    means = np.where(np.abs(means - meant) < _SNAP, meant, means)
    loops, faces_of = without_repeats(labels, faces_of)
    volumes = brush_volumes(means, loops, faces_of, owners, len(centres))
    thick = (volumes >= THINNEST)[owners[faces_of]]
    loops, faces_of = loops[thick], faces_of[thick]
    homes = np.zeros(count, np.int64)
    homes[labels] = brush_of
    faces, starts = np.unique(faces_of, return_index=True)
    return Polygons(
        corners=means + centres[homes] if count else means,
        loops=loops,
        offsets=np.append(starts, len(loops)).astype(np.int64),
        faces=faces,
        volumes=np.where(volumes >= THINNEST, volumes, 0.0),
        endless=endless,
        flat_faces=flat,
    )
