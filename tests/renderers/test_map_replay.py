from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderers.clock import ClockKind, StageClock
from renderers.context import Gpu
from renderers.map_settings import guard_share
from renderers.settings import Settings
from renderers.shadow_map import ShadowMap, ordinary_map
from scenes.scene import Light, LightKind, Scene
from tests import tolerances
from tests.gl_state import gl_state, live_objects
from tests.oracle import judge
from tests.random_scenes import look_at, random_camera, random_light, random_scene
from tests.rendering import framed, prepared, render_mask
from tests.solids import floor, moved, placed, plane

KINDS = list(LightKind)
SIZE = (160, 120)
SIDE = 512
PLAIN: Settings = {"map_size": SIDE, "filter": "2x2"}
LINEAR: Settings = {**PLAIN, "stored_depth": "linear"}
COPIED: Settings = {**PLAIN, "transfer": "copy"}


@pytest.mark.parametrize("settings", [LINEAR, COPIED, {**PLAIN, "frusta": "thesis"}])
@pytest.mark.parametrize("kind", KINDS)
def test_a_replayed_map_shows_the_shadows_that_rays_find(
    gpu: Gpu, kind: LightKind, settings: Settings
) -> None:
    for seed, geometry in enumerate(("closed boxes", "triangle soup", "open sheets")):
        scene, light, camera = random_scene(geometry, seed), random_light(kind, seed), random_camera(seed)
        mask, seen, domain = render_mask(gpu, scene, light, camera, SIZE, "shadow_map", settings)
        wrong = judge(scene, mask, seen, domain, light, camera).wrong_share
        assert wrong <= tolerances.SAMPLED_WRONG / SIDE


@pytest.mark.parametrize("kind", KINDS)
def test_a_copied_map_is_the_same_map(gpu: Gpu, kind: LightKind) -> None:
    scene, light, camera = random_scene("closed boxes", 2), random_light(kind, 2), random_camera(2)
    masks = [
        render_mask(gpu, scene, light, camera, SIZE, "shadow_map", settings)[0]
        for settings in (PLAIN, COPIED)
    ]
    assert np.array_equal(*masks)
    assert 0 < masks[0].mean() < 1


def test_copying_is_a_stage_of_its_own_where_the_map_is_made_anew(gpu: Gpu) -> None:
    scene, light, camera = random_scene("closed boxes", 2), random_light(LightKind.SPOT, 2), random_camera(2)
    with framed(gpu, scene, light, camera, SIZE) as frame:
        for settings, stages in ((PLAIN, {"map"}), (COPIED, {"map", "transfer"})):
            with prepared(frame, "shadow_map", settings) as shadow_pass:
                clocks = [StageClock(gpu, ClockKind.WALL) for _ in range(2)]
                shadow_pass.render(clocks[0], rebuild=True)
                shadow_pass.render(clocks[1], rebuild=False)
            assert set(clocks[0].stages()) == stages | {"visibility"}
            assert set(clocks[1].stages()) == {"visibility"}


def test_a_copied_map_takes_twice_the_memory_and_gives_it_back(gpu: Gpu) -> None:
    scene, light, camera = random_scene("fans", 0), random_light(LightKind.POINT, 0), random_camera(0)
    with framed(gpu, scene, light, camera, SIZE) as frame:
        gpu.release()
        state, alive = gl_state(), live_objects()
        with prepared(frame, "shadow_map", PLAIN) as plain, prepared(frame, "shadow_map", COPIED) as copied:
            assert copied.memory_bytes == 2 * plain.memory_bytes
            assert copied.count() == plain.count()
        gpu.release()
        assert gl_state() == state
        assert live_objects() == alive


