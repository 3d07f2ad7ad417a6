"""Facts by the column, and the frame of instances and candidates that they fill."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self, Unpack

import numpy as np
import numpy.typing as npt
from sqlalchemy import Column, ColumnElement, Connection, Table, select

from selector.evidence.reading import Narrower, joined, narrowed
from selector.evidence.records import candidate_row, instance_row
from selector.evidence.rows import CandidateRow, InstanceRow
from selector.evidence.schema import candidates, instances, judgements, runs, timings
from selector.evidence.table import STATUSES, Codes, Floats, Numbers

_STATUS_NUMBERS = {str(status): number for number, status in enumerate(STATUSES)}
_JUDGED = ("memory_bytes", "figure_names", "figures", "counter_names", "counters")


@dataclass(frozen=True)
class Facts:
    """Facts of one kind, the oldest first. All arrays have one entry a fact.

    Attributes:
        instance: Number in the store.
        candidate: Number in the store.
        code: Number in the store.
        status: Which of `STATUSES`.
        more: Other columns by name, as objects.
    """

    instance: Numbers
    candidate: Numbers
    code: Numbers
    status: Codes
    more: Mapping[str, npt.NDArray[Any]]

    def kept(self, which: Numbers | npt.NDArray[np.bool_]) -> Facts:
        """Some of them, by index or mask."""
        more = {name: values[which] for name, values in self.more.items()}
        return Facts(self.instance[which], self.candidate[which], self.code[which], self.status[which], more)

    def and_then(self, others: Facts) -> Facts:
        """These and others of the same kind."""
        return Facts(
            np.append(self.instance, others.instance),
            np.append(self.candidate, others.candidate),
            np.append(self.code, others.code),
            np.append(self.status, others.status),
            {name: np.append(values, others.more[name]) for name, values in self.more.items()},
        )


@dataclass(frozen=True)
class Frame:
    """The rows and columns of a table, and where facts belong in it.

    Attributes:
        instances: The rows.
        candidates: The columns.
        row_of: Number of an instance in the store -> row; -1 for those that are none.
        column_of: Number of a candidate in the store -> column; -1 likewise.
    """

    instances: tuple[InstanceRow, ...]
    candidates: tuple[CandidateRow, ...]
    row_of: Numbers
    column_of: Numbers

    @classmethod
    def of(cls, connection: Connection, *some: Facts) -> Self:
        """What these facts are about."""
        rows, row_of = _named(
            connection,
            instances,
            (instances.c.family, instances.c.scene, instances.c.key),
            np.concatenate([facts.instance for facts in some]),
        )
        columns, column_of = _named(
            connection,
            candidates,
            (candidates.c.technique, candidates.c.settings),
            np.concatenate([facts.candidate for facts in some]),
        )
        return cls(tuple(map(instance_row, rows)), tuple(map(candidate_row, columns)), row_of, column_of)

    @property
    def shape(self) -> tuple[int, int]:
        """(n, k)."""
        return len(self.instances), len(self.candidates)

    @property
    def size(self) -> int:
        """How many cells there are."""
        return len(self.instances) * len(self.candidates)

    def knows(self, facts: Facts) -> npt.NDArray[np.bool_]:
        """Which facts belong in it."""
        known: npt.NDArray[np.bool_] = (self.row_of[facts.instance] >= 0) & (
            self.column_of[facts.candidate] >= 0
        )
        return known

    def cells(self, facts: Facts) -> Numbers:
        """Where each fact belongs: row * k + column."""
        cells: Numbers = self.row_of[facts.instance] * len(self.candidates) + self.column_of[facts.candidate]
        return cells


def judged_facts(connection: Connection, where: ColumnElement[bool], **only: Unpack[Narrower]) -> Facts:
    """Judgements with memory, figures and counters, still packed."""
    return _facts(connection, judgements, [judgements.c[name] for name in _JUDGED], where, **only)


def timed_facts(connection: Connection, where: ColumnElement[bool], **only: Unpack[Narrower]) -> Facts:
    """Timings with their `id`."""
    return _facts(connection, timings, [timings.c.id], where, **only)


def newest(cells: Numbers) -> Numbers:
    """Indices of the last fact of each cell."""
    _, from_behind = np.unique(cells[::-1], return_index=True)
    last: Numbers = np.sort(len(cells) - 1 - from_behind)
    return last


def by_cell(cells: Numbers, values: Floats, shape: tuple[int, int]) -> Floats:
    """(n, k) the value of each cell, nan where there is none."""
    filled: Floats = np.full(shape, np.nan)
    filled.reshape(-1)[cells] = values
    return filled


def _facts(
    connection: Connection,
    table: Table,
    more: Sequence[Column[Any]],
    where: ColumnElement[bool],
    **only: Unpack[Narrower],
) -> Facts:
    named = (table.c.instance, table.c.candidate, table.c.code, table.c.status)
    query = narrowed(select(*named, *more).select_from(joined(table)).where(where), **only)
    rows = connection.execute(query.order_by(runs.c.started, runs.c.key)).all()
    columns = list(zip(*rows, strict=True)) or [()] * (len(named) + len(more))
    instance, candidate, code = (np.array(column, np.int64) for column in columns[:3])
    return Facts(
        instance,
        candidate,
        code,
        status=np.array([_STATUS_NUMBERS[status] for status in columns[3]], np.int8),
        more={
            column.name: _objects(values) for column, values in zip(more, columns[len(named) :], strict=True)
        },
    )


def _objects(values: Sequence[Any]) -> npt.NDArray[Any]:
    array = np.zeros(len(values), object)
    array[:] = values
    return array


def _named(
    connection: Connection, table: Table, order: Sequence[Column[Any]], numbers: Numbers
) -> tuple[list[Any], Numbers]:
    """Records of these numbers in an order, and number -> place in it."""
    wanted = set(numbers.tolist())
    every = connection.execute(select(table).order_by(*order)).mappings().all()
    records = [record for record in every if record["id"] in wanted]
    place = np.full(max((record["id"] for record in every), default=0) + 1, -1)
    place[[record["id"] for record in records]] = np.arange(len(records))
    return records, place
