"""How often `gnomon rebenchmark` finds a drift that is there, and one that is not: simulated, and recorded.

python tests/bench/drift_power.py
"""

from __future__ import annotations

import sys
from itertools import pairwise
from math import log
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from scenes.scene import Mobility
from selector.evidence.rows import Timing
from selector.rebenchmark.drift import shifts
from selector.rebenchmark.pairing import paired
from tests.selector.repeated_runs import repeats, techniques, timings

JOBS = 1000
TECHNIQUES = 5


def simulated(instances: int, noise: float, shift: float) -> tuple[float, float]:
    """Share of jobs with an alarm about what has not moved, and with one about what has."""
    random = np.random.default_rng(1)
    false = found = 0
    subjects = [(str(index), mobility) for index in range(TECHNIQUES) for mobility in Mobility]
    for _ in range(JOBS):
        # Student's t with 3 degrees of freedom: now and then an instance is far off.
        rows = random.standard_t(3, (len(subjects), instances)) * noise / np.sqrt(3.0)
        rows[: len(Mobility)] += log(1 + shift)
        alarms = {one.technique for one in shifts(dict(zip(subjects, rows, strict=True))) if one.alarm}
        found += "0" in alarms
        false += bool(alarms - {"0"})
    return false / JOBS, found / JOBS


def recorded(old: list[Timing], new: list[Timing], slowed: str | None) -> set[str]:
    """Techniques about which a job raises an alarm."""
    named = techniques()
    ratios = {key: dict(one) for key, one in paired(old, new, [], named).ratios.items()}
    for (name, _), found in ratios.items():
        if name == slowed:
            found.update({key: value + log(1.15) for key, value in found.items()})
    logs = {key: list(found.values()) for key, found in ratios.items()}
    return {one.technique for one in shifts(logs) if one.alarm}


def main() -> None:
    """Prints both."""
    sys.stdout.write("simulated: share of jobs with a false alarm / that find the one of 5 that shifted\n")
    for instances in (12, 24, 48):
        for noise in (0.03, 0.06, 0.12):
            row = []
            for shift in (0.0, 0.05, 0.1, 0.15):
                false, found = simulated(instances, noise, shift)
                row.append(f"{100 * shift:.0f} %: {100 * false:.1f} / {100 * found:.1f} %")
            sys.stdout.write(f"  {instances} instances, noise {noise}: {', '.join(row)}\n")
    runs = range(len(repeats().runs))
    taken = {number: timings([number]) for number in runs}
    jobs = {
        "a run and the one before": [(taken[a], taken[b]) for a, b in pairwise(runs)],
        "a run and all before": [
            ([row for one in range(night) for row in taken[one]], taken[night]) for night in runs[1:]
        ],
    }
    for words, compared in jobs.items():
        alarms = sum(bool(recorded(*one, None)) for one in compared)
        sys.stdout.write(f"recorded, {words}: {alarms} alarms in {len(compared)} comparisons\n")
        for name in dict.fromkeys(techniques().values()):
            hits = sum(name in recorded(*one, name) for one in compared)
            sys.stdout.write(f"  {name} slowed by 15 %: found in {hits}\n")


if __name__ == "__main__":
    main()
