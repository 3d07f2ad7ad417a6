"""A place as a grid of cells, each more or less filled: free space and sight lines by whole cells.

Rays of Embree may differ in their last bits between CPUs, and a decision with them. Here every step is an
elementwise product or sum, and every sum is of whole numbers, so that lights and cameras stand in the same
places on every machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from scenes.ray_caster import Bools
from scenes.scene import Array, Mesh
from scenes.solids import Point

_CELLS = 112
_MOST_CELLS = 1_200_000
_SAMPLES_PER_CELL = 6
_MOST_SAMPLES = 3_000_000
# Of a cell's face: sampled areas are summed as whole numbers.
_AREA_STEPS = 4096
_STRIDE = 0.75
_SOLID = 0.5
# Roberts' R2 sequence: points that fill a square evenly, whatever their number.
_R2 = (0.7548776662466927, 0.5698402909980532)

Floats = npt.NDArray[np.float32]
Counts = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Occupancy:
    """What is where.

    Attributes:
        low: (3,) lowest corner of the grid, metres.
        cell: Side of a cell, metres.
        opacity: (a, b, c) float32: share of light that a cell stops.
        free: (a, b, c) bool: cells that hang together with the sky or the start, none of them underground.
    """

    low: Array
    cell: float
    opacity: Floats
    free: Bools

    @classmethod
    def of(cls, meshes: tuple[Mesh, ...], start: Point | None) -> Occupancy:
        """The grid of these meshes, at most 112 cells long; `start` is a point in the free space."""
        corners = np.concatenate([world_corners(mesh) for mesh in meshes])
        low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        spans = np.maximum(high - low, 1e-3)
        cell = float(spans.max()) / _CELLS
        while np.prod(spans / cell + 4) > _MOST_CELLS:
            cell *= 1.125
        # One cell of air on all sides, two above: what is outside hangs together.
        shape = tuple(int(count) for count in np.floor(spans / cell) + 4)
        corner = low - 1.5 * cell
        steps = filled(corners, corner, cell, shape)
        return cls(corner, cell, opacity_of(steps), _reached(walled(steps), corner, cell, start))

    @property
    def extent(self) -> float:
        """Diagonal of the grid, metres."""
        a, b, c = (count * self.cell for count in self.opacity.shape)
        return sqrt(a * a + b * b + c * c)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner of the grid."""
        return self.low, self.low + np.array(self.opacity.shape) * self.cell

    def indices(self, points: Array) -> tuple[Counts, Bools]:
        """(..., 3) cells of (..., 3) points, clipped to the grid, and whether they are inside it."""
        cells = np.floor((points - self.low) / self.cell).astype(np.int64)
        clipped = np.clip(cells, 0, np.array(self.opacity.shape) - 1)
        return clipped, (cells == clipped).all(axis=-1)

    def is_free(self, points: Array, *, outside: bool) -> Bools:
        """Whether points are in the free space; `outside` is what holds beyond the grid."""
        cells, inside = self.indices(points)
        return np.where(inside, self.free[tuple(np.moveaxis(cells, -1, 0))], outside)

    def first_hits(self, origins: Array, directions: Array, most: float) -> Array:
        """(n,) metres that (n, 3) rays of unit directions run until half of them is stopped; inf if never."""
        passing = np.ones(len(origins))
        distance = np.full(len(origins), np.inf)
        stride = _STRIDE * self.cell
        for step in range(1, int(most / stride) + 2):
            passing = passing * (1.0 - _STRIDE * self._opacity(origins + step * stride * directions))
            distance = np.where((passing < _SOLID) & ~np.isfinite(distance), step * stride, distance)
        return distance

    def fronts(self, origins: Array, directions: Array, most: float) -> Array:
        """(n,) metres until right before what stops the rays; inf if nothing does."""
        return self.first_hits(origins, directions, most) - 1.5 * self.cell

    def passing(self, origins: Array, directions: Array, lengths: Array) -> Array:
        """(n,) share of light that gets through along (n, 3) unit directions over (n,) metres."""
        through = np.ones(len(origins))
        stride = _STRIDE * self.cell
        longest = float(np.minimum(lengths, 2.0 * self.cell * max(self.opacity.shape)).max(initial=0.0))
        # What is around the receiver is the receiver.
        for step in range(2, int(longest / stride) + 1):
            stopped = _STRIDE * self._opacity(origins + step * stride * directions)
            through = through * (1.0 - np.where((step + 1) * stride < lengths, stopped, 0.0))
        return through

    def surfaces(self) -> Array:
        """(n, 3) middles of free cells beside something solid, in the grid's order."""
        solid = self.opacity > _SOLID
        beside = ndimage.binary_dilation(solid) & self.free & ~solid
        return self.low + (np.argwhere(beside) + 0.5) * self.cell

    def _opacity(self, points: Array) -> Floats:
        cells, inside = self.indices(points)
        return np.where(inside, self.opacity[cells[:, 0], cells[:, 1], cells[:, 2]], np.float32(0.0))


