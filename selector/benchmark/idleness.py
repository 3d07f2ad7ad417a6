"""How much of the machine other programs use: times taken beside them are worth less."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass

import psutil

BUSY_CORES = 0.15
"""A quiet system uses less than this on its own: 0.01 to 0.05 of a core."""


@dataclass(frozen=True)
class _Reading:
    at: float
    busy_s: float
    own_s: float


class Idleness:
    """Measures from one look to the next."""

    def __init__(self) -> None:
        self._last = _reading()

    def cores_of_others(self) -> float:
        """How many cores others have used on average since the last look."""
        now = _reading()
        elapsed_s = now.at - self._last.at
        others_s = (now.busy_s - self._last.busy_s) - (now.own_s - self._last.own_s)
        self._last = now
        return max(others_s / elapsed_s, 0.0) if elapsed_s > 0 else 0.0

    def remark(self, when: str) -> str:
        """A sentence where others have disturbed the machine since the last look; else empty."""
        cores = self.cores_of_others()
        if cores <= BUSY_CORES:
            return ""
        return f"{when}, other programs used {cores:.1f} of {os.cpu_count()} cores."


def _reading() -> _Reading:
    times = psutil.cpu_times()
    # Guests are counted in user time already; waiting for a disk keeps no core busy.
    idle_s = sum(getattr(times, name, 0.0) for name in ("idle", "iowait", "guest", "guest_nice"))
    busy_s = sum(times) - idle_s
    return _Reading(time.monotonic(), busy_s, _own_s())


def _own_s() -> float:
    """CPU seconds of this process and all that it has started."""
    own = psutil.Process()
    total = 0.0
    for process in (own, *own.children(recursive=True)):
        try:
            times = process.cpu_times()
        except psutil.Error:
            continue
        total += times.user + times.system
        if process == own:
            # Of children that have ended and were waited for.
            total += times.children_user + times.children_system
    return total
