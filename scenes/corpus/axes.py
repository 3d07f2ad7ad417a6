"""Where one light of one scene in one view stands on each axis of the corpus. By rays, without a GPU.

Measured the same way on corpus instances and on real levels, so that they can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, tan

import numpy as np

from scenes.ray_caster import OFFSET_PER_EXTENT, Bools, Indices, RayCaster
from scenes.scene import Array, Camera, Light, LightKind, Scene
from scenes.shells import Shells

COLUMNS, ROWS = 32, 20
MOST_LAYERS = 32
_SKY_POINTS, _SKY_RAYS = 32, 24
# Float32 rays: a layer this near behind the last is the same one, as a share of the extent.
_LAYER = 4 * OFFSET_PER_EXTENT
_GOLDEN_ANGLE = float(np.pi * (3 - np.sqrt(5)))


@dataclass(frozen=True)
class Axes:
    """What the selector may have to know, in numbers that need no rendering.

    Attributes:
        triangles: Drawn, over all placements.
        instances: Meshes as drawn, over all placements.
        closed_share: Of the casting triangles, those in closed shells.
        extent_m: Diagonal of the bounds.
        lights: Of the scene.
        kind: Of the light.
        cut_off_deg: Half angle of a spot; 90 for other lights.
        range_share: Range as a share of the extent; `inf` without one.
        view_light_deg: Between the view's axis and the light's rays at what it sees: 0 with the light in the
            back, 180 facing it.
        light_distance: Median from the light to what is seen in its reach, as a share of the extent; `inf`
            for a directional light.
        eye_distance: The same from the eye.
        overlap: Mean number of casting surfaces between what is seen and the light, where there is any.
        shadow_share: Of what is seen in reach and faces the light, what is in shadow.
        lit_share: Of the whole picture, what is lit.
        boundary_distance: Median distance of visible shadow edges from the eye, as a share of the extent;
            `inf` where there is none.
        sky_blocked: Share of rays towards the upper half from what is seen that strike something.
    """

    triangles: int
    instances: int
    closed_share: float
    extent_m: float
    lights: int
    kind: LightKind
    cut_off_deg: float
    range_share: float
    view_light_deg: float
    light_distance: float
    eye_distance: float
    overlap: float
    shadow_share: float
    lit_share: float
    boundary_distance: float
    sky_blocked: float


@dataclass(frozen=True)
class Surveyed:
    """A scene with what is measured once for all of its lights and cameras.

    Attributes:
        scene: The scene.
        seen: Rays against all meshes.
        casting: Rays against meshes that cast.
        closed_share: Of the casting triangles, those in closed shells.
    """

    scene: Scene
    seen: RayCaster
    casting: RayCaster
    closed_share: float

    @classmethod
    def of(cls, scene: Scene) -> Surveyed:
        """Looks through the scene once."""
        shells = Shells.of(scene)
        seen = RayCaster(scene, casters_only=False)
        casting = seen if all(mesh.casts for mesh in scene.meshes) else RayCaster(scene)
        return cls(scene, seen, casting, shells.closed / max(shells.triangles, 1))

    def axes(self, light: Light, camera: Camera) -> Axes:
        """Where this light in this view stands."""
        extent = max(self.seen.extent, 1e-30)
        view = _Seen.by(self.seen, camera)
        ways, distances = _to_light(view.points, light)
        facing = (view.normals * ways).sum(axis=1) > 0.0
        asked = facing & _within(light, ways, distances)
        lit = np.zeros(len(asked), dtype=bool)
        error = OFFSET_PER_EXTENT * extent
        lit[asked] = self.casting.lit(view.points[asked], view.normals[asked], light, position_error=error)
        shadowed = asked & ~lit
        layers = self._layers(
            view.points[shadowed], view.normals[shadowed], ways[shadowed], distances[shadowed]
        )
        reached = view.points[asked]
        finite = np.isfinite(distances[asked])
        return Axes(
            triangles=self.scene.triangle_count,
            instances=sum(len(mesh.placements) for mesh in self.scene.meshes),
            closed_share=self.closed_share,
            extent_m=extent,
            lights=len(self.scene.lights),
            kind=light.kind,
            cut_off_deg=degrees(light.outer_cone_rad) if light.kind is LightKind.SPOT else 90.0,
            range_share=light.range_m / extent if light.kind is not LightKind.DIRECTIONAL else float("inf"),
            view_light_deg=_angle(-ways[asked], camera),
            light_distance=_median(distances[asked][finite]) / extent,
            eye_distance=_median(_lengths(reached - np.array(camera.position))) / extent,
            overlap=float(layers.mean()) if len(layers) else 0.0,
            shadow_share=float(shadowed.sum()) / max(int(asked.sum()), 1),
            lit_share=float(lit.sum()) / (COLUMNS * ROWS),
            boundary_distance=_boundary(view, asked, lit, camera) / extent,
            sky_blocked=self._sky_blocked(view),
        )

    def _layers(self, points: Array, normals: Array, ways: Array, distances: Array) -> Array:
        """(n,) how many casting surfaces are on the way from each point to the light."""
        step = _LAYER * self.seen.extent
        at = points + step * normals
        left = distances - step
        layers = np.zeros(len(points))
        active = np.arange(len(points))
        for _ in range(MOST_LAYERS):
            if not len(active):
                break
            distance, _ = self.casting.hits(at[active], ways[active])
            active, run = active[distance < left[active]], distance[distance < left[active]] + step
            layers[active] += 1
            at[active] += run[:, None] * ways[active]
            left[active] -= run
        return layers

    def _sky_blocked(self, view: _Seen) -> float:
        if not len(view.points):
            return 0.0
        chosen = np.unique(np.linspace(0, len(view.points) - 1, _SKY_POINTS).astype(int))
        index = np.arange(_SKY_RAYS)
        height = (index + 0.5) / _SKY_RAYS
        level = np.sqrt(1.0 - height * height)
        sky = np.stack(
            [level * np.cos(_GOLDEN_ANGLE * index), height, level * np.sin(_GOLDEN_ANGLE * index)], axis=1
        )
        lifted = view.points[chosen] + _LAYER * self.seen.extent * view.normals[chosen]
        origins = np.repeat(lifted, _SKY_RAYS, axis=0)
        directions = np.tile(sky, (len(chosen), 1))
        outwards = (np.repeat(view.normals[chosen], _SKY_RAYS, axis=0) * directions).sum(axis=1) > 0
        if not outwards.any():
            return 1.0
        distance, _ = self.seen.hits(origins[outwards], directions[outwards])
        return float(np.isfinite(distance).mean())


@dataclass(frozen=True)
class _Seen:
    """What the pixels of a small picture show.

    Attributes:
        pixels: (n,) which of them show a surface.
        points: (n, 3) where.
        normals: (n, 3) unit, towards the eye.
    """

    pixels: Indices
    points: Array
    normals: Array

    @classmethod
    def by(cls, caster: RayCaster, camera: Camera) -> _Seen:
        rays = _pixel_rays(camera)
        origins = np.broadcast_to(np.array(camera.position), rays.shape).astype(np.float64)
        distance, triangle = caster.hits(origins, rays)
        pixels = np.flatnonzero(np.isfinite(distance))
        rays = rays[pixels]
        corners = caster.corners(triangle[pixels])
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(_lengths(normals), 1e-300)[:, None]
        normals *= -np.sign((normals * rays).sum(axis=1))[:, None]
        return cls(pixels, origins[pixels] + distance[pixels, None] * rays, normals)


def _pixel_rays(camera: Camera) -> Array:
    forward, up = np.array(camera.forward), np.array(camera.up)
    high = tan(camera.yfov_rad / 2)
    x = (np.arange(COLUMNS) + 0.5) / COLUMNS * 2 - 1
    y = 1 - (np.arange(ROWS) + 0.5) / ROWS * 2
    down, across = np.meshgrid(high * y, high * COLUMNS / ROWS * x, indexing="ij")
    rays = forward + across.reshape(-1, 1) * np.cross(forward, up) + down.reshape(-1, 1) * up
    unit: Array = rays / _lengths(rays)[:, None]
    return unit


def _to_light(points: Array, light: Light) -> tuple[Array, Array]:
    """(n, 3) unit ways to the light, and (n,) how far it is."""
    if light.kind is LightKind.DIRECTIONAL:
        way = -np.array(light.direction)
        return np.broadcast_to(way, points.shape).astype(np.float64), np.full(len(points), np.inf)
    ways = np.array(light.position) - points
    distances = _lengths(ways)
    return ways / np.maximum(distances, 1e-300)[:, None], distances


def _within(light: Light, ways: Array, distances: Array) -> Bools:
    inside: Bools = (
        distances <= light.range_m if light.kind is not LightKind.DIRECTIONAL else np.isinf(distances)
    )
    if light.kind is LightKind.SPOT:
        inside &= -(ways @ np.array(light.direction)) >= np.cos(light.outer_cone_rad)
    return inside


def _boundary(view: _Seen, asked: Bools, lit: Bools, camera: Camera) -> float:
    """Median distance of pixels that are in shadow beside one that is lit."""
    state = np.zeros(COLUMNS * ROWS, dtype=np.int8)
    state[view.pixels] = np.where(lit, 1, np.where(asked, -1, 0))
    grid = state.reshape(ROWS, COLUMNS)
    edge = np.zeros_like(grid, dtype=bool)
    edge[:, 1:] |= grid[:, 1:] * grid[:, :-1] < 0
    edge[1:] |= grid[1:] * grid[:-1] < 0
    return _median(_lengths(view.points[edge.ravel()[view.pixels]] - np.array(camera.position)))


def _angle(rays: Array, camera: Camera) -> float:
    """Mean angle between the view's axis and the light's rays, degrees."""
    if not len(rays):
        return float("nan")
    cosines = np.clip(rays @ np.array(camera.forward), -1.0, 1.0)
    return degrees(float(np.arccos(cosines).mean()))


def _median(values: Array) -> float:
    return float(np.median(values)) if len(values) else float("inf")


def _lengths(vectors: Array) -> Array:
    lengths: Array = np.sqrt((vectors * vectors).sum(axis=1))
    return lengths
