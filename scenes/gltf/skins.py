"""Where a skinned mesh stands: in its bind pose, there where its skeleton is.

Source: glTF 2.0 specification (Khronos), section 3.7.3.3 "Skinned mesh attributes": the node's own transform
does not count; each vertex is moved by (world of its joint) x (inverse bind matrix of its joint). While the
skeleton is in its bind pose these products are all the same: that of the first joint stands for all.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.accessors import AccessorReader
from scenes.gltf.asset import Asset
from scenes.gltf.transforms import composed
from scenes.scene import Array

# JOINTS_n hold 16 bits at most.
MOST_JOINTS = 65536


def bind_pose(
    asset: Asset, accessors: AccessorReader, node: Entry, worlds: Mapping[int, Array]
) -> Array | None:
    """(4, 4) float64 world from mesh of a skinned node; None where its first joint is not in the scene.

    Args:
        asset: The file.
        accessors: Its accessors.
        node: A node with a skin.
        worlds: World matrices of the scene's nodes, by index.

    Raises:
        LevelError: The skin is malformed, or the matrix is not finite or not affine.
    """
    _, skin = asset.linked(node, "skin", "skins")
    joints = skin.integers("joints")
    if not 1 <= len(joints) <= MOST_JOINTS:
        raise skin.wrong("joints", f"a list of 1 to {MOST_JOINTS} nodes")
    world = worlds.get(joints[0])
    if world is None or not skin.has("inverseBindMatrices"):
        return world
    return composed(world, _inverse_bind_matrix(asset, accessors, skin, len(joints)), skin.where)


def _inverse_bind_matrix(asset: Asset, accessors: AccessorReader, skin: Entry, joints: int) -> Array:
    index, accessor = asset.linked(skin, "inverseBindMatrices", "accessors")
    if not joints <= accessor.integer("count") <= MOST_JOINTS:
        raise accessor.wrong("count", f"from {joints}, as many as the skin has joints, to {MOST_JOINTS}")
    matrix: Array = accessors.floats(index, "MAT4", skin.where)[0].astype(np.float64).reshape(4, 4).T
    if not np.array_equal(matrix[3], (0.0, 0.0, 0.0, 1.0)):
        raise LevelError(
            "The first inverse bind matrix is not affine.",
            where=accessor.where,
            known=f"Its last row is {tuple(map(float, matrix[3]))}, not (0, 0, 0, 1).",
            remedy="Repair the skeleton in the editor and export the level again.",
        )
    return matrix
