from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from renderers.context import Gpu
from renderers.debug_light import seen_from_light, usual_fit
from renderers.debug_maps import distances, face_depths, light_place, sampling
from renderers.debug_views import DEBUG_VIEWS, DebugView
from renderers.debug_volume_views import EDGE_COLORS, PALE, counter_view, counts, silhouette_pixels
from renderers.debug_volumes import edge_lines, volume_layers
from renderers.frame import Frame
from renderers.internals import Internals
from renderers.map_settings import guard_share
from renderers.registry import TECHNIQUES
from renderers.settings import Settings
from renderers.technique import ShadowPass
from scenes.scene import Array, Camera, Light, LightKind, Mesh, Scene
from scenes.topology import face_signs
from tests.rendering import framed, prepared
from tests.small_level import CAMERA, POINT, SPOT, SUN, small_scene
from tests.solids import box, floor, sheet
from tests.tolerances import (
    DEBUG_DISTANCE,
    DEBUG_FOOTPRINT,
    DEBUG_LINE_PX,
    DEBUG_PLATE_EDGE,
    DEBUG_TEXEL_PLANE,
)

SIZE = (96, 64)
DOWN = (0.0, -1.0, 0.0)
NOON = Light("Noon", LightKind.DIRECTIONAL, direction=DOWN)
LAMP = Light("Lamp", LightKind.SPOT, position=(0.0, 5.0, 0.0), direction=DOWN, outer_cone_rad=0.6)
LOW = Camera("Low", (0.0, 0.8, 7.0), (0.0, -0.28, -0.96), (0.0, 0.96, -0.28))
OBLIQUE = Camera("Oblique", (0.0, 6.0, 8.0), (0.0, -0.6, -0.8), (0.0, 0.8, -0.6))
UNBIASED: Settings = {"bias_slope": 0, "bias_units": 0, "bias_normal": 0}
HEIGHTS, HALVES = (1.0, 2.0, 3.0), (1.0, 2.0, 3.0)
TWO_SIDES, MANY_PIXELS = 2, 50


def plate(half: float, height: float, *, casts: bool = True) -> Mesh:
    return floor(half, height, casts=casts)


def red_box() -> Mesh:
    solid = box((0, 1, 0), (0.8, 1, 0.8))
    return Mesh("red", solid.positions, solid.triangles, base_color=(0.9, 0.05, 0.05))


@contextmanager
def rendered(
    gpu: Gpu,
    scene: Scene,
    light: Light,
    name: str,
    settings: Settings,
    camera: Camera = OBLIQUE,
    size: tuple[int, int] = SIZE,
) -> Iterator[tuple[Frame, ShadowPass, Internals]]:
    with framed(gpu, scene, light, camera, size) as frame, prepared(frame, name, settings) as shadow_pass:
        frame.shade()
        yield frame, shadow_pass, shadow_pass.internals()


def texel_rays(face: Array, side: int) -> Array:
    """(s, s, 3) unit directions in which the texels of a face look, top row first, up to their sign."""
    x = (np.arange(side) + 0.5) / side * 2 - 1
    across = face[0, :3] - x[:, None] * face[3, :3]
    along = face[1, :3] + x[:, None] * face[3, :3]
    rays = np.cross(across[None, :, :], along[:, None, :])
    unit: Array = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    return unit


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("SM", {}),
        ("SM", {"stored_depth": "linear"}),
        ("PSM", {"fall_back": "never"}),
        ("PSM", {"fall_back": "never", "depth": "kozlov"}),
        ("LiSPSM", {"fall_back": "never"}),
    ],
    ids=lambda value: "-".join(map(str, value.values())) if isinstance(value, dict) else value,
)
def test_a_map_shows_how_far_a_plane_is_from_the_light(gpu: Gpu, name: str, settings: Settings) -> None:
    side = 128
    asked = {**settings, "map_size": side, **UNBIASED}
    with rendered(gpu, Scene("Floor", (floor(8.0),), (LAMP,)), LAMP, name, asked) as (frame, _, internals):
        assert internals.map is not None
        (found,) = distances(internals.map, light_place(frame))
        (face,) = internals.map.fit.faces
    rays = texel_rays(face, side)
    drawn = np.isfinite(found)
    assert drawn.mean() > 0.5
    expected = 5.0 / np.abs(rays[..., 1])
    np.testing.assert_allclose(found[drawn], expected[drawn], rtol=DEBUG_DISTANCE)


