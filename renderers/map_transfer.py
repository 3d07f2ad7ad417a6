"""A map that is drawn in one place and copied to another, as in 2005."""

from __future__ import annotations

from OpenGL import GL

from renderers.clock import StageClock
from renderers.frame import Frame
from renderers.map_pass import MapPass

FREE_UNIT = 2


class CopiedMap:
    """A second texture that a map is copied to, as was usual before a depth buffer could be a texture."""

    def __init__(self, frame: Frame, drawn: MapPass) -> None:
        self._gpu, self._drawn = frame.gpu, drawn
        self.texture = self._gpu.depth_texture(*drawn.texture.size)
        self.memory_bytes = drawn.memory_bytes

    def release(self) -> None:
        """Give the GPU memory back."""
        self._gpu.release(self.texture)

    def copy(self, clock: StageClock) -> None:
        """Copy what was just drawn, whose target is still in use."""
        width, height = self.texture.size
        with clock.stage("transfer"):
            self.texture.use(FREE_UNIT)
            GL.glCopyTexSubImage2D(GL.GL_TEXTURE_2D, 0, 0, 0, 0, 0, width, height)
