"""Times that no longer hold although neither code nor driver has changed: what a run says of those before it.

Nothing is deleted. A run whose remarks say that a technique's times of before no longer hold makes the
training table leave them out wherever the candidate has been timed again since; where it has not, they stay
until it is.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping

import numpy as np
import numpy.typing as npt
from sqlalchemy import Connection, select

from selector.evidence.schema import candidates, devices, runs, timings

_REMARK = re.compile(r"Times of (\w+) taken before (\S+) no longer hold\.")

Marks = Mapping[tuple[str, str], str]
"""(key of a device, id of a technique) -> the latest moment before which its times no longer hold."""


def remark(technique: str, before: str) -> str:
    """The sentence by which a run says so; `before` is UTC, ISO 8601."""
    return f"Times of {technique} taken before {before} no longer hold."


def latest(marked: Iterable[tuple[str, Collection[str]]]) -> Marks:
    """The marks among (key of a device, remarks of a run)."""
    found: dict[tuple[str, str], str] = {}
    for device, remarks in marked:
        for technique, before in _REMARK.findall(" ".join(remarks)):
            found[device, technique] = max(before, found.get((device, technique), ""))
    return found


def read_marks(connection: Connection, before: str | None = None) -> Marks:
    """The marks of all runs, or only of those that began before a moment."""
    query = (
        select(devices.c.key, runs.c.remarks)
        .select_from(
            timings.join(runs, runs.c.id == timings.c.run).join(devices, devices.c.id == timings.c.device)
        )
        .where(runs.c.remarks.contains("no longer hold"))
        .distinct()
    )
    if before is not None:
        query = query.where(runs.c.started < before)
    return latest((row[0], (row[1],)) for row in connection.execute(query))


def standing(
    connection: Connection,
    device: str,
    ids: npt.NDArray[np.int64],
    cells: npt.NDArray[np.int64],
    marks: Marks,
) -> npt.NDArray[np.bool_]:
    """(m,) which of a device's timings still hold, by their ids and cells of the table."""
    kept: npt.NDArray[np.bool_] = np.ones(len(ids), bool)
    mine = {technique: before for (key, technique), before in marks.items() if key == device}
    if not mine:
        return kept
    query = (
        select(timings.c.id, candidates.c.technique, runs.c.started)
        .join(runs, runs.c.id == timings.c.run)
        .join(candidates, candidates.c.id == timings.c.candidate)
        .where(candidates.c.technique.in_(sorted(mine)))
    )
    late = {row[0]: row[2] >= mine[row[1]] for row in connection.execute(query)}
    is_late = np.array([late.get(number, True) for number in ids.tolist()], bool)
    again = np.isin(cells, cells[is_late])
    standing: npt.NDArray[np.bool_] = is_late | ~again
    return standing
