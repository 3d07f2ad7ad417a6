"""Buffer views as arrays: typed and strided, without a copy.

Source: glTF 2.0 specification (Khronos), sections 3.6.1.1 "Buffer views" and 3.6.2.4 "Data alignment".
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.buffers import BufferReader, has_data
from scenes.gltf.extensions import MESHOPT

# componentType -> little-endian numpy type.
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


class UnreadError(LevelError):
    """Data in a form that this version does not read.

    Attributes:
        feature: The form, in words.
    """

    def __init__(self, feature: str, where: str) -> None:
        super().__init__(f"This version does not read {feature} yet.", where=where)
        self.feature = feature


class Shape(NamedTuple):
    """How many elements of which kind a reference into a buffer view means."""

    component: str
    width: int
    length: int


class ViewReader:
    """Reads the buffer views of one asset; a buffer that is used twice is read once."""

    def __init__(self, asset: Asset) -> None:
        self._asset = asset
        self._reader = BufferReader(asset)
        self._buffers: dict[int, memoryview] = {}

    def elements(self, entry: Entry, shape: Shape) -> npt.NDArray[Any]:
        """(length, width) of the component type: a view of the buffer at `bufferView` and `byteOffset`.

        Raises:
            LevelError: There is no such view, its stride is too small, or the elements lie outside of it.
            UnreadError: The view is compressed by meshopt alone.
        """
        item_bytes = np.dtype(shape.component).itemsize
        start = entry.integer("byteOffset", 0)
        view = self._asset.linked(entry, "bufferView", "bufferViews")[1]
        # Some exporters write a stride of 0 for "packed".
        stride = view.integer("byteStride", 0) or item_bytes * shape.width
        if stride < item_bytes * shape.width:
            raise view.wrong("byteStride", f"at least {item_bytes * shape.width}, the size of one element")
        content = self._content(view)
        end = start + max(shape.length - 1, 0) * stride + item_bytes * shape.width if shape.length else start
        if end > len(content):
            raise LevelError(
                f"The accessor ends at byte {end} of its buffer view.",
                where=entry.where,
                known=f"The {view.where} has {len(content)} bytes.",
                remedy="The file is damaged or cut off: export it again.",
            )
        if not shape.length:
            return np.zeros((0, shape.width), shape.component)
        strides = (stride, item_bytes)
        return np.ndarray((shape.length, shape.width), shape.component, content, start, strides)

    def content(self, entry: Entry) -> memoryview:
        """The bytes of the view that `bufferView` names.

        Raises:
            LevelError: There is no such view, or it lies outside its buffer.
        """
        return self._content(self._asset.linked(entry, "bufferView", "bufferViews")[1])

    def _content(self, view: Entry) -> memoryview:
        index, buffer = self._asset.linked(view, "buffer", "buffers")
        start, length = view.integer("byteOffset", 0), view.integer("byteLength")
        if any(view.extension(name) for name in MESHOPT) and not has_data(self._asset, index, view.where):
            raise UnreadError(f"meshopt compression ({MESHOPT[0]})", where=view.where)
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
