"""What is of no more use, taken out of a store."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import Connection, Select, Table, and_, delete, false, not_, or_, select, true
from sqlalchemy.sql import ColumnElement

from selector.evidence.schema import (
    candidates,
    codes,
    devices,
    features,
    instances,
    judgements,
    runs,
    samples,
    timings,
)

_AT_ONCE = 500


@dataclass(frozen=True)
class Useless:
    """Which facts are to go: those for which all holds that is said.

    Attributes:
        current: Technique -> hash of its code today; what is of any other code goes.
        before: UTC, ISO 8601; what an earlier run found out goes.
        device: Key of a device; what was measured on it goes.
    """

    current: Mapping[str, str] | None = None
    before: str | None = None
    device: str | None = None


@dataclass(frozen=True)
class Pruned:
    """How many rows went, by table."""

    judgements: int
    timings: int
    samples: int
    instances: int
    runs: int
    devices: int


def prune(connection: Connection, useless: Useless) -> Pruned:
    """Takes facts out, and then what nothing else is about: instances with their features, runs, devices."""
    touched = _touched(connection, useless)
    doomed = select(timings.c.id).where(_holds(timings, useless))
    gone_samples = connection.execute(delete(samples).where(samples.c.timing.in_(doomed))).rowcount
    gone_timings = connection.execute(delete(timings).where(_holds(timings, useless))).rowcount
    gone_judgements = connection.execute(delete(judgements).where(_holds(judgements, useless))).rowcount
    orphans = sorted(touched - _used(connection, "instance"))
    for start in range(0, len(orphans), _AT_ONCE):
        some = orphans[start : start + _AT_ONCE]
        connection.execute(delete(features).where(features.c.instance.in_(some)))
        connection.execute(delete(instances).where(instances.c.id.in_(some)))
    for table, column in ((codes, "code"), (candidates, "candidate")):
        _drop_unused(connection, table, column)
    return Pruned(
        judgements=gone_judgements,
        timings=gone_timings,
        samples=gone_samples,
        instances=len(orphans),
        runs=_drop_unused(connection, runs, "run"),
        devices=_drop_unused(connection, devices, "device"),
    )


def _holds(facts: Table, useless: Useless) -> ColumnElement[bool]:
    """Whether all holds that is said of what is to go."""
    conditions: list[ColumnElement[bool]] = [true()]
    if useless.device is not None:
        conditions.append(facts.c.device.in_(_numbers(devices, devices.c.key == useless.device)))
    if useless.before is not None:
        conditions.append(facts.c.run.in_(_numbers(runs, runs.c.started < useless.before)))
    if useless.current is not None:
        fresh = [
            facts.c.candidate.in_(_numbers(candidates, candidates.c.technique == technique))
            & facts.c.code.in_(_numbers(codes, codes.c.key == code))
            for technique, code in useless.current.items()
        ]
        conditions.append(not_(or_(false(), *fresh)))
    return and_(*conditions)


def _numbers(table: Table, condition: ColumnElement[bool]) -> Select[tuple[int]]:
    return select(table.c.id).where(condition)


def _touched(connection: Connection, useless: Useless) -> set[int]:
    """Instances that something is to be taken from."""
    return {
        number
        for facts in (judgements, timings)
        for number in connection.scalars(select(facts.c.instance).where(_holds(facts, useless)).distinct())
    }


def _used(connection: Connection, column: str) -> set[int]:
    return {
        number
        for facts in (judgements, timings)
        for number in connection.scalars(select(facts.c[column]).distinct())
    }


def _drop_unused(connection: Connection, table: Table, column: str) -> int:
    unused = sorted(set(connection.scalars(select(table.c.id))) - _used(connection, column))
    for start in range(0, len(unused), _AT_ONCE):
        connection.execute(delete(table).where(table.c.id.in_(unused[start : start + _AT_ONCE])))
    return len(unused)
