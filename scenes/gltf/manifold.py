"""The author's promise that a mesh is closed.

Source: EXT_mesh_manifold (Khronos): the primitives of the mesh are together an oriented 2-manifold once the
vertices are merged that stand in the same place.
"""

from __future__ import annotations

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.extensions import MANIFOLD
from scenes.level import NoteBook

TRIANGLES = 4


def promises_closed(asset: Asset, mesh: Entry, corners: int | None, notes: NoteBook) -> bool:
    """Whether the mesh is promised to be closed, by a promise that its primitives do not break at once.

    Args:
        asset: The file.
        mesh: The mesh.
        corners: Indices of all its triangles together; None where not all of it was read.
        notes: Told of a promise that is broken.
    """
    try:
        extension = mesh.extension(MANIFOLD)
        if extension is None:
            return False
        primitive = extension.child("manifoldPrimitive")
        stated = asset.linked(primitive, "indices", "accessors")[1].integer("count")
        kept = corners == stated and primitive.integer("mode", TRIANGLES) == TRIANGLES
    except LevelError as error:
        # What depends on it is a remark only: the geometry itself stands in the primitives.
        notes.warning(mesh.where, f"{MANIFOLD} is not understood and ignored: {error.what}")
        return False
    if not kept:
        notes.warning(
            mesh.where,
            f"{MANIFOLD} promises closed geometry, but for {stated:,} indices, and the primitives that are "
            f"read have {'fewer' if corners is None else f'{corners:,}'}: ignored.",
        )
    return kept
