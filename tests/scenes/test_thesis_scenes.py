"""The thesis' scenes have its triangle counts, are closed where they are solid, and show their shadows."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from scenes.formats.registry import read_level
from scenes.gltf.writer import glb_bytes
from scenes.ray_caster import RayCaster
from scenes.scene import Array, Camera, LightKind, Mesh, Scene
from scenes.solids import GRID_M
from scenes.thesis.box_grid import box_grid
from scenes.thesis.export import write_thesis_scenes
from scenes.thesis.open_geometry import moebius
from scenes.thesis.registry import OPEN_SCENES, THESIS_SCENES
from scenes.thesis.set_ups import NARROWEST_TOWER_RAD, set_ups
from scenes.thesis.water_tower import tower
from scenes.topology import Topology, weld
from tests.tolerances import FAIR_SHARE, NARROWEST_CONE_RAD

SCENES = THESIS_SCENES | OPEN_SCENES
COUNTS = {"box_grid": 12_000, "rocks": 63_000, "street": 400, "room": 19_000, "water_tower": 12_500}
FLOOR = 20_000
OPEN_MESHES = {"floor", "leaves", "pickets", "moebius strip"}
FIGURES = ("46a", "46b", "46c", "46d", "46e", "52", "53", "53", "53", "54", "54", "54", "55", "56", "57")

each_scene = pytest.mark.parametrize("key", SCENES)
each_set_up = pytest.mark.parametrize("number", range(len(FIGURES)), ids=FIGURES)


@cache
def built(key: str) -> Scene:
    return SCENES[key]()


def test_the_counts_are_those_of_the_thesis() -> None:
    counts = {key: built(key).triangle_count - FLOOR for key in THESIS_SCENES}
    assert counts == COUNTS


@each_scene
def test_every_scene_stands_on_a_floor_of_20000_triangles(key: str) -> None:
    floor = built(key).meshes[0]
    assert (floor.name, floor.triangle_count, floor.casts) == ("floor", FLOOR, True)
    assert not floor.positions[:, 1].any()
    corners = floor.positions.astype(np.float64)[floor.triangles]
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 1] > 0).all()


@each_scene
def test_what_is_solid_is_closed_and_faces_outwards(key: str) -> None:
    for mesh in built(key).meshes:
        topology = welded_topology(mesh)
        closed = not topology.balances.any() and bool((topology.valences == 2).all())
        assert closed == (mesh.name not in OPEN_MESHES), mesh.name
        assert not closed or volume(mesh) > 0, mesh.name


def test_a_moebius_strip_has_one_edge_and_no_consistent_winding() -> None:
    strip = moebius().meshes[1]
    topology = welded_topology(strip)
    rim = topology.edges[topology.valences == 1]
    assert set(topology.valences.tolist()) == {1, 2}
    assert ((topology.valences == 2) & (topology.balances != 0)).any()
    # The rim is one loop: each of its corners has two rim edges, and from one all others are reached.
    corners, degrees = np.unique(rim, return_counts=True)
    assert (degrees == 2).all()
    reached = np.isin(corners, rim[0])
    for _ in range(len(corners)):
        touched = np.isin(rim, corners[reached]).any(axis=1)
        reached |= np.isin(corners, rim[touched])
    assert reached.all()


@each_scene
def test_no_triangle_is_empty(key: str) -> None:
    for mesh in built(key).meshes:
        corners = mesh.positions.astype(np.float64)[mesh.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert normals.any(axis=1).all(), mesh.name


@each_scene
def test_two_calls_agree_and_all_positions_are_on_the_grid(key: str) -> None:
    scene = built(key)
    assert scene.digest == SCENES[key]().digest
    for mesh in scene.meshes:
        steps = mesh.world_positions() / GRID_M
        np.testing.assert_array_equal(steps, np.round(steps))


def test_no_two_scenes_are_the_same() -> None:
    assert len({built(key).digest for key in SCENES}) == len(SCENES)


@pytest.mark.parametrize("boxes", [1, 8, 100, 1000, 20_833])
def test_a_box_grid_has_as_many_boxes_as_asked_for(boxes: int) -> None:
    grid = box_grid(boxes).meshes[1]
    assert grid.triangle_count == 12 * boxes
    assert welded_topology(grid).valences.max() == 2, "boxes touch"
    assert volume(grid) > 0


def test_set_ups_are_the_figures_in_order() -> None:
    assert tuple(set_up.figure for set_up in set_ups()) == FIGURES
    assert len({set_up.name for set_up in set_ups()}) == len(FIGURES)


@each_set_up
def test_a_set_up_stages_its_light_and_camera(number: int) -> None:
    set_up = set_ups()[number]
    staged = set_up.staged()
    assert staged.lights == (set_up.light,)
    assert staged.cameras == (set_up.camera,)
    assert set_up.light.kind is LightKind.SPOT
    assert staged.triangle_count == built(set_up.scene).triangle_count


@each_set_up
def test_the_camera_sees_light_and_shadow(number: int) -> None:
    set_up = set_ups()[number]
    lit, shadowed = shares(set_up.staged())
    assert lit > FAIR_SHARE
    # A lamp behind the viewer hides shadows behind what casts them: that is what figure 54 shows.
    assert shadowed > (FAIR_SHARE / 3 if "behind" in set_up.name else FAIR_SHARE)


@pytest.mark.parametrize("key", ["fence", "moebius"])
def test_open_scenes_show_their_shadows(key: str) -> None:
    assert min(shares(built(key))) > FAIR_SHARE


def test_the_narrowest_cone_just_holds_the_tower() -> None:
    light = next(set_up.light for set_up in set_ups() if set_up.figure == "52")
    ways = np.concatenate([mesh.positions for mesh in tower()]) - np.array(light.position)
    widest = np.arccos((ways @ light.direction / np.linalg.norm(ways, axis=1)).min())
    assert NARROWEST_TOWER_RAD - NARROWEST_CONE_RAD < widest <= NARROWEST_TOWER_RAD == light.outer_cone_rad


def test_figure_55_has_its_light_between_the_viewer_and_the_rocks() -> None:
    set_up = next(set_up for set_up in set_ups() if set_up.figure == "55")
    nearest = built("rocks").meshes[1].positions

    def distance(position: tuple[float, float, float]) -> float:
        return float(np.linalg.norm(nearest - position, axis=1).min())

    assert distance(set_up.light.position) < distance(set_up.camera.position) / 2


def test_export_writes_every_scene_so_that_it_reads_back(tmp_path: Path) -> None:
    paths = write_thesis_scenes(tmp_path)
    assert [path.stem for path in paths] == list(SCENES)
    for path, key in zip(paths, SCENES, strict=True):
        made, level = built(key), read_level(path)
        assert path.read_bytes() == glb_bytes(made)
        assert level.notes == ()
        assert level.scene.triangle_count == made.triangle_count
        for loaded, mesh in zip(level.scene.meshes, made.meshes, strict=True):
            np.testing.assert_array_equal(loaded.positions[loaded.triangles], mesh.positions[mesh.triangles])
        assert [light.name for light in level.scene.lights] == [light.name for light in made.lights]
        assert [camera.name for camera in level.scene.cameras] == [camera.name for camera in made.cameras]


def welded_topology(mesh: Mesh) -> Topology:
    _, index = weld(mesh.positions)
    return Topology.of(index[mesh.triangles].astype(np.int32))


def volume(mesh: Mesh) -> float:
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    return float((np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]).sum() / 6)


def shares(scene: Scene) -> tuple[float, float]:
    """The shares of the picture that face the first light in its cone: lit, and in a cast shadow."""
    light, camera = scene.lights[0], scene.cameras[0]
    directions = pixel_rays(camera)
    caster = RayCaster(scene, casters_only=False)
    origins = np.broadcast_to(camera.position, directions.shape).astype(np.float64)
    distances, triangles = caster.hits(origins, directions)
    struck = triangles >= 0
    rays = directions[struck] / np.linalg.norm(directions[struck], axis=1, keepdims=True)
    points = origins[struck] + distances[struck, None] * rays
    corners = caster.corners(triangles[struck])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals *= -np.sign((normals * rays).sum(axis=1, keepdims=True))
    ways = points - np.array(light.position)
    inside = ways @ light.direction > np.cos(light.outer_cone_rad) * np.linalg.norm(ways, axis=1)
    asked = inside & ((normals * ways).sum(axis=1) < 0)
    lit = caster.lit(points[asked], normals[asked], light, position_error=1e-6 * caster.extent)
    return float(lit.sum()) / len(directions), float((~lit).sum()) / len(directions)


def pixel_rays(camera: Camera) -> Array:
    """(n, 3) directions through the pixels of a small picture of the thesis' shape, 5 to 4."""
    forward, up = np.array(camera.forward), np.array(camera.up)
    high = np.tan(camera.yfov_rad / 2)
    y, x = np.meshgrid(np.linspace(high, -high, 96), 1.25 * np.linspace(-high, high, 120), indexing="ij")
    rays = forward + x.reshape(-1, 1) * np.cross(forward, up) + y.reshape(-1, 1) * up
    return np.asarray(rays, dtype=np.float64)
