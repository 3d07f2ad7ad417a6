"""Places that a light surely lights: what its rays strike first, best suited to be looked at first."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from scenes.playable_space import PlayableSpace
from scenes.ray_caster import OFFSET_PER_EXTENT, Bools, Indices, RayCaster
from scenes.scene import Array, Light, LightKind, Scene

_PROBES = 512
_CANDIDATES = 12
_LAYERS = 4  # surfaces that a ray is followed through: both sides of a sky or a pane, and what lies behind
_SQUARELY = 0.2  # cosine; a surface that is struck flatter than 78 degrees shows no shadow worth judging
_FIXTURE = 0.1  # of the median distance to what the light strikes: nearer than this is its own lamp
_WALL_DETOUR = 0.2  # of the extent: within this much of its middle, a floor suits the sun better than a wall
_PATCH = 0.003, 0.1  # of the extent, and of the pool of light: so much of the surface around is lit too
_RINGS = np.array([1.0, 1 / 8, 1 / 64])  # of the patch's radius: where it is probed
_GOLDEN_ANGLE = float(np.pi * (3 - np.sqrt(5)))


@dataclass(frozen=True)
class LitPlace:
    """The first surface on one ray of a light.

    Attributes:
        point: (3,) world, metres.
        normal: (3,) unit, geometric, to the side that is lit.
        to_light: (3,) unit.
        distance: How far the light is, metres; for a directional light nothing that matters.
        pool: How far, roughly, the light reaches around the place, metres.
        cost: 0 is best: on the light's axis, on open ground, struck squarely.
    """

    point: Array
    normal: Array
    to_light: Array
    distance: float
    pool: float
    cost: float


def lit_places(scene: Scene, light: Light, space: PlayableSpace) -> list[LitPlace]:
    """Up to twelve places, cheapest first, spread farther and farther from the light's axis; none if none.

    The axis is a spot's direction; straight down from a point light; through the scene's middle for the sun.
    Probed are 512 rays spread evenly over the cone, the sphere or the scene's cross-section, and the centres
    of a few hundred triangles, so that small geometry is found too. Light goes through what casts nothing:
    such a surface and the one behind it are both lit.

    Args:
        scene: With some extent.
        light: Cone and range count.
        space: Of the scene. All places can be seen from within it.
    """
    sun = light.kind is LightKind.DIRECTIONAL
    if not sun and space.shuts_in(np.asarray(light.position)):
        return []
    struck = _struck(scene, light, space.caster)
    normals = _normals(space.caster.corners(struck.triangle))
    incidence = -np.einsum("ij,ij->i", normals, struck.directions)
    # A face that is struck exactly edge-on has no lit side.
    faced = incidence != 0
    struck, incidence = struck.chosen(faced), incidence[faced]
    if not len(incidence):
        return []
    normals = normals[faced] * np.sign(incidence)[:, None]
    cost = struck.detour + 1.0 * (np.abs(incidence) < _SQUARELY)
    if sun:
        cost += _WALL_DETOUR * (normals[:, 1] < sqrt(0.5))
    else:
        cost += 2.0 * (struck.distance < _FIXTURE * np.median(struck.distance))
    if space.wound_well:
        cost += 2.0 * space.caster.strikes_back(struck.triangle, struck.directions)
    points = struck.origins + struck.distance[:, None] * struck.directions
    pools = _pool_radius(light, struck.distance, space.caster.extent)
    cost += 4.0 * ~_in_lit_patch(space.caster, struck, points, normals, pools)
    return [
        LitPlace(
            points[i],
            normals[i],
            -struck.directions[i],
            float(struck.distance[i]),
            float(pools[i]),
            float(cost[i]),
        )
        for i in _chosen(np.argsort(cost, kind="stable"), points, normals, space, sun=sun)
    ]


def _chosen(order: Indices, points: Array, normals: Array, space: PlayableSpace, *, sun: bool) -> Indices:
    """Up to twelve of the places in playable space, best first.

    Neighbouring rays share their fate, so the second to the twelfth are ever farther apart.
    """

    def playable(places: Indices) -> Indices:
        kept = places[space.holds(points[places], normals[places])]
        # What a lamp lights is where the lamp is; a sun shines into gaps between walls as well.
        return kept[space.joins(points[kept], normals[kept])] if sun else kept

    chosen = order[_spread(len(order))]
    kept = playable(chosen)
    if 2 * len(kept) >= len(chosen):
        return kept
    kept = playable(order)
    return kept[_spread(len(kept))]


def _spread(count: int) -> Indices:
    if not count:
        return np.zeros(0, np.int64)
    return np.unique(np.geomspace(1, count, _CANDIDATES).astype(np.int64)) - 1


@dataclass(frozen=True)
class _Struck:
    """What a light's rays strike: (n, 3) origins and unit directions, (n,) the rest.

    From `begin` on nothing lies between the light and the surface.
    """

    origins: Array
    directions: Array
    detour: Array
    begin: Array
    distance: Array
    triangle: Indices

    def chosen(self, which: Bools) -> _Struck:
        return _Struck(
            self.origins[which],
            self.directions[which],
            self.detour[which],
            self.begin[which],
            self.distance[which],
            self.triangle[which],
        )


def _struck(scene: Scene, light: Light, caster: RayCaster) -> _Struck:
    """The first surface on each probe within reach, and those behind it as far as none of them casts."""
    origins, directions, detour = _probes(scene, light)
    # As for shadow rays, the surface on which a light is mounted is not struck by it.
    mount = OFFSET_PER_EXTENT * caster.extent
    reach = np.inf if light.kind is LightKind.DIRECTIONAL else light.range_m
    gone = np.full(len(origins), mount)
    going = np.arange(len(origins))
    layers: list[tuple[Indices, Array, Array, Indices]] = []
    for _ in range(_LAYERS):
        step, triangle = caster.hits(
            origins[going] + gone[going, None] * directions[going], directions[going]
        )
        distance = gone[going] + step
        reached = distance <= min(reach, np.finfo(float).max)
        going, distance, triangle = going[reached], distance[reached], triangle[reached]
        begin = gone[going] if not layers else (gone[going] + distance) / 2
        layers.append((going, begin, distance, triangle))
        gone[going] = distance + mount
        going = going[~caster.casts(triangle)]
    rays, begins, distances, triangles = (np.concatenate(part) for part in zip(*layers, strict=True))
    return _Struck(origins[rays], directions[rays], detour[rays], begins, distances, triangles)


def _plane_axes(normals: Array) -> tuple[Array, Array]:
    """Two (..., 3) unit vectors that are orthogonal to a unit normal and to each other."""
    first = np.cross(normals, np.eye(3)[np.argmin(np.abs(normals), axis=-1)])
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    return first, np.cross(normals, first)


def _probes(scene: Scene, light: Light) -> tuple[Array, Array, Array]:
    """(n, 3) origins, (n, 3) unit directions, (n,) detour from the axis in [0, 1]; the axis comes first."""
    if light.kind is LightKind.DIRECTIONAL:
        return _parallel_probes(scene, np.asarray(light.direction))
    spot = light.kind is LightKind.SPOT
    axis = np.asarray(light.direction if spot else (0.0, -1.0, 0.0))
    half_angle = 0.9 * light.outer_cone_rad if spot else np.pi
    position = np.asarray(light.position)
    directions = np.concatenate([_fan(axis, half_angle), _centroids(scene) - position])
    lengths = np.linalg.norm(directions, axis=1)
    directions = directions[lengths > 0] / lengths[lengths > 0, None]
    off_axis = np.arccos(np.clip(directions @ axis, -1, 1))
    inside = off_axis <= half_angle
    return np.broadcast_to(position, directions.shape)[inside], directions[inside], off_axis[inside] / np.pi


def _parallel_probes(scene: Scene, axis: Array) -> tuple[Array, Array, Array]:
    extent = float(np.linalg.norm(scene.bounds[1] - scene.bounds[0]))
    middle = scene.bounds.mean(axis=0)
    index = np.arange(_PROBES)
    right, up = _plane_axes(axis)
    # Vogel's sunflower: equal areas of the disc.
    radius, angle = extent / 2 * np.sqrt(index / _PROBES), _GOLDEN_ANGLE * index
    disc = (radius * np.cos(angle))[:, None] * right + (radius * np.sin(angle))[:, None] * up
    through = _centroids(scene) - middle
    offsets = np.concatenate([disc, through - (through @ axis)[:, None] * axis])
    origins = middle + offsets - extent * axis
    return origins, np.broadcast_to(axis, origins.shape), np.linalg.norm(offsets, axis=1) / extent


def _fan(axis: Array, half_angle: float) -> Array:
    """(n, 3) unit directions on equal areas of a cap: the cosine runs evenly from 1 to the half angle's."""
    index = np.arange(_PROBES)
    right, up = _plane_axes(axis)
    along = 1 - (1 - np.cos(half_angle)) * index / _PROBES
    around = np.sqrt(np.maximum(1 - along**2, 0))
    angle = _GOLDEN_ANGLE * index
    aside = np.cos(angle)[:, None] * right + np.sin(angle)[:, None] * up
    fan: Array = along[:, None] * axis + around[:, None] * aside
    return fan


