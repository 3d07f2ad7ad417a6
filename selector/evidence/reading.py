"""What is in a store, row by row, in the same order in every store that holds the same."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import groupby
from operator import itemgetter
from typing import Any, TypedDict, Unpack

from sqlalchemy import Column, Connection, FromClause, RowMapping, Select, Table, func, select

from selector.evidence.numbering import Vocabularies
from selector.evidence.packing import unpacked, unpacked_counts, unpacked_floats
from selector.evidence.records import MOBILITIES, candidate_row, device_row, instance_row, run_row
from selector.evidence.rows import (
    Asked,
    CandidateRow,
    DeviceRow,
    InstanceRow,
    Judgement,
    Role,
    RunRow,
    SampleRow,
    Timing,
)
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
from selector.measurement import Status, Truth

_AT_ONCE = 2000


class Narrower(TypedDict, total=False):
    """Which facts about a device are wanted: those for which all holds that is given.

    Attributes:
        codes: Hashes of the code, any of these.
        role: What the instance may be used for.
        family: What the instance belongs to.
        technique: Id of the candidate's technique.
        instance: Key of the instance.
        run: Key of the run that found it out.
        before: UTC, ISO 8601: the run began earlier.
    """

    codes: Collection[str]
    role: Role
    family: str
    technique: str
    instance: str
    run: str
    before: str


class Only(Narrower, total=False):
    """The same of facts about any device.

    Attributes:
        device: Key of the device.
    """

    device: str


def read_instances(
    connection: Connection, role: Role | None = None, family: str | None = None
) -> Iterator[InstanceRow]:
    """Every instance, in the order of families, scenes and keys."""
    query = select(instances).order_by(instances.c.family, instances.c.scene, instances.c.key)
    if role is not None:
        query = query.where(instances.c.role == str(role))
    if family is not None:
        query = query.where(instances.c.family == family)
    return (instance_row(record) for record in _mappings(connection, query))


def read_candidates(connection: Connection) -> Iterator[CandidateRow]:
    """Every candidate, in the order of techniques and settings."""
    query = select(candidates).order_by(candidates.c.technique, candidates.c.settings)
    return (candidate_row(record) for record in _mappings(connection, query))


def read_devices(connection: Connection) -> Iterator[DeviceRow]:
    """Every device, real ones first."""
    query = select(devices).order_by(devices.c.virtual, devices.c.renderer, devices.c.key)
    return (device_row(record) for record in _mappings(connection, query))


def read_runs(connection: Connection) -> Iterator[RunRow]:
    """Every run, the oldest first."""
    query = select(runs).order_by(runs.c.started, runs.c.key)
    return (run_row(record) for record in _mappings(connection, query))


def read_judgements(connection: Connection, **only: Unpack[Only]) -> Iterator[Judgement]:
    """Judgements in the order of what they are about."""
    words = Vocabularies(connection)
    columns = [column for column in judgements.c if not column.primary_key]
    query = narrowed(select(*_KEYS, *columns).select_from(joined(judgements)), **only).order_by(*_KEYS)
    for record in _mappings(connection, query):
        yield Judgement(
            asked=_asked(record),
            run=record["run_key"],
            status=Status(record["status"]),
            reason=record["reason"],
            memory_bytes=record["memory_bytes"],
            truth=Truth(record["truth"]),
            fallback=record["fallback"],
            figures=unpacked_floats(words.names(record["figure_names"]), record["figures"]),
            counters=unpacked_counts(words.names(record["counter_names"]), record["counters"]),
        )


def read_timings(connection: Connection, **only: Unpack[Only]) -> Iterator[Timing]:
    """Timings with all their samples, in the order of what they are about and of runs."""
    words = Vocabularies(connection)
    source = joined(timings).outerjoin(samples, samples.c.timing == timings.c.id)
    columns = (timings.c.id, timings.c.status, timings.c.reason, *samples.c)
    query = narrowed(select(*_KEYS, *columns).select_from(source), **only)
    query = query.order_by(*_KEYS, samples.c.round, samples.c.mobility)
    for _, group in groupby(_mappings(connection, query), itemgetter("id")):
        records = list(group)
        first = records[0]
        yield Timing(
            asked=_asked(first),
            run=first["run_key"],
            status=Status(first["status"]),
            reason=first["reason"],
            samples=tuple(_sample(words, record) for record in records if record["round"] is not None),
        )


def read_judged(connection: Connection, **only: Unpack[Only]) -> set[tuple[str, str]]:
    """(instance key, candidate key) of every judgement, failed ones too."""
    query = narrowed(select(instances.c.key, candidates.c.key).select_from(joined(judgements)), **only)
    return {(row[0], row[1]) for row in connection.execute(query)}


def read_timed(connection: Connection, **only: Unpack[Only]) -> dict[tuple[str, str], int]:
    """(instance key, candidate key) -> rounds over all runs; 0 where it failed before the first."""
    rounds = (
        select(samples.c.timing, func.count(samples.c.round.distinct()).label("rounds"))
        .group_by(samples.c.timing)
        .subquery()
    )
    source = joined(timings).outerjoin(rounds, rounds.c.timing == timings.c.id)
    query = select(instances.c.key, candidates.c.key, func.coalesce(func.sum(rounds.c.rounds), 0))
    query = narrowed(query.select_from(source), **only).group_by(instances.c.key, candidates.c.key)
    return {(row[0], row[1]): int(row[2]) for row in connection.execute(query)}


def read_names(connection: Connection) -> dict[str, tuple[str, ...]]:
    """Every name that values have: of a `figure`, `counter`, `stage`, `feature` or `cost`."""
    words = Vocabularies(connection)
    columns: dict[str, Column[int]] = {
        "figure": judgements.c.figure_names,
        "counter": judgements.c.counter_names,
        "stage": samples.c.stage_names,
        "feature": features.c.value_names,
        "cost": features.c.cost_names,
    }
    return {
        kind: tuple(
            sorted(
                {
                    name
                    for number in connection.scalars(select(column).distinct())
                    for name in words.names(number)
                }
            )
        )
        for kind, column in columns.items()
    }


def joined(facts: Table) -> FromClause:
    """Judgements or timings, each with everything that it names."""
    source: FromClause = facts
    for column, table in (
        ("instance", instances),
        ("candidate", candidates),
        ("device", devices),
        ("code", codes),
        ("run", runs),
    ):
        source = source.join(table, table.c.id == facts.c[column])
    return source


def narrowed(query: Select[Any], **only: Unpack[Only]) -> Select[Any]:
    """Only the facts for which all holds that is given."""
    if "codes" in only:
        query = query.where(codes.c.key.in_(list(only["codes"])))
    columns: dict[str, Column[str]] = {
        "device": devices.c.key,
        "role": instances.c.role,
        "family": instances.c.family,
        "technique": candidates.c.technique,
        "instance": instances.c.key,
        "run": runs.c.key,
    }
    for name, column in columns.items():
        if name in only:
            query = query.where(column.in_([str(only[name])]))  # type: ignore[literal-required]
    if "before" in only:
        query = query.where(runs.c.started < only["before"])
    return query


_KEYS = (
    instances.c.key.label("instance_key"),
    candidates.c.key.label("candidate_key"),
    devices.c.key.label("device_key"),
    codes.c.key.label("code_key"),
    runs.c.key.label("run_key"),
)


def _asked(record: RowMapping) -> Asked:
    return Asked(record["instance_key"], record["candidate_key"], record["device_key"], record["code_key"])


def _sample(words: Vocabularies, record: RowMapping) -> SampleRow:
    return SampleRow(
        round=record["round"],
        mobility=MOBILITIES[record["mobility"]],
        shadow_ms=record["shadow_ms"],
        frame_ms=record["frame_ms"],
        canary_ms=record["canary_ms"],
        stages_ms=unpacked(words.names(record["stage_names"]), record["stages_ms"]),
    )


def _mappings(connection: Connection, query: Select[Any]) -> Iterator[RowMapping]:
    return iter(connection.execution_options(yield_per=_AT_ONCE).execute(query).mappings())
