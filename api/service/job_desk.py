"""Takes jobs, has them measured one after the other by a process that may die, and keeps what came out."""

from __future__ import annotations

import asyncio
import logging
import secrets
import sqlite3
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from starlette.concurrency import run_in_threadpool

from api.service.child_process import TAKEN
from api.service.job_ends import JobEnds, gone
from api.service.job_folders import JobFolders
from api.service.job_record import Progress, event_id, job_record
from api.service.job_results import RESULTS
from api.service.job_store import JobRow, JobStore, State
from api.service.problems import ProblemError, problem_record, unwritten
from api.service.receiving import Upload
from api.service.settings import Settings
from api.service.worker import Entry, LostWorkerError, Worker
from api.wording import shortened

START_S = 300.0
RETRY_AFTER_S = 60
CLEANING_S = 3600.0
LONGEST_WHAT = 200
FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 60.0

Json = dict[str, Any]
log = logging.getLogger(__name__)


class JobDesk:
    """The queue and its worker.

    Args:
        settings: Of the service.
        folders: Where the files of jobs are.
        store: What is known of jobs.
        entry: What runs in the process that measures.

    Attributes:
        lost: How many processes were lost, by what ended them.
        followers: How many clients follow jobs.
    """

    def __init__(self, settings: Settings, folders: JobFolders, store: JobStore, entry: Entry) -> None:
        self._settings, self._folders, self._store, self._entry = settings, folders, store, entry
        self._ends = JobEnds(settings.limits, folders, store)
        self._progress: dict[str, Progress] = {}
        self._changed: dict[str, set[asyncio.Event]] = {}
        self._work = asyncio.Event()
        self._worker: Worker | None = None
        self._running: str | None = None
        self._task: asyncio.Task[None] | None = None
        self.lost: Counter[str] = Counter()
        self.followers = 0

    def start(self) -> None:
        """Takes up what an earlier service left, and begins to work."""
        self._recover()
        self._task = asyncio.get_running_loop().create_task(self._run())

    async def stop(self) -> None:
        """Ends the work; a job that runs is queued again."""
        if self._task:
            self._task.cancel()
            with suppress(asyncio.CancelledError):
                await self._task
        if self._worker:
            self._worker.end()

    @property
    def problem(self) -> ProblemError | None:
        """Why jobs cannot be taken now; None where they can."""
        try:
            self._store.check()
        except sqlite3.Error as error:
            return ProblemError(
                "not-ready", "The queue of jobs cannot be written.", known=f"SQLite says: {error}."
            )
        if self._task is None or self._task.done():
            return ProblemError("not-ready", "Nobody works on the queue of jobs.")
        return None

    @property
    def worker_pid(self) -> int | None:
        """Of the process that measures, or waits for something to measure."""
        return self._worker.pid if self._worker and self._worker.alive else None

    def counts(self) -> dict[str, int]:
        """How many jobs there are in each state."""
        return self._store.counts()

    def check_room(self) -> None:
        """Refuse a job while the queue is full.

        Raises:
            ProblemError: It is.
        """
        counts = self._store.counts()
        if counts[State.QUEUED] + counts[State.RUNNING] >= self._settings.limits.queue:
            raise ProblemError(
                "queue-full",
                "The queue of jobs is full.",
                known=f"It takes {self._settings.limits.queue} jobs.",
                remedy="Try again when some are done, or cancel one.",
                headers={"Retry-After": str(RETRY_AFTER_S)},
            )

    def take(self, upload: Upload, looked: Json, options: Json) -> JobRow:
        """An upload that was looked at becomes a job; it is on disk when this returns.

        Raises:
            ProblemError: The queue is full.
        """
        self.check_room()
        job = secrets.token_urlsafe(24)
        self._folders.take(upload.folder, job)
        try:
            row = self._store.add(job, looked["name"], looked["media_type"], options, looked["lights"])
        except sqlite3.Error as error:
            self._folders.drop(job)
            raise unwritten(error) from error
        self._work.set()
        return row

    def row(self, job: str) -> JobRow:
        """What is known of a job.

        Raises:
            ProblemError: There is none of this id.
        """
        row = self._store.get(job)
        if row is None:
            known = "Jobs that have ended are kept for a while only."
            raise ProblemError("not-found", "There is no job of this id.", known=known)
        return row

    def record(self, row: JobRow) -> Json:
        """A job as its client sees it."""
        return job_record(row, self._progress.get(row.id))

    def event_id(self, row: JobRow) -> str:
        """Differs whenever the record differs."""
        return event_id(row, self._progress.get(row.id))

    def result(self, job: str, name: str) -> Path:
        """One of the files of a job that is done.

        Raises:
            ProblemError: Somebody has removed it.
        """
        path = self._folders.of(job) / RESULTS / name
        if not path.is_file():
            raise gone("The results of this job are gone from the service's folder.")
        return path

    def follow(self) -> Callable[[], None]:
        """One more client follows a job, until what is returned is called.

        Raises:
            ProblemError: There are too many.
        """
        if self.followers >= self._settings.limits.streams:
            raise ProblemError("busy", "Too many clients follow jobs.", headers={"Retry-After": "5"})
        self.followers += 1

        def release() -> None:
            self.followers -= 1

        return release

    @property
    def listeners(self) -> int:
        """How many wait for changes."""
        return sum(len(events) for events in self._changed.values())

    def cancel(self, job: str) -> JobRow:
        """Ends a job that waits or runs.

        Raises:
            ProblemError: There is none of this id, or it has ended.
        """
        row = self.row(job)
        if not self._store.end(job, State.CANCELLED, size=0):
            raise ProblemError(
                "already-ended", "This job has ended: it stays as it is.", known=f"It is {row.state}."
            )
        if self._running == job and self._worker:
            self._worker.kill()
        elif self._running != job:
            self._folders.drop(job)
        self._tell(job)
        return self.row(job)

    async def wait_for_change(self, job: str, seconds: float) -> bool:
        """Whether something has changed within the time."""
        event = asyncio.Event()
        self._changed.setdefault(job, set()).add(event)
        try:
            async with asyncio.timeout(seconds):
                await event.wait()
        except TimeoutError:
            return False
        finally:
            waiting = self._changed[job]
            waiting.discard(event)
            if not waiting:
                del self._changed[job]
        return True

    def _tell(self, job: str) -> None:
        for event in self._changed.get(job, ()):
            event.set()

    def _recover(self) -> None:
        self._requeue_stuck(counted=True)
        self._folders.drop_unknown(row.id for row in self._store.all())
        self._ends.clean()

    async def _run(self) -> None:
        pause_s, cleaned = FIRST_PAUSE_S, time.monotonic()
        while True:
            try:
                if self._worker is None or not self._worker.alive:
                    self._worker = await self._hired()
                self._requeue_stuck(counted=False)
                row = self._store.next()
                if row is not None:
                    await self._measure(row)
                    self._ends.clean()
                pause_s = FIRST_PAUSE_S
                if row is not None:
                    continue
                self._work.clear()
                with suppress(TimeoutError):
                    async with asyncio.timeout(CLEANING_S):
                        await self._work.wait()
                if time.monotonic() - cleaned > CLEANING_S:
                    self._ends.clean()
                    cleaned = time.monotonic()
            except Exception as error:
                if not isinstance(error, (LostWorkerError, sqlite3.Error, OSError)):
                    log.exception("a bug")
                log.warning("the queue of jobs pauses for %g s: %s", pause_s, error)
                await asyncio.sleep(pause_s)
                pause_s = min(2 * pause_s, LONGEST_PAUSE_S)

    def _requeue_stuck(self, *, counted: bool) -> None:
        for job in self._ends.requeue_stuck(counted=counted):
            self._tell(job)

    async def _hired(self) -> Worker:
        limits = self._settings.limits
        worker = Worker(self._entry, (self._settings.device, limits.measuring_s), limits.measuring_bytes)
        word = await worker.heard(START_S)
        assert word["kind"] == "ready"
        return worker

    async def _measure(self, row: JobRow) -> None:
        if not self._folders.has_level(row.id, row.level):
            self._ends.fail(row.id, gone("The level of this job is gone from the service's folder.").record())
            self._tell(row.id)
            return
        if not self._store.begin(row.id):
            return
        self._running = row.id
        self._progress[row.id] = Progress(what="starting")
        self._tell(row.id)
        try:
            await self._heard(row)
        except LostWorkerError as error:
            self._lose(row.id, error)
        except asyncio.CancelledError:
            # The service stops: this start was nobody's fault.
            if not self._ends.finished(row.id):
                self._store.requeue(row.id, crashed=False, counted=False)
            raise
        finally:
            self._running = None
            self._progress.pop(row.id, None)
            if self._worker:
                # What a driver or a library keeps from one level does not reach the next.
                self._worker.end()
            if self.row(row.id).state is State.CANCELLED:
                self._folders.drop(row.id)
            self._tell(row.id)

    async def _heard(self, row: JobRow) -> None:
        """Follow the work to its end."""
        assert self._worker is not None
        limits = self._settings.limits
        folder = self._folders.of(row.id)
        self._worker.tell({"folder": str(folder), "level": f"level/{row.level}", "options": row.options})
        until = time.monotonic() + limits.measuring_s
        while True:
            word = await self._worker.heard(min(limits.measuring_idle_s, max(until - time.monotonic(), 0)))
            if word["kind"] == TAKEN:
                continue
            if word["kind"] == "progress":
                what = shortened(str(word["what"]), LONGEST_WHAT)
                self._progress[row.id] = Progress(int(word["done"]), int(word["total"]), what)
                self._tell(row.id)
            elif word["kind"] == "problem":
                texts = str(word["detail"]), str(word["known"]), str(word["remedy"])
                self._ends.fail(row.id, problem_record(str(word["problem"]), *texts))
                return
            else:
                size = await run_in_threadpool(self._ends.settled, row.id)
                self._store.end(row.id, State.DONE, steps=int(word["steps"]), size=size)
                return

    def _lose(self, job: str, error: LostWorkerError) -> None:
        if self.row(job).state.ended or self._ends.finished(job):
            return
        self.lost[error.loss] += 1
        self._ends.after_loss(job, error)
