"""uvicorn's HTTP protocol with an end to waiting: for the head of a request, and for how many clients."""

from __future__ import annotations

import asyncio
from functools import partial
from http import HTTPStatus
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from api.service.guard import SECURITY_HEADERS
from api.service.problems import MEDIA_TYPE, ProblemError, bytes_of
from api.service.settings import Limits


class WaitingProtocol(H11Protocol):
    """One connection.

    Args:
        limits: Of the service.
        more: What uvicorn gives a protocol.
    """

    def __init__(self, limits: Limits, **more: Any) -> None:
        super().__init__(**more)
        self._limits = limits
        self._head_deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait, unless there are too many already."""
        super().connection_made(transport)
        if len(self.connections) > self._limits.connections:
            self._refuse(
                ProblemError("busy", "Too many clients are connected.", headers={"Retry-After": "5"})
            )
        else:
            self._await_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no more."""
        self._stop_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what comes; the head of a request that has begun has to end in time."""
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE:
            self._stop_waiting()
        elif self._head_deadline is None and not self.transport.is_closing():
            self._await_head()

    def send_400_response(self, msg: str) -> None:
        """Tell a client that does not speak HTTP."""
        self._refuse(ProblemError("bad-request", "This is no valid HTTP request.", known=msg))

    def _await_head(self) -> None:
        self._head_deadline = self.loop.call_later(self._limits.header_s, self._give_up)

    def _stop_waiting(self) -> None:
        if self._head_deadline is not None:
            self._head_deadline.cancel()
            self._head_deadline = None

    def _give_up(self) -> None:
        known = f"The service waits {self._limits.header_s:g} s for its head."
        self._refuse(ProblemError("slow-client", "No request has come in.", known=known))

    def _refuse(self, problem: ProblemError) -> None:
        self._stop_waiting()
        if self.transport.is_closing():
            return
        body = bytes_of(problem.record())
        headers = {
            **SECURITY_HEADERS,
            "Content-Type": MEDIA_TYPE,
            "Content-Length": str(len(body)),
            "Connection": "close",
            **(problem.headers or {}),
        }
        status = HTTPStatus(problem.status_code)
        events: list[Any] = [
            h11.Response(status_code=status, headers=list(headers.items()), reason=status.phrase.encode()),
            h11.Data(data=body),
            h11.EndOfMessage(),
        ]
        # A request that is being answered is not interrupted by another answer.
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            for event in events:
                self.transport.write(self.conn.send(event) or b"")
        self.transport.close()


def waiting(limits: Limits) -> Any:
    """What uvicorn makes a protocol with, for each connection."""
    return partial(WaitingProtocol, limits)
