"""Single hero: one large figure on a pedestal in an empty hall of columns, all triangles on one object."""

from __future__ import annotations

import numpy as np

from scenes.corpus.copies import boxes, copies
from scenes.corpus.draws import Draws
from scenes.corpus.parts_figures import figure
from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind
from scenes.solids import Shell, joined, moved, placed, turned
from scenes.thesis.skinned_solids import circle, hoop, rod, turned_solid

SUMMARY = "One statue with spear and shield before a few columns: a single, very detailed caster."
INDOOR = False
TRIANGLES = (400, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.POINT, LightKind.DIRECTIONAL)


def build(plan: Plan) -> Stage:
    """Half of the triangles and more are the statue's; columns around it come with crowding."""
    rounds = max(min(int(np.sqrt(plan.triangles / 12)), 200), 5)
    columns = round(plan.by_crowding(1, 8)) if plan.triangles > 1500 else 0
    shaft = [(0.6, -0.1), (0.6, 0.3), (0.42, 0.4), (0.36, 4.6), (0.62, 4.9), (0.62, 5.2)]
    ways = circle(16)[1 : 2 * columns + 1 : 2]
    pillars = [(7.0 * x, 0.0, -7.0 * abs(z) - 0.5) for x, z in ways.tolist()]
    step = boxes(
        [(-2.2, -0.1, -2.2), (-1.6, 0.2, -1.6), (-1.1, 0.5, -1.1)],
        [(2.2, 0.25, 2.2), (1.6, 0.55, 1.6), (1.1, 1.5, 1.1)],
    )
    meshes = [
        ground(34.0, 34.0, (0.50, 0.46, 0.40), plan.triangles / 30),
        placed("pedestal", step, (0.46, 0.44, 0.41)),
        placed("statue", _statue(plan.draws("statue"), rounds), (0.42, 0.28, 0.12)),
    ]
    if columns:
        meshes.append(
            placed("columns", copies(turned_solid(shaft, max(rounds // 4, 6)), pillars), (0.62, 0.59, 0.53))
        )
    vistas = (
        ((4.5, 3.0, 8.5), (0.0, 2.75, 0.0)),
        ((-6.5, 6.0, 7.0), (0.5, 1.5, -0.5)),
        ((5.0, 1.8, 9.0), (-0.5, 2.0, 0.0)),
    )
    return Stage(tuple(meshes), vistas=vistas)


def _statue(draws: Draws, rounds: int) -> Shell:
    """A warrior, twice as large as life: spear in the raised hand, a shield with a boss, a plume."""
    sides = max(rounds // 2, 4)
    body = figure(draws, sides)
    body = Shell(body.positions * 2.1, body.triangles)
    spear = rod((-1.0, 1.2, 0.9), (-0.55, 4.9, 0.3), 0.035, 0.03, max(sides, 4))
    point = rod((-0.551, 4.89, 0.301), (-0.5, 5.35, 0.22), 0.09, 0.004, max(sides, 4))
    shield = turned_solid(
        [(0.85, -0.04), (0.85, 0.0), (0.5, 0.12), (0.18, 0.17), (0.16, 0.26), (0.03, 0.3)], max(rounds, 6)
    )
    x, y, z = shield.positions.T
    upright = Shell(np.stack([x + 0.75, -z + 2.1, y + 0.25], axis=1), shield.triangles)
    rim = hoop((0.0, 0.0, 0.0), 0.85, 0.05, max(rounds, 6), max(sides // 2, 3))
    x, y, z = rim.positions.T
    rim = Shell(np.stack([x + 0.75, -z + 2.1, y + 0.25], axis=1), rim.triangles)
    plume = hoop((0.0, 0.0, 0.0), 0.34, 0.07, max(rounds, 6), max(sides // 2, 3))
    x, y, z = plume.positions.T
    crest = Shell(np.stack([y, 3.62 + x, z - 0.02], axis=1), plume.triangles)
    whole = moved(joined([body, spear, point, upright, rim, crest]), (0.0, 1.46, 0.0))
    cosine, sine = draws.turns(1)[0].tolist()
    return turned(whole, cosine, sine) if draws.one_below(2) else whole
