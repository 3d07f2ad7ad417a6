"""Debris field: what is left of a wreck, loose plates and beams of every size lying and floating about."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.corpus.copies import cross_axes, rods
from scenes.corpus.draws import Draws
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, LightKind, Mesh
from scenes.solids import Color, Shell, cards, joined, placed
from scenes.thesis.skinned_solids import circle, hoop, turned_solid

SUMMARY = "A wreck strewn over a plain: ribs, beams and torn plates at every angle, open and closed mixed."
INDOOR = False
TRIANGLES = (400, 1_000_000)
KINDS = (LightKind.POINT, LightKind.SPOT, LightKind.DIRECTIONAL)

_RUST: Color = (0.36, 0.18, 0.09)
_PLATE: Color = (0.40, 0.41, 0.40)
_SIDE_M = 80.0


def build(plan: Plan) -> Stage:
    """The ribs of a hull, and around them beams (closed) and plates (open), densest in the middle."""
    quads = max(int(np.sqrt(plan.triangles / 16)), 4)
    x, z = square_points(_SIDE_M, quads)
    furrow = -1.6 / (1.0 + (z / 5.0) * (z / 5.0))
    heights = 0.9 * noise(x / 16.0 + 8.0, z / 16.0 + 8.0, plan.draws("ground"), 3) + furrow
    meshes = [hills(_SIDE_M, quads, heights, (0.44, 0.36, 0.26))]
    meshes += _hull(plan)
    used = sum(mesh.triangle_count for mesh in meshes)
    pieces = max((plan.triangles - used) // 8, 8)
    pieces = min(pieces, round(plan.by_grain(60, 200_000)))
    meshes += _pieces(plan, pieces)
    vistas = (
        ((-18.0, 4.5, 15.0), (0.0, 1.0, 0.0)),
        ((10.0, 2.5, 13.0), (-2.0, 0.75, 1.0)),
        ((24.0, 10.0, 20.0), (0.0, 0.0, 0.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _hull(plan: Plan) -> Iterator[Mesh]:
    """Ribs as half-sunk hoops that get smaller, stringers along them, an engine bell."""
    ribs = max(min(plan.triangles // 400, 13), 3)
    around, across = (12, 4) if plan.triangles < 20_000 else (32, 8)
    parts, feet = [], []
    turns = circle(8)
    for number in range(ribs):
        share = number / (ribs - 1)
        radius = 4.0 - 2.0 * share * share
        ring = hoop((0.0, 0.0, 0.0), radius, 0.14, around, across)
        x, y, z = ring.positions.T
        upright = np.stack([y + 18.0 * share - 9.0, z + 0.6 * radius - 1.0, x], axis=1)
        parts.append(Shell(upright, ring.triangles))
        feet.append(
            np.stack(
                [
                    np.full(8, 18.0 * share - 9.0),
                    radius * turns[:, 1] + 0.6 * radius - 1.0,
                    radius * turns[:, 0],
                ],
                axis=1,
            )
        )
    lines = np.array(feet)[:, [0, 1, 2, 3, 4]]
    parts.append(rods(lines[:-1].reshape(-1, 3), lines[1:].reshape(-1, 3), 0.08, None, 4))
    yield placed("hull", joined(parts), _RUST)
    bell = [(0.6, 0.0), (0.7, 0.5), (1.2, 1.0), (1.8, 2.2), (1.7, 2.2), (1.1, 1.0), (0.6, 0.6)]
    sides = 8 if plan.triangles < 20_000 else 32
    yield placed("engine", turned_solid(bell, sides, (12.5, -0.6, 1.5)), _PLATE)


def _pieces(plan: Plan, count: int) -> Iterator[Mesh]:
    draws = plan.draws("pieces")
    reach = np.sqrt(draws.numbers(count)) * 30.0
    ways = draws.turns(count)
    small = plan.by_grain(1.0, 0.35) * (0.15 + np.sqrt(np.sqrt(200.0 / (count + 200.0))))
    share = draws.numbers(count)
    size = small * (0.2 + 2.4 * share * share * share)
    hover = draws.numbers(count) * draws.numbers(count) * plan.by_crowding(0.3, 5.0)
    middle = np.stack([1.2 * reach * ways[:, 0], 0.3 * size + hover, 0.8 * reach * ways[:, 1]], axis=1)
    middle[:, 1] -= 1.4 / (1.0 + (middle[:, 2] / 5.0) * (middle[:, 2] / 5.0))
    half = count // 2
    along = draws.unit_vectors(count) * [1.0, 0.5, 1.0]
    beams = size[:half, None] * along[:half]
    yield placed(
        "beams", rods(middle[:half] - beams, middle[:half] + beams, 0.12 * size[:half], None, 4), _RUST
    )
    yield placed("plates", _plates(draws, middle[half:], size[half:], along[half:]), _PLATE)


def _plates(draws: Draws, middle: Array, size: Array, along: Array) -> Shell:
    across, other = cross_axes(along)
    lean = draws.numbers(len(middle), -0.6, 0.6)[:, None]
    wide = size[:, None] * (across + lean * other) * draws.numbers(len(middle), 0.5, 1.2)[:, None]
    long = size[:, None] * along
    return cards(middle - (wide + long) / 2, long, wide)