def test_a_map_of_a_sun_shows_how_far_one_thing_is_behind_another(gpu: Gpu) -> None:
    scene = Scene("Plate", (floor(4.0), plate(1.0, 2.0)), (NOON,))
    asked = {"map_size": 128, "focus": "light", **UNBIASED}
    with rendered(gpu, scene, NOON, "SM", asked) as (frame, _, internals):
        assert internals.map is not None
        (found,) = distances(internals.map, light_place(frame))
    near = found < 1.0
    np.testing.assert_allclose(found[near], 0.0, atol=DEBUG_DISTANCE)
    np.testing.assert_allclose(found[np.isfinite(found) & ~near], 2.0, rtol=DEBUG_DISTANCE)
    assert near.sum() == pytest.approx(np.isfinite(found).sum() / 16, rel=0.1)


def test_texels_that_hold_nothing_have_no_distance(gpu: Gpu) -> None:
    scene = Scene("Plate", (plate(1.0, 1.0), floor(4.0, casts=False)), (LAMP,))
    with rendered(gpu, scene, LAMP, "SM", {"map_size": 64}) as (frame, _, internals):
        assert internals.map is not None
        found = distances(internals.map, light_place(frame))
        stored = face_depths(internals.map)
    assert (np.isnan(found) == (stored == 0)).all()
    assert 0.1 < np.isfinite(found).mean() < 0.9


def test_a_large_map_is_shown_by_the_nearest_texel_of_each_block(gpu: Gpu) -> None:
    with rendered(gpu, small_scene((SPOT,)), SPOT, "SM", {"map_size": 100}, CAMERA) as (_, _, internals):
        assert internals.map is not None
        whole, small = face_depths(internals.map), face_depths(internals.map, most=32)
    assert small.shape == (1, 25, 25)
    assert small[0, 3, 7] == whole[0, 12:16, 28:32].max()


def test_the_counter_counts_plates_above_a_floor(gpu: Gpu) -> None:
    plates = tuple(plate(half, height) for half, height in zip(HALVES, HEIGHTS, strict=True))
    scene = Scene("Stack", (floor(5.0), *plates), (NOON,))
    with rendered(gpu, scene, NOON, "SV", {}, LOW) as (frame, _, internals):
        found, domain = counts(frame, internals), frame.read_domain()
        places = frame.read_surfaces().positions
    reach = np.abs(places[..., [0, 2]]).max(axis=2)[..., None]
    above = places[..., 1:2] + 0.5 < np.array(HEIGHTS)
    expected = ((reach < np.array(HALVES)) & above).sum(axis=2)
    sure = domain & (np.abs(reach - np.array(HALVES)) > DEBUG_PLATE_EDGE).all(axis=2)
    assert set(expected[sure]) == {0, 1, 2, 3}
    assert (found[sure] == expected[sure]).all()


def test_counts_have_the_same_colors_whoever_counts(gpu: Gpu) -> None:
    scene = Scene("Plate", (floor(5.0), plate(1.5, 2.0)), (NOON,))
    legends = []
    for label, asked_for in (("SV", {}), ("Chan", {"map_size": 32})):
        with rendered(gpu, scene, NOON, label, asked_for, LOW) as (frame, _, internals):
            asked = frame.read_domain() if label == "SV" else silhouette_pixels(frame, internals)
            none_counted = asked & (counts(frame, internals) == 0)
            shown = counter_view(frame, internals)
        assert none_counted.any()
        assert shown.panels[0].picture is not None
        assert shown.panels[0].picture[none_counted].min() > 0.8 * min(PALE)
        legends.append(shown.legend.swatches)
    assert legends[0] == legends[1]
    assert [words for _, words in legends[0]] == ["0", "1"]
    assert legends[0][0][0] == PALE


