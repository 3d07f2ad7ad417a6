"""Morph targets at their default weights: the shape that stands where no animation plays.

Source: glTF 2.0 specification (Khronos), section 3.7.2.2 "Morph targets": a node's weights count before its
mesh's, and without either all are 0.
"""

from __future__ import annotations

import numpy as np

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.accessors import AccessorReader, finite_positions
from scenes.gltf.asset import Asset
from scenes.level import NoteBook
from scenes.scene import Positions

Weights = tuple[float, ...]


def default_weights(mesh: Entry, node: Entry) -> Weights:
    """The weights with which a node shows a mesh, empty where all are 0.

    Raises:
        LevelError: They are no finite numbers.
    """
    entry = node if node.has("weights") else mesh
    weights = entry.numbers("weights", len(entry.items("weights")), ())
    return weights if any(weights) else ()


def morphed(
    asset: Asset,
    accessors: AccessorReader,
    primitive: Entry,
    positions: Positions,
    weights: Weights,
    notes: NoteBook,
) -> Positions:
    """(v, 3) float32: `positions`, moved by each target's displacements times its weight.

    The same bits on every machine: products and sums in float64, in the order of the targets.

    Raises:
        LevelError: There are other numbers of targets than weights, or of displacements than positions, or
            the result is not finite.
    """
    targets = primitive.items("targets")
    if not targets:
        return positions
    if not weights:
        notes.info(primitive.where, "Morph targets: read in the base shape, all default weights are 0.")
        return positions
    if len(weights) != len(targets):
        raise LevelError(
            f"There are {len(weights)} morph weights for {len(targets)} targets.",
            where=primitive.where,
            remedy="Repair the shape keys in the editor and export the level again.",
        )
    notes.info(primitive.where, "Morph targets: read at their default weights.")
    moved = positions.astype(np.float64)
    for number, (values, weight) in enumerate(zip(targets, weights, strict=True)):
        if not isinstance(values, dict):
            raise primitive.wrong("targets", "a list of objects")
        target = Entry(values, f"{primitive.where}, target {number}")
        # An accessor without data stands for zeros: displacements that move nothing.
        if weight and target.has("POSITION") and accessors.has_data(target.integer("POSITION"), target.where):
            index = target.integer("POSITION")
            _require_count(asset.entry("accessors", index, target.where), len(positions))
            moved += weight * accessors.positions(index, target.where).astype(np.float64)
    with np.errstate(over="ignore"):
        return finite_positions(moved.astype(np.float32), primitive.where)


def _require_count(accessor: Entry, count: int) -> None:
    if accessor.integer("count") != count:
        raise accessor.wrong("count", f"{count}, as many as the primitive has positions")
