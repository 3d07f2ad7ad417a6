"""Evidence as arrays: one row an instance, one column a candidate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.scene import Mobility
from selector.evidence.rows import CandidateRow, InstanceRow
from selector.measurement import Status
from selector.recommendation import SHORT_EDGE_PX

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]
Codes = npt.NDArray[np.int8]

STATUSES = tuple(Status)
"""What the numbers in `EvidenceTable.status` stand for."""
UNKNOWN = -1
"""Stands for a candidate that nobody has tried on the instance."""


@dataclass(frozen=True)
class Times:
    """How long each candidate takes for each instance. All (n, k) float64; nan where nobody timed it.

    Each sample is divided by the canary of its round and multiplied by the device's median canary, so
    that the machine's drift is gone.

    Attributes:
        median_ms: Median over all rounds of all runs.
        low_ms: Where the median is not below, in 95 of 100 repetitions; of fewer than six rounds the fastest.
        high_ms: Where the median is not above, likewise.
        rounds: How many samples there are; 0 where there are none.
    """

    median_ms: Floats
    low_ms: Floats
    high_ms: Floats
    rounds: Numbers


@dataclass(frozen=True)
class EvidenceTable:
    """What is known of n instances and k candidates on one device. Arrays are (n, k).

    Attributes:
        instances: The rows, in the order of families, scenes and keys.
        candidates: The columns, in the order of techniques and settings.
        status: int8, which of `STATUSES`, or `UNKNOWN`: the first failure that is known of.
        times: By mobility.
        figures: Name -> float64, nan where there is none, such as `edge_error_px` in pixels.
        counters: Name -> float64, nan where nobody counted.
        memory_bytes: float64, nan where unknown.
        canary_ms: The device's median canary; nan where nothing was timed.
    """

    instances: tuple[InstanceRow, ...]
    candidates: tuple[CandidateRow, ...]
    status: Codes
    times: Mapping[Mobility, Times]
    figures: Mapping[str, Floats]
    counters: Mapping[str, Floats]
    memory_bytes: Floats
    canary_ms: float

    def shadow_ms(self, mobility: Mobility) -> Floats:
        """(n, k) median milliseconds of the technique's own stages; nan where unknown."""
        return self.times[mobility].median_ms

    @property
    def edge_error_px(self) -> Floats:
        """(n, k) mean displacement of the shadow's edge; nan where unknown or too little edge is seen."""
        return self._figure("edge_error_px")

    @property
    def wrong_share(self) -> Floats:
        """(n, k) share of pixels on the wrong side; nan where unknown."""
        return self._figure("wrong_share")

    @property
    def exceedance_px(self) -> Floats:
        """(n, k) what an error limit is compared with, as in `selector.recommendation`; nan where unknown.

        The edge's displacement; where too little edge is seen, the wrong pixels as if the edge were 64 long.
        """
        edge, pixels = self.edge_error_px, self._figure("pixels")
        wrong = np.nan_to_num(self.wrong_share) * pixels
        exceedance: Floats = np.where(np.isnan(edge), wrong / SHORT_EDGE_PX, edge)
        return exceedance

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """(n, k) whether the candidate was tried and nothing failed."""
        good: npt.NDArray[np.bool_] = self.status == STATUSES.index(Status.OK)
        return good

    def _figure(self, name: str) -> Floats:
        nothing: Floats = np.full(self.status.shape, np.nan)
        return self.figures.get(name, nothing)
