"""Viewpoints on Quake's own maps, judged by their brushes: exact half spaces, without any ray."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy import ndimage

from scenes.formats.registry import read_level
from scenes.quake.brushes import polygons
from scenes.quake.map_parser import parse_map
from scenes.quake.textures import BrushKind, brush_kind
from scenes.quake.units import UNITS_PER_M
from scenes.ray_caster import Bools, RayCaster
from scenes.scene import Array, Light, LightKind, Scene
from scenes.viewpoints import viewpoints
from tests import tolerances
from tests.tolerances import EYE_HEIGHT

FOLDER = Path(__file__).parents[2] / "../shared/levels/quake"
CELL = 16.0
SUNS = tuple(
    Light("Sun", LightKind.DIRECTIONAL, direction=direction)
    for direction in ((0.0, -1.0, 0.0), (0.6, -0.8, 0.0), (-0.28, -0.96, 0.0))
)

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the folder of real levels is not here")


@dataclass(frozen=True)
class Brush:
    """The inside of (f, 3) outward unit normals and (f,) distances, in Quake's units and axes.

    Its corners lie within the (2, 3) bounds.
    """

    normals: Array
    distances: Array
    bounds: Array
    kind: BrushKind
    of_world: bool

    def heights(self, points: Array) -> Array:
        return points @ self.normals.T - self.distances


def brushes(path: Path) -> list[Brush]:
    text = parse_map(path.read_bytes())
    shapes = polygons(text)
    loops = np.repeat(shapes.faces, np.diff(shapes.offsets))
    corners = shapes.corners[shapes.loops]
    found = []
    for entity in text.entities:
        for brush in range(*entity.brushes):
            faces = slice(text.face_offsets[brush], text.face_offsets[brush + 1])
            kind = brush_kind(frozenset(text.textures[faces]))
            if entity.kind.startswith("trigger_") or kind not in (BrushKind.SOLID, BrushKind.SKY):
                continue
            points = text.points[faces]
            normals = np.cross(points[:, 0] - points[:, 1], points[:, 2] - points[:, 1])
            lengths = np.linalg.norm(normals, axis=1)
            points, normals = points[lengths > 0], normals[lengths > 0] / lengths[lengths > 0, None]
            distances = (normals * points[:, 0]).sum(axis=1)
            own = corners[(loops >= faces.start) & (loops < faces.stop)]
            if len(own):
                bounds = np.stack([own.min(axis=0), own.max(axis=0)])
                found.append(Brush(normals, distances, bounds, kind, entity.kind == "worldspawn"))
    return found


def units(metres: npt.ArrayLike) -> Array:
    x, y, z = np.moveaxis(np.asarray(metres, float) * UNITS_PER_M, -1, 0)
    return np.stack([x, -z, y], axis=-1)


def longest_inside(solids: list[Brush], starts: Array, ends: Array) -> Array:
    """(n,) how much of each segment lies deep in one brush, in units, by the clipping of Cyrus and Beck."""
    longest = np.zeros(len(starts))
    lengths = np.linalg.norm(ends - starts, axis=1)
    for brush in solids:
        here = brush.heights(starts) + tolerances.BRUSH_SKIN
        there = brush.heights(ends) + tolerances.BRUSH_SKIN
        share = here / np.where(here == there, 1.0, here - there)
        entry = np.where((here > 0) & (there <= 0), share, 0.0).max(axis=1)
        exit_ = np.where((here <= 0) & (there > 0), share, 1.0).min(axis=1)
        beside = ((here > 0) & (there > 0)).any(axis=1)
        longest = np.maximum(longest, np.where(beside, 0.0, (exit_ - entry) * lengths))
    return longest


def outside_the_hull(solids: list[Brush], scene: Scene, points: Array) -> Bools:
    """(n,) bool: what floods the map from beyond its bounds, cell by cell, gets there."""
    low, high = np.sort(units(scene.bounds), axis=0) + np.array([[-4 * CELL], [4 * CELL]])
    axes = [np.arange(low[axis] + CELL / 2, high[axis], CELL) for axis in range(3)]
    filled = np.zeros([len(axis) for axis in axes], bool)
    for brush in solids:
        if brush.of_world:
            first, last = np.floor((brush.bounds - low) / CELL).astype(int) + np.array([[-1], [2]])
            near = tuple(slice(*ends) for ends in zip(first, last, strict=True))
            ranges = [axis[part] for axis, part in zip(axes, near, strict=True)]
            centres = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1)
            grown = CELL / 2 * np.abs(brush.normals).sum(axis=1)
            filled[near] |= (brush.heights(centres) <= grown).all(axis=-1)
    labels, _ = ndimage.label(~filled)
    cells = np.floor((points - low) / CELL).astype(int)
    found: Bools = labels[tuple(cells.T)] == labels[0, 0, 0]
    return found


@pytest.mark.parametrize("name", ["dm6", pytest.param("e1m1", marks=pytest.mark.slow)])
@pytest.mark.parametrize("extension", ["map", "glb"])
def test_every_eye_is_in_the_hull_and_in_no_brush(name: str, extension: str) -> None:
    solids = brushes(FOLDER / f"{name}.map")
    scene = read_level(FOLDER / f"{name}.{extension}").scene
    caster = RayCaster(scene, casters_only=False)
    made = [viewpoints(scene, light, caster) for light in (*scene.lights, *SUNS)]
    eyes = np.array([camera.position for views in made for camera in views])
    forward = np.array([camera.forward for views in made for camera in views])
    distance, _ = caster.hits(eyes, forward)
    places, eyes = units(eyes + distance[:, None] * forward), units(eyes)
    inside = np.any([(brush.heights(eyes) < 0).all(axis=1) for brush in solids], axis=0)
    assert not inside.any()
    assert not outside_the_hull(solids, scene, eyes).any()
    assert longest_inside(solids, eyes, places).max() == 0.0
    # Skies let light through, and what they shut in is seen.
    opaque = [brush for brush in solids if brush.kind is BrushKind.SOLID or extension == "glb"]
    lamps = np.array(
        [light.position for light, views in zip(scene.lights, made, strict=False) for _ in views]
    )
    assert longest_inside(opaque, units(lamps), places[: len(lamps)]).max() == 0.0


def test_lamps_in_the_air_of_a_map_have_four_views_and_most_who_stand_are_a_mans_height() -> None:
    path = FOLDER / "dm6.map"
    scene = read_level(path).scene
    caster = RayCaster(scene, casters_only=False)
    made = {light.name: viewpoints(scene, light, caster) for light in scene.lights}
    assert {name for name, views in made.items() if len(views) != 4} == {"light 2"}
    in_solid = [
        light.name
        for light in scene.lights
        if any(
            (brush.heights(units([light.position])) < -tolerances.BRUSH_SKIN).all()
            for brush in brushes(path)
            if brush.kind is BrushKind.SOLID
        )
    ]
    assert in_solid == ["light 2"]
    eyes = np.array([camera.position for views in made.values() for camera in views[1:3]])
    height, _ = caster.hits(eyes, np.tile([0.0, -1.0, 0.0], (len(eyes), 1)))
    # 0.94 measured; the others look at walls high up.
    assert np.mean(np.abs(height - 1.6) <= 1.6 * EYE_HEIGHT) > 0.9
