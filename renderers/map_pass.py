"""Draws what a light sees into a depth map, one face or six beside each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

import moderngl
import numpy as np

from renderers import shader
from renderers.context import DEPTH_CLAMP, Released
from renderers.map_back_faces import mirrors, outward_corners
from renderers.run_drawer import RunDrawer
from renderers.world import World
from scenes.clusters import Runs, without
from scenes.convex import clip_planes
from scenes.frusta import Reach, boxes_inside
from scenes.map_frusta import MapFit
from scenes.scene import Array

BYTES_PER_TEXEL = 4
COLUMNS = 3


def atlas_shape(faces: int) -> tuple[int, int]:
    """Columns and rows of the atlas that holds `faces` faces."""
    return (1, 1) if faces == 1 else (COLUMNS, -(-faces // COLUMNS))


class MapPass:
    """A depth map of one or six faces and the pass that fills it.

    Args:
        world: What casts.
        side: Texels along a face.
        faces: 1 or 6.
        offset: Slope factor and units of the polygon offset.
        back_faces: Whether to draw only what is turned away from the light; all casters must be closed.
        linear: Whether to store depth linear in the distance along a face's axis, for perspective faces.
    """

    def __init__(
        self,
        world: World,
        side: int,
        faces: int,
        offset: tuple[float, float],
        *,
        back_faces: bool = False,
        linear: bool = False,
    ) -> None:
        self.world, self.side, self.offset, self._back_faces = world, side, offset, back_faces
        gpu = world.gpu
        self.columns, self.rows = atlas_shape(faces)
        self.texture = gpu.depth_texture(self.columns * side, self.rows * side)
        self.memory_bytes = self.columns * self.rows * side * side * BYTES_PER_TEXEL
        self._target = gpu.ctx.framebuffer(depth_attachment=self.texture)
        self._program = shader.program(
            gpu,
            shader.source("map_pass.glsl", "caster_vertex"),
            shader.source("map_pass.glsl", "linear" if linear else "nothing"),
        )
        if linear:
            # What a fragment writes itself, polygon offset leaves alone.
            self._program["offset"] = offset
        self._matrix = cast(moderngl.Uniform, self._program["map_from_scene"])
        indices = gpu.ctx.buffer(outward_corners(world).tobytes() or bytes(16)) if back_faces else None
        vertices = world.vertex_array(self._program, indices)
        self._casters = RunDrawer(gpu, vertices, len(world.clusters.low))
        self._owned: list[Released] = [self._target, self.texture, self._casters]
        if indices is not None:
            self._owned.append(indices)

    def release(self) -> None:
        """Give the GPU memory back."""
        self.world.gpu.release(*self._owned)

    def draw(self, fit: MapFit, within: Reach) -> None:
        """Fill the map with the casters that `within` may hold, as `fit` sees them."""
        ctx = self.world.gpu.ctx
        self._target.use()
        self._target.scissor = (0, 0, *self._target.size)
        self._target.viewport = self._target.scissor
        self._target.clear(depth=0.0)
        ctx.enable_only(moderngl.DEPTH_TEST | (moderngl.CULL_FACE if self._back_faces else 0))
        ctx.enable_direct(DEPTH_CLAMP)
        ctx.depth_func = ">"
        slope, units = self.offset
        # Away from the light, which in reversed depth is down.
        ctx.polygon_offset = (-slope, -units)
        for index, runs in self._runs(fit, within):
            self._draw_face(fit.faces[index], index, runs)
        ctx.polygon_offset = (0.0, 0.0)
        ctx.disable_direct(DEPTH_CLAMP)
        ctx.enable_only(moderngl.NOTHING)

    def atlas_from_clip(self, index: int) -> Array:
        """(4, 4) float64: from a face's clip space to homogeneous atlas coordinates and depth in [0, 1]."""
        cell = np.array([index % self.columns, index // self.columns])
        shape = np.array([self.columns, self.rows])
        matrix = np.eye(4)
        matrix[[0, 1], [0, 1]] = 0.5 / shape
        matrix[:2, 3] = (cell + 0.5) / shape
        return matrix

    def block(self, fit: MapFit, normal_texels: float, taps: int = 1) -> bytes:
        """The uniform block of `map_receiver.glsl`."""
        matrices = np.zeros((6, 4, 4), "f4")
        for index, face in enumerate(fit.faces):
            matrices[index] = (self.atlas_from_clip(index) @ face).T
        texels = np.array([self.columns, self.rows], float) * self.side
        return matrices.tobytes() + np.array([*(1 / texels), normal_texels, taps], "f4").tobytes()

    def triangles(self, fit: MapFit, within: Reach) -> int:
        """Triangles drawn into the faces of `fit`."""
        return sum(int(runs[:, 1].sum()) for _, runs in self._runs(fit, within))

    def texels(self, fit: MapFit, within: Reach) -> int:
        """Texels written, overdraw included."""
        query = self.world.gpu.ctx.query(samples=True)
        with query:
            self.draw(fit, within)
        return int(query.samples)

    def _runs(self, fit: MapFit, within: Reach) -> Iterator[tuple[int, Runs]]:
        """Each face that shows anything, with the casters that it may show."""
        world, clusters = self.world, self.world.clusters
        kept = within.touches(clusters.low, clusters.high)
        edge_on = np.zeros(0, np.int64)
        if within.has_place:
            edge_on = clusters.edge_on(world.positions, world.triangles, within.centre)
        for index, face in enumerate(fit.faces):
            if face.any():
                seen = kept & boxes_inside(clip_planes(face), clusters.low, clusters.high)
                yield index, without(clusters.runs(seen), edge_on)

    def _draw_face(self, face: Array, index: int, runs: Runs) -> None:
        if not len(runs):
            return
        x, y = index % self.columns * self.side, index // self.columns * self.side
        self._target.viewport = self._target.scissor = (x, y, self.side, self.side)
        self._matrix.write(face.T.astype("f4").tobytes())
        if self._back_faces:
            self.world.gpu.ctx.cull_face = "back" if mirrors(face) else "front"
        self._casters.draw(runs)
