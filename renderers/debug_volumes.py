"""Shadow volumes to look at: silhouette edges as lines, sides and caps as layers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, cast

import moderngl
import numpy as np
import numpy.typing as npt

from renderers import shader
from renderers.debug_palette import Color
from renderers.frame import Frame
from renderers.volume_pass import VolumePass
from scenes.scene import Array

FILE = "debug_volumes.glsl"
SILHOUETTE, FIRST_RIM, SECOND_RIM, END = 0, 1, 2, 3
"""Lines of a volume's side: the edge that casts it, the rays through its ends, and the edge where it ends."""


def edge_lines(
    frame: Frame,
    volumes: VolumePass,
    colors: Sequence[Color],
    *,
    lines: Sequence[int] = (SILHOUETTE,),
    width_px: float,
    hidden: float,
) -> Array:
    """(h, w, 4) float64: lines over the picture, colour of 0..1 times alpha, and alpha; top row first.

    Args:
        frame: With its surfaces drawn.
        volumes: With their silhouettes found.
        colors: Of sides of multiplicity 1, 2 and more.
        lines: Which lines of each side.
        width_px: How wide.
        hidden: Alpha where the scene hides a line.
    """
    vertices = shader.source(FILE, "line_vertex")
    program = shader.program(frame.gpu, vertices, shader.source(FILE, "line_fragment"))
    _set(program, "viewport", (frame.width, frame.height))
    _set(program, "half_width", width_px / 2)
    _set(program, "hidden_alpha", hidden)
    _set(program, "colors", [tuple(channel / 255 for channel in color) for color in colors])
    with _target(frame, "f1", depth=False) as color:
        frame.depth.use(2)
        frame.gpu.ctx.blend_func = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)
        drawn = frame.gpu.ctx.vertex_array(program, [])
        for line in lines:
            _set(program, "line", line)
            volumes.draw_by(None, drawn)
        frame.gpu.release(drawn)
        return _rows(color, np.uint8, frame) / 255


def volume_layers(frame: Frame, volumes: VolumePass) -> Array:
    """(h, w, 3) float64: how many sides, near caps and far caps stand before each surface or lie on it.

    Top row first. Near caps lie on the lit casters themselves.
    """
    gpu, fragment = frame.gpu, shader.source(FILE, "layer_fragment")
    caps, sides = (
        gpu.ctx.vertex_array(shader.program(gpu, shader.source(FILE, section), fragment), [])
        for section in ("cap_layer_vertex", "side_layer_vertex")
    )
    with _target(frame, "f4", depth=True) as layers:
        gpu.ctx.blend_func = (moderngl.ONE, moderngl.ONE)
        gpu.ctx.depth_func = ">="
        volumes.draw_by(caps, sides)
        gpu.release(caps, sides)
        return _rows(layers, np.float32, frame)[..., :3].astype(float)


@contextmanager
def _target(frame: Frame, dtype: str, *, depth: bool) -> Iterator[moderngl.Texture]:
    """A clear target of the frame's size to blend into, tested against the frame's depth where `depth`."""
    ctx = frame.gpu.ctx
    texture = ctx.texture((frame.width, frame.height), 4, dtype=dtype)
    target = ctx.framebuffer([texture], frame.depth if depth else None)
    target.depth_mask = False
    target.use()
    target.clear()
    ctx.enable_only(moderngl.BLEND | (moderngl.DEPTH_TEST if depth else 0))
    ctx.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
    try:
        yield texture
    finally:
        ctx.enable_only(moderngl.NOTHING)
        frame.gpu.release(target, texture)


def _set(program: moderngl.Program, name: str, value: object) -> None:
    cast(moderngl.Uniform, program[name]).value = value


def _rows(texture: moderngl.Texture, dtype: npt.DTypeLike, frame: Frame) -> Array:
    pixels: npt.NDArray[Any] = np.frombuffer(texture.read(alignment=1), dtype)
    return pixels.reshape(frame.height, frame.width, 4)[::-1].astype(float)
