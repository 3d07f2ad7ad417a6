"""Closed solids and cards to build scenes from, out of nothing but exact arithmetic.

Right-handed, metres, triangles counter-clockwise seen from outside.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenes.scene import Array, Mesh, Positions

Indices = npt.NDArray[np.int64]
Point = tuple[float, float, float]
Color = tuple[float, float, float]

# Fine enough for any level (0.06 mm), and float32 holds every multiple exactly up to 1 km.
GRID_M = 2.0**-14

_HALF_SQRT2 = 0.7071067811865476
_OCTAGON = np.array(
    [
        (1, 0),
        (_HALF_SQRT2, _HALF_SQRT2),
        (0, 1),
        (-_HALF_SQRT2, _HALF_SQRT2),
        (-1, 0),
        (-_HALF_SQRT2, -_HALF_SQRT2),
        (0, -1),
        (_HALF_SQRT2, -_HALF_SQRT2),
    ]
)


class Shell(NamedTuple):
    """A triangle set: (v, 3) float64 positions in metres, (t, 3) int64 indices into them."""

    positions: Array
    triangles: Indices


def snapped(positions: Array) -> Positions:
    """The positions on the nearest multiples of 2^-14 m, so that they are the same bits on every machine."""
    return (np.round(positions / GRID_M) * GRID_M).astype(np.float32)


def placed(name: str, shell: Shell, color: Color, placements: Array | None = None) -> Mesh:
    """The shell, snapped, as a mesh; `placements`, (k, 4, 4), put it elsewhere."""
    return Mesh(
        name=name,
        positions=snapped(shell.positions),
        triangles=shell.triangles.astype(np.int32),
        placements=np.eye(4)[None] if placements is None else placements,
        base_color=color,
    )


def joined(shells: Iterable[Shell]) -> Shell:
    """All shells as one, in order, sharing no vertices."""
    parts = list(shells)
    starts = np.cumsum([0, *(len(part.positions) for part in parts[:-1])])
    return Shell(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
    )


def moved(shell: Shell, offset: Point) -> Shell:
    """The shell, `offset` metres further."""
    return Shell(shell.positions + np.array(offset), shell.triangles)


def turned(shell: Shell, cosine: float, sine: float) -> Shell:
    """The shell turned about the Y axis through the origin; its cosine and sine keep libm out of it."""
    x, y, z = shell.positions.T
    return Shell(np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=1), shell.triangles)


def cells(x: Sequence[float], y: Sequence[float], z: Sequence[float], filled: npt.ArrayLike) -> Shell:
    """The surface of the filled cells of a rectangular grid: closed, without T-junctions.

    Args:
        x: Ascending grid planes in metres; likewise `y` and `z`.
        y: See `x`.
        z: See `x`.
        filled: (len(x) - 1, len(y) - 1, len(z) - 1) bool.
    """
    solid = np.pad(np.asarray(filled, dtype=bool), 1)
    inside = (slice(1, -1),) * 3
    quads = []
    for axis in range(3):
        u, v = np.eye(3, dtype=np.int64)[[(axis + 1) % 3, (axis + 2) % 3]]
        ring = np.array([0 * u, u, u + v, v])
        for side in (0, 1):
            neighbour = np.roll(solid, 1 - 2 * side, axis=axis)
            exposed = np.argwhere((solid & ~neighbour)[inside])
            exposed[:, axis] += side
            quads.append(exposed[:, None, :] + (ring if side else ring[::-1]))
    corners = np.concatenate(quads)
    used, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    planes = [np.asarray(breaks, dtype=np.float64) for breaks in (x, y, z)]
    positions = np.stack([plane[used[:, axis]] for axis, plane in enumerate(planes)], axis=1)
    return Shell(positions, index.reshape(-1, 4)[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))


def box(low: Point, high: Point) -> Shell:
    """The box between two corners: 12 triangles."""
    x, y, z = zip(low, high, strict=True)
    return cells(x, y, z, [[[True]]])


def loft(lower: npt.ArrayLike, upper: npt.ArrayLike, cap: npt.ArrayLike | None = None) -> Shell:
    """The closed solid between two rings.

    Args:
        lower: (n, 3) the first ring in metres, counter-clockwise seen from the second.
        upper: (n, 3) the second ring, corner for corner.
        cap: (k, 3) triangles over 0..n-1 that close a ring; by default a fan, right for a convex ring.
    """
    rings = np.array([lower, upper], dtype=np.float64)
    count = rings.shape[1]
    here = np.arange(count)
    ahead = (here + 1) % count
    fan = np.stack([np.zeros_like(here[2:]), here[1:-1], here[2:]], axis=1)
    top = fan if cap is None else np.asarray(cap, dtype=np.int64)
    sides = [
        np.stack([here, ahead, ahead + count], axis=1),
        np.stack([here, ahead + count, here + count], axis=1),
    ]
    return Shell(rings.reshape(-1, 3), np.concatenate([*sides, top[:, ::-1], top + count]))


def post(foot: Point, top: Point, foot_radius_m: float, top_radius_m: float) -> Shell:
    """An eight-sided post, upright or leaning, with level ends: 28 triangles."""
    outline = np.stack([_OCTAGON[:, 0], np.zeros(8), -_OCTAGON[:, 1]], axis=1)
    return loft(outline * foot_radius_m + np.array(foot), outline * top_radius_m + np.array(top))


def wheel(centre: Point, radius_m: float, width_m: float) -> Shell:
    """An eight-sided disc whose axle is the Z axis: 28 triangles."""
    outline = np.stack([_OCTAGON[:, 0], _OCTAGON[:, 1], np.zeros(8)], axis=1) * radius_m + np.array(centre)
    half = np.array([0.0, 0.0, width_m / 2])
    return loft(outline - half, outline + half)


def cards(corner: Array, along: Array, across: Array) -> Shell:
    """Single-sided parallelograms, open on purpose: leaves, panes.

    Args:
        corner: (n, 3) one corner each, in metres.
        along: (n, 3) the edge from it, in metres.
        across: (n, 3) the other edge from it; `along` x `across` is the front.
    """
    positions = np.stack([corner, corner + along, corner + along + across, corner + across], axis=1)
    quads = np.arange(4 * len(corner)).reshape(-1, 4)
    return Shell(positions.reshape(-1, 3), quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))
