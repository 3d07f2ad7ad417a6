"""Waits for a job to end, and tells how far it is meanwhile."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from .errors import (
    BadAnswerError,
    CancelledRequestError,
    ProblemError,
    ServiceUnreachableError,
    TimedOutError,
)
from .records import Job
from .service import Service

POLL_S = 2.0
MOST_STREAMS = 3
"""So often a stream of events is tried; then the job is only asked about."""
GRACE_S = 30.0
"""So long the service may be away: it takes up its jobs again when it is restarted."""

OnChange = Callable[[Job], None]


def wait_for_job(
    service: Service, job_id: str, on_change: OnChange = lambda _: None, *, seconds: float = 3600.0
) -> Job:
    """The job when it has ended, however it ended; by its events, or by asking where there are none.

    Args:
        service: Whose job it is.
        job_id: Which.
        on_change: Is told each new state and progress, in the thread that waits.
        seconds: How long to wait at most.

    Raises:
        TimedOutError: It has not ended in time; it goes on.
        CancelledRequestError: Waiting was cancelled; the job goes on.
        ServiceUnreachableError: The service was away for more than half a minute.
        ProblemError: The service does not know the job.
    """
    waiting = _Waiting(service, job_id, on_change, time.monotonic() + seconds, seconds)
    for _ in range(MOST_STREAMS):
        job = waiting.streamed() or waiting.asked()
        if job.ended:
            return job
        waiting.pause(job)
    while not (job := waiting.asked()).ended:
        waiting.pause(job)
    return job


@dataclass
class _Waiting:
    service: Service
    job_id: str
    on_change: OnChange
    until: float
    seconds: float
    last_id: str = ""
    last: Job | None = None
    away_since: float | None = field(default=None)

    def streamed(self) -> Job | None:
        """The job when it has ended; None where its events break off before, or there are none."""
        try:
            for event_id, job in self.service.job_events(self.job_id, self.last_id, self._left()):
                self.last_id = event_id or self.last_id
                self._tell(job)
                if job.ended:
                    return job
        except (ServiceUnreachableError, BadAnswerError, ProblemError):
            # Asking will tell whether it was the stream or the service.
            self._left()
        return None

    def asked(self) -> Job:
        """The job as it is; waits for a service that is away for a while."""
        while True:
            self._left()
            try:
                job = self.service.job(self.job_id)
            except (ServiceUnreachableError, ProblemError) as error:
                self._bear(error)
                continue
            self.away_since = None
            self._tell(job)
            return job

    def pause(self, job: Job) -> None:
        """Sleeps until the job should be asked about again."""
        self._sleep(POLL_S if job.retry_after_s is None else max(job.retry_after_s, 0.1))

    def _bear(self, error: ServiceUnreachableError | ProblemError) -> None:
        if isinstance(error, ProblemError) and error.status != 503:
            raise error
        self.away_since = self.away_since or time.monotonic()
        if time.monotonic() - self.away_since > GRACE_S:
            raise error
        self._sleep((error.retry_after_s if isinstance(error, ProblemError) else None) or POLL_S)

    def _sleep(self, seconds: float) -> None:
        if self.service.cancellation.wait(min(seconds, self._left())):
            raise CancelledRequestError("Waiting was cancelled; the job goes on.")

    def _left(self) -> float:
        left = self.until - time.monotonic()
        if left <= 0:
            raise TimedOutError(f"The job has not ended within {self.seconds:g} s; it goes on.")
        return left

    def _tell(self, job: Job) -> None:
        if job != self.last:
            self.last = job
            self.on_change(job)
