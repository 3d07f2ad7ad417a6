"""Binary PLY of the layout that nearly all programs write, read as it lies in the file.

Source: G. Turk, "The PLY polygon file format" (1994). trimesh reads the other layouts; of this one it makes
arrays of twice the size, and takes the first face's number of corners for that of all.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from scenes.errors import LevelError
from scenes.scene import Array, Triangles

_INTEGERS = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
}
_TYPES = _INTEGERS | {
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
_CORNERS = ("vertex_indices", "vertex_index")
_END = b"end_header"
# Longer headers, and numbers with more digits, are left to trimesh.
_LONGEST_HEADER, _MOST_DIGITS, _MOST_PROPERTIES = 65536, 15, 256


@dataclass
class _Element:
    """What a header says of one kind of element: its scalars and lists, with numpy's types."""

    name: str
    count: int
    properties: list[tuple[str, str]] = field(default_factory=list)
    lists: list[tuple[int, str, str]] = field(default_factory=list)


def read_binary_ply(source: bytes) -> tuple[Array, Triangles] | None:
    """(v, 3) float32 or float64 corners and (t, 3) indices, not yet checked; None for any other layout.

    Polygons become fans.

    Raises:
        LevelError: The file is cut short, or its faces have different numbers of corners.
    """
    header, start = _header(source)
    if len(header) != 2 or [one.name for one in header] != ["vertex", "face"]:
        return None
    vertex, face = header
    kinds = dict(vertex.properties)
    if vertex.lists or len(kinds) != len(vertex.properties) or not {"x", "y", "z"} <= kinds.keys():
        return None
    if len(face.lists) != 1 or not vertex.count or not face.count:
        return None
    corners = _rows(source, start, np.dtype(vertex.properties), vertex.count)
    axes = [corners[axis] for axis in "xyz"]
    points = np.stack(axes, axis=1, dtype=np.result_type(*axes, np.float32).newbyteorder("="))
    return points, _fans(_polygons(source, start + corners.nbytes, face))


def _header(source: bytes) -> tuple[list[_Element], int]:
    """What the header of a binary file says, and the byte behind it; nothing where it is of another kind."""
    end = source.find(_END, 0, _LONGEST_HEADER)
    start = source.find(b"\n", end) + 1
    try:
        magic, form, *lines = source[: max(end, 0)].decode("ascii").splitlines()
        order = _ORDERS[form.split()[1]]
        if magic != "ply" or source[end:start].strip() != _END:
            return [], 0
        elements: list[_Element] = []
        for words in map(str.split, lines):
            _take(words, order, elements)
    except (KeyError, IndexError, ValueError):
        return [], 0
    return elements, start


def _take(words: list[str], order: str, elements: list[_Element]) -> None:
    """Takes one line of a header.

    Raises:
        KeyError, IndexError, ValueError: It is no line of the kind that is read here.
    """
    match words:
        case [] | ["comment" | "obj_info", *_]:
            return
        case ["element", name, count] if count.isdigit() and len(count) <= _MOST_DIGITS:
            elements.append(_Element(name, int(count)))
        case ["property", "list", length, item, name] if name in _CORNERS:
            one = elements[-1]
            one.lists.append((len(one.properties), order + _INTEGERS[length], order + _INTEGERS[item]))
        case ["property", kind, name] if len(elements[-1].properties) < _MOST_PROPERTIES:
            elements[-1].properties.append((name, order + _TYPES[kind]))
        case _:
            raise ValueError(words)


def _polygons(source: bytes, start: int, face: _Element) -> npt.NDArray[np.integer]:
    """(f, n) indices: the corners of faces that all have n of them."""
    place, length, item = face.lists[0]
    # Their names may be anything, and mean nothing here.
    before = sum(np.dtype(kind).itemsize for _, kind in face.properties[:place])
    after = sum(np.dtype(kind).itemsize for _, kind in face.properties[place:])
    corners = max(int(_rows(source, start + before, np.dtype(length), 1)[0]), 0)
    if corners * np.dtype(item).itemsize > len(source) - start:
        raise _cut_short(source, corners * np.dtype(item).itemsize)
    row = np.dtype([("", f"V{before}"), ("n", length), ("i", item, (corners,)), ("", f"V{after}")])
    # Where the numbers differ, so does the length: that is said first.
    rows = _rows(source, start, row, min(face.count, (len(source) - start) // row.itemsize))
    if (rows["n"] != corners).any():
        raise LevelError(
            "The faces of this PLY file have different numbers of corners.",
            where=f"face {int(np.argmax(rows['n'] != corners))}",
            known=f"The first has {corners} corners.",
            remedy="Export it again, as triangles, or as text.",
        )
    polygons: npt.NDArray[np.integer] = _rows(source, start, row, face.count)["i"]
    return polygons


def _fans(polygons: npt.NDArray[np.integer]) -> Triangles:
    steps = range(1, polygons.shape[1] - 1)
    fans = np.zeros((len(polygons), len(steps), 3), polygons.dtype.newbyteorder("="))
    fans[:, :, 0] = polygons[:, :1]
    fans[:, :, 1] = polygons[:, 1:-1]
    fans[:, :, 2] = polygons[:, 2:]
    return fans.reshape(-1, 3)


def _rows(source: bytes, start: int, row: np.dtype[np.void] | np.dtype[np.generic], count: int) -> np.ndarray:
    if start + count * row.itemsize > len(source):
        raise _cut_short(source, start + count * row.itemsize)
    return np.frombuffer(source, row, count, start)


def _cut_short(source: bytes, needed: int) -> LevelError:
    return LevelError(
        "This PLY file was cut short.",
        known=f"It has {len(source):,} bytes and needs {needed:,} at least.",
        remedy="Export it again, as triangles.",
    )
