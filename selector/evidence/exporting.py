"""A store as files: a table a file, Parquet or CSV, the same bytes for the same evidence."""

from __future__ import annotations

import os
from collections.abc import Iterator
from enum import StrEnum
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import csv, parquet

from scenes.atomic_file import output_error
from selector.evidence.flat_tables import FLAT_TABLES, FlatTable
from selector.evidence.numbering import Record
from selector.evidence.store import Store

_ROWS_AT_ONCE = 50_000
_LEVEL = 15
"""Of zstd: beyond it, llvmpipe's evidence becomes no smaller and writing takes several times as long."""


class FileFormat(StrEnum):
    """What files are written in; their suffix."""

    PARQUET = "parquet"
    CSV = "csv"


def export(store: Store, folder: Path, form: FileFormat) -> list[Path]:
    """Writes every table into a folder, which is made if need be.

    Raises:
        OutputError: The folder or a file cannot be written. Each file is there whole or as it was before.
        StoreError: The store cannot be read.
    """
    names = store.names()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise output_error(folder, error) from error
    written = []
    for table in FLAT_TABLES.values():
        path = folder / f"{table.name}.{form}"
        schema = table.schema(names)
        _write(path, table, schema, store, form)
        written.append(path)
    return written


def _write(path: Path, table: FlatTable, schema: pa.Schema, store: Store, form: FileFormat) -> None:
    temporary = path.with_name(f".gnomon-{os.getpid()}-{path.name}.partial")
    try:
        with _writer(temporary, schema, form) as writer:
            for records in _chunks(table.records(store)):
                writer.write_table(pa.Table.from_pylist(records, schema))
        temporary.replace(path)
    except OSError as error:
        raise output_error(path, error) from error
    finally:
        temporary.unlink(missing_ok=True)


def _writer(path: Path, schema: pa.Schema, form: FileFormat) -> Any:
    if form is FileFormat.CSV:
        return csv.CSVWriter(path, schema)
    # Times hardly ever repeat: their bytes, sorted by place, compress better than any dictionary.
    real = {field.name for field in schema if field.type == pa.float64()}
    return parquet.ParquetWriter(
        path,
        schema,
        compression="zstd",
        compression_level=_LEVEL,
        use_dictionary=[field.name for field in schema if field.name not in real],
        column_encoding=dict.fromkeys(sorted(real), "BYTE_STREAM_SPLIT"),
        store_schema=False,
    )


def _chunks(records: Iterator[Record]) -> Iterator[list[Record]]:
    while chunk := list(islice(records, _ROWS_AT_ONCE)):
        yield chunk
