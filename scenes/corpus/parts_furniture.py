"""Plain furniture as arrays of boxes: tables, chairs, beds, shelves; each stands at the origin."""

from __future__ import annotations

import numpy as np

from scenes.corpus.copies import boxes
from scenes.corpus.draws import Draws
from scenes.solids import Shell, joined
from scenes.thesis.skinned_solids import turned_solid


def table(width: float, depth: float, height: float) -> Shell:
    """A top on four legs: 60 triangles."""
    half = np.array([width / 2, 0.0, depth / 2])
    legs = np.array([(x, 0.0, z) for x in (-1, 1) for z in (-1, 1)]) * (half - [0.06, 0.0, 0.06])
    top = boxes(-half + [0.0, height - 0.05, 0.0], half + [0.0, height, 0.0])
    return joined([top, boxes(legs - [0.035, 0.0, 0.035], legs + [0.035, height - 0.045, 0.035])])


def chair() -> Shell:
    """Seat, legs and a back of slats: 132 triangles. It faces +Z."""
    back = [(x, 0.46, -0.22) for x in (-0.2, -0.07, 0.06, 0.17)]
    slats = boxes(back, np.array(back) + [0.03, 0.42, 0.03])
    rail = boxes([(-0.2, 0.86, -0.225)], [(0.2, 0.93, -0.185)])
    return joined([table(0.44, 0.44, 0.47), slats, rail, boxes([(-0.2, 0.16, -0.18)], [(-0.17, 0.19, 0.18)])])


def bed(width: float) -> Shell:
    """Frame, mattress, pillow, headboard: 48 triangles. The head is towards -Z."""
    half = width / 2
    return boxes(
        [
            (-half, 0.12, -1.0),
            (-half + 0.04, 0.3, -0.98),
            (-half + 0.15, 0.46, -0.9),
            (-half - 0.03, 0.0, -1.08),
        ],
        [(half, 0.32, 1.05), (half - 0.04, 0.5, 1.0), (half - 0.15, 0.62, -0.5), (half + 0.03, 1.05, -1.0)],
    )


def sofa(width: float) -> Shell:
    """Seat, back and arms: 48 triangles. It faces +Z."""
    half = width / 2
    return boxes(
        [(-half, 0.08, -0.4), (-half, 0.3, -0.42), (-half - 0.14, 0.06, -0.4), (half - 0.01, 0.06, -0.4)],
        [(half, 0.44, 0.4), (half, 0.85, -0.2), (-half + 0.01, 0.62, 0.42), (half + 0.14, 0.62, 0.42)],
    )


def shelf(width: float, height: float, boards: int) -> Shell:
    """Sides, back and boards, 0.32 m deep: 12 (boards + 3) triangles. It faces +Z."""
    half = width / 2
    levels = (np.arange(boards) / (boards - 1)) * (height - 0.03)
    low = np.stack([np.full(boards, -half), levels, np.full(boards, -0.15)], axis=1)
    sides = boxes(
        [(-half - 0.03, 0.0, -0.16), (half, 0.0, -0.16), (-half, 0.0, -0.17)],
        [(-half, height, 0.17), (half + 0.03, height, 0.17), (half, height, -0.15)],
    )
    return joined([sides, boxes(low, low + [width, 0.03, 0.31])])


def books(draws: Draws, width: float, levels: list[float], count: int) -> Shell:
    """So many books on each board, upright, of random height and thickness."""
    pitch = width / count
    x = np.tile((np.arange(count) + 0.5) * pitch - width / 2, len(levels))
    y = np.repeat(np.array(levels), count)
    tall = draws.numbers(len(x), 0.18, 0.3)
    half = pitch * draws.numbers(len(x), 0.3, 0.47)
    low = np.stack([x - half, y, np.full_like(x, -0.12)], axis=1)
    high = np.stack([x + half, y + tall, draws.numbers(len(x), 0.02, 0.12)], axis=1)
    return boxes(low, high)


def vase(sides: int, rings: int) -> Shell:
    """A turned vase, 0.4 m tall."""
    share = np.arange(rings) / (rings - 1)
    belly = 0.06 + 0.34 * share * (1.0 - share) * (1.25 - share)
    return turned_solid(np.stack([belly, 0.4 * share], axis=1), sides)
