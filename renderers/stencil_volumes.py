"""Counts volumes in an 8-bit stencil buffer, as was done before float targets could be blended.

A stencil counter adds and subtracts ones. Every piece therefore has weight 1 and winds outwards: that is
Crow's variant, whose near caps all wind outwards already in their stored corner order.
"""

from __future__ import annotations

import moderngl
import numpy as np
from OpenGL import GL

from renderers import shader
from renderers.frame import Frame
from renderers.volume_pass import BEHIND, IN_FRONT, VolumePass
from renderers.volume_silhouettes import VolumeForm

FILE = "stencil_volumes.glsl"
NO_LAYERS = np.zeros(1, np.int32)
ALL_BITS = 0xFF
BYTES_PER_PIXEL = 8


class StencilVolumePass(VolumePass):
    """The same count modulo 256, or up to 255.

    Args:
        frame: The frame whose depth is counted against.
        form: How volumes are put together; its pieces must have unit weights.
        one_sided: Front and back faces in two passes that stop at 0 and 255 (Heidmann 1991), instead of one
            pass that wraps (EXT_stencil_two_side).
    """

    fragment = "stencil_fragment"

    def __init__(self, frame: Frame, form: VolumeForm, *, one_sided: bool) -> None:
        super().__init__(frame, form=form)
        ctx = frame.gpu.ctx
        self._one_sided = one_sided
        self._stencil = _depth_stencil_texture(frame)
        self._stencil_target = ctx.framebuffer(depth_attachment=self._stencil)
        GL.glNamedFramebufferTexture(
            self._stencil_target.glo, GL.GL_DEPTH_STENCIL_ATTACHMENT, self._stencil.glo, 0
        )
        self._copy_depth = shader.full_screen(frame.gpu, shader.source(FILE, "copy_depth"))
        self._copy_count = shader.full_screen(frame.gpu, shader.source(FILE, "copy_count"))
        self.memory_bytes += BYTES_PER_PIXEL * frame.width * frame.height

    def release(self) -> None:
        """Give the GPU memory back."""
        super().release()
        owned = (self._stencil_target, self._stencil, self._copy_depth, self._copy_count)
        self._frame.gpu.release(*owned)

    def draw(self, depth_func: str = BEHIND) -> None:
        """Count the volumes that `depth_func` keeps, and copy the count to `counts`."""
        ctx, target = self._frame.gpu.ctx, self._stencil_target
        target.depth_mask = True
        target.use()
        target.scissor = self._frame.window
        self._run(self._copy_depth, self._depth, moderngl.DEPTH_TEST)
        GL.glDepthMask(GL.GL_FALSE)
        GL.glClearBufferiv(GL.GL_STENCIL, 0, NO_LAYERS)
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.depth_func = depth_func
        GL.glEnable(GL.GL_STENCIL_TEST)
        GL.glStencilFunc(GL.GL_ALWAYS, 0, ALL_BITS)
        entering, leaving = GL.GL_FRONT, GL.GL_BACK
        more, less = (entering, leaving) if depth_func == IN_FRONT else (leaving, entering)
        if self._one_sided:
            self._draw_one_side(more, GL.GL_INCR)
            self._draw_one_side(less, GL.GL_DECR)
        else:
            GL.glStencilOpSeparate(more, GL.GL_KEEP, GL.GL_KEEP, GL.GL_INCR_WRAP)
            GL.glStencilOpSeparate(less, GL.GL_KEEP, GL.GL_KEEP, GL.GL_DECR_WRAP)
            self._pieces.draw()
        GL.glStencilOp(GL.GL_KEEP, GL.GL_KEEP, GL.GL_KEEP)
        GL.glDisable(GL.GL_STENCIL_TEST)
        self.target.use()
        self.target.scissor = self._frame.window
        self._run(self._copy_count, self._stencil, moderngl.NOTHING)

    def fragments(self, depth_func: str) -> int:
        """Fragments that pass `depth_func`; those of the two copies, one for each pixel, are none of them."""
        _, _, width, height = self._frame.window
        return super().fragments(depth_func) - 2 * width * height

    def _draw_one_side(self, side: int, operation: int) -> None:
        GL.glEnable(GL.GL_CULL_FACE)
        GL.glCullFace(GL.GL_FRONT if side == GL.GL_BACK else GL.GL_BACK)
        GL.glStencilOp(GL.GL_KEEP, GL.GL_KEEP, operation)
        self._pieces.draw()
        GL.glCullFace(GL.GL_BACK)
        GL.glDisable(GL.GL_CULL_FACE)

    def _run(self, full_screen: moderngl.VertexArray, texture: moderngl.Texture, tests: int) -> None:
        ctx = self._frame.gpu.ctx
        ctx.enable_only(tests)
        ctx.depth_func = "1"
        texture.use(2)
        full_screen.render(moderngl.TRIANGLES, vertices=3)
        ctx.enable_only(moderngl.NOTHING)


def _depth_stencil_texture(frame: Frame) -> moderngl.Texture:
    """Depth as precise as the frame's with 8 bits of stencil, which shaders read."""
    texture = frame.gpu.depth_texture(frame.width, frame.height)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    GL.glTextureStorage2D(texture.glo, 1, GL.GL_DEPTH32F_STENCIL8, frame.width, frame.height)
    GL.glTextureParameteri(texture.glo, GL.GL_DEPTH_STENCIL_TEXTURE_MODE, GL.GL_STENCIL_INDEX)
    return texture
