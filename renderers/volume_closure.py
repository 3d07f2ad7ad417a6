"""Whether volumes of lit faces alone, Crow's variant, are all the shadow that a mesh casts.

Let A faces of a mesh between a point p and the light l show the light their front, and B faces their back.
Where the mesh is closed and oriented alike, the way to the light leaves it through a front and enters it
through a back, so that A - B = w(p) - w(l), where w is its winding number. Hence wherever w(l) <= w(p), that
is where it winds around no point less often than around the light, no back stands between without a front,
and to count the fronts alone is right.

Closed and oriented alike means that at every edge as many faces run one way as the other, which makes their
number even: all there is to ask of an edge. Two faces or twenty may share it, and meshes may overlap.

An author's promise (`Mesh.promised_closed`) is not asked: it may be of several meshes together, each of them
open; it may be false, and volumes are the truth that all else is compared with; and to count the edges of a
million triangles takes about a second, once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from scenes.scene import EXPANDED_AT_ONCE, Array, Light, LightKind, Mesh, Scene
from scenes.topology import Counts, Topology, weld

Integers = npt.NDArray[np.int32]
Bools = npt.NDArray[np.bool_]

# Of the sum of all tetrahedra's volumes: less is a body without thickness, of rounding alone.
HOLLOW = 1e-9
# A light this far from a whole winding number stands on the mesh itself.
UNDECIDED = 0.1


@dataclass(frozen=True)
class Closure:
    """How the placements of a mesh bound bodies.

    Attributes:
        open_edges: Edges where more faces run one way than the other.
        least: (k,) lowest winding number of each placement: 0 where its faces look outwards, -1 inwards.
        low: (k, 3) float64 lowest corner of each placement, world metres.
        high: (k, 3) float64 highest corner.
    """

    open_edges: int
    least: Integers
    low: Array
    high: Array


_KNOWN: WeakKeyDictionary[Mesh, Closure] = WeakKeyDictionary()


def closure(mesh: Mesh) -> Closure:
    """How `mesh` bounds bodies; found once for each mesh.

    It is taken to wind around the points inside it once; the lobes of one that passes through itself inside
    out are not told apart.
    """
    if mesh not in _KNOWN:
        _KNOWN[mesh] = _closure(mesh)
    return _KNOWN[mesh]


def _closure(mesh: Mesh) -> Closure:
    if not len(mesh.triangles):
        nowhere = np.zeros((len(mesh.placements), 3))
        return Closure(0, np.zeros(len(nowhere), np.int32), nowhere, nowhere)
    _, welded = weld(mesh.positions)
    topology = Topology.of(welded.astype(np.int32)[mesh.triangles])
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    volumes = _determinants(corners - corners.reshape(-1, 3).mean(axis=0))
    hollow = abs(volumes.sum()) <= HOLLOW * np.abs(volumes).sum()
    turned = np.sign(np.linalg.det(mesh.placements[:, :3, :3]))
    sides = np.zeros(len(turned)) if hollow else np.sign(volumes.sum()) * turned
    low, high = _placed_boxes(mesh)
    return Closure(int(np.count_nonzero(topology.balances)), np.minimum(sides, 0).astype(np.int32), low, high)


def _placed_boxes(mesh: Mesh) -> tuple[Array, Array]:
    """(k, 3) float64 lowest and highest world corner of each placement; few are expanded at once."""
    drawn = np.zeros(len(mesh.positions), bool)
    drawn[mesh.triangles.ravel()] = True
    corners = Mesh("corners", mesh.positions[drawn], np.zeros((0, 3), np.int32), mesh.placements)
    low, high = np.zeros((2, len(mesh.placements), 3))
    step = max(EXPANDED_AT_ONCE // len(corners.positions), 1)
    for first in range(0, len(low), step):
        some = slice(first, first + step)
        placed = replace(corners, placements=mesh.placements[some]).world_positions()
        low[some], high[some] = placed.min(axis=1), placed.max(axis=1)
    return low, high


@dataclass(frozen=True)
class Bodies:
    """All placements of all casting meshes, in the scene's order.

    Attributes:
        closed: (n,) bool: closed, oriented alike, and outwards.
        faces: (n,) int64: how many faces each has.
        low: (n, 3) float64 lowest corner of each, world metres.
        high: (n, 3) float64 highest corner.
    """

    closed: Bools
    faces: Counts
    low: Array
    high: Array

    @classmethod
    def of(cls, scene: Scene) -> Bodies:
        """Those of `scene`."""
        casting = [mesh for mesh in scene.meshes if mesh.casts]
        found = [closure(mesh) for mesh in casting]
        least = np.concatenate([np.zeros(0, np.int32), *(one.least for one in found)])
        times = [len(one.least) for one in found]
        shut = np.repeat([one.open_edges == 0 for one in found], times).astype(bool)
        low, high = (
            np.concatenate([np.zeros((0, 3)), *boxes])
            for boxes in ([one.low for one in found], [one.high for one in found])
        )
        faces = np.repeat(np.array([len(mesh.triangles) for mesh in casting], np.int64), times)
        return cls(shut & (least == 0), faces, low, high)

    def bounded(self, light: Light) -> Bools:
        """(n,) bool: those whose lit faces alone cast all their shadow; never wrongly True."""
        return self.closed & ~_in_boxes(light, self.low, self.high)

    def of_faces(self, values: Integers) -> Integers:
        """(t,) int32: of `values` (n,) that of each casting face's placement, in the scene's order."""
        return np.repeat(values, self.faces)


def lit_faces_fall_short(light: Light, scene: Scene) -> str | None:
    """Why volumes of lit faces alone may miss shadows of `light`, or None where they cannot."""
    casting = [mesh for mesh in scene.meshes if mesh.casts]
    found = [mesh for mesh in casting if closure(mesh).open_edges]
    if found:
        count = sum(closure(mesh).open_edges * len(mesh.placements) for mesh in found)
        others = " and others" if len(found) > 1 else ""
        return (
            f'it needs closed meshes, but {count:,} edges, of "{found[0].name}"{others}, '
            "lack a face on one side; variant=general takes any"
        )
    for mesh in casting:
        if not _light_is_least_enclosed(light, mesh):
            return (
                f'it needs a light outside, but "{mesh.name}" encloses it or faces inwards; '
                "variant=general takes any"
            )
    return None


def _light_is_least_enclosed(light: Light, mesh: Mesh) -> bool:
    """Whether every placement of `mesh` winds around the light no more than around any other point."""
    return bool((np.abs(times_around(light, mesh) - closure(mesh).least) < UNDECIDED).all())


def times_around(light: Light, mesh: Mesh) -> Array:
    """(k,) float64: how often each placement of a closed `mesh` winds around the light."""
    bodies = closure(mesh)
    holding = _in_boxes(light, bodies.low, bodies.high)
    around = np.zeros(len(holding))
    if holding.any():
        around[holding] = [
            _winding_number(placed[mesh.triangles] - np.asarray(light.position))
            for placed in replace(mesh, placements=mesh.placements[holding]).world_positions()
        ]
    return around


def _in_boxes(light: Light, low: Array, high: Array) -> Bools:
    """(n,) bool: whether the light stands in each box."""
    place = np.asarray(light.position)
    inside = ((low <= place) & (place <= high)).all(axis=1)
    return np.logical_and(inside, light.kind is not LightKind.DIRECTIONAL)


def _winding_number(corners: Array) -> float:
    """How often (t, 3, 3) corners wind around zero: solid angles over 4 pi (van Oosterom, Strackee 1983)."""
    lengths = np.linalg.norm(corners, axis=2)
    following = np.roll(corners, -1, axis=1)
    cosines = np.einsum("ijk,ijk->ij", corners, following)
    below = lengths.prod(axis=1) + (cosines * np.roll(lengths, -2, axis=1)).sum(axis=1)
    return float(np.arctan2(_determinants(corners), below).sum() / (2 * np.pi))


def _determinants(corners: Array) -> Array:
    products: Array = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return products
