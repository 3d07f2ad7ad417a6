"""The pieces that bound the shadow volumes of one light: near and far caps, and sides at silhouettes."""

from __future__ import annotations

import moderngl
import numpy as np

from renderers import shader
from renderers.frame import Frame
from renderers.volume_closure import Bodies
from renderers.volume_silhouettes import Pieces, VolumeForm, silhouette_pieces
from scenes.extrusion import end_plane
from scenes.frusta import Reach, reach
from scenes.scene import Array, Light

FILE = "shadow_volume.glsl"
GROUP = 64
BYTES_PER_PIECE = 16
EDGES_PER_FACE = 3
VERTICES_PER_PIECE = 6
LEAST_SIGN = {"general": -1, "crow": 0}
EACH_ITS_OWN = 2


class VolumePieces:
    """Buffers and programs that find the pieces and draw them, each fragment through `fragment`."""

    def __init__(self, frame: Frame, form: VolumeForm, fragment: shader.Source) -> None:
        self._frame, self.form = frame, form
        gpu, world = frame.gpu, frame.world
        ctx = gpu.ctx
        # Asked for here, since the world makes them when they are first asked for, and finding is timed.
        self._around = world.edges
        self._faces, self._edges = world.caster_count, len(self._around.topology.edges)
        one_per_edge = not (form.per_triangle or form.unit_weights)
        most_sides = self._edges if one_per_edge else EDGES_PER_FACE * self._faces
        self._signs = ctx.buffer(reserve=4 * max(self._faces, 1))
        self._caps = ctx.buffer(reserve=BYTES_PER_PIECE * max(self._faces, 1))
        self._sides = ctx.buffer(reserve=BYTES_PER_PIECE * max(most_sides, 1))
        self._cap_command = ctx.buffer(reserve=20)
        self._side_command = ctx.buffer(reserve=20)
        self._block = ctx.buffer(reserve=16 * 7)
        sides = "triangle_sides" if form.per_triangle else "edge_multiplicities"
        self._find_faces = shader.compute(gpu, shader.source(FILE, "face_signs"))
        self._find_sides = shader.compute(gpu, shader.source(FILE, sides))
        caps = "unit_cap_vertex" if form.unit_weights else "cap_vertex"
        self._draw_caps = ctx.vertex_array(shader.program(gpu, shader.source(FILE, caps), fragment), [])
        self._draw_sides = ctx.vertex_array(
            shader.program(gpu, shader.source(FILE, "side_vertex"), fragment), []
        )
        buffers = [self._signs, self._caps, self._sides]
        buffers += [self._cap_command, self._side_command, self._block]
        if form.variant == "mixed":
            self._bodies = Bodies.of(world.scene)
            self._bounded, self._least_of_faces = np.zeros(0, bool), np.zeros(0, np.int32)
            self._least_signs = ctx.buffer(reserve=4 * max(self._faces, 1))
            buffers.append(self._least_signs)
        self.memory_bytes = sum(buffer.size for buffer in buffers)
        self._buffers = buffers

    def release(self) -> None:
        """Give the GPU memory back."""
        self._frame.gpu.release(*self._buffers, self._draw_caps, self._draw_sides)

    def find(self) -> None:
        """Make the pieces for the frame's light."""
        least = self._least()
        self._write_block(self._frame.light)
        if self.form.on_cpu:
            self._find_on_cpu(least)
        else:
            self._find_on_gpu()

    def draw(self) -> None:
        """Draw the pieces in the state that is set."""
        self.draw_by(self._draw_caps, self._draw_sides)

    def draw_by(self, caps: moderngl.VertexArray | None, sides: moderngl.VertexArray) -> None:
        """Draw the pieces by these programs, six vertices for each side, and for each cap if any."""
        self._block.bind_to_uniform_block(2)
        vertices = self._frame.world.vertex_buffer
        if caps is not None and self.form.caps:
            _bind(vertices, self._caps)
            caps.render_indirect(self._cap_command, moderngl.TRIANGLES, count=1)
        _bind(vertices, self._sides)
        sides.render_indirect(self._side_command, moderngl.TRIANGLES, count=1)

    def count(self) -> tuple[int, int]:
        """How many caps (near and far as one) and sides `draw` draws."""
        caps, sides = (
            np.frombuffer(command.read(4), np.uint32)[0] // VERTICES_PER_PIECE
            for command in (self._cap_command, self._side_command)
        )
        return int(caps) if self.form.caps else 0, int(sides)

    def _find_on_gpu(self) -> None:
        world, ctx = self._frame.world, self._frame.gpu.ctx
        self._cap_command.write(_command(0))
        self._side_command.write(_command(0))
        _bind(world.vertex_buffer, world.index_buffer, self._signs, self._caps, self._cap_command)
        if self.form.variant == "mixed":
            self._least_signs.bind_to_storage_buffer(5)
        self._find_faces.run(group_x=-(-self._faces // GROUP))
        ctx.memory_barrier()
        if self.form.per_triangle:
            _bind(world.vertex_buffer, world.index_buffer, self._signs, self._sides, self._side_command)
            self._find_sides.run(group_x=-(-self._faces // GROUP))
        else:
            edges = self._around
            around = (edges.vertices, self._signs, edges.offsets, edges.half_edges)
            _bind(world.vertex_buffer, *around, self._sides, self._side_command)
            self._find_sides.run(group_x=-(-self._edges // GROUP))
        ctx.memory_barrier()

    def _find_on_cpu(self, least: int | Pieces) -> None:
        caps, sides = silhouette_pieces(self._frame.world, self._frame.light, self.form, least)
        for found, pieces, command in (
            (caps, self._caps, self._cap_command),
            (sides, self._sides, self._side_command),
        ):
            if len(found):
                pieces.write(found.tobytes())
            command.write(_command(len(found)))

    def _least(self) -> int | Pieces:
        """The least sign that counts, for all faces or for each; what differs by face is on the GPU, too."""
        if self.form.variant != "mixed":
            return LEAST_SIGN[self.form.variant]
        world = self._frame.world
        bounded = self._bodies.bounded(self._frame.light)
        if not np.array_equal(bounded, self._bounded):
            self._bounded = bounded
            self._least_of_faces = self._bodies.of_faces(bounded.astype(np.int32) - 1)[world.clusters.order]
            self._least_signs.write(self._least_of_faces.tobytes())
        return self._least_of_faces

    def _write_block(self, light: Light) -> None:
        within = reach(light, self._frame.world.origin)
        rows = np.zeros((6, 4), "f4")
        rows[0] = self._end(light, within)
        rows[1 : 1 + len(within.planes)] = within.planes
        least = LEAST_SIGN.get(self.form.variant, EACH_ITS_OWN)
        sizes = np.array([self._faces, self._edges, least, self.form.unit_weights], np.int32)
        self._block.write(rows.tobytes() + sizes.tobytes())
        self._block.bind_to_uniform_block(2)

    def _end(self, light: Light, within: Reach) -> Array:
        """(4,) plane on which volumes end; (0, 0, 0, length) without one, length 0 for infinity."""
        world = self._frame.world
        bounds, clusters = world.scene.bounds - world.origin, world.clusters
        if self.form.extrusion == "finite":
            size = float(np.linalg.norm(bounds[1] - bounds[0]))
            return np.array([0, 0, 0, light.range_m if np.isfinite(light.range_m) else size])
        kept = within.touches(clusters.low, clusters.high)
        low, high = clusters.low[kept], clusters.high[kept]
        end = None
        if self.form.extrusion == "receivers":
            end = end_plane(light, within.centre, bounds, low, high)
        return np.zeros(4) if end is None else np.array([*end.normal, end.distance])


def _bind(*buffers: moderngl.Buffer) -> None:
    for binding, buffer in enumerate(buffers):
        buffer.bind_to_storage_buffer(binding)


def _command(pieces: int) -> bytes:
    return np.array([VERTICES_PER_PIECE * pieces, 1, 0, 0, 0], np.uint32).tobytes()
