"""The store in which a sample is measured: beside the evidence until it is known what the sample says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from scenes.atomic_file import output_error
from scenes.errors import OutputError
from selector.evidence.merging import merge
from selector.evidence.rows import Purpose, RunRow
from selector.evidence.store import Store
from selector.evidence.store_error import StoreError
from selector.evidence.writing import Batch

_BEGINNING = b"SQLite format 3\0"
KEEPS = timedelta(hours=20)
"""A sample that a killed job has left is gone on with for so long; a night later the machine is another."""


def begun_sample(path: Path, now: datetime) -> int | None:
    """The seed of the sample that a killed job has left; one that is too old is taken away.

    Raises:
        OutputError: Something else stands there.
    """
    if not path.exists():
        return None
    _require_ours(path)
    try:
        with Store.open(str(path)) as store:
            runs = list(store.runs())
    except StoreError:
        # Killed while the file was being made.
        runs = []
    if runs and all(now - datetime.fromisoformat(row.started) < KEEPS for row in runs):
        return runs[0].seed
    discard(path)
    return None


def _require_ours(path: Path) -> None:
    try:
        with path.open("rb") as file:
            ours = file.read(len(_BEGINNING)) in (b"", _BEGINNING)
    except OSError as error:
        raise output_error(path, error) from error
    if not ours:
        raise OutputError(
            "A job keeps its sample under this name, and another file is there.",
            where=str(path),
            remedy="Move it away.",
        )


def discard(path: Path) -> None:
    """Takes a sample's store away."""
    for suffix in ("", "-wal", "-shm"):
        path.with_name(path.name + suffix).unlink(missing_ok=True)


def began(store: Store) -> str:
    """When the first of a sample's times was taken; UTC, ISO 8601."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    return min((row.started for row in store.runs() if row.purpose is Purpose.TIMES), default=now)


def bring_in(store: Store, sample: Store, remarks: Sequence[str]) -> None:
    """Adds a sample to the evidence; its timed runs say what no longer holds. May be done again.

    Raises:
        StoreError: It cannot be read or written. What was added by then stays.
    """
    runs = [_remarked(row, remarks) for row in sample.runs()]
    store.add_batch(Batch(runs=runs))
    merge(store, sample)


def _remarked(row: RunRow, remarks: Sequence[str]) -> RunRow:
    if row.purpose is not Purpose.TIMES:
        return row
    return replace(row, remarks=(*row.remarks, *remarks))
