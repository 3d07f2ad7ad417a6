"""Harbour: gantry cranes over stacks of containers on a quay, lattices above large boxes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import boxes, copies, placements, rods
from scenes.corpus.parts_frames import lattice_beam
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind, Mesh
from scenes.solids import Color, Shell, joined, loft, placed

SUMMARY = "Gantry cranes over stacks of containers, a freighter at the quay: lattices above large boxes."
INDOOR = False
TRIANGLES = (2_500, 1_000_000)
KINDS = (LightKind.DIRECTIONAL, LightKind.SPOT, LightKind.POINT)

_PAINTS: tuple[Color, ...] = (
    (0.46, 0.12, 0.08),
    (0.08, 0.22, 0.40),
    (0.14, 0.32, 0.20),
    (0.58, 0.38, 0.08),
    (0.55, 0.55, 0.53),
)
_CRANE: Color = (0.62, 0.24, 0.05)
_LONG, _WIDE, _TALL = 6.0, 2.4, 2.6


def build(plan: Plan) -> Stage:
    """One to three cranes; containers in stacks, corrugated where there are triangles for it."""
    cranes = max(min(round(plan.by_grain(1, 4)), plan.triangles // 2200), 1)
    panels = max(min(plan.triangles // (cranes * 700), 22), 3)
    meshes = [
        ground(150.0, 70.0, (0.36, 0.36, 0.35), plan.triangles / 50),
        placed("quay", boxes([(-75.0, -5.0, -36.5)], [(75.0, 0.15, -35.0)]), (0.30, 0.29, 0.28)),
        placed("freighter", joined(_freighter()), (0.16, 0.07, 0.07)),
    ]
    x = (np.arange(cranes) - (cranes - 1) / 2) * 30.0 + plan.draws("cranes").numbers(cranes, -4.0, 4.0)
    matrices = placements(np.stack([x, 0.0 * x, 0.0 * x], axis=1), np.tile([1.0, 0.0], (cranes, 1)), 1.0)
    meshes.append(placed("cranes", joined(_crane(panels)), _CRANE, matrices))
    left = plan.triangles - sum(mesh.triangle_count for mesh in meshes)
    meshes += _containers(plan, max(left, 12 * 8))
    vistas = (
        ((-46.0, 5.0, 30.0), (0.0, 9.0, -8.0)),
        ((30.0, 30.0, 46.0), (0.0, 6.0, -8.0)),
        ((8.0, 1.8, 29.0), (0.0, 8.0, -10.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _crane(panels: int) -> Iterator[Shell]:
    """Four legs, portal beams, a boom over the water, tie rods, a cabin, a spreader on ropes."""
    z_front, z_back, high = -32.0, -16.0, 24.0
    for x in (-6.0, 6.0):
        for z in (z_front, z_back):
            yield boxes([(x - 0.6, 0.0, z - 0.6)], [(x + 0.6, high, z + 0.6)])
            yield boxes([(x - 1.6, 0.0, z - 0.9)], [(x + 1.6, 1.2, z + 0.9)])
        yield boxes([(x - 0.5, 10.0, z_front)], [(x + 0.5, 11.2, z_back)])
        yield rods([(x, 1.0, z_front)], [(x, 10.5, z_back)], 0.3, None, 4)
    for z in (z_front, z_back):
        yield boxes([(-6.0, high - 1.2, z - 0.5)], [(6.0, high, z + 0.5)])
    for x in (-2.0, 2.0):
        yield lattice_beam(
            (x, high + 1.0, -62.0),
            (x, high + 1.0, -4.0),
            ((1.2, 0.0, 0.0), (0.0, 1.8, 0.0)),
            2 * panels,
            0.14,
        )
    top = (0.0, high + 12.0, -27.0)
    for x in (-6.0, 6.0):
        for z in (z_front, z_back):
            yield rods([(x, high - 0.5, z)], [top], 0.3, 0.2, 6)
    yield rods(
        [top] * 4,
        [
            (-2.0, high + 2.0, -60.0),
            (2.0, high + 2.0, -60.0),
            (-2.0, high + 2.0, -5.0),
            (2.0, high + 2.0, -5.0),
        ],
        0.08,
        None,
        4,
    )
    yield boxes(
        [(-3.2, high - 3.4, -46.0), (-3.0, high + 2.0, -20.0), (-3.0, 9.5, -45.0)],
        [(-0.8, high - 0.2, -43.5), (3.0, high + 5.5, -13.0), (3.0, 10.1, -42.6)],
    )
    yield rods(
        [(x, 10.0, z) for x in (-2.6, 2.6) for z in (-44.6, -43.0)],
        [(x, high + 0.2, z) for x in (-1.6, 1.6) for z in (-44.6, -43.0)],
        0.04,
        None,
        4,
    )


def _freighter() -> Iterator[Shell]:
    lower = [
        (-36.0, -4.0, -39.0),
        (34.0, -4.0, -39.0),
        (46.0, -4.0, -46.0),
        (34.0, -4.0, -53.0),
        (-36.0, -4.0, -53.0),
    ]
    upper = [
        (-38.0, 5.0, -38.0),
        (36.0, 5.0, -38.0),
        (52.0, 7.0, -46.0),
        (36.0, 5.0, -54.0),
        (-38.0, 5.0, -54.0),
    ]
    yield loft(lower, upper)
    yield boxes(
        [(-36.0, 4.8, -53.0), (-35.0, 13.0, -56.0), (-33.0, 14.8, -47.5)],
        [(-28.0, 13.5, -39.0), (-29.0, 15.0, -36.0), (-31.0, 19.0, -44.5)],
    )


def _containers(plan: Plan, triangles: int) -> Iterator[Mesh]:
    """Rows of stacks on the quay and on the deck, of random heights, with ribs on their long sides."""
    wanted = round(plan.by_grain(30, 420))
    count = max(min(wanted, triangles // 12), 5)
    ribs = max(min((triangles // count - 12) // 12, 160), 0)
    draws = plan.draws("containers")
    stacks = max(int(count / plan.by_crowding(1.4, 3.6)), 4)
    columns = 18
    number = np.arange(stacks)
    # Every third row is a lane for the carriers.
    row = number // columns
    x = (number % columns - (columns - 1) / 2) * (_LONG + 0.7)
    z = -9.0 + (row + row // 2) * (_WIDE + 0.9)
    stack = (
        np.concatenate([number, draws.below(count - stacks, stacks)]) if count > stacks else number[:count]
    )
    stack = np.sort(stack)
    level = np.arange(len(stack)) - np.searchsorted(stack, stack)
    places = np.stack([x[stack], level * _TALL, z[stack]], axis=1)
    for paint, color in enumerate(_PAINTS):
        mine = places[draws.of("paint").below(len(places), len(_PAINTS)) == paint]
        if len(mine):
            yield placed(f"containers {paint + 1}", copies(_container(ribs), mine), color)


def _container(ribs: int) -> Shell:
    half_x, half_z = _LONG / 2, _WIDE / 2
    inset = 0.06 if ribs else 0.0
    body = boxes([(-half_x, 0.0, -half_z + inset)], [(half_x, _TALL - 0.02, half_z - inset)])
    if not ribs:
        return body
    each = max(ribs // 2, 1)
    x = (np.arange(each) + 0.5) / each * (_LONG - 0.2) - half_x + 0.1
    wide = min(0.12, 0.3 * _LONG / each)
    parts = [body]
    for z in (-half_z, half_z - 0.08):
        low = np.stack([x - wide, np.full_like(x, 0.1), np.full_like(x, z)], axis=1)
        parts.append(boxes(low, low + [2 * wide, _TALL - 0.25, 0.08]))
    return joined(parts)
