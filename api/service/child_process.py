"""The inside of a process that the service starts: its limits, its end, and the messages it takes.

Messages are JSON, so that nothing that a broken process says is run by the service.
"""

from __future__ import annotations

import ctypes
import json
import math
import os
import resource
import signal
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from api.service.problems import ProblemError, is_full, no_room, of_error
from scenes.errors import GnomonError

TAKEN = "taken"
"""Said before a request is worked on: what ends the process before was not the request."""
_PR_SET_PDEATHSIG = 1

Json = dict[str, Any]
Say = Callable[[Json], None]
Work = Callable[[Json, Say], Json]
"""What is done with a request; it may say how far it is, and gives the answer."""


def work_through(
    pipe: Connection, parent: int, memory_bytes: int, seconds: float, prepare: Callable[[], Work]
) -> None:
    """Answers requests until the other end of the pipe is closed; says at first whether it can.

    Args:
        pipe: Where requests come from and answers go to.
        parent: Id of the process that asks: this one dies with it, whatever it is doing.
        memory_bytes: That this process may take, beside what it takes now; the system's own limit where 0.
        seconds: That one request may take, on every core.
        prepare: Gives what is done; what it raises is why nothing can be.
    """
    live_and_die_with(parent)

    def say(message: Json) -> None:
        pipe.send_bytes(json.dumps(message, allow_nan=False).encode())

    try:
        work = prepare()
    except GnomonError as error:
        say(_refusal(of_error(error, "not-ready")))
        return
    if memory_bytes:
        _limit("RLIMIT_AS", _address_bytes() + memory_bytes)
    _limit("RLIMIT_CORE", 0)
    say({"kind": "ready"})
    while (request := _next(pipe)) is not None:
        # In case that nobody is left to end it.
        _limit("RLIMIT_CPU", math.ceil(time.process_time() + seconds * (os.cpu_count() or 1)))
        say({"kind": TAKEN})
        say(_answer(request, say, work))


def live_and_die_with(parent: int) -> None:
    """This process gets a group of its own, which ends with its parent.

    Ctrl-C in a terminal does not reach it: whoever started it decides when to stop.
    """
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(0)
    os.setsid()


def _answer(request: Json, say: Say, work: Work) -> Json:
    try:
        return {"kind": "done", **work(request, say)}
    except ProblemError as problem:
        return _refusal(no_room() if is_full(problem) else problem)
    except GnomonError as error:
        return _refusal(no_room() if is_full(error) else of_error(error))
    except MemoryError:
        return _refusal(out_of_memory())
    except Exception as error:  # noqa: BLE001  the service answers, whatever happens to a level
        if is_full(error):
            return _refusal(no_room())
        # What a library says of it may name files of this machine.
        return _refusal(
            ProblemError("internal", f"This level meets a bug inside Gnomon ({type(error).__name__}).")
        )


def _refusal(problem: ProblemError) -> Json:
    texts = {"detail": problem.detail, "known": problem.known, "remedy": problem.remedy}
    return {"kind": "problem", "problem": problem.kind, **texts}


def out_of_memory() -> ProblemError:
    """What is said of a level that takes more memory than it may."""
    remedy = "Split the level, or simplify its meshes."
    return ProblemError("bad-level", "This level takes more memory than the service gives it.", remedy=remedy)


def _next(pipe: Connection) -> Json | None:
    try:
        request = json.loads(pipe.recv_bytes())
    except (EOFError, ConnectionResetError):
        return None
    assert isinstance(request, dict)
    return request


def _address_bytes() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123  no path of a user's
        return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")


def _limit(name: str, most: int) -> None:
    # Only what is in force: the reader of Draco data sets a limit of its own in its own process.
    kind = getattr(resource, name)
    _, highest = resource.getrlimit(kind)
    resource.setrlimit(kind, (most if highest == resource.RLIM_INFINITY else min(most, highest), highest))
