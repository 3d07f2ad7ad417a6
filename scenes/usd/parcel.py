"""A scene on its way from the program that reads USD: few large arrays instead of thousands of small ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from scenes.level import Note
from scenes.scene import Array, Camera, Light, Mesh, Positions, Scene, Triangles

Numbers = npt.NDArray[Any]
Color = tuple[float, float, float]


class Part(NamedTuple):
    """A mesh to be: its name, arrays that are rows of larger ones, and looks, as in `Mesh`."""

    name: str
    positions: Positions
    triangles: Triangles
    placements: Array
    casts: bool
    base_color: Color


class Column(NamedTuple):
    """Arrays of one kind: the large ones of which they are rows, and for each which one and which rows."""

    wholes: list[Numbers]
    rows: list[tuple[int, int, int]]


class Parcel(NamedTuple):
    """A scene and its notes."""

    name: str
    names: list[str]
    columns: tuple[Column, Column, Column]
    looks: list[tuple[bool, Color]]
    lights: tuple[Light, ...]
    cameras: tuple[Camera, ...]
    notes: tuple[Note, ...]


def packed(
    name: str,
    parts: Sequence[Part],
    lights: tuple[Light, ...],
    cameras: tuple[Camera, ...],
    notes: tuple[Note, ...],
) -> Parcel:
    """A scene of these parts, and what there is to say about it."""
    names, positions, triangles, placements, casts, colors = zip(*parts, strict=True) if parts else [()] * 6
    columns = _column(positions), _column(triangles), _column(placements)
    looks = list(zip(casts, colors, strict=True))
    return Parcel(name, list(names), columns, looks, lights, cameras, notes)


def unpacked(parcel: Parcel) -> tuple[Scene, tuple[Note, ...]]:
    """What was packed; what shared an array shares one again."""
    meshes = tuple(
        Mesh(name, positions, triangles, placements, casts, color)
        for name, positions, triangles, placements, (casts, color) in zip(
            parcel.names, *map(_arrays, parcel.columns), parcel.looks, strict=True
        )
    )
    return Scene(parcel.name, meshes, parcel.lights, parcel.cameras), parcel.notes


def _column(arrays: Sequence[Numbers]) -> Column:
    wholes: list[Numbers] = []
    known: dict[int, tuple[int, int]] = {}
    rows = []
    for array in arrays:
        owner = array if array.base is None else array.base
        if id(owner) not in known:
            wholes.append(_whole(array))
            known[id(owner)] = len(wholes) - 1, _address(wholes[-1])
        number, start = known[id(owner)]
        first = (_address(array) - start) // array.strides[0]
        rows.append((number, first, first + len(array)))
    return Column(wholes, rows)


def _whole(array: Numbers) -> Numbers:
    """All that lies in the memory of which an array is rows, as rows of the same kind."""
    base = array.base if isinstance(array.base, np.ndarray) else array
    return base.reshape(-1).view(array.dtype).reshape(-1, *array.shape[1:])


def _address(array: Numbers) -> int:
    return int(array.__array_interface__["data"][0])


def _arrays(column: Column) -> list[Numbers]:
    # What was sent has a type of its own that only equals numpy's: a mesh would take it for another one.
    wholes = [whole.view(np.dtype(whole.dtype.char)) for whole in column.wholes]
    for whole in wholes:
        whole.flags.writeable = False
    made = {(number, first, last): wholes[number][first:last] for number, first, last in column.rows}
    return [made[rows] for rows in column.rows]