@pytest.mark.parametrize("kind", [LightKind.SPOT, LightKind.POINT])
def test_a_plane_does_not_shadow_itself_on_a_linear_map(gpu: Gpu, kind: LightKind) -> None:
    random = np.random.default_rng(3)
    for slope in np.radians(np.linspace(0, 80, 9)):
        to_light = np.array([np.sin(slope), np.cos(slope), 0.0])
        light = Light("light", kind, tuple(5 * to_light), tuple(-to_light), 0.3, 0.6)
        scene = Scene("plane", (plane((0, 1, 0), 4.0),))
        camera = look_at((random.uniform(-2, 2), 6, 1), (0, 0, 0))
        mask, _, domain = render_mask(gpu, scene, light, camera, (96, 72), "shadow_map", LINEAR)
        assert (mask[domain] == 1).all()


def test_without_bias_a_linear_map_has_acne(gpu: Gpu) -> None:
    light = Light("light", LightKind.SPOT, (3.0, 4.0, 0), (-0.6, -0.8, 0.0), 0.3, 0.6)
    scene, camera = Scene("plane", (plane((0, 1, 0), 4.0),)), look_at((0, 6, 1), (0, 0, 0))
    settings = {**LINEAR, "bias_slope": 0, "bias_units": 0, "bias_normal": 0}
    mask, _, domain = render_mask(gpu, scene, light, camera, (96, 72), "shadow_map", settings)
    assert (mask[domain] < 1).mean() > 0.2


def test_linear_and_hyperbolic_maps_of_a_sun_are_one(gpu: Gpu) -> None:
    scene, light = random_scene("closed boxes", 1), random_light(LightKind.DIRECTIONAL, 1)
    masks = [
        render_mask(gpu, scene, light, random_camera(1), SIZE, "shadow_map", settings)[0]
        for settings in (PLAIN, LINEAR)
    ]
    assert np.array_equal(*masks)


def test_the_thesis_takes_the_whole_cone_and_the_depth_of_the_whole_scene(gpu: Gpu) -> None:
    # A small table under a wide lamp; a cellar that the lamp does not reach makes the scene deeper.
    cellar = moved(floor(1.0, cells=8), placed(offset=(40.0, -6.0, 0.0)))
    lamp = Light("lamp", LightKind.SPOT, (0.0, 2.0, 0.0), (0.0, -1.0, 0.0), 0.3, 1.1)
    shrink = guard_share(SIDE, "2x2")
    with framed(
        gpu, Scene("table", (floor(1.0, cells=8), cellar)), lamp, look_at((0, 5, 3), (0, 0, 0)), SIZE
    ) as frame:
        fitted, thesis = (
            ordinary_map(frame, shrink, focused=False, thesis=whole).faces[0] for whole in (False, True)
        )
        deep = np.array([*(np.array([0.0, -5.9, 0.0]) - frame.world.origin), 1.0])
    slopes = [np.linalg.norm(face[:2, :3], axis=1) for face in (fitted, thesis)]
    assert np.allclose(slopes[1], shrink / np.tan(1.1))
    assert (slopes[0] > 1.5 * slopes[1]).all()
    assert (fitted @ deep)[2] < 0 <= (thesis @ deep)[2]


@pytest.mark.parametrize("kind", KINDS)
def test_fall_off_at_the_edge_of_a_cone_is_shading_alone(gpu: Gpu, kind: LightKind) -> None:
    scene, camera = random_scene("closed boxes", 3), random_camera(3)
    soft = replace(random_light(kind, 3), inner_cone_rad=0.0)
    hard = replace(soft, inner_cone_rad=soft.outer_cone_rad)
    masks, pictures = [], []
    for light in (soft, hard):
        with framed(gpu, scene, light, camera, SIZE) as frame, prepared(frame, "shadow_map", PLAIN):
            frame.shade()
            masks.append(frame.read_mask())
            pictures.append(frame.read_picture().astype(int))
            domain = frame.read_domain()
    assert np.array_equal(*masks)
    darker = (pictures[0] <= pictures[1]).all()
    assert darker
    assert (pictures[0][domain] < pictures[1][domain]).any() == (kind is LightKind.SPOT)


def test_replays_are_no_candidates() -> None:
    replays = {name for name, option in ShadowMap.options.items() if option.replay}
    assert {"transfer", "stored_depth", "frusta"} <= replays
