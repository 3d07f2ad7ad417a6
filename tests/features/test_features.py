from __future__ import annotations

from dataclasses import replace
from math import cos, degrees, log2, pi, radians, tan

import numpy as np
import pytest

from features.extraction import extract, extractor_version
from features.level_survey import LevelSurvey
from features.light_view import LightView
from features.table import FEATURES, NAMES, Group
from scenes.scene import Camera, Light, LightKind, Mesh, Scene, View
from tests.random_scenes import look_at, random_camera, random_light, random_scene
from tests.solids import box, floor
from tests.tolerances import (
    FEATURE_EDGE_DISTANCE,
    FEATURE_FOOTPRINT,
    FEATURE_GRID,
    FEATURE_MOVED,
    FEATURE_RAYS,
)

DOWN = (0.0, -1.0, 0.0)
TOP = Camera("top", (0.0, 10.0, 0.0), DOWN, (0.0, 0.0, -1.0), yfov_rad=radians(60))
SUN = Light("sun", LightKind.DIRECTIONAL, direction=DOWN)
LAMP = Light("lamp", LightKind.POINT, (0.0, 5.0, 0.0))
SPOT = Light("spot", LightKind.SPOT, (0.0, 5.0, 0.0), DOWN, 0.1, radians(30))
VIEW = View(TOP, 320, 200)
BARE = Scene("bare", (floor(10.0),))


def measured(scene: Scene, light: Light, view: View = VIEW) -> dict[str, float]:
    return dict(extract(LevelSurvey.of(scene), light, view).values)


def light_of(kind: LightKind) -> Light:
    return {LightKind.SPOT: SPOT, LightKind.POINT: LAMP, LightKind.DIRECTIONAL: SUN}[kind]


def test_the_table_names_each_feature_once_and_says_what_it_is() -> None:
    assert len(set(NAMES)) == len(NAMES) >= 12
    assert {one.group for one in FEATURES} == set(Group)
    for one in FEATURES:
        text = one.measure.__doc__ or ""
        assert all(word in text for word in ("Unit", "ange", "ource")), one.name
        assert one.low
        assert one.high != one.low


@pytest.mark.parametrize("kind", list(LightKind))
@pytest.mark.parametrize(
    "geometry", ["closed boxes", "open sheets", "triangle soup", "duplicates and degenerates"]
)
def test_features_are_finite_and_repeat(geometry: str, kind: LightKind) -> None:
    scene = random_scene(geometry, 3)
    light, view = random_light(kind, 5), View(random_camera(7), 160, 100)
    first = measured(scene, light, view)
    assert list(first) == list(NAMES)
    assert all(np.isfinite(value) for value in first.values())
    assert measured(scene, light, view) == first


@pytest.mark.parametrize("kind", list(LightKind))
@pytest.mark.parametrize(
    "scene",
    [
        Scene("empty", ()),
        Scene("nothing drawn", (Mesh("m", np.zeros((3, 3)), np.zeros((0, 3), int)),)),
        Scene("one point", (Mesh("m", np.ones((3, 3)), np.array([[0, 1, 2]])),)),
        Scene("one line", (Mesh("m", np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]])),)),
        Scene("behind the eye", (box((0, 50, 0), (1, 1, 1)),)),
        Scene("glass", (replace(floor(10.0), casts=False),)),
    ],
    ids=lambda scene: scene.name,
)
def test_features_are_finite_where_there_is_nothing(scene: Scene, kind: LightKind) -> None:
    assert all(np.isfinite(value) for value in measured(scene, light_of(kind)).values())


@pytest.mark.parametrize("kind", list(LightKind))
def test_moving_everything_changes_no_feature(kind: LightKind) -> None:
    scene, light, camera = random_scene("closed boxes", 2), random_light(kind, 5), random_camera(3)
    offset = np.array([128.0, -32.0, 64.0])
    shift = np.eye(4)
    shift[:3, 3] = offset
    moved = Scene("moved", tuple(replace(one, placements=shift @ one.placements) for one in scene.meshes))
    here = measured(scene, light, View(camera, 160, 100))
    there = measured(
        moved,
        replace(light, position=tuple(np.add(light.position, offset))),
        View(replace(camera, position=tuple(np.add(camera.position, offset))), 160, 100),
    )
    assert there == pytest.approx(here, rel=FEATURE_MOVED, abs=FEATURE_MOVED)


@pytest.mark.parametrize("kind", list(LightKind))
def test_a_level_of_twice_the_size_has_the_same_features(kind: LightKind) -> None:
    scene, light, camera = random_scene("closed boxes", 2), random_light(kind, 5), random_camera(3)
    twice = np.diag([2.0, 2.0, 2.0, 1.0])
    large = Scene("large", tuple(replace(one, placements=twice @ one.placements) for one in scene.meshes))
    here = measured(scene, light, View(camera, 160, 100))
    there = measured(
        large,
        replace(light, position=tuple(2 * np.array(light.position)), range_m=2 * light.range_m),
        View(
            replace(camera, position=tuple(2 * np.array(camera.position)), near_m=2 * camera.near_m), 160, 100
        ),
    )
    assert there == pytest.approx(here, rel=FEATURE_MOVED, abs=FEATURE_MOVED)


