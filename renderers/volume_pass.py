"""Counts, for every pixel, the triangles between its surface and the light.

Back-end: additive blending of signed weights into a 32-bit float target against the scene's depth, exact up
to 2^24 overlapping volumes, where an 8-bit stencil counter is wrong from 256 on.
"""

from __future__ import annotations

import moderngl
import numpy as np

from renderers import shader
from renderers.frame import Frame
from scenes.extrusion import end_plane
from scenes.frusta import reach
from scenes.scene import Light

FILE = "shadow_volume.glsl"
GROUP = 64
BYTES_PER_PIECE = 16


class VolumePass:
    """Buffers, programs and target that make and draw the volumes of one light in one frame."""

    def __init__(self, frame: Frame) -> None:
        self._frame = frame
        gpu, world = frame.gpu, frame.world
        ctx = gpu.ctx
        self._faces, self._edges = world.caster_count, len(world.topology.edges)
        self.counts = ctx.texture((frame.width, frame.height), 1, dtype="f4")
        self.counts.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.target = ctx.framebuffer([self.counts], frame.depth)
        self.target.depth_mask = False
        self._signs = ctx.buffer(reserve=4 * max(self._faces, 1))
        self._caps = ctx.buffer(reserve=BYTES_PER_PIECE * max(self._faces, 1))
        self._sides = ctx.buffer(reserve=BYTES_PER_PIECE * max(self._edges, 1))
        self._cap_command = ctx.buffer(reserve=20)
        self._side_command = ctx.buffer(reserve=20)
        self._block = ctx.buffer(reserve=16 * 7)
        self._find_faces = shader.compute(gpu, shader.source(FILE, "face_signs"))
        self._find_edges = shader.compute(gpu, shader.source(FILE, "edge_multiplicities"))
        count = shader.source(FILE, "count_fragment")
        self._draw_caps = ctx.vertex_array(shader.program(gpu, shader.source(FILE, "cap_vertex"), count), [])
        self._draw_sides = ctx.vertex_array(
            shader.program(gpu, shader.source(FILE, "side_vertex"), count), []
        )
        owned = (self._signs, self._caps, self._sides, self._cap_command, self._side_command, self._block)
        self.memory_bytes = sum(buffer.size for buffer in owned) + 4 * frame.width * frame.height
        self._owned = (*owned, self.target, self.counts, self._draw_caps, self._draw_sides)

    def release(self) -> None:
        """Give the GPU memory back."""
        self._frame.gpu.release(*self._owned)

    def find_silhouettes(self) -> None:
        """Make the pieces of the volumes' boundary for the frame's light: caps, and sides at silhouettes."""
        frame, world = self._frame, self._frame.world
        self._write_block(frame.light)
        empty_command = np.array([0, 1, 0, 0, 0], np.uint32).tobytes()
        self._cap_command.write(empty_command)
        self._side_command.write(empty_command)
        self._bind(world.vertex_buffer, world.index_buffer, self._signs, self._caps, self._cap_command)
        self._find_faces.run(group_x=-(-self._faces // GROUP))
        frame.gpu.ctx.memory_barrier()
        self._bind(
            world.vertex_buffer,
            world.edge_buffer,
            self._signs,
            world.offset_buffer,
            world.half_edge_buffer,
            self._sides,
            self._side_command,
        )
        self._find_edges.run(group_x=-(-self._edges // GROUP))
        frame.gpu.ctx.memory_barrier()

    def draw(self, depth_func: str = "<=") -> None:
        """Add up the volumes; reversed depth, so `<=` keeps what lies on or behind the visible surface."""
        ctx = self._frame.gpu.ctx
        self.target.use()
        self.target.scissor = self._frame.window
        self.target.clear()
        ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        ctx.depth_func = depth_func
        ctx.blend_func = (moderngl.ONE, moderngl.ONE)
        self._block.bind_to_uniform_block(2)
        self._bind(self._frame.world.vertex_buffer, self._caps)
        self._draw_caps.render_indirect(self._cap_command, moderngl.TRIANGLES, count=1)
        self._bind(self._frame.world.vertex_buffer, self._sides)
        self._draw_sides.render_indirect(self._side_command, moderngl.TRIANGLES, count=1)
        ctx.enable_only(moderngl.NOTHING)

    def pieces(self) -> tuple[int, int]:
        """How many caps (near and far as one) and sides the last call of `find_silhouettes` made."""
        caps, sides = (
            np.frombuffer(command.read(4), np.uint32)[0] // 6
            for command in (self._cap_command, self._side_command)
        )
        return int(caps), int(sides)

    def fragments(self, depth_func: str) -> int:
        """Fragments that pass `depth_func`; "1" for all that are rasterised."""
        query = self._frame.gpu.ctx.query(samples=True)
        with query:
            self.draw(depth_func)
        return int(query.samples)

    def _bind(self, *buffers: moderngl.Buffer) -> None:
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)

    def _write_block(self, light: Light) -> None:
        world = self._frame.world
        within = reach(light, world.origin)
        clusters = world.clusters
        kept = within.touches(clusters.low, clusters.high)
        end = end_plane(
            light, within.centre, world.scene.bounds - world.origin, clusters.low[kept], clusters.high[kept]
        )
        rows = np.zeros((6, 4), "f4")
        if end is not None:
            rows[0] = [*end.normal, end.distance]
        rows[1 : 1 + len(within.planes)] = within.planes
        sizes = np.array([self._faces, self._edges, 0, 0], np.int32)
        self._block.write(rows.tobytes() + sizes.tobytes())
        self._block.bind_to_uniform_block(2)
