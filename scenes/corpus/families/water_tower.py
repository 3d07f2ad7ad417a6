"""Water tower: the thesis' Water Tower, alone or with others, large shadows and thin ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scenes.corpus.copies import placements
from scenes.corpus.parts_ground import hills, noise, square_points
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind
from scenes.thesis.water_tower import tower

SUMMARY = "The thesis' Water Tower on braced legs, alone or in a row: large casters and very thin ones."
INDOOR = False
TRIANGLES = (8_000, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.DIRECTIONAL, LightKind.POINT)

_PARTS_BY_NEED = ("tank", "legs", "deck", "roof", "braces", "riser", "ladder", "railing", "hoops")


def build(plan: Plan) -> Stage:
    """Towers of 12,500 triangles; where there are fewer, without hoops and railing."""
    parts = {mesh.name: mesh for mesh in tower()}
    whole = sum(mesh.triangle_count for mesh in parts.values())
    count = max(min(round(plan.by_crowding(1, 9)), round(plan.by_grain(1, 9)), plan.triangles // whole), 1)
    left = 1.1 * plan.triangles / count
    kept = []
    for name in _PARTS_BY_NEED:
        if parts[name].triangle_count <= left:
            kept.append(parts[name])
            left -= parts[name].triangle_count
    draws = plan.draws("towers")
    number = np.arange(count)
    places = np.stack(
        [(number % 3) * 14.0 * np.where(number % 3 == 2, -0.5, 1.0), 0.0 * number, (number // 3) * -16.0],
        axis=1,
    )
    places += draws.points(count, (-1.5, 0.0, -1.5), (1.5, 0.0, 1.5))
    matrices = placements(places, draws.turns(count), draws.numbers(count, 0.85, 1.1))
    quads = max(int(np.sqrt(plan.triangles / 8)), 8)
    x, z = square_points(110.0, quads)
    lawn = 0.12 * noise(x / 20.0 + 9.0, z / 20.0 + 9.0, draws.of("ground"), 2)
    grounds = hills(110.0, quads, lawn, (0.46, 0.42, 0.30))
    vistas = (
        ((14.0, 15.0, 28.0), (3.5, 5.0, -1.5)),
        ((-16.0, 3.0, 20.0), (0.0, 6.0, 0.0)),
        ((12.5, 7.5, 12.0), (4.5, 0.5, -2.5)),
    )
    return Stage((grounds, *(replace(mesh, placements=matrices) for mesh in kept)), vistas=vistas)
