"""How much a shadow's errors flicker while the camera moves: a figure from a few frames, without a GPU.

The scene and its light stand still, so a place in the world that two frames show is in shadow in both or in
neither. A map that is fitted to what the camera sees is another one in each frame, and errs elsewhere.

Each frame is drawn twice: with the map of its own camera, and with that of the frame before. Both answer for
the same places, at the same pixels. Pixels that are followed from frame to frame show places up to half a
pixel apart instead, and errors are mostly thinner than that: they come and go with the pixels' centres even
where they are glued to the world. Measured so on 12 views of spot lights with maps of 256 texels, a map that
does not depend on the camera flickers in 1.5e-2 of the pixels, as does a fitted one; in 5.6e-3 and 5.8e-3 if
any of the four pixels around a place may vouch for it; measured as here, in none and in 3.5e-3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from renderers.error_figures import Bools, Floats, Points

State = npt.NDArray[np.int8]
RIGHT, FALSE_LIT, FALSE_SHADOW = 0, 1, 2

SAME_FACING = 0.9
"""Cosine between the normals of two samples of a surface: facets of a curve pass, walls of a corner fail."""

FLAT_PX = 0.05
"""Height, in pixels, of a sample over the plane of another: rounded depth and normals stay far below."""


@dataclass(frozen=True)
class Sight:
    """What one frame shows, top row first.

    Attributes:
        positions: (h, w, 3) float64, scene space or any other that all frames share.
        normals: (h, w, 3) float64, unit, geometric, towards the eye.
        domain: (h, w) bool, the pixels that count.
        clip_from_position: (4, 4) float64, the camera's perspective.
    """

    positions: Points
    normals: Points
    domain: Bools
    clip_from_position: Points


@dataclass
class Flicker:
    """Adds up the frames of a camera move.

    Attributes:
        seen: Pixels so far whose place the frame before shows too.
        changed: Those of them whose error is another one with the map of the frame before.
    """

    seen: int = 0
    changed: int = 0

    def add(self, now: State, before: State, seen: Bools) -> None:
        """Count one frame: its errors with its own map, and with that of the frame before, where `seen`."""
        self.seen += int(np.count_nonzero(seen))
        self.changed += int(np.count_nonzero((now != before) & seen))

    @property
    def share(self) -> float | None:
        """Changed pixels over those that could change; None where none could."""
        return self.changed / self.seen if self.seen else None


def error_state(mask: Floats, truth: Bools, domain: Bools) -> State:
    """(h, w) int8: `RIGHT`, `FALSE_LIT` or `FALSE_SHADOW`; lit begins at 0.5, as in `error_figures`."""
    lit = mask >= 0.5
    state = FALSE_LIT * (lit & ~truth & domain) + FALSE_SHADOW * (~lit & truth & domain)
    return state.astype(np.int8)


def co_visible(now: Sight, before: Sight) -> Bools:
    """(h, w) bool: the pixels of `now` whose place is seen in `before`, in the domain of both.

    The pixel of `before` that the place falls into must show the same surface: its sample and the place lie
    in each other's plane, and face the same way.
    """
    height, width = now.domain.shape
    pixels = np.flatnonzero(now.domain)
    places, normals = now.positions.reshape(-1, 3)[pixels], now.normals.reshape(-1, 3)[pixels]
    matrix = before.clip_from_position
    clip = places @ matrix[:, :3].T + matrix[:, 3]
    depth = np.where(clip[:, 3] > 0, clip[:, 3], np.inf)
    column = np.floor((clip[:, 0] / depth + 1) / 2 * width).astype(np.int64)
    row = np.floor((1 - clip[:, 1] / depth) / 2 * height).astype(np.int64)
    inside = np.isfinite(depth) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
    there = np.where(inside, row * width + column, 0)
    # The second row of a perspective has the length of the cotangent of half the field of view.
    pixel_m = 2 * depth / (np.linalg.norm(matrix[1, :3]) * height)
    other_normals = before.normals.reshape(-1, 3)[there]
    steps = before.positions.reshape(-1, 3)[there] - places
    height_m = np.maximum(
        np.abs(np.einsum("ij,ij->i", normals, steps)), np.abs(np.einsum("ij,ij->i", other_normals, steps))
    )
    facing = np.einsum("ij,ij->i", normals, other_normals) >= SAME_FACING
    seen = np.zeros(now.domain.shape, np.bool_)
    same = before.domain.ravel()[there] & facing & (height_m <= FLAT_PX * pixel_m)
    seen.ravel()[pixels] = inside & same
    return seen
