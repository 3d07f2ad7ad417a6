"""A process of its own that answers questions, and may hang or die on one without harm to the others."""

from __future__ import annotations

import ctypes
import os
import signal
from multiprocessing.connection import Connection

from renderers.clock import truthful_clock
from renderers.context import Gpu
from scenes.errors import GnomonError
from selector.benchmark.device_rows import device_row
from selector.benchmark.judging import Judge, candidate_rows
from selector.benchmark.messages import Asks, Begins, Failed, Finished, Job, Part, Ready, Task, Unfit
from selector.benchmark.questions import Posed, posed
from selector.benchmark.stopwatch import Stopwatch
from selector.benchmark.timing import Timekeeper
from selector.candidate import Candidate, candidates
from selector.evidence.rows import Purpose

_PR_SET_PDEATHSIG = 1


def enter(pipe: Connection, job: Job, parent: int) -> None:
    """Answers one question after the other, until the other end of the pipe is closed.

    Args:
        pipe: Where questions come from and words go to.
        job: How they are answered.
        parent: Id of the process that asks: this one dies with it, whatever it is doing.
    """
    _die_with(parent)
    # Ctrl-C reaches the whole group; whoever asks decides when to stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        gpu = Gpu(job.device)
    except GnomonError as error:
        pipe.send(Unfit(error.what, error.where, error.known, error.remedy))
        return
    with gpu:
        pipe.send(Ready(device_row(gpu.device, truthful_clock(gpu), job.threads), gpu.device.limits))
        answerer = (
            Timekeeper(gpu, job, pipe.send) if job.purpose is Purpose.TIMES else Judge(gpu, job, pipe.send)
        )
        while (task := _next(pipe)) is not None:
            pipe.send(_answered(pipe, gpu, job, task, answerer))


def _next(pipe: Connection) -> Task | None:
    try:
        task = pipe.recv()
    except EOFError:
        return None
    assert isinstance(task, Task)
    return task


def _answered(
    pipe: Connection, gpu: Gpu, job: Job, task: Task, answerer: Judge | Timekeeper
) -> Finished | Failed:
    watch = Stopwatch()
    try:
        pipe.send(Begins(Part.SCENE))
        with watch.part("scene"):
            found = posed(task.question, job.width, job.height)
        wanted = _wanted(pipe, gpu, job, found)
        if wanted and isinstance(answerer, Judge):
            answerer.answer(found, wanted, watch, rays=task.rays)
        elif wanted:
            answerer.answer(found, wanted, watch)
    except (BrokenPipeError, EOFError):
        raise SystemExit from None
    except GnomonError as error:
        return Failed(str(error))
    except Exception as error:  # noqa: BLE001  the other questions must not be lost with this one
        return Failed(f"{type(error).__name__}: {error}")
    return Finished(dict(watch.seconds))


def _wanted(pipe: Connection, gpu: Gpu, job: Job, found: Posed) -> list[Candidate]:
    """The candidates that the store has no fresh answer about."""
    known = candidates(found.light.kind, gpu.device.limits, job.techniques)
    rows = candidate_rows(known)
    pipe.send(Asks(found.row, rows))
    keys = pipe.recv()
    return [one for one, row in zip(known, rows, strict=True) if row.key in keys]


def _die_with(parent: int) -> None:
    """Has the kernel kill this process when its parent ends; ends it now where that has happened already."""
    if ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL) != 0:
        raise OSError(ctypes.get_errno(), "prctl refuses to tie this process to its parent")
    if os.getppid() != parent:
        raise SystemExit
