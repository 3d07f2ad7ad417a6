"""A process that the service has started, watched from outside: its memory, its time, its end."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from enum import StrEnum
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection
from typing import Any

import psutil

TICK_S = 0.25
_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

Json = dict[str, Any]
Entry = Callable[..., None]


class Loss(StrEnum):
    """What ended a process."""

    CRASH = "crash"
    TIME = "time"
    MEMORY = "memory"


class LostWorkerError(Exception):
    """A process ended, or was ended, before it had answered.

    Args:
        loss: What ended it.
        words: How it ended.
    """

    def __init__(self, loss: Loss, words: str) -> None:
        super().__init__(words)
        self.loss = loss
        self.words = words


class Worker:
    """One process. Started by the thread in which the event loop runs: it dies with that thread.

    Args:
        entry: What runs in it: called with a pipe, the id of this process, and `arguments`.
        arguments: What else it is told.
        memory_bytes: That it and all that it starts may hold.
    """

    def __init__(self, entry: Entry, arguments: tuple[object, ...], memory_bytes: int) -> None:
        self._memory_bytes = memory_bytes
        context = get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=entry, args=(theirs, os.getpid(), *arguments), daemon=True)
        with _single_threaded(), _deaf_to_ctrl_c():
            self._process.start()
        theirs.close()
        self._ended = False

    @property
    def pid(self) -> int:
        """Of the process."""
        assert self._process.pid is not None
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it can be asked more."""
        return not self._ended and self._process.is_alive()

    @property
    def own_bytes(self) -> int:
        """Memory that it holds by itself."""
        with suppress(psutil.Error):
            return int(psutil.Process(self.pid).memory_info().rss)
        return 0

    @property
    def held_bytes(self) -> int:
        """Memory that it and all that it has started hold now."""
        total = 0
        with suppress(psutil.Error):
            process = psutil.Process(self.pid)
            for one in (process, *process.children(recursive=True)):
                with suppress(psutil.Error):
                    total += int(one.memory_info().rss)
        return total

    def tell(self, request: Json) -> None:
        """Ask it something; one that has just died is found out by `heard`."""
        with suppress(OSError):
            self._pipe.send_bytes(json.dumps(request).encode())

    async def heard(self, seconds: float) -> Json:
        """The next thing that it says.

        Raises:
            LostWorkerError: It died, or took too long or too much; it is no more then.
        """
        until = time.monotonic() + seconds
        try:
            while not await _readable(self._pipe, min(TICK_S, max(until - time.monotonic(), 0))):
                self._check(until, seconds)
            message = json.loads(self._pipe.recv_bytes())
        except (EOFError, OSError, ValueError):
            raise LostWorkerError(Loss.CRASH, self.end()) from None
        except BaseException:
            # What it would still say belongs to nobody.
            self.end()
            raise
        assert isinstance(message, dict)
        return message

    def kill(self) -> None:
        """Whoever listens to it finds it dead, with all that it has started."""
        # Those are in its group; it has none yet while it starts.
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.kill()

    def end(self) -> str:
        """Ends it with all that it has started, and says how it ended; nothing if it has been ended."""
        if self._ended:
            return ""
        self._ended = True
        code = self._process.exitcode
        self.kill()
        self._process.join()
        self._pipe.close()
        code = self._process.exitcode if code is None else code
        return _ending(code or 0)

    def _check(self, until: float, seconds: float) -> None:
        if time.monotonic() >= until:
            self.end()
            raise LostWorkerError(Loss.TIME, f"it gave no answer within {seconds:g} s")
        if self.held_bytes > self._memory_bytes:
            self.end()
            raise LostWorkerError(
                Loss.MEMORY, f"it took more than {self._memory_bytes / 2**30:.1f} GiB of memory"
            )


async def _readable(pipe: Connection, seconds: float) -> bool:
    loop = asyncio.get_running_loop()
    event, number = asyncio.Event(), pipe.fileno()
    loop.add_reader(number, event.set)
    try:
        async with asyncio.timeout(seconds):
            await event.wait()
    except TimeoutError:
        return False
    finally:
        loop.remove_reader(number)
    return True


def _ending(code: int) -> str:
    if code < 0:
        return f"its process was ended by {signal.Signals(-code).name}"
    return f"its process ended with code {code}"


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """In the block, new processes do not hear Ctrl-C: until they have a group of their own, they are in ours.

    A mask, since a thread may set its own, and since what is blocked stays so in the new process.
    """
    # It would lift the mask when it starts.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _single_threaded() -> Iterator[None]:
    """In the block, new processes compute with one thread each: they share the cores."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
