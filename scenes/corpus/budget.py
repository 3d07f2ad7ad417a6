"""Brings a place to its number of triangles, and its shells into the state that a spec asks for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scenes.corpus.draws import Draws
from scenes.corpus.spec import Closure
from scenes.scene import Array, Mesh
from scenes.solids import GRID_M, Indices, Shell, joined, placed, snapped

_ENOUGH, _TOO_MUCH = 0.8, 1.25
_AREA_STEPS = 2.0**10
_SMALLEST_EDGE_M = 2.0**-8
_FLIPPED = 8


def refined(meshes: tuple[Mesh, ...], triangles: int) -> tuple[Mesh, ...]:
    """The meshes, coarse ones split until there are about so many triangles; shapes stay.

    Every triangle of a mesh is split into n^2 alike, so that closed meshes stay closed.
    """
    counts = [mesh.triangle_count for mesh in meshes]
    areas = [_area(mesh) for mesh in meshes]
    limits = [_most_splits(mesh) for mesh in meshes]
    splits = [1] * len(meshes)
    while (total := _total(counts, splits)) < _ENOUGH * triangles:
        by_size = sorted(range(len(meshes)), key=lambda index: -areas[index] / splits[index] ** 2)
        for index in by_size:
            more = counts[index] * ((splits[index] + 1) ** 2 - splits[index] ** 2)
            if counts[index] and splits[index] < limits[index] and total + more <= _TOO_MUCH * triangles:
                splits[index] += 1
                break
        else:
            break
    return tuple(_split(mesh, number) for mesh, number in zip(meshes, splits, strict=True))


def closed_as(meshes: tuple[Mesh, ...], closure: Closure, draws: Draws) -> tuple[Mesh, ...]:
    """The meshes in that state."""
    if closure is Closure.BOTTOMLESS:
        return tuple(map(_bottomless, meshes))
    if closure is Closure.FLIPPED:
        return tuple(_flipped(mesh, draws.of(number)) for number, mesh in enumerate(meshes))
    return meshes


def merged(meshes: tuple[Mesh, ...]) -> Mesh:
    """All meshes and placements as one mesh."""
    parts = [
        Shell(world, mesh.triangles.astype(np.int64)) for mesh in meshes for world in mesh.world_positions()
    ]
    return placed("level", joined(parts), meshes[-1].base_color)


def tessellated(shell: Shell, splits: int) -> Shell:
    """Every triangle split into `splits`^2 of its shape; neighbours stay joined."""
    if splits == 1:
        return shell
    weights, pattern = _lattice(splits)
    corners = shell.positions[shell.triangles]
    # The same sum for both triangles of an edge, whatever their order of corners: no cracks.
    parts = [corners[:, None, corner] * weights[None, :, corner, None] for corner in range(3)]
    points = ((parts[0] + parts[1]) + parts[2]) / splits
    first = len(weights) * np.arange(len(corners))
    positions, index = _merged(snapped(points.reshape(-1, 3)).astype(np.float64))
    triangles = index[(first[:, None, None] + pattern).reshape(-1, 3)]
    return Shell(positions, triangles)


def _lattice(splits: int) -> tuple[Indices, Indices]:
    """(k, 3) weights of the points of a split triangle, and (splits^2, 3) triangles over them."""
    rows = [(splits - row, row - column, column) for row in range(splits + 1) for column in range(row + 1)]
    number = {weight: index for index, weight in enumerate(rows)}
    pattern = []
    for a, b, c in rows:
        if a:
            pattern.append([number[a, b, c], number[a - 1, b + 1, c], number[a - 1, b, c + 1]])
        if a and b:
            pattern.append([number[a, b, c], number[a - 1, b, c + 1], number[a, b - 1, c + 1]])
    return np.array(rows, dtype=np.int64), np.array(pattern, dtype=np.int64)


def _merged(positions: Array) -> tuple[Array, Indices]:
    steps = np.round(positions / GRID_M).astype(np.int64)
    steps -= steps.min(axis=0)
    spans = steps.max(axis=0) + 1
    keys = (steps[:, 0] * spans[1] + steps[:, 1]) * spans[2] + steps[:, 2]
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return positions[first], inverse.ravel()


def _split(mesh: Mesh, splits: int) -> Mesh:
    if splits == 1:
        return mesh
    shell = tessellated(Shell(mesh.positions.astype(np.float64), mesh.triangles.astype(np.int64)), splits)
    return replace(mesh, positions=snapped(shell.positions), triangles=shell.triangles.astype(np.int32))


def _bottomless(mesh: Mesh) -> Mesh:
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    level = (corners[:, 0, 1] == corners[:, 1, 1]) & (corners[:, 1, 1] == corners[:, 2, 1])
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    downwards = level & (one[:, 2] * other[:, 0] - one[:, 0] * other[:, 2] < 0)
    return mesh if downwards.all() else replace(mesh, triangles=mesh.triangles[~downwards])


def _flipped(mesh: Mesh, draws: Draws) -> Mesh:
    turned = draws.below(len(mesh.triangles), _FLIPPED)[:, None] == 0
    return replace(mesh, triangles=np.where(turned, mesh.triangles[:, ::-1], mesh.triangles))


def _area(mesh: Mesh) -> float:
    """Square metres per triangle, from whole numbers: sums of floats depend on their order."""
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    squared = normals * normals
    doubled = np.sqrt((squared[:, 0] + squared[:, 1]) + squared[:, 2])
    return float(np.round(doubled * _AREA_STEPS).astype(np.int64).sum()) / max(len(corners), 1)


def _most_splits(mesh: Mesh) -> int:
    """So many that no edge gets too short for the grid of positions."""
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    edges = np.abs(corners - np.roll(corners, 1, axis=1)).max(axis=2)
    shortest = float(edges.min()) if len(edges) else 0.0
    return max(int(shortest / _SMALLEST_EDGE_M), 1)


def _total(counts: list[int], splits: list[int]) -> int:
    return sum(count * number**2 for count, number in zip(counts, splits, strict=True))
