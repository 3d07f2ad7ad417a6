"""The workers of a benchmark: watched, blamed for what they hang or die on, and replaced."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Self

import psutil

from scenes.errors import DeviceError
from selector.benchmark.device_rows import THREADS_VARIABLE
from selector.benchmark.messages import (
    Begins,
    Failed,
    Finished,
    Job,
    Judged,
    Part,
    Ready,
    Task,
    Unfit,
    Word,
)
from selector.benchmark.worker import enter
from selector.evidence.rows import Purpose
from selector.measurement import Status

Entry = Callable[[Connection, Job, int], None]

TICK_S = 0.2
SHARE_OF_MEMORY = 0.8
LEAST_MEMORY_BYTES = 1 << 30
MOST_STARTS = 3
"""Workers that end in a row without having had their device."""
_ONE_THREAD = (THREADS_VARIABLE, "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Bounds:
    """When a worker is given up.

    Attributes:
        silence_s: How long each part may take.
        memory_bytes: How much memory a worker may hold.
    """

    silence_s: dict[Part, float]
    memory_bytes: int

    @classmethod
    def of(cls, timeout_s: float, workers: int) -> Bounds:
        """From the time that one frame may take.

        A candidate is prepared, rendered, counted in a few more renders and compared: it takes some ten of
        its frames, so that one which keeps the timeout for a frame is never given up. Scenes of a million
        triangles take 20 s to make on a busy core.
        """
        silence_s = {
            Part.START: 30 * timeout_s,
            Part.SCENE: 75 * timeout_s,
            Part.TRUTH: 30 * timeout_s,
            Part.CANDIDATE: 15 * timeout_s,
        }
        available = int(SHARE_OF_MEMORY * psutil.virtual_memory().available)
        return cls(silence_s, max(available // workers, LEAST_MEMORY_BYTES))


@dataclass(frozen=True)
class Lost:
    """A worker has gone.

    Attributes:
        part: What it was at.
        candidate: Key of the candidate that it was at; empty where it was at none.
        status: What to say of whatever it was at.
        reason: Why.
        killed: Whether somebody else killed it: another program, or a system without memory.
    """

    part: Part
    candidate: str
    status: Status
    reason: str
    killed: bool = False


@dataclass
class Member:
    """One worker, as the benchmark sees it."""

    process: SpawnProcess
    pipe: Connection
    task: Task | None = None
    part: Part = Part.START
    candidate: str = ""
    since: float = field(default_factory=time.monotonic)
    verdict: tuple[Status, str] | None = None

    @property
    def ready(self) -> bool:
        """Whether it waits for a question."""
        return self.task is None and self.part is not Part.START

    def hear(self, word: Word) -> None:
        """Keep up with what it is at."""
        self.since = time.monotonic()
        if isinstance(word, Begins):
            self.part, self.candidate = word.part, word.candidate
        elif isinstance(word, Judged):
            self.candidate = ""
        elif isinstance(word, Ready):
            self.part = Part.SCENE
        elif isinstance(word, (Finished, Failed)):
            self.task, self.candidate = None, ""


class Crew:
    """Workers, one process and one GL context each. A context manager that ends them all.

    Args:
        job: What they do.
        size: How many.
        bounds: When one is given up.
        entry: What runs in their processes.
    """

    def __init__(self, job: Job, size: int, bounds: Bounds, entry: Entry = enter) -> None:
        self._job, self._bounds, self._entry = job, bounds, entry
        self._failed_starts = 0
        self.members = [self._hired() for _ in range(size)]

    def __enter__(self) -> Self:
        """The crew itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End all processes, whatever they are at."""
        for member in self.members:
            member.process.kill()
        for member in self.members:
            member.process.join()
            member.pipe.close()

    def give(self, member: Member, task: Task) -> None:
        """Ask a worker that is ready."""
        member.task, member.part, member.candidate = task, Part.SCENE, ""
        member.since = time.monotonic()
        # One that has just died is found out by `events`.
        with suppress(BrokenPipeError, ConnectionResetError):
            member.pipe.send(task)

    def reply(self, member: Member, keys: frozenset[str]) -> None:
        """Say which candidates are wanted."""
        with suppress(BrokenPipeError, ConnectionResetError):
            member.pipe.send(keys)

    def events(self) -> Iterator[tuple[Member, Word | Lost]]:
        """What was said or has happened within a fifth of a second; the lost are replaced.

        Raises:
            DeviceError: There is no such device, or no worker lives long enough to have one.
        """
        by_pipe = {member.pipe: member for member in self.members}
        for pipe in wait(list(by_pipe), TICK_S):
            member = by_pipe[pipe]  # type: ignore[index]
            try:
                word: Word = member.pipe.recv()
            except (EOFError, ConnectionResetError):
                yield member, self._lost(member)
                self._replace(member)
                continue
            if isinstance(word, Unfit):
                raise DeviceError(word.what, where=word.where, known=word.known, remedy=word.remedy)
            if isinstance(word, Ready):
                self._failed_starts = 0
            member.hear(word)
            yield member, word
        self._watch()

    def _hired(self) -> Member:
        ours, theirs = get_context("spawn").Pipe()
        process = get_context("spawn").Process(
            target=self._entry, args=(theirs, self._job, os.getpid()), daemon=True
        )
        with _single_threaded(self._job.purpose is Purpose.ERRORS):
            process.start()
        theirs.close()
        return Member(process, ours)

    def _replace(self, member: Member) -> None:
        member.pipe.close()
        self.members[self.members.index(member)] = self._hired()

    def _lost(self, member: Member) -> Lost:
        member.process.join()
        code = member.process.exitcode or 0
        if member.part is Part.START:
            self._failed_starts += 1
            if self._failed_starts >= MOST_STARTS:
                raise DeviceError(
                    "The driver ends every process that opens the device.",
                    where=self._job.device or "",
                    known=_ending(code),
                    remedy="`gnomon devices` lists others.",
                )
        status, reason = member.verdict or (Status.CRASHED, _ending(code))
        killed = member.verdict is None and code == -signal.SIGKILL
        return Lost(member.part, member.candidate, status, reason, killed)

    def _watch(self) -> None:
        """Kill who takes too long or too much; `events` then finds them gone."""
        for member in self.members:
            if member.verdict or member.ready:
                continue
            silence_s = time.monotonic() - member.since
            if silence_s > self._bounds.silence_s[member.part] and not member.pipe.poll():
                member.verdict = Status.TIMEOUT, f"no answer within {self._bounds.silence_s[member.part]:g} s"
                member.process.kill()
            elif (held := _resident_bytes(member.process)) > self._bounds.memory_bytes:
                allowed = f"{self._bounds.memory_bytes / 2**30:.1f} GiB allowed"
                known = f"{held / 2**30:.1f} GiB of memory, {allowed}"
                member.verdict = Status.OUT_OF_MEMORY, known
                member.process.kill()


def _resident_bytes(process: SpawnProcess) -> int:
    assert process.pid is not None
    try:
        return int(psutil.Process(process.pid).memory_info().rss)
    except psutil.Error:
        return 0


def _ending(code: int) -> str:
    if code < 0:
        return f"its process was ended by {signal.Signals(-code).name}"
    return f"its process ended with code {code}"


@contextmanager
def _single_threaded(wanted: bool) -> Iterator[None]:  # noqa: FBT001
    """In the block, new processes draw and compute with one thread each: the cores are the workers'."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    if wanted:
        os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
