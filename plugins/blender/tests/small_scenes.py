"""Scenes made of a few objects, and ways to wait for the extension."""

from __future__ import annotations

import sys
import time
from types import ModuleType
from typing import Any

import bpy

NAME = "bl_ext.user_default.gnomon"


def module(name: str) -> ModuleType:
    return sys.modules[f"{NAME}.{name}"]


def preferences() -> Any:
    return bpy.context.preferences.addons[NAME].preferences


def add_light(
    name: str, kind: str = "POINT", *, at: tuple[float, float, float] = (0, 0, 3), collection: Any = None
) -> bpy.types.Object:
    data = bpy.data.lights.new(name, kind)
    data.energy = 100.0
    light = bpy.data.objects.new(name, data)
    light.location = at
    (collection or bpy.context.scene.collection).objects.link(light)
    return light


def add_room() -> None:
    """A floor, a box on it, and a camera that sees both."""
    bpy.ops.mesh.primitive_plane_add(size=12)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(1, 1, 0.5))
    camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    camera.location, camera.rotation_euler = (0, -9, 6), (1.0, 0, 0)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.view_layer.update()


def activate(light: bpy.types.Object) -> None:
    bpy.context.view_layer.objects.active = light


def answered(seconds: float = 120.0) -> str:
    """Lets the timer run until the answer is there, as Blender's event loop would; what is said then."""
    poll, session = module("session").poll, module("session").SESSION
    assert bpy.app.timers.is_registered(poll)
    end = time.monotonic() + seconds
    while (wait := poll()) is not None:
        assert time.monotonic() < end
        time.sleep(wait)
    bpy.app.timers.unregister(poll)
    status: str = session.status
    return status


def told(light: bpy.types.Object) -> dict[str, Any]:
    return {key: light[key] for key in light.keys() if key.startswith("gnomon_")}  # noqa: SIM118  iterates values otherwise
