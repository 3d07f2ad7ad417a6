"""Counts, for every pixel, the triangles between its surface and the light.

Back-end: additive blending of signed weights into a 32-bit float target against the scene's depth, exact up
to 2^24 overlapping volumes, where an 8-bit stencil counter is wrong from 256 on.
"""

from __future__ import annotations

import moderngl

from renderers import shader
from renderers.frame import Frame
from renderers.volume_pieces import FILE, VolumePieces
from renderers.volume_silhouettes import VolumeForm

BEHIND = "<="
"""Reversed depth: keeps what lies on or behind the visible surface, for z-fail."""
IN_FRONT = ">"
"""Keeps what lies in front of it, for z-pass."""


class VolumePass:
    """Buffers, programs and target that make and draw the volumes of one light in one frame.

    Counts against `depth`, a reversed depth texture of the frame's size; against the frame's own where None.
    """

    fragment = "count_fragment"

    def __init__(
        self, frame: Frame, depth: moderngl.Texture | None = None, form: VolumeForm | None = None
    ) -> None:
        self._frame = frame
        self._depth = depth or frame.depth
        ctx = frame.gpu.ctx
        self.counts = ctx.texture((frame.width, frame.height), 1, dtype="f4")
        self.counts.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.target = ctx.framebuffer([self.counts], self._depth)
        self.target.depth_mask = False
        self._pieces = self._make_pieces(form or VolumeForm())
        self.memory_bytes = self._pieces.memory_bytes + 4 * frame.width * frame.height

    def release(self) -> None:
        """Give the GPU memory back."""
        self._pieces.release()
        self._frame.gpu.release(self.target, self.counts)

    def find_silhouettes(self) -> None:
        """Make the pieces of the volumes' boundary for the frame's light: caps, and sides at silhouettes."""
        self._pieces.find()

    def _make_pieces(self, form: VolumeForm) -> VolumePieces:
        return VolumePieces(self._frame, form, shader.source(FILE, self.fragment))

    def draw(self, depth_func: str = BEHIND) -> None:
        """Add up the volumes that `depth_func` keeps.

        `IN_FRONT` subtracts them, which gives the same count where no volume holds the near rectangle.
        """
        ctx = self._frame.gpu.ctx
        self.target.use()
        self.target.scissor = self._frame.window
        self.target.clear()
        ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        ctx.depth_func = depth_func
        ctx.blend_func = (moderngl.ONE, moderngl.ONE)
        add = moderngl.FUNC_REVERSE_SUBTRACT if depth_func == IN_FRONT else moderngl.FUNC_ADD
        ctx.blend_equation = add, add
        self._pieces.draw()
        ctx.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
        ctx.enable_only(moderngl.NOTHING)

    def draw_by(self, caps: moderngl.VertexArray | None, sides: moderngl.VertexArray) -> None:
        """Draw all pieces by other programs in the state that is set; see `VolumePieces.draw_by`."""
        self._pieces.draw_by(caps, sides)

    def pieces(self) -> tuple[int, int]:
        """How many caps (near and far as one) and sides the last call of `find_silhouettes` made."""
        return self._pieces.count()

    def fragments(self, depth_func: str) -> int:
        """Fragments that pass `depth_func`; "1" for all that are rasterised."""
        query = self._frame.gpu.ctx.query(samples=True)
        with query:
            self.draw(depth_func)
        return int(query.samples)
