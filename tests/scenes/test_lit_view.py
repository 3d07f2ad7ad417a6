from __future__ import annotations

from dataclasses import replace

import pytest

from scenes.lit_view import shows_light
from scenes.ray_caster import RayCaster
from scenes.scene import Camera, Light, LightKind, Scene
from tests.random_scenes import look_at
from tests.solids import box, floor

LAMP = Light("lamp", LightKind.POINT, (0.0, 3.0, 0.0), range_m=6.0)
SCENE = Scene("room", (floor(20.0), box((0, 3, -8), (20, 3, 0.2))))


def shows(camera: Camera, light: Light, scene: Scene = SCENE) -> bool:
    return shows_light(camera, light, RayCaster(scene, casters_only=False), RayCaster(scene))


@pytest.mark.parametrize(
    ("camera", "shown"),
    [
        (look_at((0, 2, 6), (0, 0, 0)), True),
        (look_at((0, 2, 6), (0, 2, 16)), False),
        (look_at((0, 2, -14), (0, 2, 0)), False),
        (look_at((0, -2, 6), (0, 0, 0)), False),
        (look_at((0, 2, 6), (0, 9, 6.01)), False),
    ],
    ids=["at it", "turned away", "behind a wall", "below the floor", "at the sky"],
)
def test_a_view_shows_a_lamp_if_it_shows_what_it_lights(camera: Camera, shown: bool) -> None:  # noqa: FBT001
    assert shows(camera, LAMP) is shown


def test_reach_and_shade_count() -> None:
    camera = look_at((0, 2, 6), (0, 0, 0))
    assert not shows(camera, replace(LAMP, range_m=2.0))
    spot = Light("spot", LightKind.SPOT, (0.0, 3.0, 0.0), (0.0, 1.0, 0.0), 0.2, 0.4)
    assert not shows(camera, spot)
    assert shows(camera, replace(spot, direction=(0.0, -1.0, 0.0)))
    sun = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1.0, 0.0))
    assert shows(camera, sun)
    roofed = Scene("roofed", (*SCENE.meshes, box((0, 12, 0), (40, 0.1, 40))))
    assert not shows(camera, sun, roofed)
    # A sky that casts nothing lets it through.
    glass = Scene("glass", (*SCENE.meshes, replace(box((0, 12, 0), (40, 0.1, 40)), casts=False)))
    assert shows(camera, sun, glass)
