"""Frameworks of bars: trusses, lattice masts, scaffolds, railings."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from scenes.corpus.copies import rods
from scenes.scene import Array
from scenes.solids import Shell

_SQUARE = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])


def lattice_beam(
    start: npt.ArrayLike,
    end: npt.ArrayLike,
    sides: tuple[tuple[float, float, float], tuple[float, float, float]],
    panels: int,
    bar_m: float,
) -> Shell:
    """A square lattice girder: four chords, and in each panel frames and one diagonal a face.

    Args:
        start: (3,) middle of one end, metres.
        end: (3,) middle of the other.
        sides: The two vectors that span its section.
        panels: How many; 12 + 96 panels triangles.
        bar_m: Half thickness of the chords; diagonals are thinner.
    """
    first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
    section = _SQUARE[:, :1] * np.array(sides[0]) + _SQUARE[:, 1:] * np.array(sides[1])
    share = (np.arange(panels + 1) / panels)[:, None, None]
    joints = first + share * (last - first) + section
    chords = rods(joints[0], joints[-1], bar_m, None, 4)
    frames = rods(
        joints[1:].reshape(-1, 3), np.roll(joints[1:], -1, axis=1).reshape(-1, 3), 0.5 * bar_m, None, 4
    )
    ahead = np.roll(joints[1:], -1, axis=1)
    diagonals = rods(joints[:-1].reshape(-1, 3), ahead.reshape(-1, 3), 0.5 * bar_m, None, 4)
    return _joined(chords, frames, diagonals)


def plane_truss(starts: Array, ends: Array, height_m: float, panels: int, bar_m: float) -> Shell:
    """Flat upright trusses between (n, 3) points: two chords, posts and diagonals (Pratt)."""
    here, there = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    share = (np.arange(panels + 1) / panels)[:, None]
    low = here[:, None] + share * (there - here)[:, None]
    high = low + [0.0, height_m, 0.0]
    middle = panels // 2
    rising = np.concatenate([low[:, :middle], high[:, middle:-1]], axis=1)
    falling = np.concatenate([high[:, 1 : middle + 1], low[:, middle + 1 :]], axis=1)
    return _joined(
        rods(low[:, 0], low[:, -1], bar_m, None, 4),
        rods(high[:, 0], high[:, -1], bar_m, None, 4),
        rods(low.reshape(-1, 3), high.reshape(-1, 3), 0.7 * bar_m, None, 4),
        rods(rising.reshape(-1, 3), falling.reshape(-1, 3), 0.6 * bar_m, None, 4),
    )


def railing(path: npt.ArrayLike, height_m: float, posts: int, rails: int, bar_m: float) -> Shell:
    """Rails along a polyline (m, 3), and posts spread over its corners."""
    points = np.asarray(path, np.float64)
    heights = height_m * (np.arange(rails) + 1) / rails
    lines = points + np.array([0.0, 1.0, 0.0]) * heights[:, None, None]
    along = np.unique(np.linspace(0, len(points) - 1, posts).astype(int))
    return _joined(
        rods(lines[:, :-1].reshape(-1, 3), lines[:, 1:].reshape(-1, 3), bar_m, None, 4),
        rods(points[along] - [0.0, bar_m, 0.0], points[along] + [0.0, height_m, 0.0], bar_m, None, 4),
    )


def _joined(*parts: Shell) -> Shell:
    starts = np.cumsum([0, *(len(part.positions) for part in parts[:-1])])
    positions = np.concatenate([part.positions for part in parts])
    return Shell(
        positions, np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)])
    )
