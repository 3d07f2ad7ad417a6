"""What the routes of one service share."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

from fastapi import Request

from api.service.job_desk import JobDesk
from api.service.metrics import Metrics
from api.service.problems import ProblemError, of_error
from api.service.reading_pool import ReadingPool
from api.service.receiving import Reception
from api.service.settings import Settings
from models.artifact import load
from scenes.errors import GnomonError
from selector.learning.predicting import Advisor

Result = TypeVar("Result")
log = logging.getLogger(__name__)


class Adviser:
    """The model, asked in this process, one question at a time so that the service stays awake.

    Args:
        settings: Of the service.
    """

    def __init__(self, settings: Settings) -> None:
        self._most = settings.limits.questions
        self._waiting = 0
        self._thread = ThreadPoolExecutor(1, "adviser")
        self.problem: ProblemError | None = None
        try:
            self._advisor = Advisor(load(settings.model))
        except GnomonError as error:
            log.error("%s", error)  # noqa: TRY400  a sentence is enough
            self.problem = of_error(error, "not-ready")

    async def ask(self, question: Callable[[Advisor], Result]) -> Result:
        """What the model says.

        Raises:
            ProblemError: There is none, or too many ask.
        """
        if self.problem:
            raise self.problem
        if self._waiting >= self._most:
            raise ProblemError("busy", "Too many questions wait for an answer.", headers={"Retry-After": "1"})
        self._waiting += 1
        try:
            return await asyncio.get_running_loop().run_in_executor(self._thread, question, self._advisor)
        finally:
            self._waiting -= 1

    def stop(self) -> None:
        """Asks no more."""
        self._thread.shutdown(wait=False, cancel_futures=True)


@dataclass(frozen=True)
class Service:
    """The parts of one service.

    Attributes:
        settings: How it is set up.
        metrics: What is counted.
        adviser: The model.
        reception: Where uploads come in.
        pool: Processes that read levels.
        desk: The queue of jobs, and who works it.
    """

    settings: Settings
    metrics: Metrics
    adviser: Adviser
    reception: Reception
    pool: ReadingPool
    desk: JobDesk


def service_of(request: Request) -> Service:
    """The service that a request is for."""
    service = request.app.state.service
    assert isinstance(service, Service)
    return service
