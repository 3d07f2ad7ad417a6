"""Figures of people, out of rods and turned solids: closed, in a few postures."""

from __future__ import annotations

import numpy as np

from scenes.corpus.copies import rods
from scenes.corpus.draws import Draws
from scenes.solids import Shell, joined
from scenes.thesis.skinned_solids import turned_solid

_HEAD = [(0.055, 1.5), (0.06, 1.56), (0.1, 1.64), (0.105, 1.7), (0.075, 1.79), (0.03, 1.81)]
_COAT = [(0.14, 0.72), (0.2, 0.8), (0.17, 1.05), (0.21, 1.35), (0.15, 1.48), (0.05, 1.52)]


def figure(draws: Draws, sides: int) -> Shell:
    """Somebody 1.8 m tall who faces +Z, arms and legs as drawn; 20 sides and more look round.

    About 44 sides triangles; with 4 sides or fewer a plain one of about 76.
    """
    stride, swing = draws.number(-0.22, 0.22), draws.number(-0.3, 0.5)
    raised = draws.number(-0.35, 0.75) if draws.one_below(3) == 0 else -0.42
    hip, shoulder = 0.82, 1.4
    feet = np.array([(-0.11, 0.04, stride), (0.11, 0.04, -stride)])
    knees = np.array([(-0.11, 0.45, 0.5 * stride + 0.05), (0.11, 0.45, -0.5 * stride + 0.05)])
    hips = np.array([(-0.1, hip, 0.0), (0.1, hip, 0.0)])
    hands = np.array([(-0.3, shoulder + raised, swing), (0.3, shoulder - 0.42, -0.5 * swing)])
    elbows = np.array([(-0.29, shoulder + 0.45 * raised - 0.05, 0.3 * swing - 0.05), (0.29, 1.13, -0.06)])
    shoulders = np.array([(-0.2, shoulder, 0.0), (0.2, shoulder, 0.0)])
    if sides <= 4:
        limbs = rods(np.concatenate([feet, hands]), np.concatenate([hips, shoulders]), 0.06, None, 3)
        body = turned_solid([(0.16, 0.72), (0.2, 1.3), (0.06, 1.52)], 4)
        return joined([limbs, body, turned_solid([(0.06, 1.5), (0.11, 1.66), (0.04, 1.8)], 4)])
    starts = np.concatenate([feet, knees, hands, elbows])
    ends = np.concatenate([knees, hips, elbows, shoulders])
    thick = np.repeat([0.05, 0.07, 0.035, 0.045], 2)
    thin = np.repeat([0.07, 0.085, 0.045, 0.06], 2)
    shoes = rods(feet - [0.0, 0.0, 0.08], feet + [0.0, 0.0, 0.16], 0.045, 0.035, sides)
    return joined(
        [
            rods(starts, ends, thick, thin, sides),
            shoes,
            turned_solid(_COAT, sides),
            turned_solid(_HEAD, sides),
        ]
    )