def test_only_what_casts_and_is_in_reach_is_counted() -> None:
    near, far = box((0, 1, 0), (1, 1, 1)), box((60, 1, 0), (1, 1, 1))
    glass = replace(box((2, 1, 0), (1, 1, 1)), casts=False)
    found = measured(Scene("two", (near, far, glass)), replace(LAMP, range_m=20.0))
    assert found["casting_triangles"] == log2(1 + 12)
    assert found["casting_meshes"] == log2(1 + 1)
    assert measured(Scene("two", (near, far, glass)), LAMP)["casting_triangles"] == log2(1 + 24)
    # A spot that shines away from everything reaches nothing.
    assert (
        measured(Scene("two", (near, far, glass)), replace(SPOT, direction=(0, 1, 0)))["casting_triangles"]
        == 0
    )


def test_a_box_in_slanting_light_shows_a_silhouette_of_six_edges() -> None:
    scene = Scene("box", (box((0, 2, 0), (1, 1, 1)),))
    found = measured(scene, replace(SUN, direction=(2 / 7, -6 / 7, 3 / 7)))
    extent = float(np.linalg.norm(scene.bounds[1] - scene.bounds[0]))
    edge = float(scene.bounds[1, 0] - scene.bounds[0, 0])
    assert found["silhouette_edges"] == log2(1 + 6)
    assert found["silhouette_length"] == pytest.approx(log2(1 + 6 * edge / extent))
    assert found["closed_share"] == 1.0
    assert measured(BARE, SUN)["closed_share"] == 0.0


def test_stacked_sheets_are_counted_along_rays() -> None:
    sheets = tuple(floor(10.0, height=height) for height in (0.0, 1.0, 2.0))
    scene = Scene("sheets", sheets)
    narrow = replace(SPOT, outer_cone_rad=radians(20), inner_cone_rad=0.0)
    found = measured(scene, narrow)
    assert found["depth_complexity"] == 3.0
    assert found["crowding"] == 3.0
    # Of a sphere of rays, those reach the sheets that go down steeply enough.
    lamp = measured(scene, replace(LAMP, position=(0.0, 3.0, 0.0)))["depth_complexity"]
    assert 0.0 < lamp < 1.5
    # From below, the lowest is lit, and seen from above the top one is in shadow behind two.
    below = replace(SPOT, position=(0.0, -5.0, 0.0), direction=(0.0, 1.0, 0.0))
    assert measured(scene, below)["shadow_share"] == 0.0
    for height, above in ((1.5, 1.0), (0.5, 2.0)):
        dark = measured(scene, SUN, View(look_at((0, height, 0.1), (0, 0, 0)), 160, 100))
        assert dark["shadow_share"] == 1.0
        assert dark["casters_before_shadow"] == above


def test_a_half_roof_shadows_its_half() -> None:
    """A roof over x > 0, the sun overhead, the eye between: half of the view is dark."""
    roof = box((5, 9.9, 0), (5, 0.01, 10))
    eye = replace(TOP, position=(0.0, 8.0, 0.0))
    found = measured(Scene("roofed", (floor(10.0), roof)), SUN, View(eye, 480, 300))
    assert found["shadow_share"] == pytest.approx(0.5, abs=FEATURE_GRID)
    assert found["casters_before_shadow"] == pytest.approx(2.0, abs=FEATURE_GRID)
    assert found["receiver_pixels"] == pytest.approx(log2(1 + 480 * 300))
    # Only pairs to the right can be parted: one of 48 columns times the view's 1.6 by 128 steps across.
    assert found["edge_density"] <= 0.5 / 48 + FEATURE_GRID
    finer = measured(Scene("roofed", (floor(10.0), roof)), SUN, View(eye, 960, 600))
    assert finer["edge_density"] == found["edge_density"]


def test_nearer_edges_are_nearer() -> None:
    """A narrow view of stripes finer than its cells: every edge is as far as the floor."""

    def edge_at(height: float) -> float:
        eye = replace(TOP, position=(0.0, height, 0.0), yfov_rad=radians(10))
        stripes = [box((x * 0.05, 20, 0), (0.0125, 0.01, 10)) for x in range(-40, 41)]
        scene = Scene("stripes", (floor(10.0), *stripes))
        extent = float(np.linalg.norm(scene.bounds[1] - scene.bounds[0]))
        return measured(scene, SUN, View(eye, 160, 100))["edge_distance"] * extent

    assert edge_at(4.0) == pytest.approx(4.0, rel=FEATURE_EDGE_DISTANCE)
    assert edge_at(6.0) == pytest.approx(6.0, rel=FEATURE_EDGE_DISTANCE)
    assert measured(BARE, SUN)["edge_distance"] == 4.0


