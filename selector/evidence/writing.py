"""What is added to a store in one transaction. What is there stays, so adding twice is adding once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import Connection, Table, select

from selector.evidence.numbering import Record, Vocabularies, insert_new, inserting, numbers
from selector.evidence.packing import packed_counts, packed_floats
from selector.evidence.records import (
    MOBILITIES,
    candidate_record,
    device_record,
    instance_record,
    run_record,
)
from selector.evidence.rows import (
    Asked,
    CandidateRow,
    DeviceRow,
    InstanceRow,
    Judgement,
    RunRow,
    SampleRow,
    Timing,
)
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


@dataclass(frozen=True)
class Batch:
    """Rows that are added together; judgements and timings may name only what is here or in the store."""

    runs: Sequence[RunRow] = ()
    devices: Sequence[DeviceRow] = ()
    instances: Sequence[InstanceRow] = ()
    candidates: Sequence[CandidateRow] = ()
    judgements: Sequence[Judgement] = ()
    timings: Sequence[Timing] = ()


def write(connection: Connection, batch: Batch) -> None:
    """Adds what is not there yet.

    Where the store knows better, it keeps what it knows: a judgement that failed gives way to one that did
    not, and a timing that failed in the end has failed.

    Raises:
        StoreError: A row names what neither the batch nor the store holds.
    """
    insert_new(connection, runs, [run_record(row) for row in batch.runs])
    insert_new(connection, devices, [device_record(row) for row in batch.devices])
    insert_new(connection, instances, [instance_record(row) for row in batch.instances])
    insert_new(connection, candidates, [candidate_record(row) for row in batch.candidates])
    facts: list[Judgement | Timing] = [*batch.judgements, *batch.timings]
    if not facts:
        return
    insert_new(connection, codes, [{"key": key} for key in dict.fromkeys(fact.asked.code for fact in facts)])
    known = _Known(connection, facts)
    words = Vocabularies(connection)
    if batch.judgements:
        _write_judgements(connection, known, words, batch.judgements)
    if batch.timings:
        _write_timings(connection, known, words, batch.timings)


class _Known:
    """The numbers of everything that some facts name."""

    def __init__(self, connection: Connection, facts: Sequence[Judgement | Timing]) -> None:
        def found(table: Table, keys: Sequence[str]) -> dict[str, int]:
            return numbers(connection, table, keys)

        self.instances = found(instances, [fact.asked.instance for fact in facts])
        self.candidates = found(candidates, [fact.asked.candidate for fact in facts])
        self.devices = found(devices, [fact.asked.device for fact in facts])
        self.codes = found(codes, [fact.asked.code for fact in facts])
        self.runs = found(runs, [fact.run for fact in facts])

    def asked(self, asked: Asked) -> Record:
        return {
            "device": self.devices[asked.device],
            "code": self.codes[asked.code],
            "instance": self.instances[asked.instance],
            "candidate": self.candidates[asked.candidate],
        }


def _write_judgements(
    connection: Connection, known: _Known, words: Vocabularies, rows: Sequence[Judgement]
) -> None:
    insert = inserting(connection, judgements)
    asked = {column.name for column in judgements.primary_key}
    better = insert.on_conflict_do_update(
        index_elements=list(judgements.primary_key),
        set_={
            column.name: insert.excluded[column.name] for column in judgements.c if column.name not in asked
        },
        where=(judgements.c.status != str(Status.OK)) & (insert.excluded.status == str(Status.OK)),
    )
    connection.execute(better, [_judgement_record(known, words, row) for row in rows])


def _judgement_record(known: _Known, words: Vocabularies, row: Judgement) -> Record:
    figure_names, figures = packed_floats(row.figures)
    counter_names, counters = packed_counts(row.counters)
    return {
        **known.asked(row.asked),
        "run": known.runs[row.run],
        "status": str(row.status),
        "reason": row.reason,
        "truth": str(row.truth),
        "fallback": row.fallback,
        "memory_bytes": row.memory_bytes,
        "figure_names": words.number(figure_names),
        "figures": figures,
        "counter_names": words.number(counter_names),
        "counters": counters,
    }


def _write_timings(
    connection: Connection, known: _Known, words: Vocabularies, rows: Sequence[Timing]
) -> None:
    records = [
        {
            **known.asked(row.asked),
            "run": known.runs[row.run],
            "status": str(row.status),
            "reason": row.reason,
        }
        for row in rows
    ]
    insert = inserting(connection, timings)
    failed = insert.on_conflict_do_update(
        index_elements=[timings.c[name] for name in _TIMING_KEY],
        set_={"status": insert.excluded.status, "reason": insert.excluded.reason},
        where=(timings.c.status == str(Status.OK)) & (insert.excluded.status != str(Status.OK)),
    )
    connection.execute(failed, records)
    numbered = _timing_numbers(connection, known)
    taken = [
        _sample_record(numbered[tuple(record[name] for name in _TIMING_KEY)], words, sample)
        for record, row in zip(records, rows, strict=True)
        for sample in row.samples
    ]
    insert_new(connection, samples, taken)


_TIMING_KEY = ("device", "code", "instance", "candidate", "run")


def _timing_numbers(connection: Connection, known: _Known) -> dict[tuple[int, ...], int]:
    """(device, code, instance, candidate, run) -> number, for all that these facts may be about."""
    wanted = list(known.instances.values())
    found: dict[tuple[int, ...], int] = {}
    for start in range(0, len(wanted), 500):
        some = timings.c.instance.in_(wanted[start : start + 500])
        ours = timings.c.run.in_(list(known.runs.values()))
        for *key, number in connection.execute(
            select(*(timings.c[name] for name in _TIMING_KEY), timings.c.id).where(some, ours)
        ):
            found[tuple(key)] = number
    return found


def _sample_record(timing: int, words: Vocabularies, sample: SampleRow) -> Record:
    names, stages = packed_floats(sample.stages_ms)
    return {
        "timing": timing,
        "round": sample.round,
        "mobility": MOBILITIES.index(sample.mobility),
        "shadow_ms": sample.shadow_ms,
        "frame_ms": sample.frame_ms,
        "canary_ms": sample.canary_ms,
        "stage_names": words.number(names),
        "stages_ms": stages,
    }
