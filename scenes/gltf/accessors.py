"""Accessors: what meshes, instances and skins refer to, as arrays that hold what they promise.

Source: glTF 2.0 specification (Khronos), section 3.6.2 "Accessors".
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.sparse import INDEX_COMPONENTS, substituted
from scenes.gltf.views import COMPONENTS, Shape, UnreadError, ViewReader
from scenes.scene import Positions

WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
FLOAT = 5126

Floats = npt.NDArray[np.float32]


class AccessorReader:
    """Reads the accessors of one asset; positions that are used twice are read once.

    Attributes:
        views: Its buffer views.
    """

    def __init__(self, asset: Asset) -> None:
        self._asset = asset
        self.views = ViewReader(asset)
        self._positions: dict[int, Positions] = {}

    def positions(self, index: int, referrer: str) -> Positions:
        """(v, 3) float32 vertex positions, read-only, in the space of the node that draws them.

        Raises:
            LevelError: The accessor is no VEC3, lies outside its buffer, or a position is not finite.
        """
        if index not in self._positions:
            accessor = self._asset.entry("accessors", index, referrer)
            self._positions[index] = finite_positions(self._floats(accessor, "VEC3"), accessor.where)
        return self._positions[index]

    def floats(self, index: int, kind: str, referrer: str, *, integers: tuple[int, ...] = ()) -> Floats:
        """(count, width) float32 of an accessor of floats, or of normalised integers where these may be.

        Args:
            index: The accessor.
            kind: The `type` that it must have.
            referrer: Who asks for it.
            integers: Component types of integers that are taken, where they are normalised.

        Raises:
            LevelError: The accessor is of another type or lies outside its buffer.
        """
        accessor = self._asset.entry("accessors", index, referrer)
        component = accessor.integer("componentType")
        if component != FLOAT and (component not in integers or not accessor.boolean("normalized")):
            also = f", or one of {', '.join(map(str, integers))}, normalised" if integers else ""
            raise accessor.wrong("componentType", f"{FLOAT} (float) for this use{also}")
        return self._floats(accessor, kind)

    def indices(self, index: int, vertex_count: int, referrer: str) -> npt.NDArray[Any]:
        """(n,) vertex indices of the accessor's own unsigned type, each below `vertex_count`.

        Raises:
            LevelError: The accessor is no unsigned SCALAR, lies outside its buffer, or an index is too high.
        """
        accessor = self._asset.entry("accessors", index, referrer)
        if accessor.integer("componentType") not in INDEX_COMPONENTS:
            raise accessor.wrong("componentType", "one of 5121, 5123, 5125 (unsigned) for indices")
        return known_vertices(
            self._elements(accessor, "SCALAR")[:, 0], vertex_count, f"{referrer}, {accessor.where}"
        )

    def count(self, index: int, referrer: str) -> int:
        """How many elements the accessor states.

        Raises:
            LevelError: There is no such accessor, or it states none.
        """
        return self._asset.entry("accessors", index, referrer).integer("count")

    def dequantised(self, values: Floats, index: int, referrer: str) -> Floats:
        """`values`, the accessor's own before they were compressed, as the fractions that it may stand for.

        Raises:
            LevelError: There is no such accessor, or it is of an unknown type.
        """
        accessor = self._asset.entry("accessors", index, referrer)
        component = COMPONENTS.get(accessor.integer("componentType"))
        if component is None:
            raise accessor.wrong("componentType", f"one of {', '.join(map(str, COMPONENTS))}")
        if not accessor.boolean("normalized") or component == "<f4":
            return values
        return normalised(values.astype(component)).astype(np.float32)

    def has_data(self, index: int, referrer: str) -> bool:
        """Whether the accessor says itself what it holds.

        Raises:
            LevelError: There is no such accessor.
        """
        accessor = self._asset.entry("accessors", index, referrer)
        return accessor.has("bufferView") or accessor.has("sparse")

    def _floats(self, accessor: Entry, kind: str) -> Floats:
        values = self._elements(accessor, kind)
        if accessor.boolean("normalized"):
            values = normalised(values)
        # Packed, aligned float32 data stays a view of the file: nothing is copied.
        floats: Floats = np.require(values, np.float32, ["C_CONTIGUOUS", "ALIGNED"])
        return floats

    def _elements(self, accessor: Entry, kind: str) -> npt.NDArray[Any]:
        """(count, width) of the accessor's own component type: a view of the buffer, unless it is sparse."""
        if accessor.text("type") != kind:
            raise accessor.wrong("type", f'"{kind}" for this use')
        component = COMPONENTS.get(accessor.integer("componentType"))
        if component is None:
            raise accessor.wrong("componentType", f"one of {', '.join(map(str, COMPONENTS))}")
        shape = Shape(component, WIDTHS[kind], accessor.integer("count"))
        sparse = accessor.has("sparse")
        if accessor.has("bufferView"):
            elements = self.views.elements(accessor, shape)
        elif sparse:
            elements = np.zeros((shape.length, shape.width), component)
        else:
            raise UnreadError("accessors without data, which stand for zeros", where=accessor.where)
        return substituted(elements, accessor, shape, self.views) if sparse else elements


def finite_positions(positions: Positions, where: str) -> Positions:
    """`positions`, (v, 3) float32, made read-only.

    Raises:
        LevelError: One of them is not finite.
    """
    positions.flags.writeable = False
    # One number tells of all: no temporary as large as the positions is made unless there is cause.
    with np.errstate(over="ignore", invalid="ignore"):
        sound = np.isfinite(positions.sum(dtype=np.float64))
    finite = np.ones(0, bool) if sound else np.isfinite(positions).all(axis=1)
    if not finite.all():
        vertex = int(np.argmin(finite))
        raise LevelError(
            f"The position of vertex {vertex} is not finite.",
            where=where,
            known=f"It is {tuple(map(float, positions[vertex]))}; {np.sum(~finite)} positions are so.",
            remedy="Repair the mesh in the editor and export it again.",
        )
    return positions


def known_vertices(indices: npt.NDArray[Any], vertex_count: int, where: str) -> npt.NDArray[Any]:
    """`indices`, (n,) unsigned, as they are.

    Raises:
        LevelError: One of them is not below `vertex_count`.
    """
    if len(indices) and int(indices.max()) >= vertex_count:
        place = int(np.argmax(indices >= vertex_count))
        raise LevelError(
            f"Index {place} refers to vertex {indices[place]}, which does not exist.",
            where=where,
            known=f"There are {vertex_count} vertices, counted from 0.",
        )
    return indices


def normalised(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Integers as fractions of their type's largest value; floats as they are.

    Source: glTF 2.0 specification, section 3.11 (as for KHR_mesh_quantization): c / (2^b - 1) where
    unsigned, max(c / (2^(b-1) - 1), -1) where signed.
    """
    if values.dtype.kind == "f":
        return values
    fractions = values.astype(np.float64) / np.iinfo(values.dtype).max
    return np.maximum(fractions, -1.0)
