"""Primitives of a glTF mesh as triangle lists.

Source: glTF 2.0 specification (Khronos), section 3.7.2.1 "Overview" (topology types) of "Meshes".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.errors import LevelError
from scenes.gltf.accessors import AccessorReader
from scenes.gltf.asset import Asset, NoteBook
from scenes.gltf.entry import Entry
from scenes.gltf.extensions import DRACO, unread_feature
from scenes.gltf.materials import Surface, read_surface
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
    """

    positions: Positions
    triangles: Triangles
    surface: Surface
    reach: float


class GeometryReader:
    """Reads the meshes of one asset; nodes that share a mesh, or primitives that share data, share arrays.

    Attributes:
        lost: What kept geometry from being read, in words, each once.
    """

    def __init__(self, asset: Asset, notes: NoteBook) -> None:
        self._asset = asset
        self._notes = notes
        self._accessors = AccessorReader(asset)
        self._meshes: dict[int, tuple[Part, ...]] = {}
        self._triangles: dict[tuple[int | None, int, int], Triangles] = {}
        self.lost: dict[str, None] = {}

    def mesh(self, index: int, referrer: str) -> tuple[Part, ...]:
        """The primitives of a mesh that hold triangles.

        Raises:
            LevelError: The mesh does not exist or its data is broken.
        """
        if index not in self._meshes:
            mesh = self._asset.entry("meshes", index, referrer)
            try:
                parts = [self._part(mesh, i, values) for i, values in enumerate(mesh.items("primitives"))]
            except LevelError as error:
                # Authors know their nodes by name, and accessors not at all.
                place = error.where if error.where.startswith(mesh.where) else f"{mesh.where}, {error.where}"
                error.where = f"{referrer}, {place}"
                raise
            self._meshes[index] = tuple(part for part in parts if part is not None)
        return self._meshes[index]

    def mesh_name(self, index: int, referrer: str) -> str:
        """The author's name for a mesh, empty where there is none."""
        return self._asset.entry("meshes", index, referrer).text("name")

    def _part(self, mesh: Entry, number: int, values: object) -> Part | None:
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
        attributes = primitive.child("attributes")
        if not attributes.has("POSITION"):
            self._lose(primitive, "primitives without a POSITION accessor")
            return None
        if primitive.items("targets"):
            self._notes.warning(where, "Morph targets: read in its rest shape, all weights 0.")
        return self._drawn(primitive, attributes, mode)

    def _drawn(self, primitive: Entry, attributes: Entry, mode: int) -> Part | None:
        used = [attributes.integer("POSITION")]
        if primitive.has("indices"):
            used.append(primitive.integer("indices"))
        draco = primitive.extension(DRACO) is not None
        for index in used:
            feature = unread_feature(self._asset, index, primitive.where, draco=draco)
            if feature is None and not self._asset.entry("accessors", index, primitive.where).has(
                "bufferView"
            ):
                feature = "accessors without data, which stand for zeros"
            if feature is not None:
                self._lose(primitive, feature)
                return None
        positions = self._accessors.positions(used[0], primitive.where)
        return Part(
            positions,
            self._triangle_list(primitive, used[1] if len(used) > 1 else None, len(positions), mode),
            read_surface(self._asset, primitive, self._notes),
            float(np.abs(positions).max(initial=0.0)),
        )

    def _lose(self, primitive: Entry, feature: str) -> None:
        self.lost[feature] = None
        self._notes.warning(primitive.where, f"Skipped: this version does not read {feature} yet.")

    def _triangle_list(
        self, primitive: Entry, accessor: int | None, vertex_count: int, mode: int
    ) -> Triangles:
        key = (accessor, vertex_count, mode)
        if key not in self._triangles:
            order = (
                np.arange(vertex_count)
                if accessor is None
                else self._accessors.indices(accessor, vertex_count, primitive.where)
            )
            if mode == TRIANGLES and len(order) % 3:
                self._notes.warning(
                    primitive.where, f"The last {len(order) % 3} of {len(order)} indices make no triangle."
                )
            triangles = order[corners(len(order), mode)].astype(np.int32)
            triangles.flags.writeable = False
            self._triangles[key] = triangles
        return self._triangles[key]


def corners(count: int, mode: int) -> npt.NDArray[np.int64]:
    """(t, 3) int64: which of `count` vertices in drawing order each triangle joins, front faces alike.

    Source: glTF 2.0 specification, section 3.7.2.1: triangles {3i, 3i+1, 3i+2}; strips
    {i, i + (1 + i % 2), i + (2 - i % 2)}; fans {i + 1, i + 2, 0}.
    """
    if mode == TRIANGLES:
        return np.arange(count // 3 * 3, dtype=np.int64).reshape(-1, 3)
    i = np.arange(max(count - 2, 0), dtype=np.int64)
    if mode == STRIP:
        return np.stack([i, i + 1 + i % 2, i + 2 - i % 2], axis=1)
    assert mode == FAN
    return np.stack([i + 1, i + 2, np.zeros_like(i)], axis=1)
