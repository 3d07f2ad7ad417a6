"""Binary STL, read as it lies in the file: trimesh makes arrays of twice the size on the way.

Source: 3D Systems, "StereoLithography Interface Specification" (1989): 80 bytes of header, the number of
triangles, and for each a normal, three corners and two bytes.
"""

from __future__ import annotations

import numpy as np

from scenes.scene import Positions, Triangles

HEADER_BYTES = 84
_COUNT_AT = 80
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def triangle_count(source: bytes) -> int | None:
    """How many triangles a binary file says it has; None where it is too short for so many."""
    count = int.from_bytes(source[_COUNT_AT:HEADER_BYTES], "little")
    fits = len(source) >= HEADER_BYTES and len(source) >= HEADER_BYTES + _TRIANGLE.itemsize * count
    return count if fits else None


def read_binary_stl(source: bytes) -> tuple[Positions, Triangles] | None:
    """(3 t, 3) float32 corners and (t, 3) int32 indices, not yet checked; None where the file is no such.

    Its length has to be that of its triangles: a text file may begin with any bytes.
    """
    count = triangle_count(source)
    if not count or len(source) != HEADER_BYTES + _TRIANGLE.itemsize * count:
        return None
    rows = np.frombuffer(source, _TRIANGLE, count, HEADER_BYTES)
    points: Positions = np.array(rows["corners"], np.float32).reshape(-1, 3)
    return points, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
