"""A scene on the GPU: vertices, faces and edges, built once for all techniques, lights and views."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt
from OpenGL import GL

from renderers.context import Gpu
from scenes.clusters import Clusters
from scenes.scene import Array, Positions, Scene, Triangles
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
        topology: Edges of the casting faces.
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
    topology: Topology
    probes: SurfaceProbes
    vertex_buffer: moderngl.Buffer
    index_buffer: moderngl.Buffer
    face_buffer: moderngl.Buffer
    face_texture: int
    edge_buffer: moderngl.Buffer
    offset_buffer: moderngl.Buffer
    half_edge_buffer: moderngl.Buffer

    @classmethod
    def of(cls, gpu: Gpu, scene: Scene) -> World:
        """`scene` on `gpu`."""
        origin = scene.bounds.mean(axis=0)
        positions, triangles, casts, colors = _gather(scene, origin)
        positions, welded = weld(positions)
        triangles = welded.astype(np.int32)[triangles]
        casters = triangles[casts]
        clusters = Clusters.of(positions, casters)
        surfaces = clusters.followed_by(Clusters.of(positions, triangles[~casts]))
        order = np.concatenate([np.flatnonzero(casts), np.flatnonzero(~casts)])[surfaces.order]
        triangles = triangles[order]
        casters = triangles[: len(casters)]
        topology = Topology.of(casters)
        half_edges = topology.faces * 2 + (topology.orientations > 0)
        face_buffer = _buffer(gpu, _face_table(positions, triangles, colors[order]))
        return cls(
            gpu=gpu,
            scene=scene,
            origin=origin,
            positions=positions,
            triangles=triangles,
            caster_count=len(casters),
            clusters=clusters,
            surfaces=surfaces,
            topology=topology,
            probes=SurfaceProbes.of(positions, triangles, surfaces),
            vertex_buffer=_buffer(gpu, positions),
            index_buffer=_buffer(gpu, triangles),
            face_buffer=face_buffer,
            face_texture=gpu.buffer_texture(face_buffer),
            edge_buffer=_buffer(gpu, topology.edges),
            offset_buffer=_buffer(gpu, topology.offsets),
            half_edge_buffer=_buffer(gpu, half_edges.astype(np.int32)),
        )

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
        self.gpu.release(
            self.vertex_buffer,
            self.index_buffer,
            self.face_buffer,
            self.edge_buffer,
            self.offset_buffer,
            self.half_edge_buffer,
        )


def encode_octahedral(normals: Array) -> npt.NDArray[np.uint32]:
    """(n,) uint32: unit normals (n, 3) as two 16-bit snorms, x in the low half.

    Cigolle et al. 2014, "A survey of efficient representations for independent unit vectors", section 3.
    """
    flat = normals / np.abs(normals).sum(axis=1, keepdims=True)
    folded = (1 - np.abs(flat[:, 1::-1])) * np.where(flat[:, :2] >= 0, 1.0, -1.0)
    square = np.where(flat[:, 2:] >= 0, flat[:, :2], folded)
    halves = (np.round(square * 32767).astype(np.int64) & 0xFFFF).astype(np.uint32)
    packed: npt.NDArray[np.uint32] = halves[:, 0] | halves[:, 1] << np.uint32(16)
    return packed


def _gather(scene: Scene, origin: Array) -> tuple[Positions, Triangles, npt.NDArray[np.bool_], Array]:
    positions: list[Array] = [np.zeros((0, 3))]
    triangles: list[Triangles] = [np.zeros((0, 3), np.int32)]
    casts, colors = [np.zeros(0, bool)], [np.zeros((0, 3))]
    base = 0
    for mesh in scene.meshes:
        for world in mesh.world_positions():
            positions.append(world - origin)
            triangles.append(mesh.triangles + np.int32(base))
            casts.append(np.full(len(mesh.triangles), mesh.casts))
            colors.append(np.tile(mesh.base_color, (len(mesh.triangles), 1)))
            base += len(world)
    return (
        np.concatenate(positions).astype(np.float32),
        np.concatenate(triangles),
        np.concatenate(casts),
        np.concatenate(colors),
    )


def _face_table(positions: Positions, triangles: Triangles, colors: Array) -> npt.NDArray[np.uint32]:
    corners = positions.astype(np.float64)[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    # A face without area is never rasterised; any unit vector will do.
    normals = np.where(lengths > 0, normals / np.where(lengths > 0, lengths, 1), [0.0, 1.0, 0.0])
    bytes_ = np.round(np.clip(colors, 0, 1) * 255).astype(np.uint32)
    packed = bytes_[:, 0] | bytes_[:, 1] << 8 | bytes_[:, 2] << 16 | np.uint32(255 << 24)
    return np.stack([encode_octahedral(normals), packed], axis=1)


def _buffer(gpu: Gpu, array: npt.NDArray[Any]) -> moderngl.Buffer:
    # GL has no empty buffers; one that is never read stands for them.
    return gpu.ctx.buffer(np.ascontiguousarray(array).tobytes() or bytes(16))
