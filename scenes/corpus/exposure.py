"""How much light and shadow a camera sees of a lamp, through cells: what candidates are compared by."""

from __future__ import annotations

from math import cos, radians

import numpy as np

from scenes.corpus.cameras import Views, camera_rays, length, unit
from scenes.corpus.close_grid import Space
from scenes.corpus.draws import Indices
from scenes.corpus.occupancy import entering
from scenes.corpus.spec import Spec
from scenes.scene import Array, LightKind
from scenes.solids import GRID_M

_COLUMNS, _ROWS = 14, 9
_FEW_COLUMNS, _FEW_ROWS = 5, 3
_STEPS = 1024
# So narrow a cone, or so short a reach, is looked for around the middle of the picture, where it is aimed.
_NARROW_DEG, _SHORT, _MIDDLE = 12.0, 0.1, 0.3
# Of the picture: with this much light and this much shadow one more of either adds nothing.
_ENOUGH = 0.25


def scores(space: Space, views: Views, places: Array, spec: Spec) -> Indices:
    """(n,) int64: how much light and shadow is in view together, at most 256.

    Args:
        space: What is where.
        views: The n cameras.
        places: (n, 3) the light of each, as `light_places` gives them.
        spec: Kind, cone and range of the lights.
    """
    return _scores(space, views, places, spec, (_COLUMNS, _ROWS))


def promising(space: Space, views: Views, places: Array, spec: Spec, count: int) -> Indices:
    """The `count` of n candidates that a few rays find best, best first, in order where they are alike."""
    found = _scores(space, views, places, spec, (_FEW_COLUMNS, _FEW_ROWS))
    return np.argsort(-found, kind="stable")[:count]


def _scores(space: Space, views: Views, places: Array, spec: Spec, picture: tuple[int, int]) -> Indices:
    lit, shadowed = _shares(space, views, places, spec, picture)
    found: Indices = np.round(
        np.minimum(lit, _ENOUGH) * np.minimum(shadowed, _ENOUGH) / _ENOUGH * _STEPS
    ).astype(np.int64)
    return found


def _shares(
    space: Space, views: Views, places: Array, spec: Spec, picture: tuple[int, int]
) -> tuple[Array, Array]:
    """(n,) shares of each picture that are lit, and in shadow within the light's cone and range."""
    small = (spec.kind is LightKind.SPOT and spec.cut_off_deg < _NARROW_DEG) or (spec.reach or 1.0) < _SHORT
    rays = camera_rays(views, *picture, _MIDDLE if small else 1.0)
    count = rays.shape[1]
    flat = rays.reshape(-1, 3)
    origins = np.repeat(views.eyes, count, axis=0)
    origins = origins + entering(origins, flat, *space.bounds)[:, None] * flat
    seen = space.fronts(origins, flat, space.extent)
    hit = np.isfinite(seen)
    points = origins + np.where(hit, seen, 0.0)[:, None] * flat
    ways = np.repeat(places, count, axis=0) - points
    aims = np.repeat(unit(views.targets - places), count, axis=0)
    if spec.kind is LightKind.DIRECTIONAL:
        ways = -space.extent * aims
    distances = np.maximum(length(ways), GRID_M)
    directions = ways / distances[:, None]
    inside = hit & _inside(directions, aims, distances, spec, space.extent)
    through = space.passing(points, directions, distances)
    lit = np.where(inside, through, 0.0).reshape(-1, count)
    dark = np.where(inside, 1.0 - through, 0.0).reshape(-1, count)
    return _mean(lit), _mean(dark)


def _inside(directions: Array, aims: Array, distances: Array, spec: Spec, extent: float) -> Array:
    inside = np.ones(len(directions), dtype=bool)
    if spec.kind is LightKind.SPOT:
        products = directions * aims
        inside &= -((products[:, 0] + products[:, 1]) + products[:, 2]) > cos(radians(spec.cut_off_deg))
    if spec.kind is not LightKind.DIRECTIONAL and spec.reach is not None:
        inside &= distances < spec.reach * extent
    return inside


def _mean(values: Array) -> Array:
    # Whole numbers: a sum of floats depends on its order.
    steps = np.round(values * _STEPS).astype(np.int64)
    means: Array = steps.sum(axis=1) / (_STEPS * values.shape[1])
    return means
