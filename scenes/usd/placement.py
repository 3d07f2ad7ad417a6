"""Geometry of a USD stage placed in the world: shared by all instances, never expanded."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from pxr import UsdGeom

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.magnitudes import LARGEST, MOST_TRIANGLES, MOST_VERTICES
from scenes.scene import Array
from scenes.usd.geometry import Faces, read_meshes
from scenes.usd.parcel import Part
from scenes.usd.shapes import read_shape
from scenes.usd.surfaces import SurfaceReader
from scenes.usd.transforms import product
from scenes.usd.values import path_of, value
from scenes.usd.walk import Edge, Forest, Item, Kind
from scenes.vectors import FLAT_VOLUME


class _Drawn(NamedTuple):
    tree: str
    item: Item
    faces: Faces


def place_geometry(forest: Forest, world: Array, notes: NoteBook) -> list[Part]:
    """The meshes of the stage, one for each prim and surface, with a placement for each instance.

    Args:
        forest: The trees of the stage.
        world: (4, 4) float64, metres and Y up from stage units.
        notes: For what is skipped.

    Raises:
        LevelError: A mesh is broken, they draw too much together, or reach too far.
    """
    times = _times(forest)
    found = [
        (key, entry)
        for key, tree in forest.trees.items()
        for entry in tree.entries
        if isinstance(entry, Item) and entry.kind is Kind.GEOMETRY and times[key]
    ]
    shapes = _faces([item for _, item in found], notes, moving=forest.moving)
    drawn = [
        _Drawn(key, item, faces)
        for (key, item), faces in zip(found, shapes, strict=True)
        if faces is not None
    ]
    _refuse_too_much(drawn, times)
    _note_subdivision(drawn, notes)
    placements = _placements(forest, world, {one.tree for one in drawn})
    surfaces = SurfaceReader(notes)
    meshes: list[Part] = []
    for tree, group in groupby(drawn, key=lambda one: one.tree):
        members = list(group)
        # All at once: levels have thousands of meshes, each placed once.
        matrices = np.stack([one.item.matrix for one in members])
        placed = product(placements[tree], matrices[:, None])
        for one, kept in zip(members, _checked(members, placed, notes), strict=True):
            meshes += _meshes(one, kept, surfaces)
    return meshes


def _meshes(one: _Drawn, placements: Array, surfaces: SurfaceReader) -> list[Part]:
    if not len(placements):
        return []
    name, faces = str(one.item.prim.GetName()), one.faces
    return [
        Part(name, faces.positions, triangles, placements, surface.casts, surface.base_color)
        for triangles, surface in surfaces.parts(one.item, faces)
    ]


def _faces(items: list[Item], notes: NoteBook, *, moving: bool) -> Iterator[Faces | None]:
    kinds = [item.prim.GetTypeName() == "Mesh" or bool(item.prim.IsA(UsdGeom.Mesh)) for item in items]
    for item in items:
        if (
            "skel:skeleton" in item.authored
            and item.prim.GetRelationship("skel:skeleton").HasAuthoredTargets()
        ):
            notes.warning(path_of(item.prim), "Skinned: read in the pose that its points state.")
    meshes = iter(
        read_meshes(
            [item for item, is_mesh in zip(items, kinds, strict=True) if is_mesh], notes, moving=moving
        )
    )
    for item, is_mesh in zip(items, kinds, strict=True):
        yield next(meshes) if is_mesh else read_shape(item.prim, notes)


def _times(forest: Forest) -> dict[str, int]:
    """How often each tree is placed."""
    times = dict.fromkeys(forest.trees, 0)
    times["/"] = 1
    for key, tree in forest.trees.items():
        for entry in tree.entries:
            if isinstance(entry, Edge) and entry.drawn:
                times[entry.tree] += times[key] * len(entry.matrices)
    return times


def _refuse_too_much(drawn: list[_Drawn], times: dict[str, int]) -> None:
    for what, limit, each in (
        ("triangles", MOST_TRIANGLES, [len(one.faces.triangles) for one in drawn]),
        ("vertices", MOST_VERTICES, [len(one.faces.positions) for one in drawn]),
    ):
        amounts = [count * times[one.tree] for count, one in zip(each, drawn, strict=True)]
        if sum(amounts) > limit:
            worst = int(np.argmax(amounts))
            raise LevelError(
                f"This level draws {sum(amounts):,} {what}; at most {limit:,} are read.",
                where=path_of(drawn[worst].item.prim),
                known=f"This mesh has {each[worst]:,} {what}, placed {times[drawn[worst].tree]:,} times.",
                remedy="Split the level, simplify its meshes, or let fewer instances share them.",
            )


def _note_subdivision(drawn: list[_Drawn], notes: NoteBook) -> None:
    smooth = [
        one
        for one in drawn
        if "subdivisionScheme" in one.item.authored
        and value(one.item.prim.GetAttribute("subdivisionScheme")) != UsdGeom.Tokens.none
    ]
    if smooth:
        notes.info(
            path_of(smooth[0].item.prim),
            f"{len(smooth):,} meshes, of which this is the first, are subdivision surfaces: read as their"
            " control cages.",
        )


def _placements(forest: Forest, world: Array, wanted: set[str]) -> dict[str, Array]:
    """(k, 4, 4) float64 placements in the world of each tree that holds or places a wanted one."""
    for key in reversed(forest.trees):
        edges = (entry for entry in forest.trees[key].entries if isinstance(entry, Edge))
        if any(edge.drawn and edge.tree in wanted for edge in edges):
            wanted = wanted | {key}
    gathered: dict[str, list[Array]] = {key: [] for key in wanted}
    if "/" in wanted:
        gathered["/"].append(world[None])
    found: dict[str, Array] = {}
    for key in (key for key in forest.trees if key in wanted):
        found[key] = np.concatenate(gathered.pop(key))
        for entry in forest.trees[key].entries:
            if isinstance(entry, Edge) and entry.drawn and entry.tree in wanted:
                inner = product(found[key][:, None], entry.matrices[None])
                gathered[entry.tree].append(inner.reshape(-1, 4, 4))
    return found


def _checked(members: list[_Drawn], placed: Array, notes: NoteBook) -> Iterator[Array]:
    """The placements of each mesh that squash nothing; `placed` is (mesh, placement, 4, 4).

    Raises:
        LevelError: One is not finite, or reaches too far.
    """
    solid = ~_flat(placed)
    reach = np.array([one.faces.reach for one in members])
    with np.errstate(over="ignore", invalid="ignore"):
        extent = np.abs(placed[..., :3, :3]).sum(axis=3) * reach[:, None, None] + np.abs(placed[..., :3, 3])
    near: npt.NDArray[np.bool_] = np.all(extent <= LARGEST, axis=(1, 2))
    everywhere: npt.NDArray[np.bool_] = np.all(solid, axis=1)
    placed.flags.writeable = False
    for index, one in enumerate(members):
        where = path_of(one.item.prim) if not (everywhere[index] and near[index]) else ""
        if not near[index]:
            raise LevelError(
                f"This prim reaches farther than {LARGEST:g} metres from the origin.",
                where=where,
                known=f"Its largest coordinate is {reach[index]:g}.",
                remedy="Check its points, and the transforms of the prim and of those above it.",
            )
        if everywhere[index]:
            yield placed[index]
            continue
        flat, count = int(np.count_nonzero(~solid[index])), len(solid[index])
        notes.warning(where, f"A scale of 0 squashes {flat:,} of {count:,} placements: skipped.")
        yield placed[index][solid[index]]


def _flat(placed: Array) -> npt.NDArray[np.bool_]:
    """(mesh, placement) whether space is squashed into a plane, a line or a point."""
    with np.errstate(over="ignore", invalid="ignore"):
        axes = placed[..., :3, :3]
        largest = np.abs(axes).max(axis=2, keepdims=True)
        axes = axes / np.where(largest > 0.0, largest, 1.0)
        lengths = np.sqrt((axes * axes).sum(axis=2, keepdims=True))
        axes = axes / np.where(lengths > 0.0, lengths, 1.0)
        (a, b, c), (d, e, f), (g, h, i) = (np.moveaxis(axes[..., row, :], -1, 0) for row in range(3))
        volume = (a * (e * i - f * h) - b * (d * i - f * g)) + c * (d * h - e * g)
        flat: npt.NDArray[np.bool_] = np.abs(volume) <= FLAT_VOLUME
    return flat
