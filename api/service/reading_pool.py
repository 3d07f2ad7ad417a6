"""Processes that read levels of strangers: one request each at a time, replaced where they hang or die."""

from __future__ import annotations

import asyncio
import logging
from collections import Counter
from typing import Any

from api.service.child_process import TAKEN, out_of_memory
from api.service.problems import KINDS, ProblemError
from api.service.settings import Limits, Settings
from api.service.state_folder import MEMORY, empty_memory
from api.service.worker import Entry, Loss, LostWorkerError, Worker

START_S = 120.0
FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.5, 30.0
MOST_TRIES = 2
MOST_ANSWERS = 500
"""After which a process makes room for a new one, in case that a library loses memory."""

Json = dict[str, Any]
log = logging.getLogger(__name__)


class ReadingPool:
    """As many processes as the settings say.

    Args:
        settings: Of the service.
        entry: What runs in them.

    Attributes:
        lost: How many processes were lost, by what ended them.
    """

    def __init__(self, settings: Settings, entry: Entry) -> None:
        self._settings, self._entry = settings, entry
        # None wakes those who wait in vain.
        self._free: asyncio.Queue[tuple[Worker, int] | None] = asyncio.Queue()
        self._hiring: set[asyncio.Task[None]] = set()
        self._all: set[Worker] = set()
        self._waiting = 0
        self._unfit: ProblemError | None = None
        self._memory = settings.state / MEMORY
        self.lost: Counter[str] = Counter()

    def start(self) -> None:
        """Starts them; they are ready a second or two later.

        Raises:
            OSError: The folder for what they remember cannot be made.
        """
        empty_memory(self._settings.state)
        for _ in range(self._settings.readers):
            self._hire()

    async def stop(self) -> None:
        """Ends them, whatever they are at."""
        for task in self._hiring:
            task.cancel()
        await asyncio.gather(*self._hiring, return_exceptions=True)
        for worker in self._all:
            worker.end()
        self._all.clear()

    @property
    def problem(self) -> ProblemError | None:
        """Why no level can be read now; None where one can."""
        if not self._all:
            return self._unfit or ProblemError(
                "not-ready", "No process that reads levels is up yet.", headers={"Retry-After": "2"}
            )
        return None

    @property
    def pids(self) -> list[int]:
        """Of the processes that are up."""
        return [worker.pid for worker in self._all]

    async def ask(self, request: Json) -> Json:
        """What a process says to it.

        Cancelled, it ends the process.

        Raises:
            ProblemError: The level is bad, or took its process along; all are busy, or cannot work.
        """
        if self._unfit is not None and not self._all:
            raise self._unfit
        for _ in range(MOST_TRIES):
            worker, answers = await self._taken()
            answer = await self._answer(worker, answers, request)
            if answer is not None:
                break
        else:
            raise _busy("The processes that read levels die before they begin.")
        if answer["kind"] == "problem":
            raise _problem(answer)
        return answer

    async def _answer(self, worker: Worker, answers: int, request: Json) -> Json | None:
        """What a process says to a request; None if it died before it began with it."""
        begun = False
        worker.tell(request)
        try:
            begun = (await worker.heard(self._limits.reading_s))["kind"] == TAKEN
            return await worker.heard(self._limits.reading_s)
        except LostWorkerError as error:
            self.lost[error.loss] += 1
            log.warning("a reading process was lost: %s", error.words)
            if not begun and error.loss is Loss.CRASH:
                return None
            raise _lost(error, self._limits) from None
        except asyncio.CancelledError:
            # Its answer would be taken for that to the next request.
            worker.end()
            raise
        finally:
            self._return(worker, answers + 1)

    @property
    def _limits(self) -> Limits:
        return self._settings.limits

    async def _taken(self) -> tuple[Worker, int]:
        busy = _busy("All processes that read levels are busy.")
        if self._waiting >= self._limits.uploads:
            raise busy
        self._waiting += 1
        try:
            async with asyncio.timeout(self._limits.waiting_s):
                while True:
                    taken = await self._free.get()
                    if taken is None:
                        if self._unfit is not None and not self._all:
                            raise self._unfit
                    elif taken[0].alive:
                        return taken
                    else:
                        # It was killed while it had nothing to do.
                        self.lost[Loss.CRASH] += 1
                        self._return(*taken)
        except TimeoutError:
            raise busy from None
        finally:
            self._waiting -= 1

    def _return(self, worker: Worker, answers: int) -> None:
        if worker.alive and answers < MOST_ANSWERS and worker.own_bytes < self._limits.reading_bytes / 2:
            self._free.put_nowait((worker, answers))
            return
        worker.end()
        self._all.discard(worker)
        self._hire()

    def _hire(self) -> None:
        task = asyncio.get_running_loop().create_task(self._hired())
        self._hiring.add(task)
        task.add_done_callback(self._hiring.discard)

    async def _hired(self) -> None:
        pause_s = FIRST_PAUSE_S
        while True:
            limits = self._limits
            places = str(self._settings.model), str(self._memory)
            arguments = (*places, limits.reading_bytes, limits.reading_s)
            worker = Worker(self._entry, arguments, limits.reading_bytes)
            try:
                word = await worker.heard(START_S)
            except LostWorkerError as error:
                log.warning("a reading process did not start: %s", error.words)
            else:
                if word["kind"] == "ready":
                    self._unfit = None
                    self._all.add(worker)
                    self._free.put_nowait((worker, 0))
                    return
                worker.end()
                self._unfit = _problem(word)
                log.warning("a reading process cannot work: %s", self._unfit.detail)
                for _ in range(self._waiting):
                    self._free.put_nowait(None)
            await asyncio.sleep(pause_s)
            pause_s = min(2 * pause_s, LONGEST_PAUSE_S)


def _busy(words: str) -> ProblemError:
    return ProblemError("busy", words, remedy="Try again.", headers={"Retry-After": "5"})


def _problem(message: Json) -> ProblemError:
    kind = str(message["problem"])
    assert kind in KINDS
    return ProblemError(
        kind, str(message["detail"]), known=str(message["known"]), remedy=str(message["remedy"])
    )


def _lost(error: LostWorkerError, limits: Limits) -> ProblemError:
    if error.loss is Loss.MEMORY:
        return out_of_memory()
    if error.loss is Loss.TIME:
        return ProblemError(
            "too-long",
            f"Reading this level took more than the {limits.reading_s:g} s that it may.",
            remedy="Ask about fewer lights, or split the level.",
        )
    return ProblemError(
        "bad-level",
        "The process that read this level died of it.",
        known=f"What is known of its end: {error.words}.",
        remedy="The level is damaged, or there is a bug in a library that reads it: please report it.",
    )