@pytest.mark.parametrize(("variant", "weight"), [("crow", 1), ("general", 2)])
def test_silhouette_edges_lie_where_the_box_ends_for_the_light(gpu: Gpu, variant: str, weight: int) -> None:
    width = 2.0
    scene = Scene("Box", (floor(6.0, casts=False), box((0, 1, 0), (1, 1, 1))), (SPOT,))
    with rendered(gpu, scene, SPOT, "SV", {"variant": variant}, size=(192, 128)) as (frame, _, internals):
        assert internals.volumes is not None
        lines = edge_lines(frame, internals.volumes, EDGE_COLORS, width_px=width, hidden=1.0)
        world = frame.world
        corners = world.positions[world.triangles[: world.caster_count]].astype(float)
        sides = world.topology.multiplicities(face_signs(corners, light_place(frame)))
        edges = world.positions[world.topology.edges[sides != 0]].astype(float)
        clip = np.concatenate([edges, np.ones((*edges.shape[:2], 1))], axis=2) @ frame.clip_from_scene.T
    ends = (clip[..., :2] / clip[..., 3:] * [1, -1] + 1) / 2 * [192, 128]
    drawn = np.argwhere(lines[..., 3] > 0.5)[:, ::-1] + 0.5
    steps = np.linspace(0, 1, 400)[:, None, None]
    samples = ((1 - steps) * ends[:, 0] + steps * ends[:, 1]).reshape(-1, 2)
    gaps = np.linalg.norm(drawn[:, None] - samples[None], axis=2)
    assert len(drawn) > MANY_PIXELS
    assert gaps.min(axis=1).max() <= width / 2 + DEBUG_LINE_PX
    assert gaps.min(axis=0).max() <= DEBUG_LINE_PX
    # Each edge of a closed box's silhouette weighs the same, and has that one colour.
    strong = lines[lines[..., 3] > 0.99]
    np.testing.assert_allclose(
        strong[:, :3], np.array([EDGE_COLORS[weight - 1]] * len(strong)) / 255, atol=0.01
    )


def test_hidden_edges_are_as_faint_as_asked(gpu: Gpu) -> None:
    wall = sheet(lambda u, v: np.stack([4 * u, 4 * v, np.full_like(u, 3.0)], axis=-1), 1, casts=False)
    scene = Scene("Wall", (floor(6.0, casts=False), box((0, 1, 0), (1, 1, 1)), wall), (SPOT,))
    for hidden in (0.0, 0.5):
        with rendered(gpu, scene, SPOT, "SV", {}) as (frame, _, internals):
            assert internals.volumes is not None
            lines = edge_lines(frame, internals.volumes, EDGE_COLORS, width_px=1.0, hidden=hidden)
            behind = frame.read_surfaces().positions[..., 2] > 2.5
        assert behind.mean() > 0.3
        strongest = lines[behind][:, 3].max()
        assert strongest == 0.0 if hidden == 0.0 else 0.4 < strongest < 0.8


def test_sides_in_front_are_odd_where_there_is_shadow(gpu: Gpu) -> None:
    scene = Scene("Plate", (floor(6.0, casts=False), plate(1.5, 2.0)), (NOON,))
    with rendered(gpu, scene, NOON, "SV", {}) as (frame, _, internals):
        assert internals.volumes is not None
        layers = volume_layers(frame, internals.volumes)
        places, covered = frame.read_surfaces().positions, frame.read_surfaces().covered
    ground = covered & (np.abs(places[..., 1]) < 0.5)
    reach = np.abs(places[..., [0, 2]]).max(axis=2)
    sure = ground & (np.abs(reach - 1.5) > DEBUG_PLATE_EDGE)
    assert ((layers[sure, 0] % 2 == 1) == (reach[sure] < 1.5)).all()
    assert layers[sure, 0].max() == TWO_SIDES
    # The near cap lies on the plate, and nowhere else.
    on_plate = covered & ~ground
    assert (layers[..., 1][on_plate] == 1).all()
    assert not layers[..., 1][ground].any()


