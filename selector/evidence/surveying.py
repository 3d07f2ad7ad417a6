"""What is in a store, counted by the database."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

from sqlalchemy import Column, ColumnElement, Connection, Table, case, func, select

from selector.evidence.reading import joined
from selector.evidence.schema import (
    candidates,
    codes,
    devices,
    instances,
    judgements,
    runs,
    samples,
    timings,
)
from selector.measurement import Status

Key = tuple[str, ...]


@dataclass(frozen=True)
class Counts:
    """How many facts there are, and how many of them are not ok."""

    judgements: int = 0
    judgements_failed: int = 0
    timings: int = 0
    timings_failed: int = 0
    samples: int = 0


@dataclass(frozen=True)
class Survey:
    """Counts.

    Attributes:
        techniques: (device key, technique, code) -> facts.
        families: (family, role) -> facts.
        instances: (family, role) -> instances.
        runs: Run key -> facts.
    """

    techniques: dict[Key, Counts]
    families: dict[Key, Counts]
    instances: dict[Key, int]
    runs: dict[str, Counts]


def survey(connection: Connection) -> Survey:
    """Counts everything."""
    family = (instances.c.family, instances.c.role)
    how_many = connection.execute(select(*family, func.count()).group_by(*family).order_by(*family))
    return Survey(
        techniques=_counts(connection, devices.c.key, candidates.c.technique, codes.c.key),
        families=_counts(connection, *family),
        instances={(row[0], row[1]): row[2] for row in how_many},
        runs={key: counts for (key,), counts in _counts(connection, runs.c.key).items()},
    )


def _counts(connection: Connection, *by: Column[str]) -> dict[Key, Counts]:
    taken = select(samples.c.timing, func.count().label("taken")).group_by(samples.c.timing).subquery()
    judged = select(*by, func.count(), _failed(judgements)).select_from(joined(judgements)).group_by(*by)
    timed = (
        select(*by, func.count(), _failed(timings), func.coalesce(func.sum(taken.c.taken), 0))
        .select_from(joined(timings).outerjoin(taken, taken.c.timing == timings.c.id))
        .group_by(*by)
    )
    found: defaultdict[Key, list[int]] = defaultdict(lambda: [0] * 5)
    for row in connection.execute(judged):
        found[tuple(row[: len(by)])][:2] = map(int, row[len(by) :])
    for row in connection.execute(timed):
        found[tuple(row[: len(by)])][2:] = map(int, row[len(by) :])
    return {key: Counts(*found[key]) for key in sorted(found)}


def _failed(facts: Table) -> ColumnElement[int]:
    return func.sum(case((facts.c.status != str(Status.OK), 1), else_=0))
