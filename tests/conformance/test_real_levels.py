"""Shadow volumes against Embree on levels that nobody here made; `pytest -s` prints each share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from renderers.context import Gpu
from renderers.frame import Frame
from renderers.world import World
from scenes.formats.registry import read_level
from scenes.ray_caster import RayCaster
from scenes.viewpoints import viewpoints
from tests import tolerances
from tests.rendering import prepared

LEVELS = Path(__file__).parents[2] / "../shared/levels"
NAMES = (
    "quake/start.glb",
    "quake/e1m1.glb",
    "quake/dm4.glb",
    "quake/dm6.glb",
    "gltf/blenvy_start_level.glb",
    "gltf/animation_pointer/24_animation_pointer.gltf",
    "gltf/tps_demo_lights.glb",
    "gltf/godot_lights_and_shadows.glb",
    "gltf/kenney_fps.glb",
    "gltf/kenney_platformer.glb",
    "gltf/wicked_lights_punctual_test.glb",
    "gltf/playcanvas_lights.glb",
)
LIGHTS = 12

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not LEVELS.is_dir(), reason="the folder of real levels is not here"),
]


@pytest.mark.parametrize("name", NAMES)
def test_shadow_volumes_agree_with_rays(gpu: Gpu, name: str) -> None:
    scene = read_level(LEVELS / name).scene
    caster, seen = RayCaster(scene), RayCaster(scene, casters_only=False)
    world = World.of(gpu, scene)
    judged = wrong = 0
    with Frame(world, 640, 360) as frame:
        for light in scene.lights[:: max(1, len(scene.lights) // LIGHTS)]:
            for camera in scene.cameras or viewpoints(scene, light, seen):
                frame.look(camera)
                frame.shine(light)
                frame.draw_surfaces()
                frame.draw_domain()
                with prepared(frame, "shadow_volume", {}):
                    mask = frame.read_mask()
                domain, surfaces = frame.read_domain(), frame.read_surfaces()
                points = surfaces.positions[domain]
                distance = np.linalg.norm(points - np.asarray(camera.position), axis=1)
                lit = caster.lit(
                    points, surfaces.normals[domain], light, position_error=tolerances.VIEW_DEPTH * distance
                )
                judged += len(lit)
                wrong += int(np.count_nonzero(lit != (mask[domain] > 0.5)))
    world.release()
    print(f"{name}: {wrong} of {judged} pixels, {wrong / judged:.1e}")  # noqa: T201  the figure is the point
    assert judged > 0
    assert wrong / judged <= tolerances.VOLUME_WRONG_SHARE
