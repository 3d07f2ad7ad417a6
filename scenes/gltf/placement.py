"""Meshes of a glTF file placed in the world, one for every primitive of every node that draws it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.extensions import INSTANCING
from scenes.gltf.geometry import GeometryReader
from scenes.gltf.instancing import instance_placements
from scenes.gltf.nodes import PlacedNode
from scenes.gltf.skins import bind_pose
from scenes.gltf.transforms import is_flat
from scenes.level import NoteBook
from scenes.magnitudes import LARGEST
from scenes.scene import Array, Mesh


class MeshPlacer:
    """Places the meshes of one scene of an asset.

    Args:
        asset: The file.
        geometry: Its meshes.
        worlds: World matrices of the scene's nodes, by index.
        notes: Told what is hidden or approximated.
    """

    def __init__(
        self, asset: Asset, geometry: GeometryReader, worlds: Mapping[int, Array], notes: NoteBook
    ) -> None:
        self._asset = asset
        self._geometry = geometry
        self._worlds = worlds
        self._notes = notes

    def meshes(self, node: PlacedNode) -> list[Mesh]:
        """The meshes that a node draws, with `node` set; they share the arrays of other nodes' meshes.

        Raises:
            LevelError: The mesh is broken, or the node's transform squashes it or moves it too far.
        """
        entry = node.entry
        if not entry.has("mesh"):
            return []
        if entry.has("skin"):
            node = self._posed(node)
        # Source: glTF 2.0 specification, section 3.5.3: a scale of 0 on all axes is how nodes are hidden.
        if not node.world[:3, :3].any():
            self._notes.warning(entry.where, "Hidden by a scale of 0 on all axes: its mesh is skipped.")
            return []
        if is_flat(node.world):
            raise LevelError(
                "The transform of this node squashes its mesh into a plane, a line or a point.",
                where=entry.where,
                known=f"Its world axes are {_axes(node.world)}.",
                remedy="Give the node, and those above it, a scale other than 0 on every axis.",
            )
        index = entry.integer("mesh")
        parts = self._geometry.mesh(index, entry)
        if not parts:
            return []
        placements = self._placements(node)
        _refuse_far(node, placements, max(part.reach for part in parts))
        name = entry.text("name") or self._geometry.mesh_name(index, entry.where)
        return [
            Mesh(
                name=name or f"node {node.index}",
                positions=part.positions,
                triangles=part.triangles,
                placements=placements,
                casts=part.surface.casts,
                base_color=part.surface.base_color,
                node=node.index,
                promised_closed=part.promised_closed,
            )
            for part in parts
        ]

    def _posed(self, node: PlacedNode) -> PlacedNode:
        pose = bind_pose(self._asset, self._geometry.accessors, node.entry, self._worlds)
        if pose is None:
            self._notes.warning(
                node.entry.where,
                "Skinned: read in its bind pose, with the node's own transform, since its first joint is not "
                "in this scene.",
            )
            return node
        self._notes.warning(
            node.entry.where, "Skinned: read in its bind pose, where the first joint of its skeleton stands."
        )
        return replace(node, world=pose)

    def _placements(self, node: PlacedNode) -> Array:
        if node.entry.extension(INSTANCING) is None:
            return node.world[None]
        try:
            return instance_placements(self._geometry.accessors, self._asset, node, self._notes)
        except LevelError as error:
            if not error.where.startswith(node.entry.where):
                error.where = f"{node.entry.where}, {error.where}"
            raise


def _refuse_far(node: PlacedNode, placements: Array, reach: float) -> None:
    with np.errstate(over="ignore"):
        extents = np.abs(placements[:, :3, :3]).sum(axis=2) * reach + np.abs(placements[:, :3, 3])
    if not (extents <= LARGEST).all():
        near = (extents <= LARGEST).all(axis=1)
        raise LevelError(
            f"The mesh of this node reaches farther than {LARGEST:g} metres from the origin.",
            where=node.entry.where,
            known=f"Its largest coordinate is {reach:g}; the node's world axes are "
            f"{_axes(placements[int(np.argmin(near))])}.",
            remedy="Check the mesh, and the translations and scales of the node and of those above it.",
        )


def _axes(world: Array) -> str:
    return ", ".join(str(tuple(map(float, world[:3, axis]))) for axis in range(3))
