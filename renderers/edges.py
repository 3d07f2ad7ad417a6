"""The edges of a scene's casters on the GPU, with the faces around each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from renderers.context import Gpu
from scenes.scene import Triangles
from scenes.topology import Topology


@dataclass(frozen=True)
class Edges:
    """Edges of casting faces.

    Attributes:
        topology: The same on the CPU.
        vertices: (e, 2) int32, the vertices of each edge.
        offsets: (e + 1,) int32, where the half-edges of each edge begin.
        half_edges: (h,) int32, twice the face, and 1 where it runs from first to second.
    """

    gpu: Gpu
    topology: Topology
    vertices: moderngl.Buffer
    offsets: moderngl.Buffer
    half_edges: moderngl.Buffer

    @classmethod
    def of(cls, gpu: Gpu, triangles: Triangles) -> Edges:
        """Those of (t, 3) welded triangles."""
        topology = Topology.of(triangles)
        half_edges = topology.faces * np.int32(2) + (topology.orientations > 0)
        buffers = (gpu_buffer(gpu, array) for array in (topology.edges, topology.offsets, half_edges))
        return cls(gpu, topology, *buffers)

    def release(self) -> None:
        """Give the GPU memory back."""
        self.gpu.release(self.vertices, self.offsets, self.half_edges)


def gpu_buffer(gpu: Gpu, array: npt.NDArray[Any]) -> moderngl.Buffer:
    """A buffer that holds `array`."""
    # GL has no empty buffers; one that is never read stands for them.
    return gpu.ctx.buffer(np.ascontiguousarray(array) if array.size else bytes(16))