@pytest.mark.parametrize("half_deg", [5.0, 30.0, 75.0])
def test_the_cut_off_of_a_spot(half_deg: float) -> None:
    light = replace(SPOT, outer_cone_rad=radians(half_deg), inner_cone_rad=0.0, range_m=7.0)
    found = measured(BARE, light)
    extent = float(np.linalg.norm(BARE.bounds[1] - BARE.bounds[0]))
    assert found["cone_half_angle"] == pytest.approx(half_deg)
    assert found["solid_angle"] == pytest.approx(2 * pi * (1 - cos(radians(half_deg))))
    assert found["range_over_extent"] == pytest.approx(7.0 / extent)
    assert (found["is_spot"], found["is_point"], found["is_directional"]) == (1.0, 0.0, 0.0)


def test_the_cut_off_of_other_lights() -> None:
    lamp, sun = measured(BARE, LAMP), measured(BARE, SUN)
    assert (lamp["cone_half_angle"], lamp["solid_angle"]) == (180.0, pytest.approx(4 * pi))
    assert (sun["cone_half_angle"], sun["solid_angle"]) == (0.0, 0.0)
    assert lamp["range_over_extent"] == sun["range_over_extent"] == sun["light_distance"] == 4.0
    assert (lamp["is_point"], sun["is_directional"], lamp["is_spot"] + sun["is_spot"]) == (1.0, 1.0, 0.0)


def test_angles_between_light_and_view() -> None:
    assert measured(BARE, SUN)["view_light_angle"] == pytest.approx(0.0, abs=FEATURE_GRID)
    assert measured(BARE, SUN)["light_ahead"] == pytest.approx(180.0)
    assert measured(BARE, replace(SPOT, position=(0, 15.0, 0)))["light_ahead"] == pytest.approx(180.0)
    assert measured(BARE, SPOT)["light_ahead"] == pytest.approx(0.0)
    level = Camera("level", (0.0, 1.0, 0.0), (0.0, 0.0, -1.0))
    assert measured(BARE, SUN, View(level, 160, 100))["view_light_angle"] == pytest.approx(90.0)
    assert measured(BARE, SUN, View(level, 160, 100))["light_ahead"] == pytest.approx(90.0)


def test_distances_over_a_floor() -> None:
    extent = float(np.linalg.norm(BARE.bounds[1] - BARE.bounds[0]))
    narrow = View(replace(TOP, yfov_rad=radians(2)), 160, 100)
    found = measured(BARE, SPOT, narrow)
    assert found["light_distance"] == pytest.approx(5.0 / extent, rel=FEATURE_RAYS)
    assert found["eye_distance"] == pytest.approx(10.0 / extent, rel=FEATURE_RAYS)
    assert found["incidence"] == pytest.approx(1.0, abs=FEATURE_RAYS)
    assert found["depth_ratio"] == pytest.approx(0.0, abs=FEATURE_RAYS)
    slanting = replace(SUN, direction=(0.8, -0.6, 0.0))
    assert measured(BARE, slanting)["incidence"] == pytest.approx(0.6, rel=FEATURE_RAYS)


def test_texels_of_a_map_over_a_floor() -> None:
    """A spot straight down at 5 m, seen straight down from 10 m: a texel is as long as the cone is wide."""
    found = measured(BARE, SPOT, View(TOP, 200, 200))
    texel_m = 2 * 5.0 * tan(radians(30)) / 1024
    pixel_m = 2 * 10.0 * tan(radians(30)) / 200
    assert 2 ** found["map_texel"] == pytest.approx(texel_m / pixel_m, rel=FEATURE_FOOTPRINT)
    doubled = measured(BARE, SPOT, View(TOP, 400, 400))
    assert doubled["map_texel"] == pytest.approx(found["map_texel"] + 1)


def test_a_warp_gains_where_the_thesis_says_so() -> None:
    """A sun from the side over a long floor gains; one that shines against the view gains nothing."""
    scene = Scene("long", (floor(200.0, cells=40),))
    low = View(look_at((0, 2, 0), (0, 0, -20), near_m=0.1), 320, 200)
    aside = measured(scene, replace(SUN, direction=(0.6, -0.8, 0.0)), low)
    against = measured(scene, replace(SUN, direction=(0.0, -0.0995037, 0.9950372)), low)
    assert aside["warp_gain"] > 1.0
    assert aside["warp_gain"] > against["warp_gain"] + 1.0
    assert aside["warped_texel"] < aside["map_texel"]


def test_what_is_measured_once_is_shared_and_costs_are_told() -> None:
    level = LevelSurvey.of(BARE)
    found = extract(level, SPOT, VIEW)
    assert found.seconds > 0.0
    assert level.seconds > 0.0
    one = LightView(level, SPOT, VIEW)
    assert one.receivers is one.receivers


def test_the_version_is_one_word_that_depends_on_our_sources() -> None:
    version = extractor_version()
    assert len(version) == 16
    assert int(version, 16) >= 0
    assert degrees(pi) == 180.0
