"""Ends a connection when its time is up or its request is cancelled, whatever it is waiting for."""

from __future__ import annotations

import socket
from contextlib import ExitStack, suppress
from threading import Lock, Timer
from types import TracebackType
from typing import Self

from .cancellation import Cancellation
from .errors import CancelledRequestError, TimedOutError


class ConnectionGuard:
    """Watches one connection.

    A socket's own timeout is for each call that waits: a service that sends a byte now and then would hold
    the caller for ever.

    Args:
        seconds: How long all of it may take.
        cancellation: Which also ends it.
        who: The service, for messages.
    """

    def __init__(self, seconds: float, cancellation: Cancellation, who: str) -> None:
        self._seconds, self._cancellation, self._who = seconds, cancellation, who
        self._timer = Timer(seconds, self._expire)
        self._timer.daemon = True
        self._expired = False
        self._socket: socket.socket | None = None
        self._lock = Lock()
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        self._timer.start()
        self._stack.enter_context(self._cancellation.interrupting(self._end))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._timer.cancel()
        self._stack.close()
        with self._lock:
            self._socket = None

    def watch(self, connected: socket.socket) -> None:
        """Ends this connection when the time comes.

        Raises:
            TimedOutError: It has come already.
            CancelledRequestError: The request is cancelled already.
        """
        with self._lock:
            self._socket = connected
        self.check()

    def check(self) -> None:
        """Goes on only if there is time, and nobody has cancelled.

        Raises:
            TimedOutError: The time is up.
            CancelledRequestError: The request is cancelled.
        """
        if self._cancellation.cancelled:
            raise CancelledRequestError("The request was cancelled.")
        if self._expired:
            raise TimedOutError(f"{self._who} has not answered within {self._seconds:g} s.")

    def _expire(self) -> None:
        self._expired = True
        self._end()

    def _end(self) -> None:
        with self._lock:
            if self._socket is not None:
                with suppress(OSError):
                    # Not SSLSocket's own, which would also take its state away from under the other thread.
                    socket.socket.shutdown(self._socket, socket.SHUT_RDWR)
