"""A finer grid around one place of a coarser one, for eyes and lamps right before a surface.

Its steps are those of `Occupancy`: elementwise products and sums, and sums of whole numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from scenes.corpus.occupancy import Occupancy, filled, leaving, opacity_of, walled, world_corners
from scenes.ray_caster import Bools
from scenes.scene import Array, Mesh

PARTS = 8
"""Cells along one of the coarser grid."""
_AROUND = 6
_RIM = 0.25
_SIGHT_STEPS = 256
_SAMPLES_PER_CELL = 16
# Larger triangles are split first, so that only what is in the box is sampled: cells of the finer grid.
_LONGEST_EDGE = 16.0


@dataclass(frozen=True)
class CloseGrid:
    """A finer grid within a coarser one. Answers what `Occupancy` does.

    Attributes:
        around: The coarser grid, of the whole place.
        inner: The finer one: eight cells to each, thirteen coarse cells wide.
    """

    around: Occupancy
    inner: Occupancy

    @classmethod
    def of(cls, around: Occupancy, meshes: tuple[Mesh, ...], target: Array, eye: Array) -> CloseGrid:
        """The finer grid around a (3,) target; free is what hangs together with its sight from the eye."""
        shape = np.array(around.opacity.shape)
        first = np.maximum(around.indices(target)[0] - _AROUND, 0)
        last = np.minimum(first + 2 * _AROUND + 1, shape)
        low = around.low + first * around.cell
        cell = around.cell / PARTS
        high = around.low + last * around.cell
        corners = np.concatenate([_inside(world_corners(mesh), low, high, cell) for mesh in meshes])
        steps = filled(
            corners, low, cell, tuple(int(count) for count in PARTS * (last - first)), _SAMPLES_PER_CELL
        )
        inner = Occupancy(low, cell, opacity_of(steps), ~walled(steps))
        return cls(around, replace(inner, free=_hanging_together(inner, target, eye)))

    @property
    def cell(self) -> float:
        """Side of a fine cell, metres."""
        return self.inner.cell

    @property
    def extent(self) -> float:
        """Diagonal of the coarse grid, metres."""
        return self.around.extent

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner of the coarse grid."""
        return self.around.bounds

    def is_free(self, points: Array, *, outside: bool) -> Bools:
        """Whether points are in the free space; `outside` is what holds beyond the coarse grid."""
        _, inside = self.inner.indices(points)
        return np.where(
            inside, self.inner.is_free(points, outside=False), self.around.is_free(points, outside=outside)
        )

    def first_hits(self, origins: Array, directions: Array, most: float) -> Array:
        """(n,) metres that (n, 3) rays of unit directions run until half of them is stopped; inf if never."""
        near, far = self._hits(origins, directions, most)
        return np.where(np.isfinite(near), near, far)

    def fronts(self, origins: Array, directions: Array, most: float) -> Array:
        """(n,) metres until right before what stops the rays; inf if nothing does."""
        near, far = self._hits(origins, directions, most)
        return np.where(np.isfinite(near), near - 1.5 * self.cell, far - 1.5 * self.around.cell)

    def passing(self, origins: Array, directions: Array, lengths: Array) -> Array:
        """(n,) share of light that gets through along (n, 3) unit directions over (n,) metres."""
        left = self._left(origins, directions)
        through = np.ones(len(origins))
        (starting,) = np.nonzero(left > 0.0)
        through[starting] = self.inner.passing(origins[starting], directions[starting], lengths[starting])
        (beyond,) = np.nonzero(lengths > left)
        start, rest = left[beyond], lengths[beyond] - left[beyond]
        onwards = origins[beyond] + start[:, None] * directions[beyond]
        through[beyond] = through[beyond] * self.around.passing(onwards, directions[beyond], rest)
        return through

    def surfaces(self) -> Array:
        """(n, 3) middles of free fine cells beside something solid, not near the rim of the fine grid."""
        found = self.inner.surfaces()
        low, high = self.inner.bounds
        inside = ((found > low + _RIM * (high - low)) & (found < high - _RIM * (high - low))).all(axis=1)
        return found[inside] if inside.any() else found

    def _hits(self, origins: Array, directions: Array, most: float) -> tuple[Array, Array]:
        """(n,) metres to what the fine cells stop, and to what the coarse ones behind them stop."""
        left = self._left(origins, directions)
        near = np.full(len(origins), np.inf)
        (starting,) = np.nonzero(left > 0.0)
        near[starting] = self.inner.first_hits(
            origins[starting], directions[starting], min(most, self.inner.extent)
        )
        onwards = origins + left[:, None] * directions
        far = left + self.around.first_hits(onwards, directions, most)
        return near, far

    def _left(self, origins: Array, directions: Array) -> Array:
        """(n,) metres that rays from within the fine grid run in it; 0 from elsewhere."""
        _, inside = self.inner.indices(origins)
        return np.where(inside, leaving(origins, directions, *self.inner.bounds), 0.0)


Space = Occupancy | CloseGrid
"""What lights and cameras are placed in."""


def _inside(corners: Array, low: Array, high: Array, cell: float) -> Array:
    """(t, 3, 3) what may be in the box of (t, 3, 3) triangles, the large ones split into quarters."""
    kept = []
    while len(corners):
        corners = corners[((corners.min(axis=1) < high) & (corners.max(axis=1) > low)).all(axis=1)]
        large = (corners.max(axis=1) - corners.min(axis=1)).max(axis=1) > _LONGEST_EDGE * cell
        kept.append(corners[~large])
        corners = _quarters(corners[large])
    return np.concatenate([*kept, np.zeros((0, 3, 3))])


def _quarters(corners: Array) -> Array:
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate(parts)


def _hanging_together(inner: Occupancy, target: Array, eye: Array) -> Bools:
    """Which of the free cells hang together with the sight line, from its end at the eye on.

    Only through gaps of three cells: samples may leave a hole of one cell in a wall.
    """
    labels = np.asarray(ndimage.label(ndimage.binary_erosion(inner.free, border_value=1))[0])
    shares = np.arange(_SIGHT_STEPS, -1, -1)[:, None] / _SIGHT_STEPS
    cells, inside = inner.indices(target + shares * (eye - target))
    met = labels[tuple(cells[inside].T)]
    assert met.any(), "nothing but walls between an eye and its target"
    reached: Bools = ndimage.binary_dilation(labels == met[met > 0][0]) & inner.free
    return reached
