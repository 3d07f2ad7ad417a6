"""GPU instancing: the places where a node draws its mesh, without drawing it more than once.

Source: EXT_mesh_gpu_instancing (Khronos): each instance has a translation, a rotation and a scale in the
space of its node, in accessors of equal counts; what is absent is 0, none and 1.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.accessors import AccessorReader
from scenes.gltf.asset import Asset
from scenes.gltf.extensions import INSTANCING
from scenes.gltf.nodes import PlacedNode
from scenes.gltf.transforms import all_composed, all_flat, rotations
from scenes.level import NoteBook
from scenes.scene import Array

BYTE, SHORT = 5120, 5122
REMEDY = "Check the instances where they were made, and export them again."


def instance_count(asset: Asset, node: Entry) -> int:
    """How many instances a node states; 1 where it is not instanced.

    Raises:
        LevelError: Its accessors do not exist or state other counts than each other.
    """
    instancing = node.extension(INSTANCING)
    if instancing is None:
        return 1
    attributes = instancing.child("attributes")
    counts = {
        name: asset.linked(attributes, name, "accessors")[1].integer("count") for name in attributes.values
    }
    if len(set(counts.values())) > 1:
        raise LevelError(
            "The instances of this node have attributes of different counts.",
            where=node.where,
            known=", ".join(f"{name} has {count}" for name, count in counts.items()) + ".",
            remedy=REMEDY,
        )
    return next(iter(counts.values()), 1)


def instance_placements(accessors: AccessorReader, asset: Asset, node: PlacedNode, notes: NoteBook) -> Array:
    """(k, 4, 4) float64 world from local of each instance of a node that is instanced, in the file's order.

    An instance with a scale of 0 on all axes is hidden, and left out.

    Raises:
        LevelError: The accessors are broken, or an instance is not finite, has a rotation of length 0 or
            squashes its mesh into a plane, a line or a point.
    """
    instancing = node.entry.extension(INSTANCING)
    assert instancing is not None
    attributes = instancing.child("attributes")
    count = instance_count(asset, node.entry)

    def given(name: str, kind: str, default: float, integers: tuple[int, ...] = ()) -> Array:
        if not attributes.has(name):
            return np.full((count, 3), default)
        index = attributes.integer(name)
        values = accessors.floats(index, kind, attributes.where, integers=integers)
        _require(np.isfinite(values), node, f"{name} is not finite", values)
        return values.astype(np.float64)

    translation, scale = given("TRANSLATION", "VEC3", 0.0), given("SCALE", "VEC3", 1.0)
    local = np.tile(np.eye(4), (count, 1, 1))
    if attributes.has("ROTATION"):
        quaternions = given("ROTATION", "VEC4", 0.0, (BYTE, SHORT))
        local[:, :3, :3], sound = rotations(quaternions)
        _require(sound, node, "ROTATION has no direction: it must be a quaternion of length 1", quaternions)
    local[:, :3, :3] *= scale[:, None, :]
    local[:, :3, 3] = translation
    return _shown(node, local, notes)


def _shown(node: PlacedNode, local: Array, notes: NoteBook) -> Array:
    hidden = ~local[:, :3, :3].any(axis=(1, 2))
    if hidden.any():
        notes.warning(
            node.entry.where,
            f"{int(hidden.sum()):,} of its instances are hidden by a scale of 0: skipped.",
        )
    world = all_composed(node.world, local)
    _require(np.isfinite(world), node, "world matrix is not finite", local)
    _require(hidden | ~all_flat(world), node, "transform squashes its mesh flat", local)
    # Read-only, so that the meshes of all primitives share it.
    shown = world[~hidden]
    shown.flags.writeable = False
    return shown


def _require(
    holds: npt.NDArray[np.bool_], node: PlacedNode, failing: str, values: npt.NDArray[np.floating]
) -> None:
    if holds.all():
        return
    sound = np.logical_and.reduce(holds.reshape(len(holds), -1), axis=1)
    first = int(np.argmin(sound))
    raise LevelError(
        f"Instance {first} of this node is none: its {failing}.",
        where=node.entry.where,
        known=f"It is {_listed(values[first].ravel())}; {np.sum(~sound):,} of {len(sound):,} are so.",
        remedy=REMEDY,
    )


def _listed(values: Iterable[np.floating]) -> str:
    return "(" + ", ".join(f"{float(value):g}" for value in values) + ")"
