"""Files as evidence: what `exporting.py` writes, of any store, is added to another. Nothing is doubled."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby, islice
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import csv, parquet

from selector.evidence.exporting import FileFormat
from selector.evidence.flat_tables import (
    COST,
    FLAT_TABLES,
    KEYS,
    VALUE,
    column_type,
    judgement_of,
    numbers_of,
    sample_of,
    timing_of,
)
from selector.evidence.records import candidate_row, device_row, instance_row, run_row
from selector.evidence.rows import Timing
from selector.evidence.store import Store
from selector.evidence.store_error import StoreError
from selector.evidence.writing import Batch

_ROWS_AT_ONCE = 2000
_REMEDY = "Import what `gnomon evidence export` wrote."

Records = Iterator[Mapping[str, Any]]


def bring_in(store: Store, paths: Sequence[Path]) -> None:
    """Adds what is in some files, and in the folders among these.

    Raises:
        StoreError: A file is no table of evidence, is damaged, or names what neither it nor the store holds;
            or the store cannot be written. What was added by then stays.
    """
    files = _by_table(paths)
    for table, path in files:
        try:
            _ADDING[table](store, path, files)
        except (pa.ArrowException, OSError, KeyError, TypeError, ValueError, AttributeError) as error:
            what = "This file is no table of evidence, or it is damaged."
            raise StoreError(what, where=str(path), known=f"{error}", remedy=_REMEDY) from error


def _by_table(paths: Sequence[Path]) -> list[tuple[str, Path]]:
    """(table, file) in an order in which each names only what comes before it."""
    found: list[tuple[str, Path]] = []
    for path in paths:
        some = sorted(path.iterdir()) if path.is_dir() else [path]
        tables = [one for one in some if one.stem in FLAT_TABLES and one.suffix[1:] in set(FileFormat)]
        if not tables:
            what = "There is no such file." if not path.exists() else "There is no evidence here."
            known = f"Files of evidence are called {', '.join(FLAT_TABLES)}, and end in .parquet or .csv."
            raise StoreError(what, where=str(path), known=known, remedy=_REMEDY)
        found += [(one.stem, one) for one in tables]
    order = list(FLAT_TABLES)
    return sorted(found, key=lambda pair: order.index(pair[0]))


def _instances(store: Store, path: Path, _: object) -> None:
    for records in _chunks(path):
        rows = [instance_row(record) for record in records]
        _require_keys(path, records, [row.key for row in rows])
        store.add_batch(Batch(instances=rows))


def _candidates(store: Store, path: Path, _: object) -> None:
    for records in _chunks(path):
        rows = [candidate_row(record) for record in records]
        _require_keys(path, records, [row.key for row in rows])
        store.add_batch(Batch(candidates=rows))


def _devices(store: Store, path: Path, _: object) -> None:
    for records in _chunks(path):
        rows = [device_row(record) for record in records]
        _require_keys(path, records, [row.key for row in rows])
        store.add_batch(Batch(devices=rows))


def _runs(store: Store, path: Path, _: object) -> None:
    for records in _chunks(path):
        store.add_batch(Batch(runs=[run_row(record) for record in records]))


def _judgements(store: Store, path: Path, _: object) -> None:
    for records in _chunks(path):
        store.add_batch(Batch(judgements=[judgement_of(record) for record in records]))


def _timings(store: Store, path: Path, _: object) -> None:
    for records in _chunks(path):
        store.add_batch(Batch(timings=[timing_of(record) for record in records]))


def _samples(store: Store, path: Path, files: Sequence[tuple[str, Path]]) -> None:
    """Samples of one timing lie together; how it ended is in the table of timings."""
    told = {
        _key(record): timing_of(record)
        for table, other in files
        if table == "timings"
        for records in _chunks(other)
        for record in records
    }
    groups = groupby((record for records in _chunks(path) for record in records), _key)
    while some := [(key, list(records)) for key, records in islice(groups, _ROWS_AT_ONCE)]:
        store.add_batch(Batch(timings=[_timed(path, told, key, records) for key, records in some]))


def _timed(
    path: Path, told: Mapping[tuple[str, ...], Timing], key: tuple[str, ...], records: list[Mapping[str, Any]]
) -> Timing:
    if key not in told:
        known = f"That of candidate {key[1]} for instance {key[0]} is not among the timings."
        raise StoreError("A sample belongs to no timing.", where=str(path), known=known, remedy=_REMEDY)
    return replace(told[key], samples=tuple(sample_of(record) for record in records))


def _features(store: Store, path: Path, _: object) -> None:
    for records in _chunks(path):
        for extractor in dict.fromkeys(record["extractor"] for record in records):
            some = [record for record in records if record["extractor"] == extractor]
            store.add_features(
                extractor,
                {record["instance"]: numbers_of(VALUE, record) for record in some},
                {record["instance"]: numbers_of(COST, record) for record in some},
            )


_ADDING = {
    "instances": _instances,
    "candidates": _candidates,
    "devices": _devices,
    "runs": _runs,
    "judgements": _judgements,
    "timings": _timings,
    "samples": _samples,
    "features": _features,
}


def _chunks(path: Path) -> Iterator[list[Mapping[str, Any]]]:
    for batch in _batches(path):
        if batch.num_rows:
            yield batch.to_pylist()


def _batches(path: Path) -> Iterator[pa.RecordBatch]:
    if path.suffix == f".{FileFormat.PARQUET}":
        with parquet.ParquetFile(path) as file:
            yield from file.iter_batches(_ROWS_AT_ONCE)
        return
    with path.open(encoding="utf-8") as file:
        names = file.readline().rstrip("\n").replace('"', "").split(",")
    parsing = csv.ParseOptions(newlines_in_values=True)
    converting = csv.ConvertOptions(column_types={name: column_type(name) for name in names})
    with csv.open_csv(path, parse_options=parsing, convert_options=converting) as reader:
        yield from reader


def _key(record: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(record[name] for name in KEYS)


def _require_keys(path: Path, records: Sequence[Mapping[str, Any]], keys: Sequence[str]) -> None:
    for record, key in zip(records, keys, strict=True):
        if record["key"] != key:
            known = f"{record['key']} stands for something else, which would be {key}."
            raise StoreError("A row does not match its key.", where=str(path), known=known, remedy=_REMEDY)
