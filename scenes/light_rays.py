"""Rays of a light in a fixed pattern, ways back to it, and how many surfaces stand along either."""

from __future__ import annotations

from math import pi

import numpy as np

from scenes.frusta import light_axes
from scenes.ray_caster import OFFSET_PER_EXTENT, Bools, RayCaster
from scenes.scene import Array, Light, LightKind

GOLDEN_ANGLE = float(pi * (3 - np.sqrt(5)))
MOST_LAYERS = 32
"""Surfaces along a ray that are told apart; more are as many."""

# Float32 rays: a layer this near behind the last is the same one, as a share of the extent.
_STEP = 4 * OFFSET_PER_EXTENT


def light_rays(light: Light, bounds: Array, count: int) -> tuple[Array, Array, Array]:
    """(n, 3) origins, (n, 3) unit directions and (n,) lengths of rays that leave a light, evenly spread.

    Over equal solid angles of a spot's cone or a lamp's sphere; over equal areas of the disc that holds a
    scene's cross-section, for a directional light. The same pattern for every scene (Vogel 1979).

    Args:
        light: Its range is how long the rays are.
        bounds: (2, 3) lowest and highest corner of the scene, metres.
        count: How many rays.
    """
    index = np.arange(count) + 0.5
    angle = GOLDEN_ANGLE * index
    if light.kind is LightKind.DIRECTIONAL:
        right, up, forward = light_axes(light)
        extent = float(np.linalg.norm(bounds[1] - bounds[0]))
        radius = extent / 2 * np.sqrt(index / count)
        aside = np.cos(angle)[:, None] * right + np.sin(angle)[:, None] * up
        origins = bounds.mean(axis=0) + radius[:, None] * aside - extent * forward
        return origins, np.broadcast_to(forward, origins.shape), np.full(count, np.inf)
    spot = light.kind is LightKind.SPOT
    right, up, forward = light_axes(light) if spot else np.eye(3)[[0, 2, 1]]
    along = 1 - (1 - np.cos(light.outer_cone_rad if spot else pi)) * index / count
    around = np.sqrt(np.maximum(1 - along**2, 0.0))
    sideways = np.cos(angle)[:, None] * right + np.sin(angle)[:, None] * up
    directions = along[:, None] * forward + around[:, None] * sideways
    origins = np.broadcast_to(np.asarray(light.position, float), directions.shape)
    return origins, directions, np.full(count, light.range_m)


def ways_to_light(points: Array, light: Light) -> tuple[Array, Array]:
    """(n, 3) unit ways from (n, 3) points to the light, and (n,) how far it is, `inf` for a sun."""
    if light.kind is LightKind.DIRECTIONAL:
        way = -np.asarray(light.direction, float)
        return np.broadcast_to(way, points.shape), np.full(len(points), np.inf)
    ways = np.asarray(light.position, float) - points
    distances = np.linalg.norm(ways, axis=1)
    return ways / np.where(distances > 0, distances, 1.0)[:, None], distances


def in_reach(light: Light, ways: Array, distances: Array) -> Bools:
    """(n,) bool: whether places with these ways to the light lie within its range and cone."""
    if light.kind is LightKind.DIRECTIONAL:
        return np.ones(len(distances), bool)
    inside: Bools = distances <= light.range_m
    if light.kind is LightKind.SPOT:
        inside = inside & (-(ways @ np.asarray(light.direction)) >= np.cos(light.outer_cone_rad))
    return inside


def layers(caster: RayCaster, origins: Array, directions: Array, lengths: Array) -> Array:
    """(n,) float64: how many surfaces of `caster` each ray passes, at most 32.

    Args:
        caster: What counts.
        origins: (n, 3) world, metres; a surface on which a ray starts is not counted.
        directions: (n, 3) unit.
        lengths: (n,) where each ray ends, metres.
    """
    step = _STEP * max(caster.extent, np.finfo(float).tiny)
    at, left = origins + step * directions, lengths - step
    counts, active = np.zeros(len(origins)), np.arange(len(origins))
    for _ in range(MOST_LAYERS):
        if not len(active):
            break
        distances, _ = caster.hits(at[active], directions[active])
        struck = distances < left[active]
        active, run = active[struck], distances[struck] + step
        counts[active] += 1
        at[active] += run[:, None] * directions[active]
        left[active] -= run
    return counts
