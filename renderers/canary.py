"""A fixed frame that tells how fast the machine is right now, so that its drift can be divided out."""

from __future__ import annotations

import time

import numpy as np

from renderers.clock import ClockKind, StageClock
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.settings import Settings
from renderers.shadow_map import ShadowMap
from renderers.world import World
from scenes.scene import Camera, Light, LightKind, Mesh, Scene

WIDTH, HEIGHT = 320, 256
BOXES = 6


def canary_scene() -> Scene:
    """A floor and a row of boxes under a spot light; never changed, or old samples lose their meaning."""
    floor = np.array([[-8, 0, -8], [8, 0, -8], [8, 0, 8], [-8, 0, 8]], np.float32)
    box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3).astype(np.int32)
    placements = np.tile(np.eye(4), (BOXES, 1, 1))
    placements[:, 0, 3] = np.arange(BOXES) * 2 - BOXES
    light = Light("canary", LightKind.SPOT, (0.0, 8.0, 5.0), (0.0, -0.8, -0.6), 0.4, 0.6)
    camera = Camera("canary", (0.0, 4.0, 12.0), (0.0, -0.28, -0.96), (0.0, 0.96, -0.28))
    ground = Mesh("floor", floor, np.array([[0, 2, 1], [0, 3, 2]], np.int32))
    return Scene("canary", (ground, Mesh("boxes", box, faces, placements)), (light,), (camera,))


class Canary:
    """The frame, ready to be timed again and again."""

    def __init__(self, gpu: Gpu, kind: ClockKind) -> None:
        scene = canary_scene()
        self._gpu, self._kind = gpu, kind
        self._world = World.of(gpu, scene)
        self._frame = Frame(self._world, WIDTH, HEIGHT)
        self._frame.look(scene.cameras[0])
        self._frame.shine(scene.lights[0])
        settings: Settings = {"map_size": 512, "filter": "2x2", "focus": "light"}
        self._pass = ShadowMap().prepare(self._frame, scene.lights[0], settings)
        self.sing()

    def sing(self) -> float:
        """Milliseconds of one canary frame."""
        clock = StageClock(self._gpu, self._kind)
        self._gpu.ctx.finish()
        start = time.perf_counter()
        with clock.stage("canary"):
            self._frame.draw_surfaces()
            self._pass.render(StageClock(self._gpu, self._kind, staged=False), rebuild=True)
            self._frame.shade()
        self._gpu.ctx.finish()
        wall_ms = (time.perf_counter() - start) * 1e3
        return clock.stages()["canary"] if self._kind is ClockKind.QUERY else wall_ms

    def release(self) -> None:
        """Give the GPU memory back."""
        self._pass.release()
        self._frame.release()
        self._world.release()
