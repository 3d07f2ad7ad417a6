"""Calls of our functions in a program of its own, with limits on its time and memory.

For libraries in C++ that a damaged file can keep busy without end, or crash: only the system can stop them.
The program starts with the first call and stays for the next ones; where it hangs or dies, it is ended and
started anew. Arrays follow their message through a socket: fresh memory that both share takes several times
as long, since the system has to clear it page by page.
"""

from __future__ import annotations

import gc
import importlib
import math
import os
import pickle
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Sequence
from contextlib import suppress
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np

from scenes.errors import GnomonError

# Bytes of a message.
_HEAD = struct.Struct("<Q")
# Smaller arrays are part of the message, larger ones follow it.
_LEAST_APART = 4096
_ALIGNMENT = 64
# With the 208 kB that systems give, large arrays take twice as long.
_PIPE_BYTES = 2**20
_SETTINGS = {
    # Threads reserve more addresses than the program may have.
    "OPENBLAS_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "8",
    # Pages that are given back after a level are cleared for the next: that takes as long as reading it.
    "MALLOC_TRIM_THRESHOLD_": str(2**28),
    "MALLOC_MMAP_THRESHOLD_": str(2**25),
}


class EndedError(Exception):
    """The program gave no answer: it took too long, or it died."""


class LimitedProcess:
    """A program that answers calls, one at a time, as long as this object lives.

    Args:
        most_bytes: Addresses that it may take, beyond which it is out of memory.
        most_seconds: How long one call may take, by the clock and by the CPU.
    """

    def __init__(self, most_bytes: int, most_seconds: float) -> None:
        self.most_bytes = most_bytes
        self.most_seconds = most_seconds
        self._lock = threading.Lock()
        self._owner = 0
        self._started: tuple[subprocess.Popen[bytes], socket.socket] | None = None

    def call(self, module: str, function: str, *arguments: object) -> Any:
        """What a function gives: both it and its arguments are sent by pickle.

        Raises:
            EndedError: It took too long, or the program died.
            GnomonError: The function raised it.
            RuntimeError: The function raised anything else, which is in the text.
        """
        with self._lock:
            try:
                answer = self._answer((module, function, arguments, Path.cwd()))
            except BaseException:
                # What it would still say belongs to this call, not to the next one.
                self._end()
                raise
        if isinstance(answer, GnomonError):
            raise answer
        if isinstance(answer, _Fault):
            raise RuntimeError(f"{module}.{function}: {answer.text}")  # noqa: TRY004  of no argument's
        return answer

    def _answer(self, request: object) -> Any:
        pipe = self._pipe()
        try:
            _send(pipe, request)
            return _received(pipe)
        except TimeoutError as error:
            raise EndedError(f"It took more than {self.most_seconds:g} seconds.") from error
        except (OSError, EOFError) as error:
            raise EndedError(f"It crashed, or took more than {self.most_bytes:,} bytes.") from error

    def _pipe(self) -> socket.socket:
        # A process that was forked off must not speak with the program of the one before it.
        if self._started is not None and self._owner == os.getpid() and self._started[0].poll() is None:
            return self._started[1]
        self._end()
        ours, theirs = socket.socketpair()
        for end in (ours, theirs):
            end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _PIPE_BYTES)
            end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _PIPE_BYTES)
        places = (str(Path(__file__).resolve().parents[1]), os.environ.get("PYTHONPATH"))
        process = subprocess.Popen(  # noqa: S603  our own file
            [
                *(sys.executable, "-P", "-m", __name__),
                *(str(theirs.fileno()), str(self.most_bytes), str(self.most_seconds)),
            ],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=[theirs.fileno()],
            env=os.environ | _SETTINGS | {"PYTHONPATH": os.pathsep.join(filter(None, places))},
        )
        theirs.close()
        ours.settimeout(self.most_seconds)
        self._owner, self._started = os.getpid(), (process, ours)
        weakref.finalize(self, _end, process, ours, os.getpid())
        return ours

    def _end(self) -> None:
        if self._started is not None:
            _end(*self._started, self._owner)
        self._started = None


class _Fault:
    """What went wrong in the program, in words."""

    def __init__(self, text: str) -> None:
        self.text = text


