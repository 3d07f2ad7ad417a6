"""Evidence as flat tables for files: each fact names what it is about by keys, each value has a column.

Values by name have a column each, such as `figure:edge_error_px`, and one column lists the names of the row:
so a figure that has no meaning in a view can be told from one that nobody looked for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import pyarrow as pa

from scenes.scene import Mobility
from selector.evidence.numbering import Record
from selector.evidence.packing import names_of, names_text
from selector.evidence.records import candidate_record, device_record, instance_record, run_record
from selector.evidence.rows import Asked, Judgement, SampleRow, Timing
from selector.evidence.store import Store
from selector.measurement import Status, Truth

KEYS = ("instance", "candidate", "device", "code", "run")
WHOLE = {"width", "height", "threads", "seed", "memory_bytes", "round"}
REAL = {"shadow_ms", "frame_ms", "canary_ms"}
FIGURE, COUNTER, STAGE, VALUE, COST = "figure", "counter", "stage", "feature", "cost"
KINDS = {
    FIGURE: pa.float64(),
    COUNTER: pa.int64(),
    STAGE: pa.float64(),
    VALUE: pa.float64(),
    COST: pa.float64(),
}


@dataclass(frozen=True)
class FlatTable:
    """One table of all evidence.

    Attributes:
        name: Of the file.
        columns: Those that every store has, in order.
        kinds: Of the values by name that follow.
        records: A store's rows.
    """

    name: str
    columns: tuple[str, ...]
    kinds: tuple[str, ...]
    records: Callable[[Store], Iterator[Record]]

    def schema(self, names: Mapping[str, tuple[str, ...]]) -> pa.Schema:
        """With a column for each of these names by kind."""
        fields = [(column, column_type(column)) for column in self.columns]
        for kind in self.kinds:
            fields += [(f"{kind}:{name}", KINDS[kind]) for name in names[kind]]
        return pa.schema([pa.field(name, what) for name, what in fields])


def column_type(column: str) -> pa.DataType:
    """What is in a column of this name."""
    if column in WHOLE:
        return pa.int64()
    return (
        pa.float64()
        if column in REAL
        else KINDS.get(column.partition(":")[0] if ":" in column else "", pa.string())
    )


def judgement_of(record: Mapping[str, Any]) -> Judgement:
    """What was written down."""
    return Judgement(
        asked=asked_of(record),
        run=record["run"],
        status=Status(record["status"]),
        reason=record["reason"],
        memory_bytes=record["memory_bytes"],
        truth=Truth(record["truth"]),
        fallback=record["fallback"],
        figures=gathered(FIGURE, record),
        counters=gathered(COUNTER, record),
    )


def timing_of(record: Mapping[str, Any]) -> Timing:
    """What was written down, without samples."""
    return Timing(asked_of(record), record["run"], Status(record["status"]), record["reason"])


def sample_of(record: Mapping[str, Any]) -> SampleRow:
    """What was written down."""
    times = (record["shadow_ms"], record["frame_ms"], record["canary_ms"])
    return SampleRow(record["round"], Mobility(record["mobility"]), *times, gathered(STAGE, record))


def asked_of(record: Mapping[str, Any]) -> Asked:
    """What a fact is about."""
    return Asked(record["instance"], record["candidate"], record["device"], record["code"])


def gathered(kind: str, record: Mapping[str, Any]) -> dict[str, Any]:
    """Values by name."""
    return {name: record[f"{kind}:{name}"] for name in names_of(record[f"{kind}_names"])}


def numbers_of(kind: str, record: Mapping[str, Any]) -> dict[str, float]:
    """The same, where what is missing is not a number."""
    return {name: math.nan if value is None else value for name, value in gathered(kind, record).items()}


def _spread(kind: str, values: Mapping[str, Any]) -> Record:
    columns = {f"{kind}:{name}": _present(value) for name, value in values.items()}
    return {f"{kind}_names": names_text(tuple(sorted(values))), **columns}


def _present(value: float | None) -> float | None:
    return None if value is None or math.isnan(value) else value


def _named(asked: Asked, run: str) -> Record:
    return dict(zip(KEYS, (asked.instance, asked.candidate, asked.device, asked.code, run), strict=True))


def _judgements(store: Store) -> Iterator[Record]:
    for row in store.judgements():
        yield {
            **_named(row.asked, row.run),
            "status": str(row.status),
            "reason": row.reason,
            "truth": str(row.truth),
            "fallback": row.fallback,
            "memory_bytes": row.memory_bytes,
            **_spread(FIGURE, row.figures),
            **_spread(COUNTER, row.counters),
        }


def _timings(store: Store) -> Iterator[Record]:
    for row in store.timings():
        yield {**_named(row.asked, row.run), "status": str(row.status), "reason": row.reason}


def _samples(store: Store) -> Iterator[Record]:
    for row in store.timings():
        named = _named(row.asked, row.run)
        for sample in row.samples:
            yield {
                **named,
                "round": sample.round,
                "mobility": str(sample.mobility),
                "shadow_ms": sample.shadow_ms,
                "frame_ms": sample.frame_ms,
                "canary_ms": sample.canary_ms,
                **_spread(STAGE, sample.stages_ms),
            }


def _features(store: Store) -> Iterator[Record]:
    for extractor in store.extractors():
        values, costs = store.features(extractor), store.feature_costs(extractor)
        for key, of_instance in values.items():
            named = {"extractor": extractor, "instance": key}
            yield {**named, **_spread(VALUE, of_instance), **_spread(COST, costs[key])}


FLAT_TABLES = {
    table.name: table
    for table in (
        FlatTable(
            "instances",
            (
                "key",
                "scene_digest",
                "scene",
                "family",
                "origin",
                "role",
                "light",
                "camera",
                "width",
                "height",
            ),
            (),
            lambda store: map(instance_record, store.instances()),
        ),
        FlatTable(
            "candidates",
            ("key", "technique", "settings"),
            (),
            lambda store: map(candidate_record, store.candidates()),
        ),
        FlatTable(
            "devices",
            ("key", "renderer", "vendor", "gl_version", "clock", "processor", "threads", "virtual"),
            (),
            lambda store: map(device_record, store.devices()),
        ),
        FlatTable(
            "runs",
            ("key", "started", "commit", "purpose", "seed", "remarks"),
            (),
            lambda store: map(run_record, store.runs()),
        ),
        FlatTable(
            "judgements",
            (*KEYS, "status", "reason", "truth", "fallback", "memory_bytes", "figure_names", "counter_names"),
            (FIGURE, COUNTER),
            _judgements,
        ),
        FlatTable("timings", (*KEYS, "status", "reason"), (), _timings),
        FlatTable(
            "samples",
            (*KEYS, "round", "mobility", "shadow_ms", "frame_ms", "canary_ms", "stage_names"),
            (STAGE,),
            _samples,
        ),
        FlatTable(
            "features", ("extractor", "instance", "feature_names", "cost_names"), (VALUE, COST), _features
        ),
    )
}
"""In an order in which each names only what comes before it."""
