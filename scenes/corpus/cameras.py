"""Where cameras may stand: many candidates by rule, of which the one that sees most shadow is taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.corpus.close_grid import Space
from scenes.corpus.draws import TURNS, Draws, Indices
from scenes.corpus.occupancy import leaving
from scenes.corpus.spec import Standpoint
from scenes.corpus.stage import Stage
from scenes.scene import Array
from scenes.solids import GRID_M
from scenes.thesis.skinned_solids import circle

CANDIDATES = 40
_CLOSE_CANDIDATES = 320
YFOV_RAD = 0.9375
ASPECT = 1.6

_PULLED_IN = 0.85
# Distance as a share of the room's diagonal, of that of the whole place for close ones: shortest and longest
# wanted; and elevations in 1/256 turns.
_DISTANCES = {
    Standpoint.NEAR: (0.008, 0.08),
    Standpoint.FAR: (0.25, 1.0),
    Standpoint.VISTA: (0.2, 0.45),
    Standpoint.CLOSE: (0.0015, 0.012),
    Standpoint.REMOTE: (0.6, 1.5),
}
_RISES = {
    Standpoint.NEAR: (6, 34),
    Standpoint.FAR: (6, 34),
    Standpoint.VISTA: (8, 26),
    Standpoint.CLOSE: (-20, 56),
    Standpoint.REMOTE: (8, 40),
}
_SHORTEST = 0.35
_CELLS_AWAY = 1.75


@dataclass(frozen=True)
class Views:
    """Candidates: (n, 3) eyes and (n, 3) targets, on the grid of positions."""

    eyes: Array
    targets: Array

    def at(self, index: Indices) -> Views:
        """Some of them."""
        return Views(self.eyes[index], self.targets[index])


def candidate_views(stage: Stage, space: Space, standpoint: Standpoint, draws: Draws) -> Views:
    """Eyes in the free space that see their targets; at least one."""
    if standpoint is Standpoint.VISTA and stage.vistas:
        eyes, targets = np.array(stage.vistas, dtype=np.float64).transpose(1, 0, 2)
        return Views(on_grid(eyes), on_grid(_in_sight(space, eyes, targets)))
    low, high = room_of(stage, space)
    close = standpoint is Standpoint.CLOSE
    size = space.extent if close else float(length(high - low))
    targets = _targets(space, low, high, draws.of("targets"), _CLOSE_CANDIDATES if close else CANDIDATES)
    directions = risen(draws.of("directions"), len(targets), *_RISES[standpoint])
    nearest, farthest = _DISTANCES[standpoint]
    wanted = size * draws.of("distances").numbers(len(targets), nearest, farthest)
    # Nearer than a cell or two, an eye could be inside what the cell holds.
    wanted = np.maximum(wanted, _CELLS_AWAY * space.cell)
    free = space.first_hits(targets, directions, farthest * size)
    if standpoint is not Standpoint.REMOTE:
        free = np.minimum(free, leaving(targets, directions, low, high))
    reach = np.minimum(wanted, _PULLED_IN * free)
    eyes = targets + reach[:, None] * directions
    good = (reach > _SHORTEST * nearest * size) & space.is_free(eyes, outside=stage.start is None)
    chosen = np.flatnonzero(good) if good.any() else np.argsort(-reach, kind="stable")[:1]
    return Views(on_grid(eyes[chosen]), on_grid(targets[chosen]))


def nearer(views: Views, most: float) -> Views:
    """The views from at most so many metres, on the same lines."""
    ways = views.eyes - views.targets
    share = np.minimum(most / np.maximum(length(ways), 1e-12), 1.0)
    return Views(on_grid(views.targets + share[:, None] * ways), views.targets)


def room_of(stage: Stage, space: Space) -> tuple[Array, Array]:
    """Lowest and highest corner of where eyes may be."""
    if stage.room is not None:
        return np.array(stage.room[0]), np.array(stage.room[1])
    lowest, highest = space.bounds
    spans = highest - lowest
    around = np.array([0.3, 0.0, 0.3]) * spans
    above = np.array([0.0, 0.5, 0.0]) * spans.max()
    return lowest - around, highest + around + above


def risen(draws: Draws, count: int, lowest: int, highest: int) -> Array:
    """(count, 3) unit directions of any azimuth, so many 256ths of a turn over the horizon."""
    azimuth = draws.turns(count)
    rise = circle(TURNS)[lowest + draws.below(count, highest - lowest + 1)]
    return np.stack([azimuth[:, 0] * rise[:, 0], rise[:, 1], azimuth[:, 1] * rise[:, 0]], axis=1)


def camera_rays(views: Views, columns: int, rows: int, part: float) -> Array:
    """(n, columns * rows, 3) unit directions through an even grid of the picture, or of its middle part."""
    forward = unit(views.targets - views.eyes)
    level = np.sqrt(forward[:, 0] * forward[:, 0] + forward[:, 2] * forward[:, 2])
    level = np.maximum(level, 1e-3)
    right = np.stack([-forward[:, 2] / level, np.zeros(len(level)), forward[:, 0] / level], axis=1)
    up = np.cross(right, forward)
    high = 0.506 * part  # tan(YFOV_RAD / 2), rounded
    x = ASPECT * high * ((np.arange(columns) + 0.5) / columns * 2 - 1)
    y = high * ((np.arange(rows) + 0.5) / rows * 2 - 1)
    across, along = (part.reshape(-1, 1) for part in np.meshgrid(x, y, indexing="ij"))
    rays = forward[:, None] + across * right[:, None] + along * up[:, None]
    return unit(rays)


def unit(vectors: Array) -> Array:
    """(..., 3) vectors at length 1."""
    units: Array = vectors / np.maximum(length(vectors), 1e-12)[..., None]
    return units


def length(vectors: Array) -> Array:
    """(...) lengths, by elementwise steps only."""
    squared = vectors * vectors
    lengths: Array = np.sqrt((squared[..., 0] + squared[..., 1]) + squared[..., 2])
    return lengths


def on_grid(points: Array) -> Array:
    """The points on multiples of 2^-14 m."""
    return np.round(points / GRID_M) * GRID_M


def _in_sight(space: Space, eyes: Array, targets: Array) -> Array:
    """The targets, or what is in front of them: lights are placed around what is really seen."""
    ways = targets - eyes
    distances = length(ways)
    directions = unit(ways)
    seen = space.fronts(eyes, directions, float(distances.max()))
    return eyes + np.maximum(np.minimum(distances, seen), 0.25 * distances)[:, None] * directions


def _targets(space: Space, low: Array, high: Array, draws: Draws, count: int) -> Array:
    surfaces = space.surfaces()
    inside = np.all((surfaces > low) & (surfaces < high), axis=1)
    places = surfaces[inside] if inside.any() else surfaces
    assert len(places), "a place without surfaces beside free space"
    return places[draws.below(count, len(places))]
