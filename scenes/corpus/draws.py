"""Random draws that are the same bits on every machine: raw words of PCG64, and products of them."""

from __future__ import annotations

import hashlib

import numpy as np
import numpy.typing as npt

from scenes.scene import Array
from scenes.thesis.skinned_solids import circle

Indices = npt.NDArray[np.int64]
Words = npt.NDArray[np.uint64]

TURNS = 256
"""Directions on a circle come from a table of so many."""


class Draws:
    """A stream of numbers that depends on nothing but its key.

    Args:
        key: What the stream is for. A part of a scene with a key of its own does not change when another
            part draws more.
    """

    def __init__(self, *key: str | int) -> None:
        self._key = key
        digest = hashlib.sha256("\0".join(map(str, key)).encode()).digest()
        self._generator = np.random.PCG64(int.from_bytes(digest[:16], "little"))

    def of(self, *part: str | int) -> Draws:
        """The stream of a part."""
        return Draws(*self._key, *part)

    def numbers(self, count: int, low: float = 0.0, high: float = 1.0) -> Array:
        """(count,) float64 in low .. high."""
        shares: Array = (self._words(count) >> np.uint64(11)).astype(np.float64) * 2.0**-53
        return low + (high - low) * shares

    def number(self, low: float = 0.0, high: float = 1.0) -> float:
        """One float in low .. high."""
        return float(self.numbers(1, low, high)[0])

    def points(self, count: int, low: tuple[float, ...], high: tuple[float, ...]) -> Array:
        """(count, d) float64 between two corners."""
        return np.stack(
            [self.numbers(count, one, other) for one, other in zip(low, high, strict=True)], axis=1
        )

    def below(self, count: int, limit: int) -> Indices:
        """(count,) int64 in 0 .. limit - 1."""
        return ((self._words(count) >> np.uint64(32)) % np.uint64(limit)).astype(np.int64)

    def one_below(self, limit: int) -> int:
        """One int in 0 .. limit - 1."""
        return int(self.below(1, limit)[0])

    def order(self, count: int) -> Indices:
        """0 .. count - 1 in random order."""
        return np.argsort(self._words(count), kind="stable")

    def turns(self, count: int) -> Array:
        """(count, 2) cosines and sines of random turns."""
        return circle(TURNS)[self.below(count, TURNS)]

    def unit_vectors(self, count: int) -> Array:
        """(count, 3) in every direction: nearly even, as cubes have corners."""
        inside = self.points(count, (-1.0,) * 3, (1.0,) * 3) + [0.0, 2.0**-20, 0.0]
        squared = inside * inside
        return inside / np.sqrt((squared[:, 0] + squared[:, 1]) + squared[:, 2])[:, None]

    def _words(self, count: int) -> Words:
        return np.atleast_1d(np.asarray(self._generator.random_raw(count), dtype=np.uint64))
