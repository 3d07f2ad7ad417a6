"""A scene on the GPU: vertices and faces, built once for all techniques, lights and views; edges if asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import moderngl
import numpy as np
import numpy.typing as npt
from OpenGL import GL

from renderers.context import Gpu
from renderers.edges import Edges, gpu_buffer
from scenes.clusters import Clusters
from scenes.corner_blocks import corner_blocks, face_crosses, lengths
from scenes.scene import EXPANDED_AT_ONCE, Array, Mesh, Positions, Scene, Triangles
from scenes.surface_probes import SurfaceProbes
from scenes.topology import Topology, weld


@dataclass(frozen=True)
class World:
    """Geometry of one scene on one device, in scene space: world space minus `origin`.

    Casting faces come first, in clusters of neighbours, so that what casts is a prefix of the index buffer
    and what casts within a light's reach is a few runs of it. Each face keeps its stored corner order.

    Attributes:
        origin: (3,) float64 world position of scene space's zero: the middle of the scene, so that float32
            holds scenes far from the world's zero.
        positions: (v, 3) float32 welded vertices, scene space, metres.
        triangles: (t, 3) int32, casting faces first.
        caster_count: How many faces cast.
        clusters: The casting faces.
        surfaces: All faces.
        probes: Places on all faces that stand for them.
    """

    gpu: Gpu
    scene: Scene
    origin: Array
    positions: Positions
    triangles: Triangles
    caster_count: int
    clusters: Clusters
    surfaces: Clusters
    probes: SurfaceProbes
    vertex_buffer: moderngl.Buffer
    index_buffer: moderngl.Buffer
    face_buffer: moderngl.Buffer
    face_texture: int

    @classmethod
    def of(cls, gpu: Gpu, scene: Scene) -> World:
        """`scene` on `gpu`."""
        origin = scene.bounds.mean(axis=0)
        meshes = sorted(scene.meshes, key=lambda mesh: not mesh.casts)
        counts = [mesh.triangle_count for mesh in meshes]
        caster_count = sum(mesh.triangle_count for mesh in meshes if mesh.casts)
        positions, triangles = _placed(meshes, origin)
        clusters = Clusters.of(positions, triangles[:caster_count])
        surfaces = clusters.followed_by(Clusters.of(positions, triangles[caster_count:]))
        triangles = np.take(triangles, surfaces.order, axis=0)
        colors = np.repeat(_packed_colors(meshes), counts)[surfaces.order]
        # Faces are gone through before vertices are welded: neighbours still lie side by side in memory.
        face_buffer = gpu_buffer(gpu, _face_table(positions, triangles, colors))
        probes = SurfaceProbes.of(positions, triangles, surfaces)
        positions, index = weld(positions)
        triangles = np.take(index.astype(np.int32), triangles)
        return cls(
            gpu=gpu,
            scene=scene,
            origin=origin,
            positions=positions,
            triangles=triangles,
            caster_count=caster_count,
            clusters=clusters,
            surfaces=surfaces,
            probes=probes,
            vertex_buffer=gpu_buffer(gpu, positions),
            index_buffer=gpu_buffer(gpu, triangles),
            face_buffer=face_buffer,
            face_texture=gpu.buffer_texture(face_buffer),
        )

    @cached_property
    def edges(self) -> Edges:
        """Edges of the casting faces, made when first asked for: only while a pass is prepared.

        On 7.7 million triangles they take longer than the rest of the world, and maps need none.
        """
        return Edges.of(self.gpu, self.triangles[: self.caster_count])

    @property
    def topology(self) -> Topology:
        """Edges of the casting faces, on the CPU."""
        return self.edges.topology

    def vertex_array(
        self, program: moderngl.Program, indices: moderngl.Buffer | None = None
    ) -> moderngl.VertexArray:
        """All faces as indexed triangles, or others, for a program with one attribute, `position`."""
        layout = [(self.vertex_buffer, "3f", "position")]
        index_buffer = self.index_buffer if indices is None else indices
        return self.gpu.ctx.vertex_array(program, layout, index_buffer=index_buffer)

    def bind_faces(self, unit: int) -> None:
        """Make the face table a buffer texture on texture unit `unit`.

        On llvmpipe a buffer texture is fetched in half the time of a storage buffer.
        """
        GL.glActiveTexture(GL.GL_TEXTURE0 + unit)
        GL.glBindTexture(GL.GL_TEXTURE_BUFFER, self.face_texture)

    def release(self) -> None:
        """Give the GPU memory back."""
        GL.glDeleteTextures([self.face_texture])
        self.gpu.release(self.vertex_buffer, self.index_buffer, self.face_buffer)
        if "edges" in vars(self):
            self.edges.release()


def encode_octahedral(normals: Array) -> npt.NDArray[np.uint32]:
    """(n,) uint32: unit normals (3, n) as two 16-bit snorms, x in the low half.

    Cigolle et al. 2014, "A survey of efficient representations for independent unit vectors", section 3.
    """
    flat = normals / (np.abs(normals[0]) + np.abs(normals[1]) + np.abs(normals[2]))
    folded = (1 - np.abs(flat[1::-1])) * np.where(flat[:2] >= 0, 1.0, -1.0)
    square = np.where(flat[2] >= 0, flat[:2], folded)
    # A negative number becomes its two's complement only by way of a signed one.
    halves = np.round(square * 32767).astype(np.int32).astype(np.uint32) & np.uint32(0xFFFF)
    packed: npt.NDArray[np.uint32] = halves[0] | halves[1] << np.uint32(16)
    return packed


def _placed(meshes: Sequence[Mesh], origin: Array) -> tuple[Positions, Triangles]:
    """All vertices (v, 3) float32, scene space, and triangles (t, 3) of the placed `meshes`, in order."""
    positions = np.zeros((sum(len(mesh.positions) * len(mesh.placements) for mesh in meshes), 3), np.float32)
    triangles = np.zeros((sum(mesh.triangle_count for mesh in meshes), 3), np.int32)
    vertex = face = 0
    for mesh in meshes:
        step = max(EXPANDED_AT_ONCE // max(len(mesh.positions), 1), 1)
        for first in range(0, len(mesh.placements), step):
            some = replace(mesh, placements=mesh.placements[first : first + step])
            bases = vertex + np.arange(len(some.placements), dtype=np.int32) * len(mesh.positions)
            placed = (some.world_positions() - origin).reshape(-1, 3)
            indices = (mesh.triangles + bases[:, None, None]).reshape(-1, 3)
            positions[vertex : vertex + len(placed)] = placed
            triangles[face : face + len(indices)] = indices
            vertex, face = vertex + len(placed), face + len(indices)
    return positions, triangles


def _packed_colors(meshes: Sequence[Mesh]) -> npt.NDArray[np.uint32]:
    """(m,) uint32: the meshes' colors, eight bits for each channel."""
    colors = np.array([mesh.base_color for mesh in meshes]).reshape(-1, 3)
    channels = np.round(np.clip(colors, 0, 1) * 255).astype(np.uint32)
    packed: npt.NDArray[np.uint32] = channels @ np.array([1, 1 << 8, 1 << 16], np.uint32)
    return packed | np.uint32(255 << 24)


def _face_table(
    positions: Positions, triangles: Triangles, colors: npt.NDArray[np.uint32]
) -> npt.NDArray[np.uint32]:
    """(t, 2) uint32: normal and color of each face."""
    table = np.stack([np.zeros_like(colors), colors], axis=1)
    for part, corners in corner_blocks(positions, triangles):
        normals = face_crosses(corners)
        sizes = lengths(normals)
        # A face without area is never rasterised; any unit vector will do.
        normals[:, sizes == 0] = [[0.0], [1.0], [0.0]]
        table[part, 0] = encode_octahedral(normals / np.where(sizes > 0, sizes, 1))
    return table
