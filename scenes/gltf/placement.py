"""Meshes of a glTF file placed in the world, one for every primitive of every node that draws it."""

from __future__ import annotations

import numpy as np

from scenes.errors import LevelError
from scenes.gltf.asset import NoteBook
from scenes.gltf.extensions import INSTANCING
from scenes.gltf.geometry import GeometryReader
from scenes.gltf.magnitudes import LARGEST
from scenes.gltf.nodes import PlacedNode
from scenes.gltf.transforms import is_flat
from scenes.scene import Mesh


def place_meshes(geometry: GeometryReader, node: PlacedNode, notes: NoteBook) -> list[Mesh]:
    """The meshes that a node draws, with `node` set; they share the arrays of other nodes' meshes.

    Raises:
        LevelError: The mesh is broken, or the node's transform squashes it or moves it too far.
    """
    entry = node.entry
    if not entry.has("mesh"):
        return []
    # Source: glTF 2.0 specification, section 3.5.3: a scale of 0 on all axes is how nodes are hidden.
    if not node.world[:3, :3].any():
        notes.warning(entry.where, "Hidden by a scale of 0 on all axes: its mesh is skipped.")
        return []
    if is_flat(node.world):
        raise LevelError(
            "The transform of this node squashes its mesh into a plane, a line or a point.",
            where=entry.where,
            known=f"Its world axes are {_axes(node)}.",
            remedy="Give the node, and those above it, a scale other than 0 on every axis.",
        )
    parts = geometry.mesh(entry.integer("mesh"), entry.where)
    if parts and entry.has("skin"):
        notes.warning(
            entry.where,
            "Skinned: read in the bind pose that its positions state, with the node's own transform.",
        )
    if parts and entry.extension(INSTANCING) is not None:
        notes.warning(
            entry.where,
            f"GPU instancing ({INSTANCING}) is not read yet: the mesh is placed once, at the node itself.",
        )
    for part in parts:
        _refuse_far(node, part.reach)
    name = entry.text("name") or geometry.mesh_name(entry.integer("mesh"), entry.where)
    return [
        Mesh(
            name=name or f"node {node.index}",
            positions=part.positions,
            triangles=part.triangles,
            placements=node.world[None],
            casts=part.surface.casts,
            base_color=part.surface.base_color,
            node=node.index,
        )
        for part in parts
    ]


def _refuse_far(node: PlacedNode, reach: float) -> None:
    with np.errstate(over="ignore"):
        extent = np.abs(node.world[:3, :3]).sum(axis=1) * reach + np.abs(node.world[:3, 3])
    if not (extent <= LARGEST).all():
        raise LevelError(
            f"The mesh of this node reaches farther than {LARGEST:g} metres from the origin.",
            where=node.entry.where,
            known=f"Its largest coordinate is {reach:g}; the node's world axes are {_axes(node)}.",
            remedy="Check the mesh, and the translations and scales of the node and of those above it.",
        )


def _axes(node: PlacedNode) -> str:
    return ", ".join(str(tuple(map(float, node.world[:3, axis]))) for axis in range(3))
