"""Draws only those triangles of volumes, in only those tiles of the screen, that can count somewhere."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np
from OpenGL import GL

from renderers import shader
from renderers.frame import Frame, Window
from renderers.volume_pass import VolumePass
from renderers.volume_pieces import FILE as VOLUME_FILE
from renderers.volume_pieces import VolumePieces
from renderers.volume_silhouettes import VolumeForm

FILE = "volume_tiles.glsl"
COMMAND_BYTES = 20
BYTES_PER_TRIANGLE = 8
"""Least that the lists take."""
# Whole triangles, and those that are cut up.
LISTS = 2
# Room in the tiles' lists for each triangle; where it is not enough, all are drawn whole.
CUTS = 4


class TiledPieces(VolumePieces):
    """Pieces sorted into tiles of `side` pixels before they are drawn against `depth`.

    That is the depth to count against, 0 where nothing counts. The device does all the sorting, and nothing
    is read back.
    """

    def __init__(
        self, frame: Frame, form: VolumeForm, fragment: shader.Source, depth: moderngl.Texture, side: int
    ) -> None:
        super().__init__(frame, form, fragment)
        gpu, ctx = frame.gpu, frame.gpu.ctx
        self._depth, self._tile_side = depth, side
        self._columns, self._rows = -(-frame.width // side), -(-frame.height // side)
        self._tiles = self._columns * self._rows
        triangles = (self._caps.size + self._sides.size) // 16 * 2
        most = gpu.device.limits.max_buffer_bytes // 4
        self._most_triangles, self._room = triangles, min(CUTS * triangles, most - LISTS * triangles)
        self._tile_depths = ctx.buffer(reserve=4 * self._tiles)
        self._entries = ctx.buffer(reserve=4 * (LISTS * triangles + self._room))
        self._commands = ctx.buffer(reserve=COMMAND_BYTES * (LISTS + self._tiles))
        self._groups = ctx.buffer(reserve=12)
        self._find_depths, self._plan, self._sort, self._place = (
            shader.compute(gpu, shader.source(FILE, section))
            for section in ("tile_depths", "plan", "sort", "place")
        )
        self._triangles = ctx.vertex_array(
            shader.program(gpu, shader.source(FILE, "triangle_vertex"), fragment), []
        )
        self._lists = [self._tile_depths, self._entries, self._commands, self._groups]
        self.memory_bytes += sum(one.size for one in self._lists)

    def release(self) -> None:
        """Give the GPU memory back."""
        super().release()
        self._frame.gpu.release(*self._lists, self._triangles)

    def cull(self) -> None:
        """Sort the pieces for the depths as they are now."""
        frame = self._frame
        grid = (self._columns, self._rows, self._tile_side, self._most_triangles)
        for stage in (self._find_depths, self._sort):
            stage["grid"].value = grid
            stage["viewport"].value = (frame.width, frame.height)
        self._place["grid"].value = grid
        self._place["room"].value = self._room
        self._commands.write(np.tile(np.array([0, 1, 0, 0, 0], np.uint32), LISTS + self._tiles).tobytes())
        self._depth.use(2)
        self._block.bind_to_uniform_block(2)
        lists = (self._entries, self._commands, self._cap_command, self._side_command)
        buffers = (frame.world.vertex_buffer, self._caps, self._sides, self._tile_depths, *lists)
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        self._find_depths.run(self._columns, self._rows)
        self._sort_after(self._plan, placing=False)
        self._sort_after(self._place, placing=True)

    def draw(self) -> None:
        """Draw what `cull` has left, in the state that is set."""
        self._block.bind_to_uniform_block(2)
        buffers = (self._frame.world.vertex_buffer, self._caps, self._sides, self._entries)
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        self._triangles.render_indirect(self._commands, moderngl.TRIANGLES, count=1)
        for tile, scissor in self._scissors():
            GL.glScissor(*scissor)
            self._triangles.render_indirect(self._commands, moderngl.TRIANGLES, count=1, first=LISTS + tile)
        GL.glScissor(*self._frame.window)

    def triangles(self) -> int:
        """How many triangles `draw` draws, in all tiles."""
        commands = np.frombuffer(self._commands.read(), np.uint32).reshape(-1, 5)
        return int(commands[0, 0] + commands[LISTS:, 0].sum()) // 3

    def _sort_after(self, sizing: moderngl.ComputeShader, *, placing: bool) -> None:
        """Sort in as many groups as `sizing` finds necessary."""
        ctx = self._frame.gpu.ctx
        self._groups.bind_to_storage_buffer(3)
        ctx.memory_barrier()
        sizing.run()
        ctx.memory_barrier()
        self._tile_depths.bind_to_storage_buffer(3)
        self._sort["placing"].value = placing
        self._sort.run_indirect(self._groups)
        ctx.memory_barrier()

    def _scissors(self) -> Iterator[tuple[int, Window]]:
        """The tiles that meet the frame's window, and what they share with it."""
        x, y, width, height = self._frame.window
        side = self._tile_side
        for row in range(y // side, -(-(y + height) // side)):
            low, high = max(y, side * row), min(y + height, side * (row + 1))
            for column in range(x // side, -(-(x + width) // side)):
                left, right = max(x, side * column), min(x + width, side * (column + 1))
                yield row * self._columns + column, (left, low, right - left, high - low)


class TiledVolumePass(VolumePass):
    """Counts against `depth` in tiles of `side` pixels."""

    def __init__(
        self, frame: Frame, depth: moderngl.Texture, side: int, form: VolumeForm | None = None
    ) -> None:
        self._side = side
        super().__init__(frame, depth, form)

    def cull(self) -> None:
        """Find out what can count, for the depths as they are now; `draw` leaves the rest out."""
        self._tiled.cull()

    def triangles(self) -> int:
        """How many triangles are drawn, those cut up once in each tile."""
        return self._tiled.triangles()

    def _make_pieces(self, form: VolumeForm) -> TiledPieces:
        fragment = shader.source(VOLUME_FILE, self.fragment)
        self._tiled = TiledPieces(self._frame, form, fragment, self._depth, self._side)
        return self._tiled
