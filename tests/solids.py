"""Geometry of code for tests: boxes, sheets, fans, soups and one-sided surfaces."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from scenes.scene import Array, Mesh, Scene

Triples = npt.NDArray[np.int64]

_CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_CUBE_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def quads(corners: Triples) -> Triples:
    """(2 n, 3) triangles of (n, 4) quads, in the same winding."""
    return corners[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def box(
    centre: npt.ArrayLike, half: npt.ArrayLike, turn: Rotation | None = None, *, casts: bool = True
) -> Mesh:
    """A closed box with outward faces."""
    corners = _CUBE * np.asarray(half, float)
    corners = corners if turn is None else turn.apply(corners)
    return Mesh("box", corners + np.asarray(centre, float), quads(_CUBE_QUADS), casts=casts)


def floor(half: float = 10.0, height: float = 0.0, cells: int = 1, *, casts: bool = True) -> Mesh:
    """A square that faces up."""
    return sheet(
        lambda u, v: np.stack([u * half, np.full_like(u, height), -v * half], axis=-1), cells, casts=casts
    )


def sheet(shape: object, cells: int, *, casts: bool = True, name: str = "sheet") -> Mesh:
    """A grid of `cells` squared over u, v in [-1, 1], placed by `shape(u, v)`."""
    assert callable(shape)
    u, v = np.meshgrid(*[np.linspace(-1, 1, cells + 1)] * 2, indexing="ij")
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    corners = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return Mesh(name, shape(u, v).reshape(-1, 3), quads(corners.reshape(-1, 4)), casts=casts)


def plane(normal: npt.ArrayLike, half: float, *, cells: int = 1) -> Mesh:
    """A square through the origin."""
    across, along = axes_beside(normal)
    return sheet(lambda u, v: half * (u[..., None] * across + v[..., None] * along), cells, name="plane")


def axes_beside(direction: npt.ArrayLike) -> tuple[Array, Array]:
    """Two unit vectors that make a right-handed frame with `direction` as the third axis."""
    forward = np.asarray(direction, float) / np.linalg.norm(direction)
    helper = np.eye(3)[np.argmin(np.abs(forward))]
    across = np.cross(helper, forward)
    across /= np.linalg.norm(across)
    return across, np.cross(forward, across)


def soup(corners: Array, *, name: str = "soup") -> Mesh:
    """Loose triangles (t, 3, 3)."""
    return Mesh(name, corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def fan(start: Array, end: Array, tips: Array) -> Mesh:
    """One triangle for each tip (k, 3), all on the edge from `start` to `end`."""
    return Mesh(
        "fan",
        np.vstack([start, end, tips]),
        np.stack([np.zeros(len(tips)), np.ones(len(tips)), 2 + np.arange(len(tips))], axis=1),
    )


def klein_bottle(cells: int = 24) -> Mesh:
    """The figure-8 immersion: closed, not orientable, crosses itself; its seam is welded with a flip."""

    def shape(u: Array, v: Array) -> Array:
        turn, around = np.pi * (u + 1), np.pi * (v + 1)
        across = np.cos(turn / 2) * np.sin(around) - np.sin(turn / 2) * np.sin(2 * around)
        lift = np.sin(turn / 2) * np.sin(around) + np.cos(turn / 2) * np.sin(2 * around)
        radius = 1.5 + across
        return np.stack([radius * np.cos(turn), lift, radius * np.sin(turn)], axis=-1)

    mesh = sheet(shape, cells, name="klein bottle")
    grid = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    grid[:, -1] = grid[:, 0]
    grid[-1] = grid[0, ::-1]
    return Mesh(mesh.name, mesh.positions, grid.ravel()[mesh.triangles])


def moebius_strip(cells: int = 24, half_width: float = 0.5) -> Mesh:
    """An open strip with one side; its seam is welded with a flip."""

    def shape(u: Array, v: Array) -> Array:
        turn = np.pi * (u + 1)
        radius = 1.5 + half_width * v * np.cos(turn / 2)
        lift = half_width * v * np.sin(turn / 2)
        return np.stack([radius * np.cos(turn), lift, radius * np.sin(turn)], axis=-1)

    mesh = sheet(shape, cells, name="moebius strip")
    grid = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    grid[-1] = grid[0, ::-1]
    return Mesh(mesh.name, mesh.positions, grid.ravel()[mesh.triangles])


def moved(mesh: Mesh, matrix: Array) -> Mesh:
    """The same mesh placed by (4, 4) `matrix` after its own placements."""
    placements = matrix @ mesh.placements
    return Mesh(mesh.name, mesh.positions, mesh.triangles, placements, mesh.casts, mesh.base_color)


def placed(
    scale: float = 1.0, turn: Rotation | None = None, offset: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> Array:
    """(4, 4) placement: scale, then turn, then move."""
    matrix = np.eye(4)
    matrix[:3, :3] = scale * (np.eye(3) if turn is None else turn.as_matrix())
    matrix[:3, 3] = offset
    return matrix


def world_triangles(scene: Scene) -> Array:
    """(t, 3, 3) float64 corners of all casting triangles, world."""
    parts = [world[mesh.triangles] for mesh in scene.meshes if mesh.casts for world in mesh.world_positions()]
    return np.concatenate(parts) if parts else np.zeros((0, 3, 3))
