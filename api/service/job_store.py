"""The queue of jobs on disk: what is said to be so is still so after a power cut."""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from enum import StrEnum
from pathlib import Path
from typing import Any, Self

from scenes.errors import GnomonError

FILE, JOBS = "jobs.sqlite", "jobs"
"""The queue, and the folder beside it with what belongs to each job."""
VERSION = 1
APPLICATION = 0x474E4D51
"""Marks the file as a queue of ours; those of the first days have 0."""
_OTHER_FOLDER = "Choose another folder with --state, or move this file away."
_SCHEMA = """
CREATE TABLE jobs (
    number INTEGER PRIMARY KEY,
    id TEXT NOT NULL UNIQUE,
    state TEXT NOT NULL,
    level TEXT NOT NULL,
    media_type TEXT NOT NULL,
    options TEXT NOT NULL,
    lights INTEGER NOT NULL,
    created REAL NOT NULL,
    started REAL,
    finished REAL,
    starts INTEGER NOT NULL DEFAULT 0,
    crashes INTEGER NOT NULL DEFAULT 0,
    version INTEGER NOT NULL DEFAULT 0,
    steps INTEGER NOT NULL DEFAULT 0,
    problem TEXT,
    bytes INTEGER NOT NULL DEFAULT 0
)
"""

Json = dict[str, Any]


class State(StrEnum):
    """Of a job."""

    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"

    @property
    def ended(self) -> bool:
        """Whether nothing more happens to it."""
        return self in (State.DONE, State.FAILED, State.CANCELLED)


class JobStoreError(GnomonError):
    """A queue that cannot be used."""

    exit_code = 7


@dataclass(frozen=True)
class JobRow:
    """One job as it is stored.

    Attributes:
        number: Its place in the order of arrival.
        id: What only its owner knows.
        state: How far it is.
        level: File name of its level.
        media_type: Of its level.
        options: What is asked.
        lights: How many are asked about.
        created: Seconds since 1970.
        started: The last time that it was begun.
        finished: When it ended.
        starts: How often it was begun.
        crashes: How often its process died of it.
        version: Grows with every change.
        steps: Of the work, once it is known.
        problem: Why it failed.
        bytes: That its files take, once it has ended.
    """

    number: int
    id: str
    state: State
    level: str
    media_type: str
    options: Json
    lights: int
    created: float
    started: float | None
    finished: float | None
    starts: int
    crashes: int
    version: int
    steps: int
    problem: Json | None
    bytes: int


