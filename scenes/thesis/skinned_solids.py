"""Closed solids with many sides: turned ones, hoops, rods and bars between two points, rough stones.

Only elementwise products, quotients, sums and square roots; cosines are rounded before they are used.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
import numpy.typing as npt

from scenes.scene import Array
from scenes.solids import Point, Shell, cells

# Far coarser than the last bits in which one libm differs from another, far finer than the grid of positions.
_COSINE_STEPS = 2.0**24
_LATTICE = 16


def circle(sides: int) -> Array:
    """(sides, 2) float64 cosines and sines of equal turns, the same bits on every machine."""
    turns = 2 * np.pi * np.arange(sides) / sides
    return np.round(np.stack([np.cos(turns), np.sin(turns)], axis=1) * _COSINE_STEPS) / _COSINE_STEPS


def skinned(rings: npt.ArrayLike) -> Shell:
    """The closed solid through rings: 2 n (m - 1) triangles between them, n - 2 at either end.

    Args:
        rings: (m, n, 3) in metres, each ring convex and counter-clockwise seen from the next.
    """
    points = np.asarray(rings, dtype=np.float64)
    count, sides = points.shape[:2]
    lower = sides * np.arange(count - 1)[:, None] + np.arange(sides)
    sheet = _sheet(lower, np.roll(lower, -1, axis=1), sides)
    corners = np.arange(1, sides - 1)
    fan = np.stack([np.zeros_like(corners), corners, corners + 1], axis=1)
    return Shell(points.reshape(-1, 3), np.concatenate([sheet, fan[:, ::-1], fan + sides * (count - 1)]))


def turned_solid(profile: npt.ArrayLike, sides: int, foot: Point = (0.0, 0.0, 0.0)) -> Shell:
    """What a lathe makes: the profile turned about an upright axis through `foot`.

    Args:
        profile: (m, 2) radius (over 0) and height, from the lowest ring to the highest, in metres. Heights
            may fall and rise again, so that a bowl is hollow.
        sides: Corners of each ring.
        foot: Where the profile's origin goes.
    """
    radius, height = np.asarray(profile, dtype=np.float64).T
    x, z = circle(sides).T
    rings = np.stack(
        [radius[:, None] * x, np.broadcast_to(height[:, None], (len(radius), sides)), -radius[:, None] * z],
        axis=2,
    )
    return skinned(rings + np.array(foot))


def hoop(centre: Point, radius_m: float, tube_m: float, around: int, across: int) -> Shell:
    """A level torus: 2 `around` `across` triangles."""
    x, z = (turn[:, None] for turn in circle(around).T)
    out, up = circle(across).T
    reach = radius_m + tube_m * out
    height = np.broadcast_to(tube_m * up, (around, across))
    points = np.stack([reach * x, height, -reach * z], axis=2).reshape(-1, 3) + np.array(centre)
    here = across * np.arange(around)[:, None] + np.arange(across)
    ahead = np.roll(here, -1, axis=0)
    corners = np.stack([here, ahead, np.roll(ahead, -1, axis=1), np.roll(here, -1, axis=1)], axis=2)
    return Shell(points, corners.reshape(-1, 4)[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))


def rod(start: Point, end: Point, start_radius_m: float, end_radius_m: float, sides: int = 8) -> Shell:
    """A round rod between two points: 4 sides - 4 triangles."""
    across, other = _cross_axes(start, end)
    out, up = (turn[:, None] for turn in circle(sides).T)
    outline = out * across + up * other
    return skinned([np.array(start) + start_radius_m * outline, np.array(end) + end_radius_m * outline])


def bar(start: Point, end: Point, width_m: float, depth_m: float | None = None) -> Shell:
    """A square bar between two points, or a flat one: 12 triangles. `width_m` is level unless it stands."""
    across, other = _cross_axes(start, end)
    half, half_other = width_m / 2, (width_m if depth_m is None else depth_m) / 2
    outline = np.array([u * half * across + v * half_other * other for u, v in _SQUARE])
    return skinned([np.array(start) + outline, np.array(end) + outline])


_SQUARE = ((1, 1), (-1, 1), (-1, -1), (1, -1))


def stone(divisions: tuple[int, int, int], half_m: Point, roughness_m: float, seed: int) -> Shell:
    """A rough stone around the origin: a box with rounded edges, dented by noise, a little thinner on top.

    4 (a b + b c + c a) triangles for divisions a, b, c along x, y and z.

    Args:
        divisions: Faces along each side.
        half_m: Half its size in metres.
        roughness_m: How far the noise moves the surface at most, in each direction.
        seed: Of the noise.
    """
    across, up, out = ((np.arange(count + 1) * 2.0 / count - 1.0).tolist() for count in divisions)
    shell = cells(across, up, out, np.ones(divisions, dtype=bool))
    x, y, z = shell.positions.T
    # The ball of the 8-norm: a box whose edges and corners are worn.
    eighth = (x * x) * (x * x) * ((x * x) * (x * x)) + (y * y) * (y * y) * ((y * y) * (y * y))
    eighth = eighth + (z * z) * (z * z) * ((z * z) * (z * z))
    worn = shell.positions / np.sqrt(np.sqrt(np.sqrt(eighth)))[:, None]
    thinner = 1.0 - 0.0625 * (worn[:, 1] + 1.0)
    points = worn * np.array(half_m) * np.stack([thinner, np.ones_like(thinner), thinner], axis=1)
    dents = 0.625 * _noise(1.75 * points, seed) + 0.375 * _noise(4.25 * points, seed + 1)
    return Shell(points + roughness_m * dents, shell.triangles)


def _noise(points: Array, seed: int) -> Array:
    """(n, 3) in -1 .. 1: numbers at the points of a lattice, smoothly interpolated (value noise)."""
    # Raw words of the generator, because only they are promised to stay the same in every NumPy.
    words = np.random.PCG64(seed).random_raw(3 * _LATTICE**3)
    lattice = ((words >> 11) * 2.0**-52 - 1.0).reshape(_LATTICE, _LATTICE, _LATTICE, 3)
    below = np.floor(points)
    x, y, z = (below.astype(np.int64) % _LATTICE).T
    part = points - below
    u, v, w = (part * part * (3.0 - 2.0 * part)).T
    values = np.zeros((len(points), 3))
    for right, up, out in np.ndindex(2, 2, 2):
        weight = (u if right else 1 - u) * (v if up else 1 - v) * (w if out else 1 - w)
        corner = lattice[(x + right) % _LATTICE, (y + up) % _LATTICE, (z + out) % _LATTICE]
        values = values + weight[:, None] * corner
    return values


def _sheet(lower: npt.NDArray[np.int64], ahead: npt.NDArray[np.int64], step: int) -> npt.NDArray[np.int64]:
    quads = np.stack([lower, ahead, ahead + step, lower + step], axis=2).reshape(-1, 4)
    return quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def _cross_axes(start: Point, end: Point) -> tuple[Array, Array]:
    """Two unit vectors that with the way from start to end make a right-handed frame; the first is level."""
    x, y, z = (there - here for here, there in zip(start, end, strict=True))
    length = sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    level = sqrt(x * x + z * z)
    u = (z / level, 0.0, -x / level) if level > 1e-6 else (1.0, 0.0, 0.0)
    return np.array(u), np.array([y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]])