def world_corners(mesh: Mesh) -> Array:
    """(t, 3, 3) float64 corners of all placements."""
    corners: Array = mesh.world_positions()[:, mesh.triangles].reshape(-1, 3, 3)
    return corners


def filled(
    corners: Array, low: Array, cell: float, shape: tuple[int, ...], samples_per_cell: int = _SAMPLES_PER_CELL
) -> Counts:
    """How much area of (t, 3, 3) corners is in each cell of a grid, in steps of a cell's face."""
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.cross(one, other)
    squared = normals * normals
    areas = np.sqrt((squared[:, 0] + squared[:, 1]) + squared[:, 2]) / 2 / (cell * cell)
    counts = np.floor(samples_per_cell * areas).astype(np.int64) + 1
    if counts.sum() > _MOST_SAMPLES:
        counts = np.maximum(counts * _MOST_SAMPLES // counts.sum(), 1)
    owner = np.repeat(np.arange(len(corners)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    u, v = ((0.5 + number * step) % 1.0 for step in _R2)
    folded = u + v > 1.0
    u, v = np.where(folded, 1.0 - u, u), np.where(folded, 1.0 - v, v)
    points = corners[owner, 0] + u[:, None] * one[owner] + v[:, None] * other[owner]
    cells = np.floor((points - low) / cell).astype(np.int64)
    inside = ((cells >= 0) & (cells < shape)).all(axis=1)
    flat = (cells[inside, 0] * shape[1] + cells[inside, 1]) * shape[2] + cells[inside, 2]
    steps = np.round(np.minimum(areas / counts, 1.0) * _AREA_STEPS).astype(np.int64)
    # Sums of whole numbers below 2^53 are exact in any order.
    weights = steps[owner[inside]].astype(np.float64)
    sums = np.bincount(flat, weights=weights, minlength=int(np.prod(shape)))
    return sums.astype(np.int64).reshape(shape)


def opacity_of(steps: Counts) -> Floats:
    """Share of light that each cell stops, from its area in steps."""
    return (np.minimum(steps, _AREA_STEPS) / _AREA_STEPS).astype(np.float32)


def walled(steps: Counts) -> Bools:
    """Cells that hold so much that nobody gets through."""
    return steps > _AREA_STEPS // 4


def leaving(points: Array, directions: Array, low: Array, high: Array) -> Array:
    """(n,) metres until rays from inside a box leave it."""
    safe = np.where(np.abs(directions) < 1e-9, 1e-9, directions)
    ahead = np.maximum((low - points) / safe, (high - points) / safe)
    lengths: Array = np.maximum(ahead.min(axis=1), 0.0)
    return lengths


def entering(points: Array, directions: Array, low: Array, high: Array) -> Array:
    """(n,) metres until rays reach a box; 0 from inside it, and where they miss it."""
    safe = np.where(np.abs(directions) < 1e-9, 1e-9, directions)
    one, other = (low - points) / safe, (high - points) / safe
    first, last = np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)
    return np.where((first < last) & (first > 0.0), first, 0.0)


def _reached(filled: Bools, low: Array, cell: float, start: Point | None) -> Bools:
    labels, _ = ndimage.label(~filled)
    first = (0, -1, 0) if start is None else tuple(np.floor((np.array(start) - low) / cell).astype(int))
    label = labels[first]
    assert label, f"the start {start} is not in free space"
    reached: Bools = labels == label
    if start is None:
        reached &= ~_under_the_ground(filled)
    return reached


def _under_the_ground(filled: Bools) -> Bools:
    """Cells with something over them and nothing below: the ground may be a single sheet."""
    above = np.logical_or.accumulate(filled[:, ::-1], axis=1)[:, ::-1]
    below = np.logical_or.accumulate(filled, axis=1)
    under: Bools = above & ~below
    return under
