"""Node transforms, with the same bits on every machine.

Only elementwise products, sums, divisions and square roots in a fixed order: `@` may fuse or reorder,
and trigonometric functions differ in their last bits.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.scene import Array
from scenes.vectors import FLAT_VOLUME, unit, vector

Bools = npt.NDArray[np.bool_]

IDENTITY = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def local_matrix(node: Entry) -> Array:
    """(4, 4) float64 parent from local, column vectors.

    Raises:
        LevelError: The matrix or a part of translation, rotation and scale is malformed, the last row of
            the matrix is not 0 0 0 1, or the rotation is the zero quaternion.
    """
    if node.has("matrix"):
        matrix = np.array(node.numbers("matrix", 16, IDENTITY)).reshape(4, 4).T
        if tuple(matrix[3]) != (0.0, 0.0, 0.0, 1.0):
            raise node.wrong("matrix", "affine: its 4th, 8th and 12th number 0, its 16th 1")
        return matrix
    matrix = np.eye(4)
    matrix[:3, :3] = _rotation(node) * np.array(node.numbers("scale", 3, (1.0, 1.0, 1.0)))
    matrix[:3, 3] = node.numbers("translation", 3, (0.0, 0.0, 0.0))
    return matrix


def rotations(quaternions: Array) -> tuple[Array, Bools]:
    """(k, 3, 3) float64 rotation matrices of (k, 4) quaternions x y z w of any length, and which are sound.

    Of one without length, or whose square is beyond float64, the matrix means nothing.

    Source: as in Shoemake, "Animating rotation with quaternion curves" (1985): products scaled by 2 / |q|^2.
    """
    x, y, z, w = quaternions.T
    with np.errstate(all="ignore"):
        squared = ((x * x + y * y) + z * z) + w * w
        s = 2.0 / squared
        matrices = np.stack(
            [
                np.stack([1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)], axis=-1),
                np.stack([s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)], axis=-1),
                np.stack([s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)], axis=-1),
            ],
            axis=-2,
        )
    return matrices, np.isfinite(squared) & np.isfinite(s)


def _rotation(node: Entry) -> Array:
    # As `rotations`, bit for bit, in a fifth of its time for one.
    x, y, z, w = node.numbers("rotation", 4, (0.0, 0.0, 0.0, 1.0))
    squared = ((x * x + y * y) + z * z) + w * w
    if squared == 0.0 or not math.isfinite(squared) or not math.isfinite(2.0 / squared):
        raise node.wrong("rotation", "a quaternion of length 1")
    s = 2.0 / squared
    return np.array(
        [
            [1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)],
        ]
    )


def composed(parent: Array, local: Array, where: str) -> Array:
    """(4, 4) float64: the product of two affine matrices.

    Raises:
        LevelError: An element is not finite.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        terms = [parent[:, axis, None] * local[None, axis, :] for axis in range(4)]
        world: Array = ((terms[0] + terms[1]) + terms[2]) + terms[3]
    if not np.isfinite(world).all():
        raise LevelError(
            "The world matrix of this node is not finite.",
            where=where,
            remedy="Check the scales and translations of the node and of those above it.",
        )
    return world


def all_composed(parent: Array, local: Array) -> Array:
    """(k, 4, 4) float64: the products of one affine matrix with each of (k, 4, 4), the bits of `composed`."""
    with np.errstate(over="ignore", invalid="ignore"):
        terms = [parent[None, :, axis, None] * local[:, None, axis, :] for axis in range(4)]
        world: Array = ((terms[0] + terms[1]) + terms[2]) + terms[3]
    return world


def is_flat(matrix: Array) -> bool:
    """Whether a (4, 4) matrix squashes space flat: what `all_flat` says, in a third of its time for one."""
    columns = [unit(vector(matrix[:3, axis])) for axis in range(3)]
    if columns[0] is None or columns[1] is None or columns[2] is None:
        return True
    (a, b, c), (d, e, f), (g, h, i) = columns[0], columns[1], columns[2]
    volume = (a * (e * i - f * h) - b * (d * i - f * g)) + c * (d * h - e * g)
    return abs(volume) <= FLAT_VOLUME


def all_flat(matrices: Array) -> Bools:
    """(k,) bool: which of (k, 4, 4) finite matrices squash space into a plane, a line or a point."""
    axes = matrices[:, :3, :3]
    largest = np.abs(axes).max(axis=1, keepdims=True)
    lengthless = (largest == 0.0).any(axis=(1, 2))
    with np.errstate(invalid="ignore", divide="ignore"):
        axes = axes / largest
        axes = axes / np.sqrt((axes * axes).sum(axis=1, keepdims=True))
        (a, d, g), (b, e, h), (c, f, i) = (axes[:, row].T for row in range(3))
        volume = (a * (e * i - f * h) - b * (d * i - f * g)) + c * (d * h - e * g)
        flat: Bools = lengthless | (np.abs(volume) <= FLAT_VOLUME)
    return flat
