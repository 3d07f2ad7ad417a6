"""How jobs end: done, failed, lost or forgotten; and how those go on whose process or service has ended.

A job is done when its results have been synced and have got their name; what is written into the queue
afterwards only repeats it. So a job whose service was killed between the two is found done by the next one.
"""

from __future__ import annotations

import logging
import time
from typing import Any

from api.service.job_folders import JobFolders
from api.service.job_store import JobStore, State
from api.service.problems import ProblemError, problem_record
from api.service.settings import Limits
from api.service.worker import Loss, LostWorkerError

Json = dict[str, Any]
log = logging.getLogger(__name__)


class JobEnds:
    """What becomes of jobs.

    Args:
        limits: Of the service.
        folders: Where the files of jobs are.
        store: What is known of jobs.
    """

    def __init__(self, limits: Limits, folders: JobFolders, store: JobStore) -> None:
        self._limits, self._folders, self._store = limits, folders, store

    def finished(self, job: str) -> bool:
        """Whether its results are there although nobody has said so; it is done then."""
        if not self._folders.has_results(job):
            return False
        self._store.end(job, State.DONE, steps=0, size=self.settled(job))
        return True

    def settled(self, job: str) -> int:
        """Keeps the results of a job only; gives their bytes."""
        self._folders.drop_level(job)
        return self._folders.size(job)

    def fail(self, job: str, problem: Json) -> None:
        """The job has failed for this reason."""
        self._store.end(job, State.FAILED, problem=problem)
        self._folders.drop(job)

    def after_loss(self, job: str, error: LostWorkerError) -> None:
        """Its process is gone: it is tried again, unless it took too long or too many along."""
        log.warning("the measuring process was lost: %s", error.words)
        if error.loss is Loss.TIME:
            problem = problem_record("too-long", f"Measuring this level was given up: {error.words}.")
            self.fail(job, problem)
            return
        self._store.requeue(job, crashed=True)
        row = self._store.get(job)
        if row is not None and row.crashes >= self._limits.attempts:
            self.fail(job, _gave_up(f"It was tried {row.crashes} times; the last time, {error.words}."))

    def requeue_stuck(self, *, counted: bool) -> list[str]:
        """What seems to run while nothing does is queued again; gives the ids.

        Its service has ended, which counts, or its end could not be written for want of room, which does not.
        """
        stuck = [row for row in self._store.all() if row.state is State.RUNNING and not self.finished(row.id)]
        for row in stuck:
            if row.starts >= self._limits.starts:
                self.fail(row.id, _gave_up(f"It was begun {row.starts} times, and never came to its end."))
            else:
                self._store.requeue(row.id, crashed=False, counted=counted)
        return [row.id for row in stuck]

    def clean(self) -> None:
        """Forgets jobs that have ended: old ones, and the oldest where there is too much of them."""
        limits = self._limits
        ended = [row for row in self._store.all() if row.state.ended]
        kept, size = 0, 0
        for row in sorted(ended, key=lambda one: one.finished or 0, reverse=True):
            kept, size = kept + 1, size + row.bytes
            old = time.time() - (row.finished or 0) > limits.kept_s
            if old or kept > limits.kept_jobs or size > limits.kept_bytes:
                self._store.forget(row.id)
                self._folders.drop(row.id)


def gone(words: str) -> ProblemError:
    """What is said of files that somebody has removed."""
    return ProblemError("gone", words, remedy="Send the level again.")


def _gave_up(known: str) -> Json:
    return problem_record(
        "bad-level",
        "The process that measured this level died of it.",
        known,
        "Please report it, with the level.",
    )
