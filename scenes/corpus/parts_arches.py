"""Bars along curves: arches, hoops, cables."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from scenes.corpus.copies import rods
from scenes.scene import Array
from scenes.solids import Shell
from scenes.thesis.skinned_solids import circle


def chain(points: npt.ArrayLike, radius_m: float, sides: int = 4) -> Shell:
    """Rods along (..., m, 3) polylines, one closed solid for each piece."""
    path = np.asarray(points, dtype=np.float64)
    return rods(path[..., :-1, :].reshape(-1, 3), path[..., 1:, :].reshape(-1, 3), radius_m, None, sides)


def round_arch(feet: npt.ArrayLike, across: npt.ArrayLike, rise_m: float, segments: int) -> Array:
    """(n, segments + 1, 3) points of half ellipses from (n, 3) feet to `feet + across`, `rise_m` high."""
    start, way = np.broadcast_arrays(np.asarray(feet, np.float64), np.asarray(across, np.float64))
    start, way = start.reshape(-1, 3), way.reshape(-1, 3)
    cosine, sine = circle(2 * segments)[: segments + 1].T
    share = (1.0 - cosine) / 2
    points: Array = start[:, None] + share[:, None] * way[:, None]
    points[..., 1] += rise_m * sine
    return points


def pointed_arch(feet: npt.ArrayLike, across: npt.ArrayLike, rise_m: float, segments: int) -> Array:
    """(n, 2 segments + 1, 3) points of Gothic arches: each side an arc that would go on past the middle."""
    start, way = np.broadcast_arrays(np.asarray(feet, np.float64), np.asarray(across, np.float64))
    start, way = start.reshape(-1, 3), way.reshape(-1, 3)
    # A sixth of a turn: from the foot to where the arcs meet when each is centred on the other's foot.
    cosine, sine = circle(6 * segments)[: segments + 1].T
    share = 1.0 - cosine
    height = sine / sine[-1]
    shares = np.concatenate([share, 1.0 - share[-2::-1]])
    heights = np.concatenate([height, height[-2::-1]])
    points: Array = start[:, None] + shares[:, None] * way[:, None]
    points[..., 1] += rise_m * heights
    return points


def sagging(starts: npt.ArrayLike, ends: npt.ArrayLike, sag_m: npt.ArrayLike, pieces: int) -> Array:
    """(n, pieces + 1, 3) points of ropes between (n, 3) points: parabolas that hang `sag_m` deep."""
    here, there = np.broadcast_arrays(np.asarray(starts, np.float64), np.asarray(ends, np.float64))
    here, there = here.reshape(-1, 3), there.reshape(-1, 3)
    share = np.arange(pieces + 1) / pieces
    points: Array = here[:, None] + share[:, None] * (there - here)[:, None]
    points[..., 1] -= 4.0 * share * (1.0 - share) * np.broadcast_to(sag_m, len(here))[:, None]
    return points
