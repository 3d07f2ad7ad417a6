"""The service listening at an address, until it is told to stop."""

from __future__ import annotations

import errno
import ipaddress
import logging
import os
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import uvicorn
from fastapi import FastAPI

from api.service.application import Entries, create_app
from api.service.guard import is_loopback
from api.service.settings import Settings
from api.service.waiting_protocol import waiting
from scenes.errors import GnomonError

TOKEN_VARIABLE = "GNOMON_TOKEN"  # noqa: S105  the name of a variable
SHORTEST_TOKEN, LONGEST_TOKEN = 16, 1024
GRACE_S = 3
BACKLOG = 128


class ServeError(GnomonError):
    """A service that cannot be started as it was asked for."""

    exit_code = 2


def token_of(file: Path | None) -> str:
    """The token in a file or, without one, in the environment; empty where there is neither.

    Raises:
        ServeError: The file cannot be read, or what is in it is no token.
    """
    if file is None:
        token, where = os.environ.get(TOKEN_VARIABLE, "").strip(), TOKEN_VARIABLE
        if not token:
            return ""
    else:
        token, where = _read(file), str(file)
    fit = token.isascii() and token.isprintable() and " " not in token
    if not fit or not SHORTEST_TOKEN <= len(token) <= LONGEST_TOKEN:
        raise ServeError(
            "This is no token.",
            where=where,
            known=f"One has {SHORTEST_TOKEN} to {LONGEST_TOKEN} letters, digits and signs, and no spaces.",
            remedy="`openssl rand -hex 24` makes one.",
        )
    return token


def check(settings: Settings) -> None:
    """Refuse what would let strangers in.

    Raises:
        ServeError: Others could reach it, and nothing keeps them out.
    """
    if not is_loopback(settings.host) and not settings.token:
        raise ServeError(
            "Beyond this machine the service asks for a token, and none was given.",
            where=settings.host,
            remedy=f"Give one with --token-file FILE or {TOKEN_VARIABLE}, or leave --host out.",
        )


def serve(settings: Settings, announce: Callable[[str], None], entries: Entries | None = None) -> None:
    """Runs the service until a signal ends it.

    Args:
        settings: How it is set up.
        announce: Told its address once it answers there.
        entries: What runs in its processes.

    Raises:
        ServeError: It cannot listen there, or must not.
        JobStoreError: Its folder cannot be used.
        Exception: Whatever else keeps it from starting or ending, which is a bug.
    """
    check(settings)
    # Ctrl-C is how it is told to stop, however early.
    with suppress(KeyboardInterrupt):
        _serve(settings, announce, entries)


def _serve(settings: Settings, announce: Callable[[str], None], entries: Entries | None) -> None:
    app = create_app(settings, entries)
    # What goes wrong with a request is logged by our own code, with the request's id.
    logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
    with listening(settings) as listener:
        server = _Server(configuration(app, settings), lambda: announce(url_of(settings.host, listener)))
        ended: SystemExit | None = None
        try:
            with suppress(KeyboardInterrupt):
                server.run(sockets=[listener])
        except SystemExit as error:
            ended = error
        # It says nothing of what its application raised, neither when it starts nor when it ends.
        failure = getattr(app.state, "failure", None) or ended
        if failure is not None:
            raise failure


def configuration(app: FastAPI, settings: Settings) -> uvicorn.Config:
    """What uvicorn is told."""
    return uvicorn.Config(
        app,
        http=waiting(settings.limits),
        ws="none",
        lifespan="on",
        # Its logs go where ours go, and ours name no client.
        log_config=None,
        access_log=False,
        server_header=False,
        date_header=False,
        proxy_headers=False,
        timeout_graceful_shutdown=GRACE_S,
    )


def url_of(host: str, listener: socket.socket) -> str:
    """Where a browser finds it."""
    port = listener.getsockname()[1]
    name = f"[{host}]" if ":" in host and not host.startswith("[") else host
    anywhere = host in ("0.0.0.0", "::")  # noqa: S104  told apart, not bound
    return f"http://{'127.0.0.1' if anywhere else name}:{port}"


class _Server(uvicorn.Server):
    """Says when it answers."""

    def __init__(self, config: uvicorn.Config, on_start: Callable[[], None]) -> None:
        super().__init__(config)
        self._on_start = on_start

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start, and say so."""
        await super().startup(sockets)
        if self.started:
            self._on_start()


@contextmanager
def listening(settings: Settings) -> Iterator[socket.socket]:
    """A socket at the address that is wanted.

    Raises:
        ServeError: The service cannot listen there.
    """
    host = settings.host.strip("[]")
    try:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        with suppress(ValueError):
            host = str(ipaddress.ip_address(host))
        # asyncio sends small answers at once only where the protocol is named; else each waits 40 ms for an
        # acknowledgement that the client delays (as measured).
        with socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listener:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind((host, settings.port))
            listener.listen(BACKLOG)
            listener.setblocking(False)  # noqa: FBT003  so the socket wants it
            yield listener
    except OSError as error:
        remedies = {
            errno.EADDRINUSE: "Another program listens there: stop it, or choose another with --port.",
            errno.EACCES: "Ports below 1024 belong to the system: choose another with --port.",
        }
        raise ServeError(
            "The service cannot listen there.",
            where=f"{settings.host}:{settings.port}",
            known=f"The system says: {error.strerror or error}.",
            remedy=remedies.get(error.errno or 0, "Choose another --host or --port."),
        ) from error


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8").strip()
    except (OSError, ValueError) as error:
        raise ServeError("The token cannot be read.", where=str(file), known=f"{error}.") from error