def serve(pipe: socket.socket, most_seconds: float) -> None:
    """Answers calls until there are no more."""
    # What is read does not run in circles, and looking for that takes a tenth of the time.
    gc.disable()
    while True:
        try:
            module, function, arguments, folder = _received(pipe)
        except EOFError:
            return
        _limit_time(most_seconds)
        _send(pipe, _result(module, function, arguments, folder))
        gc.collect()
        # What is left belongs to the libraries, and is not looked through again.
        gc.freeze()


def _result(module: str, function: str, arguments: Sequence[object], folder: Path) -> object:
    try:
        os.chdir(folder)
        return getattr(importlib.import_module(module), function)(*arguments)
    except GnomonError as error:
        error.__cause__ = error.__context__ = None
        return error
    except Exception as error:  # noqa: BLE001  whatever it is, the caller is told
        return _Fault(f"{type(error).__name__}: {error}")


def _send(pipe: socket.socket, value: object) -> None:
    large: list[memoryview] = []

    def is_small(buffer: pickle.PickleBuffer) -> bool:
        raw = buffer.raw()
        if raw.nbytes >= _LEAST_APART:
            large.append(raw)
        return raw.nbytes < _LEAST_APART

    message = pickle.dumps(value, protocol=5, buffer_callback=is_small)
    body = pickle.dumps((message, [raw.nbytes for raw in large]))
    pipe.sendall(_HEAD.pack(len(body)) + body)
    for raw in large:
        pipe.sendall(raw)
        pipe.sendall(bytes(_padded(raw.nbytes) - raw.nbytes))


def _received(pipe: socket.socket) -> Any:
    (length,) = _HEAD.unpack(_exactly(pipe, _HEAD.size))
    message, sizes = pickle.loads(_exactly(pipe, length))  # noqa: S301  from our own program
    memory = _exactly(pipe, sum(map(_padded, sizes))).toreadonly()
    ends = accumulate(map(_padded, sizes))
    buffers = [memory[end - _padded(size) :][:size] for size, end in zip(sizes, ends, strict=True)]
    return pickle.loads(message, buffers=buffers)  # noqa: S301  likewise


def _padded(size: int) -> int:
    return -(-size // _ALIGNMENT) * _ALIGNMENT


def _exactly(pipe: socket.socket, count: int) -> memoryview:
    # numpy takes large pages where it can, and need not clear what is written anyway.
    found = np.empty(count, np.uint8).data  # noqa: TID251  filled below, or thrown away
    rest = found
    while rest:
        size = pipe.recv_into(rest)
        if not size:
            raise EOFError
        rest = rest[size:]
    return found


def _end(process: subprocess.Popen[bytes], pipe: socket.socket, owner: int) -> None:
    pipe.close()
    # One that was forked off leaves the program to whoever started it.
    if owner == os.getpid():
        process.kill()
        process.wait()


def _limit_memory(most_bytes: int) -> None:
    _limit("RLIMIT_AS", most_bytes)
    _limit("RLIMIT_CORE", 0)


def _limit_time(most_seconds: float) -> None:
    """Of this call, in case that nobody is left to end it: several threads use the time of several."""
    more = math.ceil(most_seconds) * (os.cpu_count() or 1)
    _limit("RLIMIT_CPU", math.ceil(time.process_time()) + more)


def _limit(name: str, most: int) -> None:
    # Where the system knows no such limits, there are none.
    with suppress(ImportError):
        import resource  # noqa: PLC0415

        kind = getattr(resource, name)
        _, highest = resource.getrlimit(kind)
        lower = most if highest == resource.RLIM_INFINITY else min(most, highest)
        resource.setrlimit(kind, (lower, highest))


def main() -> None:
    """Serves the pipe, and keeps the limits, that the command line names."""
    number, most_bytes, most_seconds = sys.argv[1:]
    # Whoever started it ends it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _limit_memory(int(most_bytes))
    with socket.socket(fileno=int(number)) as pipe:
        serve(pipe, float(most_seconds))


if __name__ == "__main__":
    # As the module that the messages name.
    importlib.import_module("scenes.limited_process").main()
