"""Corners of brushes made one where they are one, and what follows from their loops: triangles, volumes."""

from __future__ import annotations

import numpy as np

from scenes.quake.map_text import Indices
from scenes.scene import Array

# Units: 8 um. Corners of one brush nearer than this are one corner; clipping is exact to 1e-8.
WELD = 2.0**-12


def clusters(corners: Array, brush_of: Indices) -> Indices:
    """(v,) int64: corners of one brush that lie within `WELD` of each other have one number."""
    # Loaded by whoever reads a map: every format is known to every command.
    from scipy.sparse import coo_array  # noqa: PLC0415
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415
    from scipy.spatial import cKDTree  # noqa: PLC0415

    if not len(corners):
        return np.zeros(0, np.int64)
    # A fourth coordinate keeps brushes apart.
    tree = cKDTree(np.column_stack([corners, brush_of * (4.0 * WELD)]))
    pairs = tree.query_pairs(WELD, output_type="ndarray")
    links = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(len(corners),) * 2)
    _, labels = connected_components(links, directed=False)
    return labels.astype(np.int64)


def without_repeats(labels: Indices, faces_of: Indices) -> tuple[Indices, Indices]:
    """Loops without corners that repeat their forerunner, and without those of fewer than three corners."""
    if not len(labels):
        return labels, faces_of
    _, starts, sizes = np.unique(faces_of, return_index=True, return_counts=True)
    forerunner = np.arange(len(labels)) - 1
    forerunner[starts] = starts + sizes - 1
    kept = labels != labels[forerunner]
    labels, faces_of = labels[kept], faces_of[kept]
    _, inverse, sizes = np.unique(faces_of, return_inverse=True, return_counts=True)
    enough = (sizes >= 3)[inverse]
    return labels[enough], faces_of[enough]


def fans(offsets: Indices) -> tuple[Indices, Indices]:
    """(t, 3) places in the loops of the triangles that fan each polygon out, and (t,) its polygon."""
    sizes = np.diff(offsets)
    polygon = np.repeat(np.arange(len(sizes)), sizes - 2)
    starts = np.cumsum(np.append(0, sizes - 2))[:-1]
    step = np.arange(len(polygon)) - starts[polygon]
    first = offsets[:-1][polygon]
    return np.stack([first, first + step + 1, first + step + 2], axis=1).astype(np.int64), polygon


def brush_volumes(corners: Array, loops: Indices, faces_of: Indices, owners: Indices, brushes: int) -> Array:
    """(b,) float64: by the divergence theorem, a sixth of the sum of the faces' triple products."""
    if not len(loops):
        return np.zeros(brushes)
    faces, starts = np.unique(faces_of, return_index=True)
    places, polygon = fans(np.append(starts, len(loops)).astype(np.int64))
    a, b, c = (corners[loops[places[:, corner]]] for corner in range(3))
    products = dot(a, np.cross(b, c)) / 6.0
    volumes: Array = np.bincount(owners[faces[polygon]], products, brushes).astype(np.float64)
    return volumes


def dot(one: Array, other: Array) -> Array:
    """Scalar products of vectors on the last axis, with the same bits on every machine: `@` may fuse sums."""
    products = one * other
    total: Array = (products[..., 0] + products[..., 1]) + products[..., 2]
    return total
