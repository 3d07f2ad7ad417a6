"""Grounds: flat ones, and hills made of noise."""

from __future__ import annotations

import numpy as np

from scenes.corpus.copies import sheet
from scenes.corpus.draws import Draws
from scenes.scene import Array, Mesh
from scenes.solids import Color, Shell, placed

_LATTICE = 32


def ground(width_m: float, depth_m: float, color: Color, triangles: float = 2, height_m: float = 0.0) -> Mesh:
    """A flat ground around the origin, of about so many triangles, seen from above."""
    quads = max(int(np.sqrt(triangles / 2)), 1)
    steps = np.arange(quads + 1) / quads - 0.5
    x, z = np.meshgrid(width_m * steps, depth_m * steps, indexing="ij")
    return placed("ground", _upwards(np.stack([x, np.full_like(x, height_m), z], axis=2)), color)


def hills(width_m: float, quads: int, heights: Array, color: Color, name: str = "ground") -> Mesh:
    """A square ground with (quads + 1, quads + 1) heights, by x and z."""
    return placed(name, hill_sheet(width_m, quads, heights), color)


def hill_sheet(width_m: float, quads: int, heights: Array) -> Shell:
    """The same as a shell."""
    x, z = square_points(width_m, quads)
    return _upwards(np.stack([x, heights, z], axis=2))


def square_points(width_m: float, quads: int) -> tuple[Array, Array]:
    """Give x and z of the points of a square ground, (quads + 1, quads + 1) each."""
    steps = width_m * (np.arange(quads + 1) / quads - 0.5)
    x, z = np.meshgrid(steps, steps, indexing="ij")
    return x, z


def noise(x: Array, z: Array, draws: Draws, octaves: int = 4) -> Array:
    """Smooth noise in -1 .. 1, ever finer bumps on coarse ones; x and z count in widths of the coarsest."""
    total = np.zeros_like(x)
    weight = 0.5
    for octave in range(octaves):
        total = total + weight * _bumps(x * 2.0**octave, z * 2.0**octave, draws.of(octave))
        weight /= 2
    return total


def _bumps(x: Array, z: Array, draws: Draws) -> Array:
    lattice = draws.numbers(_LATTICE * _LATTICE, -1.0, 1.0).reshape(_LATTICE, _LATTICE)
    left, front = np.floor(x), np.floor(z)
    u, w = x - left, z - front
    u, w = u * u * (3.0 - 2.0 * u), w * w * (3.0 - 2.0 * w)
    i, k = left.astype(np.int64) % _LATTICE, front.astype(np.int64) % _LATTICE
    j, m = (i + 1) % _LATTICE, (k + 1) % _LATTICE
    here = lattice[i, k] * (1 - u) + lattice[j, k] * u
    there = lattice[i, m] * (1 - u) + lattice[j, m] * u
    bumps: Array = here * (1 - w) + there * w
    return bumps


def _upwards(points: Array) -> Shell:
    shell = sheet(points)
    return Shell(shell.positions, shell.triangles[:, ::-1])
