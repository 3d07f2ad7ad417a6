"""Finds the pixels where a map is not certain, and keeps their depth for volumes to be counted against."""

from __future__ import annotations

from typing import cast

import moderngl

from renderers import shader
from renderers.frame import Frame
from renderers.map_pass import MapPass
from renderers.owner import Owner

FILE = "chan_hybrid.glsl"
BYTES_PER_PIXEL = 4


class SilhouettePixels(Owner):
    """The computation mask of one frame, as a depth texture.

    Chan and Durand masked by the depth bounds test; here `depth` holds the scene's depth in silhouette pixels
    and 0 elsewhere, behind which no volume lies, so that the usual depth test keeps fragments out.

    Args:
        frame: Where they are found.
        faces: Faces of the map, 1 or 6.
        grazing: Cosine of incidence up to which pixels are silhouette pixels, whatever the map says.
        simple: Whether one map with a kernel of 2x2 texels is all there is to read.
    """

    def __init__(self, frame: Frame, faces: int, grazing: float, *, simple: bool) -> None:
        self._frame, self._faces, self._grazing = frame, faces, grazing
        gpu = frame.gpu
        self.depth = gpu.depth_texture(frame.width, frame.height)
        self.depth.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._target = gpu.ctx.framebuffer([frame.mask], self.depth)
        self._classify, self._visibility = (
            shader.full_screen(gpu, shader.source(FILE, section))
            for section in ("kernel_2x2" if simple else "kernels", "visibility")
        )
        self.memory_bytes = BYTES_PER_PIXEL * frame.width * frame.height

    def release(self) -> None:
        """Give the GPU memory back."""
        self._frame.gpu.release(self._target, self.depth, self._classify, self._visibility)

    def find(self, block: moderngl.Buffer, ordinary: MapPass, covering: MapPass) -> None:
        """Write the map's answer into the frame's mask, and mark the pixels where it has none.

        Args:
            block: The uniform block of the map.
            ordinary: What it shows.
            covering: A map of casters that cover all texels they touch; `ordinary` where there is none.
        """
        frame = self._frame
        block.bind_to_uniform_block(2)
        for unit, texture in ((2, ordinary.texture), (3, covering.texture), (4, frame.depth)):
            texture.use(unit)
        program = self._classify.program
        cast(moderngl.Uniform, program["faces"]).value = self._faces
        cast(moderngl.Uniform, program["grazing"]).value = self._grazing
        self._target.depth_mask = True
        self._target.use()
        self._target.scissor = (0, 0, frame.width, frame.height)
        self._target.clear(depth=0.0)
        self._target.scissor = frame.window
        self._cover(self._classify, "1")

    def fill(self, counts: moderngl.Texture) -> None:
        """Write into the frame's mask, in silhouette pixels alone, whether `counts` is 0."""
        counts.use(5)
        self._target.depth_mask = False
        self._target.use()
        self._target.scissor = self._frame.window
        # The pass lies at infinity, which is behind every surface that is not masked.
        self._cover(self._visibility, "<")

    def count(self, counts: moderngl.Texture) -> int:
        """How many silhouette pixels there are."""
        query = self._frame.gpu.ctx.query(samples=True)
        with query:
            self.fill(counts)
        return int(query.samples)

    def _cover(self, full_screen: moderngl.VertexArray, depth_func: str) -> None:
        ctx = self._frame.gpu.ctx
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.depth_func = depth_func
        full_screen.render(moderngl.TRIANGLES, vertices=3)
        ctx.enable_only(moderngl.NOTHING)
