"""How much of what casts shadows is closed, balanced or open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.scene import Mesh, Scene
from scenes.topology import Topology, weld

Labels = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Shells:
    """Casting triangles by what kind of shell they are part of, over all placements.

    A shell is what hangs together by shared edges. It is closed where two faces meet at every edge, one
    running each way; balanced where as many faces run one way as the other at every edge, such as bricks
    that touch; open otherwise.

    Attributes:
        closed: Triangles in closed shells.
        balanced: Triangles in balanced shells that are not closed.
        open: Triangles in open shells.
    """

    closed: int
    balanced: int
    open: int

    @property
    def triangles(self) -> int:
        """All of them."""
        return self.closed + self.balanced + self.open

    @classmethod
    def of(cls, scene: Scene) -> Shells:
        """The shells of the meshes that cast."""
        sums = np.zeros(3, np.int64)
        for mesh in scene.meshes:
            if mesh.casts and len(mesh.triangles):
                sums += _of_mesh(mesh) * len(mesh.placements)
        return cls(*sums.tolist())


def _of_mesh(mesh: Mesh) -> Labels:
    """(3,) int64: triangles in closed, balanced and open shells of one placement.

    In local space: placing it elsewhere moves equal corners to equal places.
    """
    _, welded = weld(mesh.positions)
    triangles = welded.astype(np.int32)[mesh.triangles]
    topology = Topology.of(triangles)
    shells = _shell_of_face(topology, len(triangles))
    per_edge = np.repeat(np.arange(len(topology.edges)), topology.valences)
    unbalanced = np.zeros(len(triangles), bool)
    unbalanced[shells[topology.faces[topology.balances[per_edge] != 0]]] = True
    crowded = np.zeros(len(triangles), bool)
    crowded[shells[topology.faces[topology.valences[per_edge] != 2]]] = True
    is_open = unbalanced[shells]
    is_closed = ~is_open & ~crowded[shells]
    return np.array([is_closed.sum(), (~is_open & ~is_closed).sum(), is_open.sum()], np.int64)


def _shell_of_face(topology: Topology, faces: int) -> Labels:
    """(t,) int64: the lowest face that hangs together with each face by shared edges.

    Lowest neighbour's label, then labels of labels, until nothing changes: about the logarithm of the
    longest way through a shell in rounds.
    """
    label = np.arange(faces)
    if not len(topology.edges):
        return label
    first = np.repeat(topology.faces[topology.offsets[:-1]], topology.valences)
    while True:
        before = label.copy()
        low = np.minimum(label[first], label[topology.faces])
        np.minimum.at(label, label[first], low)
        np.minimum.at(label, label[topology.faces], low)
        label = np.minimum(label, label[label])
        if np.array_equal(label, before):
            return label