def test_texels_of_a_light_at_the_eye_are_as_large_as_pixels(gpu: Gpu) -> None:
    side = 64
    eye = Camera("Eye", (0.0, 4.0, 6.0), (0.0, -0.6, -0.8), (0.0, 0.8, -0.6), yfov_rad=1.0)
    torch = Light("Torch", LightKind.SPOT, eye.position, eye.forward, outer_cone_rad=0.5)
    scene = Scene("Room", (floor(20.0), box((0, 1, 0), (1, 1, 1))), (torch,))
    asked = {"map_size": side, "frusta": "thesis", "focus": "light"}
    with rendered(gpu, scene, torch, "SM", asked, eye, (side, side)) as (frame, _, internals):
        assert internals.map is not None
        found = sampling(frame, internals.map).footprints
    known = np.isfinite(found)
    assert known.mean() > 0.5
    np.testing.assert_allclose(found[known], 1 / guard_share(side, "2x2"), rtol=DEBUG_FOOTPRINT)


def test_texels_of_a_sun_on_a_plane_seen_head_on(gpu: Gpu) -> None:
    height, half, side = 6.0, 8.0, 256
    above = Camera("Above", (0.0, height, 0.0), DOWN, (0.0, 0.0, -1.0), yfov_rad=1.0)
    asked = {"map_size": side, "focus": "light"}
    scene = Scene("Floor", (floor(half),), (NOON,))
    with rendered(gpu, scene, NOON, "SM", asked, above, (96, 64)) as (frame, _, internals):
        assert internals.map is not None
        found = sampling(frame, internals.map)
    texel_m = 2 * half / (side * guard_share(side, "2x2"))
    pixel_m = 2 * height * np.tan(0.5) / 64
    np.testing.assert_allclose(found.footprints, texel_m / pixel_m, rtol=DEBUG_TEXEL_PLANE)
    columns = found.texels[32, :, 1:]
    crossed = np.abs(columns[-1] - columns[0]).max()
    assert abs(crossed - 95 * pixel_m / texel_m) <= 1


def test_a_finer_map_has_smaller_texels_on_every_face(gpu: Gpu) -> None:
    for light in (SPOT, POINT, SUN):
        means = []
        for side in (128, 256):
            with rendered(gpu, small_scene(), light, "SM", {"map_size": side}, CAMERA) as (
                frame,
                _,
                internals,
            ):
                assert internals.map is not None
                means.append(np.nanmean(sampling(frame, internals.map).footprints))
        assert 1.8 < means[0] / means[1] < 2.2