class JobStore:
    """An SQLite file. Used by one thread; every change is on disk when a method returns.

    Args:
        folder: Where it is.

    Raises:
        JobStoreError: It cannot be opened, another program or a newer Gnomon made it, or it is new while
            there are results of jobs that it knows nothing of.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / FILE
        try:
            # Calls come from the event loop alone, which tests run in a thread of its own.
            self._db = sqlite3.connect(self._path, isolation_level=None, check_same_thread=False)
            with _closed_on_failure(self._db):
                self._db.row_factory = sqlite3.Row
                # Nothing is changed in the file of another program, not even its journal.
                new = self._is_new()
                self._db.execute("PRAGMA journal_mode=WAL")
                # A commit is on disk before it is told.
                self._db.execute("PRAGMA synchronous=FULL")
                if new:
                    self._make()
        except sqlite3.Error as error:
            raise JobStoreError(
                "The queue of jobs cannot be opened.",
                where=str(self._path),
                known=f"SQLite says: {error}.",
                remedy=_OTHER_FOLDER,
            ) from error

    def __enter__(self) -> Self:
        """The store itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self._db.close()

    def _is_new(self) -> bool:
        """Whether there is nothing in the file yet; it is a queue of ours otherwise."""
        (version,) = self._db.execute("PRAGMA user_version").fetchone()
        (application,) = self._db.execute("PRAGMA application_id").fetchone()
        columns = {name for _, name, *_ in self._db.execute("PRAGMA table_info(jobs)")}
        known = f"Its user_version is {version}, its application_id {application}"
        if version > VERSION:
            raise self._refusal("A newer Gnomon made this queue, or another program this file.", f"{known}.")
        (tables,) = self._db.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()
        if version == application == tables == 0:
            self._refuse_results()
            return True
        missing = sorted({one.name for one in fields(JobRow)} - columns)
        if version != VERSION or application not in (0, APPLICATION) or missing:
            lacks = f"; it has no table jobs with {', '.join(missing)}" if missing else ""
            raise self._refusal("This file is no queue of jobs: another program made it.", f"{known}{lacks}.")
        return False

    def _refuse_results(self) -> None:
        jobs = self._path.parent / JOBS
        if jobs.is_dir() and any(jobs.iterdir()):
            raise JobStoreError(
                "The queue of jobs is empty, but there are results that belong to one.",
                where=str(jobs),
                known=f"{FILE} beside it was lost or is new.",
                remedy=f"Put the right {FILE} back, move {JOBS} away, or choose another folder with --state.",
            )

    def _refusal(self, what: str, known: str) -> JobStoreError:
        return JobStoreError(what, where=str(self._path), known=known, remedy=_OTHER_FOLDER)

    def _make(self) -> None:
        self._db.execute("BEGIN IMMEDIATE")
        self._db.execute(_SCHEMA)
        self._db.execute(f"PRAGMA application_id={APPLICATION}")
        self._db.execute(f"PRAGMA user_version={VERSION}")
        self._db.execute("COMMIT")

    def check(self) -> None:
        """Writes, and nothing changes by it; raises `sqlite3.Error` if nothing can be written."""
        self._db.execute(f"PRAGMA user_version={VERSION}")

    def add(self, job: str, level: str, media_type: str, options: Mapping[str, Any], lights: int) -> JobRow:
        """A new job, queued last."""
        values = job, State.QUEUED, level, media_type, json.dumps(options), lights, time.time()
        names = "id, state, level, media_type, options, lights, created"
        self._db.execute(f"INSERT INTO jobs ({names}) VALUES (?, ?, ?, ?, ?, ?, ?)", values)  # noqa: S608  our names
        row = self.get(job)
        assert row is not None
        return row

    def get(self, job: str) -> JobRow | None:
        """A job by its id."""
        found = self._db.execute("SELECT * FROM jobs WHERE id = ?", (job,)).fetchone()
        return _row(found) if found else None

    def all(self) -> list[JobRow]:
        """All jobs, in the order of arrival."""
        return [_row(one) for one in self._db.execute("SELECT * FROM jobs ORDER BY number")]

    def next(self) -> JobRow | None:
        """The queued job that came first."""
        query = "SELECT * FROM jobs WHERE state = ? ORDER BY number LIMIT 1"
        found = self._db.execute(query, (State.QUEUED,)).fetchone()
        return _row(found) if found else None

    def counts(self) -> dict[str, int]:
        """How many jobs there are in each state."""
        query = "SELECT state, COUNT(*) FROM jobs GROUP BY state"
        found: dict[str, int] = dict(self._db.execute(query).fetchall())
        return {str(state): found.get(state, 0) for state in State}

    def begin(self, job: str) -> bool:
        """A queued job runs; False if it is not queued any more."""
        return self._change(
            job, (State.QUEUED,), "state = ?, started = ?, starts = starts + 1", State.RUNNING, time.time()
        )

    def requeue(self, job: str, *, crashed: bool, counted: bool = True) -> bool:
        """A job that runs is queued again, at its old place; False if it does not run any more.

        Args:
            job: Its id.
            crashed: Whether its process died of it.
            counted: Whether the start counts.
        """
        return self._change(
            job,
            (State.RUNNING,),
            "state = ?, crashes = crashes + ?, starts = starts - ?",
            State.QUEUED,
            int(crashed),
            int(not counted),
        )

    def end(
        self, job: str, state: State, *, steps: int = 0, problem: Json | None = None, size: int = 0
    ) -> bool:
        """A job ends; False if it has ended before, so that nothing ends twice."""
        assert state.ended
        text = None if problem is None else json.dumps(problem)
        return self._change(
            job,
            (State.QUEUED, State.RUNNING),
            "state = ?, finished = ?, steps = ?, problem = ?, bytes = ?",
            *(state, time.time(), steps, text, size),
        )

    def forget(self, job: str) -> None:
        """A job that has ended is known no more."""
        self._db.execute("DELETE FROM jobs WHERE id = ?", (job,))

    def _change(self, job: str, states: tuple[State, ...], what: str, *values: object) -> bool:
        marks = ", ".join("?" * len(states))
        query = f"UPDATE jobs SET version = version + 1, {what} WHERE id = ? AND state IN ({marks})"  # noqa: S608  ours
        return self._db.execute(query, (*values, job, *states)).rowcount == 1


@contextmanager
def _closed_on_failure(db: sqlite3.Connection) -> Iterator[None]:
    try:
        yield
    except BaseException:
        db.close()
        raise


def _row(found: sqlite3.Row) -> JobRow:
    values = dict(found)
    values["state"] = State(values["state"])
    values["options"] = json.loads(values["options"])
    values["problem"] = json.loads(values["problem"]) if values["problem"] else None
    return JobRow(**values)
