"""A level that is measured in a second: a floor, a box and a slanted leaf, three lights and a camera."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from scenes.gltf.writer import write_glb
from scenes.scene import Camera, Light, LightKind, Mesh, Mobility, Scene
from tests.solids import box, floor

LEAF = Mesh("leaf", np.array([[2, 0.5, 0], [3, 1.5, 0], [2, 1.5, 1]], np.float32), np.array([[0, 1, 2]]))

SPOT = Light(
    "Lamp",
    LightKind.SPOT,
    position=(3.0, 6.0, 2.0),
    direction=(-3 / 7, -6 / 7, -2 / 7),
    inner_cone_rad=0.5,
    outer_cone_rad=0.75,
    range_m=20.0,
    intensity=300.0,
    mobility=Mobility.STATIC,
)
POINT = Light("Torch", LightKind.POINT, position=(-3.0, 4.0, 1.5), range_m=15.0, intensity=100.0)
SUN = Light("Sun", LightKind.DIRECTIONAL, direction=(6 / 7, -3 / 7, 2 / 7), intensity=3.0)
CAMERA = Camera("Eye", (0.0, 4.95, 5.6), (0.0, -0.6, -0.8), (0.0, 0.8, -0.6))


def small_scene(
    lights: tuple[Light, ...] = (SPOT, POINT, SUN), cameras: tuple[Camera, ...] = (CAMERA,)
) -> Scene:
    return Scene("Small", (floor(8.0), box((0, 1, 0), (1, 1, 1)), LEAF), lights, cameras)


def small_level(folder: Path, name: str = "small.glb", scene: Scene | None = None) -> Path:
    path = folder / name
    write_glb(scene or small_scene(), path)
    return path


def named(light: Light, name: str) -> Light:
    return replace(light, name=name)
