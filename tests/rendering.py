"""Renders one light by one technique, reads what the tests judge, and gives everything back."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt

from renderers.clock import ClockKind, StageClock
from renderers.context import Gpu
from renderers.frame import Frame, Mask, Surfaces
from renderers.registry import technique
from renderers.settings import Settings
from renderers.technique import ShadowPass
from renderers.world import World
from scenes.scene import Camera, Light, Scene

Bools = npt.NDArray[np.bool_]
Size = tuple[int, int]


@contextmanager
def framed(gpu: Gpu, scene: Scene, light: Light, camera: Camera, size: Size) -> Iterator[Frame]:
    """A frame with its surfaces and its domain drawn; gives its memory back, and the world's."""
    world = World.of(gpu, scene)
    try:
        with Frame(world, *size) as frame:
            frame.look(camera)
            frame.shine(light)
            frame.draw_surfaces()
            frame.draw_domain()
            yield frame
    finally:
        world.release()


def untimed(gpu: Gpu) -> StageClock:
    """A clock for renders whose time nobody asks for."""
    return StageClock(gpu, ClockKind.WALL, staged=False)


@contextmanager
def prepared(frame: Frame, name: str, settings: Settings, *, rebuild: bool = True) -> Iterator[ShadowPass]:
    """The pass of the technique `name`, rendered once into `frame`."""
    with technique(name).prepare(frame, frame.light, settings) as shadow_pass:
        shadow_pass.render(untimed(frame.gpu), rebuild=rebuild)
        yield shadow_pass


def render_mask(
    gpu: Gpu, scene: Scene, light: Light, camera: Camera, size: Size, name: str, settings: Settings
) -> tuple[Mask, Surfaces, Bools]:
    """The mask of the technique `name`, the surfaces that the camera sees, and where a mask has to answer."""
    with framed(gpu, scene, light, camera, size) as frame, prepared(frame, name, settings):
        return frame.read_mask(), frame.read_surfaces(), frame.read_domain()
