"""How much of what casts shadows is closed, balanced or open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

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
        """The shells of the meshes that cast.

        Where the author promises closed geometry, balanced counts as closed: what merely touches was told
        apart. A promise is not believed where an edge is open.
        """
        sums = np.zeros(3, np.int64)
        casting = [mesh for mesh in scene.meshes if mesh.casts and mesh.triangle_count]
        for mesh in casting:
            if not mesh.promised_closed:
                sums += _of_mesh(mesh) * len(mesh.placements)
        for body in _promised_bodies(casting):
            closed, balanced, open_ = _of_mesh(body)
            sums += np.array([closed + balanced, 0, open_]) * len(body.placements)
        return cls(*sums.tolist())


def _promised_bodies(meshes: Sequence[Mesh]) -> list[Mesh]:
    """What is promised to be closed, the meshes of each node as one."""
    groups: dict[tuple[int | None, bytes], list[Mesh]] = {}
    for mesh in meshes:
        if mesh.promised_closed:
            groups.setdefault((mesh.node, mesh.placements.tobytes()), []).append(mesh)
    bodies = []
    for group in groups.values():
        starts = np.cumsum([0, *(len(mesh.positions) for mesh in group[:-1])])
        triangles = [mesh.triangles + start for mesh, start in zip(group, starts, strict=True)]
        positions = np.concatenate([mesh.positions for mesh in group])
        bodies.append(replace(group[0], positions=positions, triangles=np.concatenate(triangles)))
    return bodies


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
