"""Trees: closed trunks and limbs, open leaf cards."""

from __future__ import annotations

import numpy as np

from scenes.corpus.copies import rods
from scenes.corpus.draws import Draws
from scenes.scene import Array
from scenes.solids import Color, Shell, cards, joined

BARK: Color = (0.20, 0.13, 0.08)
LEAVES: tuple[Color, ...] = ((0.14, 0.28, 0.06), (0.20, 0.30, 0.07), (0.10, 0.22, 0.08), (0.30, 0.26, 0.06))


def trunk_and_limbs(draws: Draws, height_m: float, limbs: int, sides: int = 5) -> tuple[Shell, Array]:
    """A bent trunk with limbs, and (limbs, 3) where these end.

    `limbs` may be 0: then it is a trunk alone.
    """
    bend = 0.04 * height_m * draws.points(4, (-1.0, 0.0, -1.0), (1.0, 0.0, 1.0))
    stations = np.array([[0.0, -0.02, 0.0], [0.0, 0.25, 0.0], [0.0, 0.5, 0.0], [0.0, 0.8, 0.0]]) * height_m
    stations[1:] += bend[1:]
    radii = height_m * np.array([0.032, 0.025, 0.018, 0.007])
    trunk = rods(stations[:-1], stations[1:] + [0.0, 0.01 * height_m, 0.0], radii[:-1], radii[1:], sides)
    if not limbs:
        return trunk, np.zeros((0, 3))
    share = draws.numbers(limbs, 0.35, 0.78)
    segment = np.minimum((share / 0.28).astype(np.int64), 2)
    part = (share - np.array([0.0, 0.25, 0.5])[segment]) / np.array([0.25, 0.25, 0.3])[segment]
    foot = stations[segment] + np.clip(part, 0.0, 1.0)[:, None] * (stations[segment + 1] - stations[segment])
    way = draws.unit_vectors(limbs)
    way[:, 1] = 0.35 + 0.4 * np.abs(way[:, 1])
    reach = height_m * (0.42 - 0.28 * (share - 0.35))
    tips = foot + reach[:, None] * way
    branches = rods(foot, tips, height_m * 0.011, height_m * 0.004, 4)
    return joined([trunk, branches]), tips


def leaf_cards(draws: Draws, tips: Array, count: int, spread_m: float, area_m2: float) -> Shell:
    """So many cards in every direction in balls around the tips, of so much area together."""
    middles = tips[draws.below(count, len(tips))]
    offset = draws.unit_vectors(count) * np.sqrt(draws.numbers(count, 0.02, 1.0))[:, None]
    offset[:, 1] *= 0.7
    along = draws.unit_vectors(count)
    across = np.cross(along, draws.unit_vectors(count))
    squared = across * across
    length = np.sqrt((squared[:, 0] + squared[:, 1]) + squared[:, 2])
    across[length < 0.1] = np.cross(
        along[length < 0.1], np.eye(3)[np.abs(along[length < 0.1]).argmin(axis=1)]
    )
    squared = across * across
    across = across / np.sqrt((squared[:, 0] + squared[:, 1]) + squared[:, 2])[:, None]
    side = np.sqrt(area_m2 / count)
    along, across = along * 1.3 * side, across * (side / 1.3)
    return cards(middles + spread_m * offset - (along + across) / 2, along, across)


def needle_tiers(height_m: float, tiers: int, sides: int) -> Shell:
    """A fir's crown: closed cones, each over the next."""
    feet = height_m * (0.15 + 0.8 * np.arange(tiers) / tiers)
    tops = np.minimum(feet + 1.7 * height_m * 0.8 / tiers, height_m)
    radii = height_m * 0.24 * (1.0 - 0.85 * np.arange(tiers) / tiers)
    start = np.stack([0 * feet, feet, 0 * feet], axis=1)
    end = np.stack([0 * feet, tops, 0 * feet], axis=1)
    return rods(start, end, radii, radii * 0.06, sides)
