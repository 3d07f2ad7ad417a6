"""How well times repeat between two runs of `gnomon benchmark`, each in a store of its own.

    .venv/bin/python tests/bench/stability.py FIRST.sqlite SECOND.sqlite [--json]

Over the instances that both have timed: Kendall's tau between the rankings of an instance's candidates, the
share of winners that are the same, what the first run's winners cost by the second's times, and how often the
second run's median lies in the interval that the first one states. Errors and counters of both have to be
equal to the last bit.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.stats import kendalltau

from scenes.scene import Array, Mobility
from selector.evidence.store import Store
from selector.evidence.table import EvidenceTable
from selector.policy import POLICIES, Policy

FEWEST = 2
"""Candidates from which on there is a ranking."""


def table_of(url: str) -> EvidenceTable:
    """What a store holds of the one device that was timed."""
    with Store.open(url) as store:
        return store.table(next(iter(store.devices())).key)


def common(first: EvidenceTable, second: EvidenceTable) -> tuple[Array, Array, Array, Array]:
    """Rows and columns of the first table, and those of the second that stand for the same."""
    keys = [[one.key for one in table.instances] for table in (first, second)]
    names = [[one.key for one in table.candidates] for table in (first, second)]
    rows = [(keys[0].index(key), keys[1].index(key)) for key in keys[0] if key in keys[1]]
    columns = [(names[0].index(name), names[1].index(name)) for name in names[0] if name in names[1]]
    ours, theirs = np.array(rows).reshape(-1, 2).T
    my_columns, their_columns = np.array(columns).reshape(-1, 2).T
    return ours, theirs, my_columns, their_columns


def of_mobility(
    tables: tuple[EvidenceTable, EvidenceTable], cells: tuple[Array, Array], mobility: Mobility
) -> Mapping[str, Any]:
    """The figures for moving or for still lights."""
    ours, theirs = (one.times[mobility] for one in tables)
    first, second = ours.median_ms[cells[0]], theirs.median_ms[cells[1]]
    # Frames are independent of the machine's drift only as multiples of the canary.
    first, second = first / tables[0].canary_ms, second / tables[1].canary_ms
    low = ours.low_ms[cells[0]] / tables[0].canary_ms
    high = ours.high_ms[cells[0]] / tables[0].canary_ms
    both = np.isfinite(first) & np.isfinite(second)
    taus, found = [], 0
    for row in np.flatnonzero(both.sum(axis=1) >= FEWEST):
        known = both[row]
        taus.append(float(kendalltau(first[row, known], second[row, known]).statistic))
        found += 1
    inside = (second >= low) & (second <= high)
    ratios = np.log(second[both] / first[both])
    winners = {one.name: _winners(tables, cells, (first, second), one) for one in POLICIES}
    return {
        "instances": found,
        "kendall_tau_median": float(np.median(taus)),
        "kendall_tau_quartiles": np.percentile(taus, [25, 75]).tolist(),
        "median_in_stated_interval": float(inside[both].mean()),
        "ratio_median": float(np.exp(np.median(ratios))),
        "ratio_95_percent": np.exp(np.percentile(ratios, [2.5, 97.5])).tolist(),
        "same_winner": {name: same for name, (same, _) in winners.items()},
        "cost_of_the_first_ones": {name: cost for name, (_, cost) in winners.items()},
    }


def _winners(
    tables: tuple[EvidenceTable, EvidenceTable],
    cells: tuple[Array, Array],
    times: tuple[Array, Array],
    policy: Policy,
) -> tuple[float, float]:
    """Share of instances with the same winner in both runs, and what the first's costs by the second's times.

    The cost is the mean over instances of its time there over that of the second run's own.
    """
    both = np.isfinite(times[0]) & np.isfinite(times[1])
    first, second = (
        policy.costs(ms, table.exceedance_px[at], table.ok[at] & both)
        for table, at, ms in zip(tables, cells, times, strict=True)
    )
    asked = np.flatnonzero(both.sum(axis=1) >= FEWEST)
    winner = first.argmin(axis=1)
    same = (winner == second.argmin(axis=1))[asked].mean()
    return float(same), float(second[asked, winner[asked]].mean())


def differing(tables: tuple[EvidenceTable, EvidenceTable], cells: tuple[Array, Array]) -> int:
    """How many error figures and counters that both know are not equal to the last bit."""
    count = 0
    for kind in ("figures", "counters"):
        ours, theirs = (getattr(one, kind) for one in tables)
        for name in set(ours) & set(theirs):
            first, second = ours[name][cells[0]], theirs[name][cells[1]]
            known = np.isfinite(first) & np.isfinite(second)
            count += int((first[known] != second[known]).sum())
    return count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("first")
    parser.add_argument("second")
    parser.add_argument("--json", action="store_true", dest="as_json")
    asked = parser.parse_args()
    tables = table_of(asked.first), table_of(asked.second)
    rows, other_rows, columns, other_columns = common(*tables)
    cells = np.ix_(rows, columns), np.ix_(other_rows, other_columns)
    result: dict[str, Any] = {
        str(mobility): of_mobility(tables, cells, mobility)  # type: ignore[arg-type]
        for mobility in Mobility
    }
    result["errors_and_counters_that_differ"] = differing(tables, cells)  # type: ignore[arg-type]
    if asked.as_json:
        Console().print_json(json.dumps(result))
        return
    shown = Table("figure", *(str(one) for one in Mobility))
    for name in result[str(Mobility.DYNAMIC)]:
        shown.add_row(name, *(_words(result[str(one)][name]) for one in Mobility))
    Console().print(shown)
    Console().print(f"errors and counters that differ: {result['errors_and_counters_that_differ']}")


def _words(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_words(one)}" for name, one in value.items())
    if isinstance(value, list):
        return " .. ".join(f"{one:.3g}" for one in value)
    return f"{value:.3g}"


if __name__ == "__main__":
    main()
