"""Cathedral: a nave of columns and pointed arches, tall windows with tracery, rows of pews."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies, sheet
from scenes.corpus.parts_arches import chain, pointed_arch
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, cells, joined, placed
from scenes.thesis.skinned_solids import turned_solid

SUMMARY = "A nave between columns and tall windows with tracery: beams of light through small openings."
INDOOR = True
TRIANGLES = (4_000, 1_000_000)
KINDS = (LightKind.POINT, LightKind.SPOT, LightKind.DIRECTIONAL)

_LENGTH, _HALF, _AISLE, _WALL = 42.0, 5.0, 10.0, 0.75
_SPRING, _RIDGE, _EAVES = 11.0, 16.0, 17.0
_STONE: Color = (0.62, 0.57, 0.48)
_RIB: Color = (0.50, 0.46, 0.39)
_WOOD: Color = (0.24, 0.14, 0.07)


def build(plan: Plan) -> Stage:
    """Bays along the nave; more triangles make rounder columns, finer tracery and more pews."""
    bays = max(min(round(plan.by_grain(4, 9)), plan.triangles // 400), 3)
    each = plan.triangles / (bays * 12)
    segments = max(min(int(each / 60), 24), 2)
    pitch = _LENGTH / bays
    x: Array = np.arange(bays + 1, dtype=np.float64) * pitch - _LENGTH / 2
    meshes = [
        ground(_LENGTH + 2, 2 * _AISLE + 2, (0.40, 0.37, 0.33), plan.triangles / 30),
        placed("walls", joined(_walls(x)), _STONE),
        placed("columns", _columns(x[1:-1], each), _STONE),
        placed("arches", joined(_arches(x, segments)), _RIB),
        placed("vault", joined(_vaults(segments)), _STONE),
        placed("tracery", joined(_tracery(plan, x, segments, each)), _RIB),
        placed(
            "altar",
            boxes([(18.0, 0.0, -3.0), (18.5, 0.75, -1.5)], [(20.5, 0.5, 3.0), (19.75, 1.75, 1.5)]),
            _STONE,
        ),
    ]
    used = sum(mesh.triangle_count for mesh in meshes)
    meshes += _pews(plan, max(plan.triangles - used, 144))
    vistas = (
        ((-19.0, 3.5, -1.0), (4.0, 4.0, 1.0)),
        ((-17.0, 6.0, 3.75), (6.0, 1.0, -3.0)),
        ((16.5, 3.0, 3.0), (-6.0, 3.0, -2.0)),
    )
    room = ((-20.0, 0.5, -4.5), (17.5, 12.0, 4.5))
    return Stage(tuple(meshes), start=(-19.0, 6.0, 0.0), room=room, vistas=vistas)


def _walls(x: Array) -> Iterator[Shell]:
    """Outer walls with a window in each bay, and ends with a door and a rose's square."""
    pitch = x[1] - x[0]
    middles = (x[:-1] + x[1:]) / 2
    half = min(1.6, 0.3 * pitch)
    planes = [
        x[0] - _WALL,
        *np.stack([middles - half, middles + half], axis=1).ravel().tolist(),
        x[-1] + _WALL,
    ]
    filled = np.ones((len(planes) - 1, 3, 1), dtype=bool)
    filled[1::2, 1] = False
    for side in (-1, 1):
        z = sorted((side * _AISLE, side * (_AISLE + _WALL)))
        yield cells(planes, [-0.25, 2.5, 10.0, _EAVES], z, filled)
    ends = np.ones((1, 4, 5), dtype=bool)
    ends[0, 2, 2] = False
    door = ends.copy()
    door[0, 0, 2] = False
    z = [-_AISLE, -2.25, -1.75, 1.75, 2.25, _AISLE]
    yield cells([x[0] - _WALL, x[0]], [-0.25, 3.5, 6.5, 11.0, _EAVES], z, door)
    yield cells([x[-1], x[-1] + _WALL], [-0.25, 3.5, 6.5, 11.0, _EAVES], z, ends)


def _columns(x: Array, each: float) -> Shell:
    sides = max(min(int(each / 20), 32), 6)
    profile = [(0.85, -0.125), (0.85, 0.5), (0.55, 0.75), (0.5, 6.0), (0.5, 6.5), (0.8, 7.125), (0.8, 7.5)]
    places = [(at, 0.0, side * _HALF) for at in x.tolist() for side in (-1, 1)]
    return copies(turned_solid(profile, sides), places)


