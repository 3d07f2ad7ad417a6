"""Corners of many triangles, some at a time: expanded all at once they would take 72 bytes for each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.scene import Array, Positions, Triangles

# What is computed from so many corners stays in a core's own cache.
TRIANGLES_AT_ONCE = 4096


def corner_blocks(positions: Positions, triangles: Triangles) -> Iterator[tuple[slice, Array]]:
    """Runs of (t, 3) triangles, and the corners of each as (3, 3, n) float64: corner, axis, triangle."""
    for first in range(0, len(triangles), TRIANGLES_AT_ONCE):
        part = slice(first, min(first + TRIANGLES_AT_ONCE, len(triangles)))
        # Three times as quick as indexing.
        corners = np.take(positions, triangles[part].T, axis=0)
        yield part, corners.transpose(0, 2, 1).astype(np.float64, order="C")


def face_crosses(corners: Array) -> Array:
    """(3, n) float64 cross products of the sides of (3, 3, n) corners: twice as long as the areas."""
    (ax, ay, az), (bx, by, bz) = corners[1] - corners[0], corners[2] - corners[0]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def lengths(columns: Array) -> Array:
    """(n,) float64 lengths of (3, n) vectors."""
    x, y, z = columns
    found: Array = np.sqrt(x * x + y * y + z * z)
    return found
