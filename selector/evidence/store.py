"""A body of evidence in a database: what was measured, on what, by which code, raw."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Concatenate, ParamSpec, Self, TypeVar, Unpack

from sqlalchemy import Connection, Engine

from selector.evidence.cached_features import read_extractors, read_features, write_features
from selector.evidence.dating import Dated, read_dated
from selector.evidence.joining import read_table
from selector.evidence.opening import OUTSIDE_TRANSACTIONS, WRITING, address_of, opened, shown
from selector.evidence.pruning import Pruned, Useless, prune
from selector.evidence.reading import (
    Narrower,
    Only,
    read_candidates,
    read_devices,
    read_instances,
    read_judged,
    read_judgements,
    read_names,
    read_runs,
    read_timed,
    read_timings,
)
from selector.evidence.rows import (
    CandidateRow,
    DeviceRow,
    InstanceRow,
    Judgement,
    Role,
    RunRow,
    Timing,
)
from selector.evidence.store_error import StoreError, in_sentences
from selector.evidence.superseding import Marks, read_marks
from selector.evidence.surveying import Survey, survey
from selector.evidence.table import EvidenceTable
from selector.evidence.writing import Batch, write

__all__ = ["Store", "StoreError"]

WAIT_S = 30.0
"""A writer that takes longer than this has died, or holds the store for good."""

_Result = TypeVar("_Result")
_Arguments = ParamSpec("_Arguments")


class Store:
    """An open store. A context manager; what it gives one by one must be used up before it is closed.

    Writers take turns: each call that adds is one transaction, whole or not there at all, whatever kills the
    program. Readers never wait.
    """

    def __init__(self, engine: Engine, where: str) -> None:
        self._engine = engine
        self._where = where

    @classmethod
    def open(cls, url: str, *, write: bool = True, wait_s: float = WAIT_S) -> Store:
        """A store that is up to date, made if need be.

        Args:
            url: A path, which is a SQLite file, or any URL of SQLAlchemy for SQLite or PostgreSQL.
            write: Whether it may be made and added to.
            wait_s: How long to wait for another writer.

        Raises:
            StoreError: There is none, it is something else, too new, or it cannot be opened.
        """
        address = address_of(url)
        return cls(opened(address, write=write, wait_s=wait_s), shown(address))

    def close(self) -> None:
        """Let go of the database."""
        self._engine.dispose()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def begin(self, run: RunRow, device: DeviceRow) -> None:
        """Say who is about to add what was measured where."""
        self._write(Batch(runs=(run,), devices=(device,)))

    def add(
        self,
        instance: InstanceRow,
        candidates: Sequence[CandidateRow],
        judgements: Sequence[Judgement],
        timings: Sequence[Timing],
    ) -> None:
        """Adds what is not there yet; judgements and timings may name what was added before.

        A judgement that failed gives way to one of the same code that did not. Samples of one run are put
        together; a timing that failed in the end has failed.

        Raises:
            StoreError: It cannot be written, or names a device, run, instance or candidate that is not there.
        """
        self._write(
            Batch(instances=(instance,), candidates=candidates, judgements=judgements, timings=timings)
        )

    def add_batch(self, batch: Batch) -> None:
        """Adds rows of many instances in one transaction; raises what `add` does."""
        self._write(batch)

    def add_features(
        self,
        extractor: str,
        values: Mapping[str, Mapping[str, float]],
        costs: Mapping[str, Mapping[str, float]] | None = None,
    ) -> None:
        """Keeps features of instances that the store holds; those of before give way.

        Args:
            extractor: Name and version of what extracted them.
            values: Instance key -> feature -> value.
            costs: Instance key -> step -> milliseconds that it took.

        Raises:
            StoreError: It cannot be written, or does not hold an instance.
        """
        self._transact(write_features, extractor, values, costs or {})

    def features(self, extractor: str) -> dict[str, dict[str, float]]:
        """Instance key -> feature -> value; not a number where it has none."""
        return self._read(read_features, extractor)[0]

    def feature_costs(self, extractor: str) -> dict[str, dict[str, float]]:
        """Instance key -> step -> milliseconds that it took."""
        return self._read(read_features, extractor)[1]

    def extractors(self) -> list[str]:
        """Whose features are kept, in order."""
        return self._read(read_extractors)

    def names(self) -> dict[str, tuple[str, ...]]:
        """Every name that has values here: of a `figure`, `counter`, `stage`, `feature` or `cost`."""
        return self._read(read_names)

    def prune(self, useless: Useless, *, dry_run: bool = False) -> Pruned:
        """Takes facts out, and what then nothing is about; or only counts what would go.

        Raises:
            StoreError: It cannot be written.
        """
        with (
            in_sentences(self._where),
            self._engine.connect().execution_options(**WRITING) as connection,
            connection.begin() as transaction,
        ):
            pruned = prune(connection, useless)
            if dry_run:
                transaction.rollback()
        if not dry_run:
            self._give_room_back()
        return pruned

    def survey(self) -> Survey:
        """What is here, counted."""
        return self._read(survey)

    def judged(self, device: str, codes: Iterable[str]) -> set[tuple[str, str]]:
        """(instance key, candidate key) that were judged on a device by one of these versions of the code."""
        return self._read(read_judged, device=device, codes=list(codes))

    def timed(self, device: str, codes: Iterable[str]) -> dict[tuple[str, str], int]:
        """The same of timings -> rounds over all runs; 0 where it failed before the first."""
        return self._read(read_timed, device=device, codes=list(codes))

    def dated(self) -> list[Dated]:
        """When everything was timed, the oldest first, without samples."""
        return self._read(read_dated)

    def marks(self) -> Marks:
        """Which times no longer hold: (device's key, technique's id) -> before when they were taken."""
        return self._read(read_marks)

    def instances(self, *, role: Role | None = None, family: str | None = None) -> Iterator[InstanceRow]:
        """Every instance, in the order of families, scenes and keys."""
        return self._each(read_instances, role, family)

    def candidates(self) -> Iterator[CandidateRow]:
        """Every candidate, in the order of techniques and settings."""
        return self._each(read_candidates)

    def devices(self) -> Iterator[DeviceRow]:
        """Every device, real ones first."""
        return self._each(read_devices)

    def runs(self) -> Iterator[RunRow]:
        """Every run, the oldest first."""
        return self._each(read_runs)

    def judgements(self, **only: Unpack[Only]) -> Iterator[Judgement]:
        """Judgements for which all holds that is given, in the order of what they are about."""
        return self._each(read_judgements, **only)

    def timings(self, **only: Unpack[Only]) -> Iterator[Timing]:
        """Timings with all their samples for which all holds that is given, in the same order."""
        return self._each(read_timings, **only)

    def table(self, device: str, **only: Unpack[Narrower]) -> EvidenceTable:
        """Everything that is known of a device's times, with errors and counters: what a learner starts from.

        Args:
            device: Key of the device. What was not judged on it is taken from others, since errors and
                counters do not depend on the device.
            only: Which facts are wanted. Without `codes` the newest version of each is taken.
        """
        return self._read(read_table, device, **only)

    def _give_room_back(self) -> None:
        """A file does not become smaller by itself; other databases look after that on their own."""
        if self._engine.dialect.name == "sqlite":
            with (
                in_sentences(self._where),
                self._engine.connect().execution_options(**OUTSIDE_TRANSACTIONS) as connection,
            ):
                connection.exec_driver_sql("VACUUM")

    def _write(self, batch: Batch) -> None:
        self._transact(write, batch)

    def _transact(
        self,
        action: Callable[Concatenate[Connection, _Arguments], _Result],
        *arguments: _Arguments.args,
        **named: _Arguments.kwargs,
    ) -> _Result:
        with (
            in_sentences(self._where),
            self._engine.connect().execution_options(**WRITING) as connection,
            connection.begin(),
        ):
            return action(connection, *arguments, **named)

    def _read(
        self,
        action: Callable[Concatenate[Connection, _Arguments], _Result],
        *arguments: _Arguments.args,
        **named: _Arguments.kwargs,
    ) -> _Result:
        with in_sentences(self._where), self._engine.connect() as connection:
            return action(connection, *arguments, **named)

    def _each(
        self,
        action: Callable[Concatenate[Connection, _Arguments], Iterator[_Result]],
        *arguments: _Arguments.args,
        **named: _Arguments.kwargs,
    ) -> Iterator[_Result]:
        with in_sentences(self._where), self._engine.connect() as connection:
            yield from action(connection, *arguments, **named)