def _arches(x: Array, segments: int) -> Iterator[Shell]:
    """Arches from column to column, and ribs across nave and aisles."""
    pitch = x[1] - x[0]
    for side in (-1, 1):
        feet = np.stack([x[:-1], np.full(len(x) - 1, 7.25), np.full(len(x) - 1, side * _HALF)], axis=1)
        yield chain(pointed_arch(feet, (pitch, 0.0, 0.0), 3.0, segments), 0.4)
        yield boxes(feet[:1] + [0.0, 3.25, -0.375], feet[-1:] + [pitch, _EAVES - 7.25, 0.375])
        aisle = np.stack([x, np.full(len(x), 7.25), np.full(len(x), side * _HALF)], axis=1)
        yield chain(pointed_arch(aisle, (0.0, 0.0, side * (_AISLE - _HALF)), 2.5, segments), 0.2)
    feet = np.stack([x, np.full(len(x), _SPRING), np.full(len(x), -_HALF)], axis=1)
    yield chain(pointed_arch(feet, (0.0, 0.0, 2 * _HALF), _RIDGE - _SPRING, segments), 0.25)


def _vaults(segments: int) -> Iterator[Shell]:
    """The pointed vault of the nave and lean-to roofs over the aisles, as single sheets."""
    for low, way, rise in (
        ((-_LENGTH / 2, _SPRING, -_HALF), (0.0, 0.0, 2 * _HALF), _RIDGE - _SPRING),
        ((-_LENGTH / 2, 8.5, _HALF), (0.0, 0.0, _AISLE - _HALF), 2.0),
        ((-_LENGTH / 2, 8.5, -_AISLE), (0.0, 0.0, _AISLE - _HALF), 2.0),
    ):
        curve = pointed_arch([low], way, rise, 2 * segments)[0]
        along = np.arange(segments + 1)[:, None, None] / segments * np.array([_LENGTH, 0.0, 0.0])
        yield sheet(curve + along)


def _tracery(plan: Plan, x: Array, segments: int, each: float) -> Iterator[Shell]:
    """Mullions and arches in every window; more of them in finer grains."""
    pitch = x[1] - x[0]
    half = min(1.6, 0.3 * pitch)
    lights = max(min(round(plan.by_grain(2, 5)), int(each / 30)), 2)
    middles = (x[:-1] + x[1:]) / 2
    wide = 2 * half / lights
    for side in (-1, 1):
        z = side * (_AISLE + _WALL / 2)
        for number in range(lights):
            left = np.stack(
                [middles - half + number * wide, np.full(len(middles), 6.75), np.full(len(middles), z)],
                axis=1,
            )
            yield chain(pointed_arch(left, (wide, 0.0, 0.0), 1.25, segments), 0.06)
            if number:
                yield boxes(left - [0.06, 4.5, 0.06], left + [0.06, 3.5, 0.06])
        feet = np.stack([middles - half, np.full(len(middles), 7.5), np.full(len(middles), z)], axis=1)
        yield chain(pointed_arch(feet, (2 * half, 0.0, 0.0), 2.375, segments), 0.1)
        bars = max(min(int(each / 40), 24), 2)
        for height in (2.5 + (np.arange(bars) + 0.5) / bars * 4.25).tolist():
            low = np.stack([middles - half, np.full(len(middles), height), np.full(len(middles), z)], axis=1)
            yield boxes(low - [0.0, 0.02, 0.02], low + [2 * half, 0.02, 0.02])


def _pews(plan: Plan, triangles: int) -> Iterator[Mesh]:
    """Two blocks of pews: seat, back, ends; many triangles fill the backs with spindles."""
    rows = max(min(triangles // 96, round(plan.by_crowding(8, 26))), 2)
    places = np.arange(rows) / rows * 27.0 - 14.0
    spindles = max((triangles - 96 * rows) // (24 * rows), 0)
    parts = []
    draws = plan.draws("pews")
    for side in (-1, 1):
        low, high = sorted((side * 1.0, side * 4.0))
        # Pushed about a little, and here and there one is missing.
        x = (places + 0.2 * draws.numbers(rows))[draws.numbers(rows) < 0.9]
        foot = np.stack([x, np.zeros(len(x)), np.full(len(x), low)], axis=1)
        wide = high - low
        for corner, size in (
            ((0.0, 0.4, 0.0), (0.5, 0.06, wide)),
            ((0.0, 0.85, 0.0), (0.06, 0.125, wide)),
            ((0.0, 0.0, 0.0), (0.5, 1.0, 0.06)),
            ((0.0, 0.0, wide - 0.06), (0.5, 1.0, 0.06)),
        ):
            parts.append(boxes(foot + np.array(corner), foot + np.array(corner) + np.array(size)))
        if spindles:
            z = low + 0.125 + (np.arange(spindles) + 0.5) / spindles * (wide - 0.25)
            at, along = (part.ravel() for part in np.meshgrid(x, z, indexing="ij"))
            foot = np.stack([at + 0.03, np.full_like(at, 0.46), along], axis=1)
            half = min(0.02, 0.3 * (wide - 0.25) / spindles)
            parts.append(boxes(foot - [half, 0.0, half], foot + [half, 0.39, half]))
    yield placed("pews", joined(parts), _WOOD)
