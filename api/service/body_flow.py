"""Bodies of requests and answers, as they flow: no more than is allowed, and not slower."""

from __future__ import annotations

import asyncio
import time
from contextlib import suppress

from starlette.datastructures import Headers
from starlette.types import Message, Receive, Send

from api.service.problems import ProblemError
from api.service.settings import Limits

DRAIN_S = 2.0


class BodyFlow:
    """Stands between a server and an application, for one request.

    Args:
        receive: Of the server.
        send: Of the server.
        limits: Of the service.
        most_bytes: Of the request's body.
        remedy: What a client can do whose body is larger.

    Attributes:
        finished: Whether the whole body has come in.
    """

    def __init__(self, receive: Receive, send: Send, limits: Limits, most_bytes: int, remedy: str) -> None:
        self._remedy = remedy
        self._receive, self._send, self._limits, self._most = receive, send, limits, most_bytes
        self._bytes = 0
        self._until = time.monotonic() + limits.body_s
        self.finished = True

    def check_length(self, headers: Headers) -> None:
        """Refuse what states itself to be too large.

        Raises:
            ProblemError: It does.
        """
        length = headers.get("content-length", "")
        self.finished = "transfer-encoding" not in headers and length in ("", "0")
        if length.isdecimal() and int(length[:30]) > self._most:
            raise self._too_large()

    async def receive(self) -> Message:
        """The next piece.

        Raises:
            ProblemError: There is too much, or it takes too long.
        """
        # After the body only the end of the connection comes, whenever that is.
        message = await (self._receive() if self.finished else self._in_time())
        if message["type"] == "http.request":
            self._bytes += len(message.get("body", b""))
            if self._bytes > self._most:
                raise self._too_large()
            self.finished = not message.get("more_body", False)
        return message

    async def send(self, message: Message) -> None:
        """Sends a piece of the answer.

        Raises:
            ConnectionError: The client does not take it.
        """
        try:
            async with asyncio.timeout(self._limits.response_idle_s):
                await self._send(message)
        except TimeoutError:
            raise ConnectionAbortedError from None

    async def drain(self) -> None:
        """Lets go by what a client is still sending: it does not listen to an answer before."""
        rest = self._most
        with suppress(TimeoutError):
            async with asyncio.timeout(min(self._limits.body_idle_s, DRAIN_S)):
                while not self.finished and rest > 0:
                    message = await self._receive()
                    rest -= len(message.get("body", b""))
                    self.finished = not message.get("more_body", False)

    async def _in_time(self) -> Message:
        rest_s = min(self._limits.body_idle_s, self._until - time.monotonic())
        try:
            async with asyncio.timeout(max(rest_s, 0)):
                return await self._receive()
        except TimeoutError:
            raise ProblemError(
                "slow-client",
                "The body of this request comes in too slowly.",
                known=f"The service waits {self._limits.body_idle_s:g} s for each piece, "
                f"and {self._limits.body_s:g} s for all.",
            ) from None

    def _too_large(self) -> ProblemError:
        return ProblemError(
            "too-large",
            f"The body of this request is larger than the {self._most:,} bytes that the service takes here.",
            remedy=self._remedy,
        )
