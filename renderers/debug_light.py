"""The scene as a light's map sees it."""

from __future__ import annotations

from typing import cast

import moderngl
import numpy as np

from renderers import shader
from renderers.context import DEPTH_CLAMP
from renderers.debug_palette import SLATE
from renderers.frame import Frame, Picture
from renderers.run_drawer import RunDrawer
from renderers.shadow_map import ordinary_map
from scenes.map_frusta import MapFit
from scenes.scene import LightKind

FILE = "debug_light.glsl"
SAMPLES = 2
"""Along each side of a pixel."""
BACKGROUND = (SLATE[0] / 255, SLATE[1] / 255, SLATE[2] / 255, 1.0)


def usual_fit(frame: Frame) -> MapFit:
    """How a map of the frame's light would look at the scene; a sun's, at what the camera sees."""
    return ordinary_map(frame, 1.0, focused=frame.light.kind is LightKind.DIRECTIONAL)


def seen_from_light(frame: Frame, fit: MapFit, side: int) -> list[Picture | None]:
    """(side, side, 3) uint8 sRGB for each face of `fit`, top row first; None for one that shows nothing.

    Flat shaded through the map's own matrices, and faint where the camera does not see the surface.
    """
    gpu, world = frame.gpu, frame.world
    ctx = gpu.ctx
    program = shader.program(gpu, shader.source(FILE, "seen_vertex"), shader.source(FILE, "seen_fragment"))
    surfaces = RunDrawer(gpu, world.vertex_array(program), len(world.surfaces.low))
    size = (SAMPLES * side, SAMPLES * side)
    color, depth = ctx.texture(size, 4), gpu.depth_texture(*size)
    target = ctx.framebuffer([color], depth)
    every = world.surfaces.runs(np.ones(len(world.surfaces.low), bool))
    matrix = cast(moderngl.Uniform, program["map_from_scene"])
    pictures: list[Picture | None] = []
    for face in fit.faces:
        if not face.any():
            pictures.append(None)
            continue
        matrix.write(face.T.astype("f4").tobytes())
        target.use()
        target.clear(color=BACKGROUND, depth=0.0)
        world.bind_faces(4)
        frame.depth.use(2)
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.enable_direct(DEPTH_CLAMP)
        ctx.depth_func = ">"
        surfaces.draw(every)
        ctx.disable_direct(DEPTH_CLAMP)
        ctx.enable_only(moderngl.NOTHING)
        pixels = np.frombuffer(color.read(), np.uint8).reshape(side, SAMPLES, side, SAMPLES, 4)[::-1]
        pictures.append(np.round(pixels[..., :3].mean(axis=(1, 3))).astype(np.uint8))
    gpu.release(target, color, depth, surfaces)
    return pictures