def _centroids(scene: Scene) -> Array:
    every = max(1, scene.triangle_count // _PROBES)
    centres = [
        mesh.world_positions()[:, mesh.triangles[::every]].mean(axis=2).reshape(-1, 3)
        for mesh in scene.meshes
        if len(mesh.triangles)
    ]
    found: Array = np.concatenate(centres)
    return found


def _normals(corners: Array) -> Array:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    unit: Array = normals / np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
    return unit


def _pool_radius(light: Light, distance: Array, extent: float) -> Array:
    """(n,): the circle that a spot lights, 45 degrees around a lamp, a quarter of the scene in the sun."""
    if light.kind is LightKind.DIRECTIONAL:
        return np.full(len(distance), extent / 4)
    half_angle = min(light.outer_cone_rad, np.pi / 4) if light.kind is LightKind.SPOT else np.pi / 4
    radius: Array = np.minimum(distance * np.tan(half_angle), min(light.range_m, extent / 2))
    return radius


def _in_lit_patch(caster: RayCaster, struck: _Struck, points: Array, normals: Array, pools: Array) -> Bools:
    """(n,) bool: whether rays that go beside the point, by little and by less, strike the same plane."""
    radius = np.minimum(_PATCH[0] * caster.extent, _PATCH[1] * pools)
    angle = 0.7 + np.arange(5) * (2 * np.pi / 5)  # along no edge that follows the axes
    first, second = _plane_axes(normals)
    star = np.cos(angle)[:, None] * first[:, None] + np.sin(angle)[:, None] * second[:, None]
    rings = radius[:, None] * _RINGS
    around = points[:, None, None] + rings[:, :, None, None] * star[:, None]
    start = np.broadcast_to(struck.origins[:, None, None], around.shape)
    ray = around - start
    wanted = np.linalg.norm(ray, axis=-1)
    begin = struck.begin[:, None, None]
    start = start + begin[..., None] * ray / wanted[..., None]
    distance, _ = caster.hits(start.reshape(-1, 3), ray.reshape(-1, 3))
    error = np.abs(distance.reshape(wanted.shape) + begin - wanted)
    mount = OFFSET_PER_EXTENT * caster.extent
    # Float32 is good for a third of the mount.
    same: Bools = (error < np.maximum(0.1 * rings, mount)[..., None]).all(axis=(1, 2))
    return same
