"""Accessors: typed, strided and normalised views of buffers as arrays.

Source: glTF 2.0 specification (Khronos), section 3.6.2 "Accessors".
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.buffers import BufferReader
from scenes.gltf.entry import Entry
from scenes.scene import Positions

# componentType -> little-endian numpy type.
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
INDEX_COMPONENTS = (5121, 5123, 5125)


class AccessorReader:
    """Reads the accessors of one asset; a buffer or an accessor that is used twice is read once."""

    def __init__(self, asset: Asset) -> None:
        self._asset = asset
        self._reader = BufferReader(asset)
        self._buffers: dict[int, memoryview] = {}
        self._positions: dict[int, Positions] = {}

    def positions(self, index: int, referrer: str) -> Positions:
        """(v, 3) float32 vertex positions, read-only, in the space of the node that draws them.

        Raises:
            LevelError: The accessor is no VEC3, lies outside its buffer, or a position is not finite.
        """
        if index not in self._positions:
            self._positions[index] = self._finite_positions(index, referrer)
        return self._positions[index]

    def _finite_positions(self, index: int, referrer: str) -> Positions:
        accessor = self._asset.entry("accessors", index, referrer)
        values = self._elements(accessor, "VEC3")
        if accessor.boolean("normalized"):
            values = normalised(values)
        # Packed, aligned float32 data stays a view of the file: nothing is copied.
        positions = np.require(values, np.float32, ["C_CONTIGUOUS", "ALIGNED"])
        positions.flags.writeable = False
        finite = np.isfinite(positions).all(axis=1)
        if not finite.all():
            vertex = int(np.argmin(finite))
            raise LevelError(
                f"The position of vertex {vertex} is not finite.",
                where=accessor.where,
                known=f"It is {tuple(map(float, positions[vertex]))}; {np.sum(~finite)} positions are so.",
                remedy="Repair the mesh in the editor and export it again.",
            )
        return positions

    def indices(self, index: int, vertex_count: int, referrer: str) -> npt.NDArray[np.int64]:
        """(n,) int64 vertex indices, each below `vertex_count`.

        Raises:
            LevelError: The accessor is no unsigned SCALAR, lies outside its buffer, or an index is too high.
        """
        accessor = self._asset.entry("accessors", index, referrer)
        if accessor.integer("componentType") not in INDEX_COMPONENTS:
            raise accessor.wrong("componentType", "one of 5121, 5123, 5125 (unsigned) for indices")
        indices = self._elements(accessor, "SCALAR")[:, 0].astype(np.int64)
        if len(indices) and int(indices.max()) >= vertex_count:
            place = int(np.argmax(indices >= vertex_count))
            raise LevelError(
                f"Index {place} refers to vertex {indices[place]}, which does not exist.",
                where=f"{referrer}, {accessor.where}",
                known=f"There are {vertex_count} vertices, counted from 0.",
            )
        return indices

    def _elements(self, accessor: Entry, kind: str) -> npt.NDArray[Any]:
        """(count, width) of the accessor's own component type, a view of the buffer."""
        if accessor.text("type") != kind:
            raise accessor.wrong("type", f'"{kind}" for this use')
        component = COMPONENTS.get(accessor.integer("componentType"))
        if component is None:
            raise accessor.wrong("componentType", f"one of {', '.join(map(str, COMPONENTS))}")
        item_bytes = np.dtype(component).itemsize
        width, count, start = WIDTHS[kind], accessor.integer("count"), accessor.integer("byteOffset", 0)
        _, view = self._asset.linked(accessor, "bufferView", "bufferViews")
        # Some exporters write a stride of 0 for "packed".
        stride = view.integer("byteStride", 0) or item_bytes * width
        if stride < item_bytes * width:
            raise view.wrong("byteStride", f"at least {item_bytes * width}, the size of one element")
        content = self._view(view)
        end = start + max(count - 1, 0) * stride + item_bytes * width if count else start
        if end > len(content):
            raise LevelError(
                f"The accessor ends at byte {end} of its buffer view.",
                where=accessor.where,
                known=f"The {view.where} has {len(content)} bytes.",
                remedy="The file is damaged or cut off: export it again.",
            )
        if not count:
            return np.zeros((0, width), component)
        return np.ndarray((count, width), component, content, start, (stride, item_bytes))

    def _view(self, view: Entry) -> memoryview:
        index, buffer = self._asset.linked(view, "buffer", "buffers")
        start, length = view.integer("byteOffset", 0), view.integer("byteLength")
        if index not in self._buffers:
            self._buffers[index] = self._reader.content(index, view.where)
        content = self._buffers[index]
        if start + length > len(content):
            raise LevelError(
                f"The buffer view ends at byte {start + length} of its buffer.",
                where=view.where,
                known=f"The {buffer.where} has {len(content)} bytes.",
                remedy="The file is damaged or cut off: export it again.",
            )
        return content[start : start + length]


def normalised(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Integers as fractions of their type's largest value; floats as they are.

    Source: glTF 2.0 specification, section 3.11 (as for KHR_mesh_quantization): c / (2^b - 1) where
    unsigned, max(c / (2^(b-1) - 1), -1) where signed.
    """
    if values.dtype.kind == "f":
        return values
    fractions = values.astype(np.float64) / np.iinfo(values.dtype).max
    return np.maximum(fractions, -1.0)
