"""The training join: the facts of one device, gathered into arrays."""

from __future__ import annotations

from itertools import chain
from typing import Unpack

import numpy as np
from sqlalchemy import Connection, select

from selector.evidence.columns import Facts, Frame, by_cell, judged_facts, newest, timed_facts
from selector.evidence.numbering import Vocabularies
from selector.evidence.packing import Names
from selector.evidence.reading import Narrower
from selector.evidence.records import MOBILITIES
from selector.evidence.schema import devices, samples, timings
from selector.evidence.summing_up import Samples, summed_up
from selector.evidence.superseding import read_marks, standing
from selector.evidence.table import STATUSES, UNKNOWN, Codes, EvidenceTable, Floats, Numbers
from selector.measurement import Status

_OK = STATUSES.index(Status.OK)


def read_table(connection: Connection, device: str, **only: Unpack[Narrower]) -> EvidenceTable:
    """Everything that is known of a device's times, with errors and counters; newer facts hide older ones."""
    timed = timed_facts(connection, devices.c.key == device, **only)
    own = judged_facts(connection, devices.c.key == device, **only)
    frame = Frame.of(connection, timed, own)
    judged = _with_borrowed(connection, device, frame, timed, own, **only)
    cells = frame.cells(judged)
    words = Vocabularies(connection)
    timed = timed.kept(_of_newest_code(timed, frame))
    marks = read_marks(connection, only.get("before"))
    timed = timed.kept(
        standing(connection, device, timed.more["id"].astype(np.int64), frame.cells(timed), marks)
    )
    times, canary_ms = summed_up(_samples(connection, device, timed, frame), frame.shape)
    return EvidenceTable(
        instances=frame.instances,
        candidates=frame.candidates,
        status=_status(frame, own, timed),
        times=dict(zip(MOBILITIES, times, strict=True)),
        figures=_by_name(judged.more["figure_names"], judged.more["figures"], "<f8", cells, frame, words),
        counters=_by_name(judged.more["counter_names"], judged.more["counters"], "<i8", cells, frame, words),
        memory_bytes=by_cell(cells, judged.more["memory_bytes"].astype(np.float64), frame.shape),
        canary_ms=canary_ms,
    )


def _with_borrowed(
    connection: Connection,
    device: str,
    frame: Frame,
    timed: Facts,
    own: Facts,
    **only: Unpack[Narrower],
) -> Facts:
    """One judgement a cell: its own device's newest, else any device's where it was only timed."""
    own = own.kept(newest(frame.cells(own)))
    lacking = np.setdiff1d(frame.cells(timed), frame.cells(own))
    if not len(lacking):
        return own
    others = judged_facts(connection, devices.c.key != device, **only)
    others = others.kept(frame.knows(others) & (others.status == _OK))
    others = others.kept(np.isin(frame.cells(others), lacking))
    return own.and_then(others.kept(newest(frame.cells(others))))


def _of_newest_code(timed: Facts, frame: Frame) -> Numbers:
    """Which timings are of the same code as the newest of their cell."""
    cells = frame.cells(timed)
    code = np.zeros(frame.size, np.int64)
    code[cells] = timed.code  # Facts come oldest first, and the last one stays.
    return np.flatnonzero(code[cells] == timed.code)


def _status(frame: Frame, own: Facts, timed: Facts) -> Codes:
    """(n, k) the judgement's failure, else the timing's."""
    status = np.full(frame.size, UNKNOWN, np.int8)
    judged = status.copy()
    judged[frame.cells(own)] = own.status
    status[frame.cells(timed)] = timed.status
    known = (judged != UNKNOWN) & ((judged != _OK) | (status == UNKNOWN))
    status[known] = judged[known]
    return status.reshape(frame.shape)


def _samples(connection: Connection, device: str, timed: Facts, frame: Frame) -> Samples:
    """All samples of these timings."""
    columns = (samples.c.timing, samples.c.mobility, samples.c.shadow_ms, samples.c.canary_ms)
    query = (
        select(*columns)
        .join(timings, timings.c.id == samples.c.timing)
        .join(devices, devices.c.id == timings.c.device)
        .where(devices.c.key == device)
    )
    rows = connection.execution_options(yield_per=10_000).execute(query)
    numbers = np.fromiter(chain.from_iterable(rows), np.float64).reshape(-1, len(columns))
    ids = timed.more["id"].astype(np.int64)
    cell_of = np.full(max(int(numbers[:, 0].max(initial=0)), int(ids.max(initial=0))) + 1, -1)
    cell_of[ids] = frame.cells(timed)
    cells = cell_of[numbers[:, 0].astype(np.int64)]
    numbers, cells = numbers[cells >= 0], cells[cells >= 0]
    return Samples(cells, numbers[:, 1].astype(np.int64), numbers[:, 2], numbers[:, 3])


def _by_name(
    vocabularies: Numbers, packed: Numbers, kind: str, cells: Numbers, frame: Frame, words: Vocabularies
) -> dict[str, Floats]:
    """Name -> (n, k), nan where the name has no value."""
    found: dict[str, Floats] = {}
    for number in np.unique(vocabularies):
        names: Names = words.names(int(number))
        of_these = vocabularies == number
        values = np.frombuffer(b"".join(packed[of_these]), kind).reshape(int(of_these.sum()), len(names))
        for column, name in enumerate(names):
            of_name = found.setdefault(name, np.full(frame.shape, np.nan))
            of_name.reshape(-1)[cells[of_these]] = values[:, column]
    return dict(sorted(found.items()))
