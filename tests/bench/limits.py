"""What a device can do at most: fragments and triangles a second, each with nothing else in the way."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import moderngl
import numpy as np

from renderers.context import Gpu

SIDE = 1024
LAYERS = 16
TRIANGLES = 200_000
REPEATS = 7

VERTEX = """#version 450 core
uniform float size;
void main() {
    vec2 corner = vec2(gl_VertexID % 3 & 1, gl_VertexID % 3 >> 1) * 4.0 * size - size;
    gl_Position = vec4(corner, 0.5, 1.0);
}"""
FRAGMENT = """#version 450 core
layout(location = 0) out float counted;
void main() { counted = gl_FrontFacing ? -1.0 : 1.0; }"""


@dataclass(frozen=True)
class Limits:
    """Rates of one device, a second.

    Attributes:
        blended_fragments: Added to a 32-bit float target behind a depth test, as shadow volumes do.
        depth_fragments: Written to a depth buffer, as shadow maps do.
        triangles: Set up and thrown away, too small to cover a pixel.
    """

    blended_fragments: float
    depth_fragments: float
    triangles: float


def measure_limits(gpu: Gpu) -> Limits:
    """The rates of the device behind `gpu`, each the median of several runs."""
    ctx = gpu.ctx
    counts = ctx.texture((SIDE, SIDE), 1, dtype="f4")
    depth = gpu.depth_texture(SIDE, SIDE)
    blended, depths = ctx.framebuffer([counts], depth), ctx.framebuffer([], depth)
    program = ctx.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
    array = ctx.vertex_array(program, [])
    covered = float(SIDE * SIDE * LAYERS)

    def fill() -> None:
        array.render(moderngl.TRIANGLES, vertices=3, instances=LAYERS)

    def specks() -> None:
        array.render(moderngl.TRIANGLES, vertices=3, instances=TRIANGLES)

    program["size"].value = 1.0
    blended.use()
    blended.depth_mask = False
    blended.clear(depth=1.0)
    ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
    ctx.depth_func, ctx.blend_func = "<=", (moderngl.ONE, moderngl.ONE)
    blended_s = _seconds(gpu, fill)
    depths.use()
    ctx.enable_only(moderngl.DEPTH_TEST)
    ctx.depth_func = "1"
    depth_s = _seconds(gpu, fill)
    program["size"].value = 1e-6
    specks_s = _seconds(gpu, specks)
    ctx.enable_only(moderngl.NOTHING)
    gpu.release(blended, depths, counts, depth, array, program)
    return Limits(covered / blended_s, covered / depth_s, TRIANGLES / specks_s)


def _seconds(gpu: Gpu, work: Callable[[], None]) -> float:
    def once() -> float:
        gpu.ctx.finish()
        start = time.perf_counter()
        work()
        gpu.ctx.finish()
        return time.perf_counter() - start

    once()
    return float(np.float64(median(once() for _ in range(REPEATS))))
