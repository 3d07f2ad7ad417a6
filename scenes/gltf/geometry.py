"""Primitives of a glTF mesh as triangle lists.

Source: glTF 2.0 specification (Khronos), section 3.7.2.1 "Overview" (topology types) of "Meshes".
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.accessors import AccessorReader, finite_positions, known_vertices
from scenes.gltf.asset import Asset
from scenes.gltf.draco import DracoReader
from scenes.gltf.extensions import DRACO
from scenes.gltf.manifold import promises_closed
from scenes.gltf.materials import Surface, read_surface
from scenes.gltf.morphing import Weights, default_weights, morphed
from scenes.gltf.views import UnreadError
from scenes.level import NoteBook
from scenes.scene import Positions, Triangles

TRIANGLES, STRIP, FAN = 4, 5, 6
LINES_AND_POINTS = (0, 1, 2, 3)


@dataclass(frozen=True)
class Part:
    """One primitive as the scene keeps it.

    Attributes:
        positions: (v, 3) float32, local space, read-only.
        triangles: (t, 3) int32, read-only.
        surface: How it casts and looks.
        reach: The largest absolute coordinate, in local units.
        promised_closed: Whether the author promises that the parts of its mesh close together.
    """

    positions: Positions
    triangles: Triangles
    surface: Surface
    reach: float
    promised_closed: bool = False


class GeometryReader:
    """Reads the meshes of one asset; nodes that share a mesh, or primitives that share data, share arrays.

    Attributes:
        accessors: Its accessors.
        lost: What kept geometry from being read, in words, each once.
    """

    def __init__(self, asset: Asset, notes: NoteBook) -> None:
        self._asset = asset
        self._notes = notes
        self.accessors = AccessorReader(asset)
        self._draco = DracoReader(self.accessors.views)
        self._meshes: dict[tuple[int, Weights], tuple[Part, ...]] = {}
        self._triangles: dict[tuple[int | None, int, int], Triangles] = {}
        self._decoded: dict[tuple[int, int, int, int | None], tuple[Positions, Triangles]] = {}
        self.lost: dict[str, None] = {}

    def mesh(self, index: int, node: Entry) -> tuple[Part, ...]:
        """The primitives that hold triangles of the mesh that a node draws, morphed as the node says.

        Raises:
            LevelError: The mesh does not exist or its data is broken.
        """
        mesh = self._asset.entry("meshes", index, node.where)
        try:
            weights = default_weights(mesh, node)
            if (index, weights) not in self._meshes:
                self._meshes[index, weights] = self._parts(mesh, weights)
        except LevelError as error:
            # Authors know their nodes by name, and accessors not at all.
            place = error.where if error.where.startswith(mesh.where) else f"{mesh.where}, {error.where}"
            error.where = f"{node.where}, {place}"
            raise
        return self._meshes[index, weights]

    def mesh_name(self, index: int, referrer: str) -> str:
        """The author's name for a mesh, empty where there is none."""
        return self._asset.entry("meshes", index, referrer).text("name")

    def _parts(self, mesh: Entry, weights: Weights) -> tuple[Part, ...]:
        found = [self._part(mesh, i, values, weights) for i, values in enumerate(mesh.items("primitives"))]
        parts = tuple(part for part in found if part is not None)
        corners = sum(part.triangles.size for part in parts) if len(parts) == len(found) else None
        if not promises_closed(self._asset, mesh, corners, self._notes):
            return parts
        if not all(part.surface.casts for part in parts):
            self._notes.info(mesh.where, "Promised to be closed, but parts of it cast no shadow.")
            return parts
        return tuple(replace(part, promised_closed=True) for part in parts)

    def _part(self, mesh: Entry, number: int, values: object, weights: Weights) -> Part | None:
        where = f"{mesh.where}, primitive {number}"
        if not isinstance(values, dict):
            raise mesh.wrong("primitives", "a list of objects")
        primitive = Entry(values, where)
        mode = primitive.integer("mode", TRIANGLES)
        if mode in LINES_AND_POINTS:
            self._notes.info(where, "Points and lines cast no shadow and are skipped.")
            return None
        if mode not in (TRIANGLES, STRIP, FAN):
            raise primitive.wrong("mode", "a whole number from 0 to 6")
        if not primitive.child("attributes").has("POSITION"):
            self._lose(where, "primitives without a POSITION accessor")
            return None
        try:
            positions, triangles = self._shape(primitive, mode)
            positions = morphed(self._asset, self.accessors, primitive, positions, weights, self._notes)
        except UnreadError as error:
            self._lose(where, error.feature)
            return None
        reach = max(float(positions.max(initial=0.0)), -float(positions.min(initial=0.0)))
        return Part(positions, triangles, read_surface(self._asset, primitive, self._notes), reach)

    def _lose(self, where: str, feature: str) -> None:
        self.lost[feature] = None
        self._notes.warning(where, f"Skipped: this version does not read {feature} yet.")

    def _shape(self, primitive: Entry, mode: int) -> tuple[Positions, Triangles]:
        """Positions and triangles: those of the accessors, also where Draco offers the same once more."""
        position = primitive.child("attributes").integer("POSITION")
        order = primitive.integer("indices") if primitive.has("indices") else None
        draco = primitive.extension(DRACO)
        used = [index for index in (position, order) if index is not None]
        if draco is not None and not all(self.accessors.has_data(i, primitive.where) for i in used):
            return self._decompressed(primitive, draco, position, order, mode)
        positions = self.accessors.positions(position, primitive.where)
        key = (order, len(positions), mode)
        if key not in self._triangles:
            listed = None
            if order is not None:
                listed = self.accessors.indices(order, len(positions), primitive.where)
            self._triangles[key] = self._triangle_list(primitive, listed, len(positions), mode)
        return positions, self._triangles[key]

    def _decompressed(
        self, primitive: Entry, draco: Entry, position: int, order: int | None, mode: int
    ) -> tuple[Positions, Triangles]:
        if mode == FAN:
            raise primitive.wrong("mode", "4 or 5 (triangles or a strip) where Draco compresses them")
        key = (draco.integer("bufferView"), draco.child("attributes").integer("POSITION"), position, order)
        if key not in self._decoded:
            vertices = self.accessors.count(position, primitive.where)
            corners_ = self.accessors.count(primitive.integer("indices"), primitive.where)
            found, triangles = self._draco.primitive(draco, vertices, corners_, strip=mode == STRIP)
            values = self.accessors.dequantised(found, position, primitive.where)
            known_vertices(triangles.ravel(), len(values), draco.where)
            self._decoded[key] = finite_positions(values, draco.where), _signed(triangles)
        return self._decoded[key]

    def _triangle_list(
        self, primitive: Entry, order: npt.NDArray[np.unsignedinteger] | None, vertex_count: int, mode: int
    ) -> Triangles:
        count = vertex_count if order is None else len(order)
        if mode == TRIANGLES and count % 3:
            self._notes.warning(primitive.where, f"The last {count % 3} of {count} indices make no triangle.")
        if mode == TRIANGLES and order is not None:
            return _signed(order[: count // 3 * 3].reshape(-1, 3))
        joined = corners(count, mode)
        return _signed(joined if order is None else order[joined])


def _signed(triangles: npt.NDArray[np.integer]) -> Triangles:
    """(t, 3) int32, read-only: the very memory of what is 32 bits wide already, such as the file's own."""
    packed = triangles.flags.c_contiguous and triangles.flags.aligned
    wide = triangles.dtype == np.dtype("<u4")
    signed: Triangles = triangles.view(np.int32) if packed and wide else triangles.astype(np.int32)
    signed.flags.writeable = False
    return signed


def corners(count: int, mode: int) -> npt.NDArray[np.int32]:
    """(t, 3) int32: which of `count` vertices in drawing order each triangle joins, front faces alike.

    Source: glTF 2.0 specification, section 3.7.2.1: triangles {3i, 3i+1, 3i+2}; strips
    {i, i + (1 + i % 2), i + (2 - i % 2)}; fans {i + 1, i + 2, 0}.
    """
    if mode == TRIANGLES:
        return np.arange(count // 3 * 3, dtype=np.int32).reshape(-1, 3)
    i = np.arange(max(count - 2, 0), dtype=np.int32)
    if mode == STRIP:
        return np.stack([i, i + 1 + i % 2, i + 2 - i % 2], axis=1)
    assert mode == FAN
    return np.stack([i + 1, i + 2, np.zeros_like(i)], axis=1)