def test_the_light_sees_the_caster_in_its_middle(gpu: Gpu) -> None:
    side = 48
    scene = Scene("Red", (floor(4.0), red_box()), (LAMP,))
    with rendered(gpu, scene, LAMP, "SM", {"map_size": 128}) as (frame, _, internals):
        assert internals.map is not None
        (picture,) = seen_from_light(frame, internals.map.fit, side)
    assert picture is not None
    red = (picture[..., 0] > 100) & (picture[..., 1] < 100)
    assert red[side // 2 - 4 : side // 2 + 4, side // 2 - 4 : side // 2 + 4].all()
    rows, columns = np.nonzero(red)
    assert abs(rows.mean() - (side - 1) / 2) < 1
    assert abs(columns.mean() - (side - 1) / 2) < 1
    assert not red[[0, -1]].any()


def test_what_the_camera_does_not_see_is_faint(gpu: Gpu) -> None:
    scene = Scene("Floor", (floor(4.0),), (LAMP,))
    aside = Camera("Aside", (0.0, 0.5, 0.0), (0.96, -0.28, 0.0), (0.28, 0.96, 0.0))
    with rendered(gpu, scene, LAMP, "SM", {"map_size": 128}, aside) as (frame, _, internals):
        assert internals.map is not None
        (picture,) = seen_from_light(frame, internals.map.fit, 64)
        (face,) = internals.map.fit.faces
    assert picture is not None
    clip = face @ [2.0, 0.0, 0.0, 1.0]
    column, row = ((clip[:2] / clip[3] * [1, -1] + 1) / 2 * 64).astype(int)
    assert picture[row, column].astype(float).mean() > 2 * picture[63 - row, 63 - column].mean()


def test_six_faces_look_six_ways(gpu: Gpu) -> None:
    with rendered(gpu, Scene("Floor", (floor(4.0),), (POINT,)), POINT, "SV", {}) as (frame, _, _):
        pictures = seen_from_light(frame, usual_fit(frame), 16)
    assert [picture is not None for picture in pictures][2:4] == [False, True]


@pytest.mark.parametrize("light", [SPOT, POINT, SUN], ids=lambda light: light.name)
@pytest.mark.parametrize("known", TECHNIQUES, ids=lambda known: known.name)
def test_every_technique_draws_every_view_that_it_has(gpu: Gpu, known: object, light: Light) -> None:
    name = known.name  # type: ignore[attr-defined]
    with rendered(gpu, small_scene(), light, name, {}, CAMERA) as (frame, shadow_pass, internals):
        before = frame.read_mask()
        for view in views_of(internals):
            drawn = view.draw(frame, internals)
            gpu.check(view.name)
            assert len(drawn.panels) in {1, 6}
            assert drawn.legend.swatches or drawn.legend.scale
            pictures = [panel.picture for panel in drawn.panels if panel.picture is not None]
            assert any(picture.std() > 0 for picture in pictures), view.name
            if drawn.of_screen:
                assert pictures[0].shape == (SIZE[1], SIZE[0], 3)
        assert (frame.read_mask() == before).all()
        assert shadow_pass.count()


def test_techniques_with_a_map_show_it_and_those_with_volumes_theirs(gpu: Gpu) -> None:
    seen: set[str] = set()
    for known in TECHNIQUES:
        with rendered(gpu, small_scene(), SPOT, known.name, {}, CAMERA) as (_, shadow_pass, internals):
            names = {view.name for view in views_of(internals)}
            counters = shadow_pass.count()
        seen |= names
        assert ({"map", "texels"} <= names) == ("map_triangles" in counters), known.label
        assert ({"counter", "edges", "volumes"} <= names) == ("volume_fragments" in counters), known.label
        assert ("silhouettes" in names) == ("silhouette_pixels" in counters), known.label
        assert "light" in names
    assert seen == {view.name for view in DEBUG_VIEWS}


def test_a_hybrid_shows_the_pixels_that_it_counts(gpu: Gpu) -> None:
    with rendered(gpu, small_scene(), SPOT, "SV", {}, CAMERA) as (frame, _, internals):
        everywhere = counts(frame, internals)
    with rendered(gpu, small_scene(), SPOT, "Chan", {"map_size": 64}, CAMERA) as (
        frame,
        shadow_pass,
        internals,
    ):
        asked, found = silhouette_pixels(frame, internals), counts(frame, internals)
        assert asked.sum() == shadow_pass.count()["silhouette_pixels"]
    assert 0.01 < asked.mean() < 0.5
    assert (found[asked] == everywhere[asked]).all()
    assert not found[~asked].any()


def test_the_replay_forms_of_volumes_show_the_same_edges(gpu: Gpu) -> None:
    forms: tuple[Settings, ...] = ({}, {"silhouettes": "cpu"}, {"extrusion": "infinite"})
    layers = []
    for settings in forms:
        with rendered(gpu, small_scene(), SPOT, "SV", settings, CAMERA) as (frame, _, internals):
            assert internals.volumes is not None
            layers.append(
                edge_lines(frame, internals.volumes, EDGE_COLORS, width_px=2.0, hidden=0.5)[..., 3] > 0.4
            )
    assert layers[0].sum() > MANY_PIXELS
    assert (layers[0] == layers[1]).all()
    assert (layers[0] == layers[2]).all()


def views_of(internals: Internals) -> list[DebugView]:
    return [view for view in DEBUG_VIEWS if view.has(internals)]
