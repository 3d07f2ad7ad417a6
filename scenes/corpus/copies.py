"""Many solids at once: boxes, rods and copies of a shell, from arrays, without a loop over them.

Elementwise products, quotients, sums and square roots only, so that the bits are the same everywhere.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from scenes.scene import Array
from scenes.solids import GRID_M, Shell, box
from scenes.thesis.skinned_solids import circle, skinned

_CUBE = box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def boxes(low: npt.ArrayLike, high: npt.ArrayLike) -> Shell:
    """(n, 3) lowest and highest corners, in metres, as n boxes of 12 triangles."""
    first, last = np.broadcast_arrays(np.asarray(low, np.float64), np.asarray(high, np.float64))
    first, last = first.reshape(-1, 3), last.reshape(-1, 3)
    positions = first[:, None] + (last - first)[:, None] * _CUBE.positions
    return _repeated(positions, _CUBE.triangles)


def copies(
    shell: Shell,
    places: npt.ArrayLike,
    turns: npt.ArrayLike | None = None,
    sizes: npt.ArrayLike | None = None,
) -> Shell:
    """The shell at many places.

    Args:
        shell: The original.
        places: (n, 3) where its origin goes, in metres.
        turns: (n, 2) cosine and sine of the turn about the Y axis of each.
        sizes: (n,) or (n, 3): by what its coordinates are multiplied before.
    """
    at = np.asarray(places, dtype=np.float64).reshape(-1, 3)
    local = np.broadcast_to(shell.positions, (len(at), *shell.positions.shape))
    if sizes is not None:
        scale = np.asarray(sizes, dtype=np.float64).reshape(len(at), -1)
        local = local * scale[:, None]
    if turns is not None:
        cosine, sine = np.asarray(turns, dtype=np.float64).reshape(-1, 2).T[:, :, None]
        x, y, z = local[..., 0], local[..., 1], local[..., 2]
        local = np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=-1)
    return _repeated(local + at[:, None], shell.triangles)


def rods(
    starts: npt.ArrayLike,
    ends: npt.ArrayLike,
    radius_m: npt.ArrayLike,
    end_radius_m: npt.ArrayLike | None = None,
    sides: int = 6,
) -> Shell:
    """Round rods between (n, 3) points: 4 sides - 4 triangles each. With four sides, square bars.

    Radii are one for all, or (n,).
    """
    here, there = np.broadcast_arrays(np.asarray(starts, np.float64), np.asarray(ends, np.float64))
    here, there = here.reshape(-1, 3), there.reshape(-1, 3)
    across, other = cross_axes(there - here)
    out, up = circle(sides).T if sides != 4 else (circle(8)[1::2]).T
    outline = out[:, None] * across[:, None] + up[:, None] * other[:, None]
    first = np.broadcast_to(np.asarray(radius_m, np.float64), len(here))[:, None, None]
    last = first if end_radius_m is None else np.broadcast_to(end_radius_m, len(here))[:, None, None]
    rings = np.concatenate([here[:, None] + first * outline, there[:, None] + last * outline], axis=1)
    pattern = skinned(np.zeros((2, sides, 3))).triangles
    return _repeated(rings, pattern)


def cross_axes(ways: Array) -> tuple[Array, Array]:
    """Two unit vectors to each of (n, 3) vectors, right-handed with it; the first is level."""
    x, y, z = ways.T
    length = np.sqrt((x * x + y * y) + z * z)
    x, y, z = x / length, y / length, z / length
    level = np.sqrt(x * x + z * z)
    upright = level <= 1e-6
    divisor = np.where(upright, 1.0, level)
    u = np.stack(
        [np.where(upright, 1.0, z / divisor), np.zeros_like(x), np.where(upright, 0.0, -x / divisor)], axis=1
    )
    other = np.stack([y * u[:, 2], z * u[:, 0] - x * u[:, 2], -y * u[:, 0]], axis=1)
    return u, other


def sheet(points: Array) -> Shell:
    """(a, b, 3) points as an open sheet of 2 (a - 1) (b - 1) triangles.

    It is seen from the side from which the first axis turns counter-clockwise into the second.
    """
    rows, columns = points.shape[:2]
    first = (columns * np.arange(rows - 1)[:, None] + np.arange(columns - 1)).reshape(-1, 1)
    corners = first + np.array([[0, columns, columns + 1, 1]])
    return Shell(points.reshape(-1, 3), corners[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))


def swept(rings: npt.ArrayLike) -> Shell:
    """The closed solid through rings whose last joins the first: a hoop of any outline.

    Args:
        rings: (m, n, 3), each counter-clockwise seen from the next.
    """
    points = np.asarray(rings, dtype=np.float64)
    count, sides = points.shape[:2]
    here = sides * np.arange(count)[:, None] + np.arange(sides)
    ahead = np.roll(here, -1, axis=0)
    quads = np.stack([here, np.roll(here, -1, axis=1), np.roll(ahead, -1, axis=1), ahead], axis=2)
    return Shell(points.reshape(-1, 3), quads.reshape(-1, 4)[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))


def _repeated(positions: Array, triangles: npt.NDArray[np.int64]) -> Shell:
    copies_of, count = positions.shape[:2]
    indices = triangles + count * np.arange(copies_of)[:, None, None]
    return Shell(positions.reshape(-1, 3), indices.reshape(-1, 3))


def placements(places: npt.ArrayLike, turns: npt.ArrayLike, sizes: npt.ArrayLike) -> Array:
    """(n, 4, 4) world from local: sized by (n,), turned about Y by (n, 2), then put at (n, 3).

    Entries are rounded to 2^-24, places to 2^-14 m, so that products with snapped positions are exact words.
    """
    at = np.round(np.asarray(places, dtype=np.float64).reshape(-1, 3) / GRID_M) * GRID_M
    cosine, sine = np.asarray(turns, dtype=np.float64).reshape(-1, 2).T
    scale = np.broadcast_to(np.asarray(sizes, dtype=np.float64), len(at))
    matrices = np.zeros((len(at), 4, 4))
    matrices[:, 0, 0], matrices[:, 0, 2] = scale * cosine, scale * sine
    matrices[:, 1, 1] = scale
    matrices[:, 2, 0], matrices[:, 2, 2] = -scale * sine, scale * cosine
    matrices = np.round(matrices * 2.0**24) / 2.0**24
    matrices[:, :3, 3], matrices[:, 3, 3] = at, 1.0
    return matrices
