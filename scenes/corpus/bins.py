"""The axes of the corpus cut into bins, so that what is covered can be counted."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite

from scenes.corpus.axes import Axes
from scenes.scene import LightKind


@dataclass(frozen=True)
class AxisBins:
    """One axis.

    Attributes:
        name: The attribute of `Axes`.
        title: In words, with its unit.
        edges: Ascending; the first bin is below the first edge, the last from the last one on.
        endless: What a value that is not finite means here; empty where it cannot happen.
        digits: Decimals in labels.
    """

    name: str
    title: str
    edges: tuple[float, ...]
    endless: str = ""
    digits: int = 0

    @property
    def labels(self) -> tuple[str, ...]:
        """One for each bin."""
        if not self.edges:
            return tuple(LightKind)
        words = [f"{edge:,.{self.digits}f}" for edge in self.edges]
        between = [f"{low} .. {high}" for low, high in pairwise(words)]
        return (f"under {words[0]}", *between, f"from {words[-1]}", *([self.endless] if self.endless else []))

    def bin_of(self, axes: Axes) -> int:
        """Which bin an instance is in."""
        value = getattr(axes, self.name)
        if not self.edges:
            return list(LightKind).index(value)
        if not isfinite(value):
            return len(self.edges) + 1
        return bisect_right(self.edges, value)

    def counts(self, rows: list[Axes]) -> list[int]:
        """How many of the rows are in each bin."""
        found = [0] * len(self.labels)
        for row in rows:
            found[self.bin_of(row)] += 1
        return found


AXES = (
    AxisBins("triangles", "triangles", (100, 316, 1000, 3160, 10_000, 31_600, 100_000, 316_000, 1_000_000)),
    AxisBins("instances", "meshes as drawn", (2, 4, 8, 16, 32, 64, 128, 256, 512)),
    AxisBins(
        "closed_share",
        "share of casting triangles in closed shells",
        (0.01, 0.25, 0.5, 0.75, 0.9, 0.99),
        digits=2,
    ),
    AxisBins("extent_m", "extent, m", (5, 10, 20, 40, 80, 160, 320)),
    AxisBins("lights", "lights in the level", (2, 3, 4, 8, 16, 64)),
    AxisBins("kind", "kind of light", ()),
    AxisBins("cut_off_deg", "cut-off, degrees (90: no spot)", (5, 10, 20, 35, 50, 65, 80, 90)),
    AxisBins("range_share", "range / extent", (0.05, 0.1, 0.2, 0.4, 0.8, 1.5), "endless", 2),
    AxisBins("view_light_deg", "view against light, degrees", (15, 30, 60, 90, 120, 150), "nothing in reach"),
    AxisBins(
        "light_distance",
        "light to receivers / extent",
        (0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8),
        "sun, or none",
        2,
    ),
    AxisBins(
        "eye_distance",
        "eye to receivers / extent",
        (0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8),
        "nothing in reach",
        2,
    ),
    AxisBins("overlap", "casters before a shadowed place", (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0), digits=1),
    AxisBins(
        "shadow_share", "share of receivers in shadow", (0.01, 0.05, 0.15, 0.3, 0.5, 0.7, 0.9), digits=2
    ),
    AxisBins("lit_share", "share of the picture that is lit", (0.01, 0.05, 0.15, 0.3, 0.5, 0.7), digits=2),
    AxisBins(
        "boundary_distance",
        "eye to shadow edges / extent",
        (0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8),
        "no edge in view",
        2,
    ),
    AxisBins("sky_blocked", "share of the sky that is hidden", (0.05, 0.2, 0.4, 0.6, 0.8, 0.95), digits=2),
)
"""In the order in which they are shown."""
