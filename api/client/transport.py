"""One request over one connection: bounded in time and size, never redirected, never through a proxy."""

from __future__ import annotations

import http.client
import ssl
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from .address import Address
from .cancellation import Cancellation
from .connection_guard import ConnectionGuard
from .errors import BadAnswerError, ServiceUnreachableError, TimedOutError
from .upload import Upload

MOST_SECONDS_CONNECTING = 10.0
CHUNK = 1 << 16


@dataclass(frozen=True)
class Request:
    """What to send.

    Attributes:
        method: HTTP method.
        target: Path and query.
        accept: Media types that are understood.
        seconds: How long all of it may take.
        idle_seconds: How long the service may say nothing.
        upload: What goes with it.
        headers: More headers.
    """

    method: str
    target: str
    accept: str
    seconds: float
    idle_seconds: float
    upload: Upload | None = None
    headers: Mapping[str, str] = field(default_factory=dict)


class Reply:
    """An answer whose body is still to be read."""

    def __init__(self, response: http.client.HTTPResponse, guard: ConnectionGuard) -> None:
        self._response, self._guard = response, guard
        self._declared = response.length
        self.status = response.status
        if response.getheader("Content-Encoding", "identity") != "identity":
            raise BadAnswerError("The answer is compressed, though that was not asked for.")

    @property
    def media_type(self) -> str:
        """Its media type in lower case, without parameters."""
        return (self.header("Content-Type") or "").partition(";")[0].strip().lower()

    def header(self, name: str) -> str | None:
        """A header; None where it is missing."""
        return self._response.getheader(name)

    def all(self, most: int) -> bytes:
        """The whole body.

        Raises:
            BadAnswerError: It is longer than allowed, or shorter than was said.
        """
        too_long = BadAnswerError(f"The answer is longer than the {most:,} bytes that are read of one.")
        if self._declared is not None and self._declared > most:
            raise too_long
        chunks, count = [], 0
        while chunk := self._response.read(CHUNK):
            self._guard.check()
            count += len(chunk)
            if count > most:
                raise too_long
            chunks.append(chunk)
        self._guard.check()
        if self._declared is not None and count < self._declared:
            raise BadAnswerError(f"The answer was cut short after {count:,} of {self._declared:,} bytes.")
        return b"".join(chunks)

    def lines(self, longest: int) -> Iterator[bytes]:
        """The body line by line, as it comes.

        Raises:
            BadAnswerError: A line is longer than allowed.
        """
        while line := self._response.readline(longest + 1):
            self._guard.check()
            if len(line) > longest:
                raise BadAnswerError(f"A line of the answer is longer than {longest:,} bytes.")
            yield line
        self._guard.check()


@dataclass(frozen=True)
class Transport:
    """Sends requests to one address.

    Attributes:
        address: Where to.
        token: Sent as a bearer token; none where empty.
    """

    address: Address
    token: str = field(default="", repr=False)

    @contextmanager
    def sent(self, request: Request, cancellation: Cancellation) -> Iterator[Reply]:
        """The answer to a request; the connection is closed with the block.

        Raises:
            ServiceUnreachableError: There is no answer.
            BadAnswerError: What answers does not speak HTTP.
            CancelledRequestError: The request was cancelled.
        """
        connection = self._connection(min(MOST_SECONDS_CONNECTING, request.seconds))
        with ConnectionGuard(request.seconds, cancellation, f"The service at {self.address}") as guard:
            try:
                guard.check()
                connection.connect()
                guard.watch(connection.sock)
                connection.sock.settimeout(request.idle_seconds)
                self._send(connection, request, guard)
                # A response without more to come takes the socket over: closing the connection is not enough.
                with connection.getresponse() as response:
                    guard.check()
                    yield Reply(response, guard)
            except (OSError, http.client.HTTPException) as error:
                # A connection that was ended on purpose looks broken.
                guard.check()
                raise self._failure(error) from error
            finally:
                connection.close()

    def _connection(self, seconds: float) -> http.client.HTTPConnection:
        address = self.address
        if address.scheme == "https":
            context = ssl.create_default_context()
            return http.client.HTTPSConnection(address.host, address.port, timeout=seconds, context=context)
        return http.client.HTTPConnection(address.host, address.port, timeout=seconds)

    def _send(self, connection: http.client.HTTPConnection, request: Request, guard: ConnectionGuard) -> None:
        connection.putrequest(request.method, self.address.prefix + request.target)
        headers = {"Accept": request.accept, "User-Agent": "gnomon-client", "Connection": "close"}
        if self.token:
            headers["Authorization"] = f"Bearer {self.token}"
        if request.upload:
            headers |= {
                "Content-Type": request.upload.media_type,
                "Content-Length": str(request.upload.length),
            }
        elif request.method == "POST":
            headers["Content-Length"] = "0"
        for name, value in (headers | dict(request.headers)).items():
            connection.putheader(name, value)
        connection.endheaders()
        for chunk in request.upload.chunks() if request.upload else ():
            guard.check()
            try:
                connection.send(chunk)
            except ConnectionError:
                # Who is told "too large" may be told so before all is sent; the answer is there to be read.
                return

    def _failure(self, error: OSError | http.client.HTTPException) -> Exception:
        who = f"The service at {self.address}"
        if isinstance(error, TimeoutError):
            return TimedOutError(f"{who} has said nothing for too long.")
        if isinstance(error, ConnectionRefusedError):
            return ServiceUnreachableError(f"Nobody answers at {self.address}. Start it with `gnomon serve`.")
        if isinstance(error, http.client.IncompleteRead):
            return BadAnswerError(f"{who} broke off in the middle of its answer.")
        if isinstance(error, OSError):
            words = error.strerror or str(error)
            return ServiceUnreachableError(f"{who} cannot be reached: {words}.")
        return BadAnswerError(f"What answers at {self.address} does not speak HTTP.")
