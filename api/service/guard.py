"""What every request passes, as plain ASGI: who may ask, how much and how slowly, and what is said of it.

A browser page of any other site can send requests to 127.0.0.1. Its `Host` is then not ours, where the site
has let its name point here (DNS rebinding), or its `Origin` is not.
"""

from __future__ import annotations

import hmac
import ipaddress
import logging
import secrets
import socket
import time
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.service.body_flow import BodyFlow
from api.service.metrics import Metrics
from api.service.problems import ProblemError, response_of
from api.service.settings import Settings
from api.wording import shortened

OPEN_PATHS = ("/", "/healthz", "/readyz")
PAGE_FOLDER = "/page/"
LEVEL_PATHS = ("/v1/levels", "/v1/levels/annotated", "/v1/jobs")
QUESTIONS, ENDLESS = "/v1/recommendations", "/events"
BODILESS = ("GET", "HEAD")
LOOPBACK_NAMES = ("localhost",)
LONGEST_HOST = 300
# Answers are data for those who asked: they are never framed, guessed at, kept or sent elsewhere.
SECURITY_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "X-Frame-Options": "SAMEORIGIN",
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
}

log = logging.getLogger(__name__)


class Guard:
    """Stands before the application.

    Args:
        app: The application.
        settings: Of the service.
        metrics: Where requests are counted.
    """

    def __init__(self, app: ASGIApp, settings: Settings, metrics: Metrics) -> None:
        self._app, self._settings, self._metrics = app, settings, metrics
        self._names = _names(settings)
        self._any_address = not is_loopback(settings.host)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request pass, or answer it with what is wrong with it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            # There are no web sockets here.
            await send({"type": "websocket.close", "code": 1008})
            return
        await self._answered(scope, receive, send)

    async def _answered(self, scope: Scope, receive: Receive, send: Send) -> None:
        start, request_id = time.perf_counter(), secrets.token_hex(8)
        flow = BodyFlow(receive, send, self._settings.limits, *_body_limit(scope, self._settings))
        headers, status = Headers(scope=scope), 0
        # Those who send no body listen at once, whatever they announce.
        patient = "expect" not in headers and scope["method"] not in BODILESS
        inner = _as_get(scope)

        async def noted(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                if patient and status not in (408, 401, 403, 421):
                    await flow.drain()
                _complete(message, request_id, closing=not flow.finished)
            await flow.send(message)

        try:
            self._check(scope)
            flow.check_length(headers)
            await self._app(inner, flow.receive, noted)
        except ProblemError as problem:
            if not status:
                await response_of(problem)(scope, flow.receive, noted)
        except (ConnectionError, ClientDisconnect):
            log.info("%s the client has gone", request_id)
        except Exception:
            log.exception("%s a bug", request_id)
            if status:
                raise
            await response_of(_bug(request_id))(scope, flow.receive, noted)
        finally:
            seconds = time.perf_counter() - start
            # Paths of jobs are keys to them: the log has the route.
            path = getattr(inner.get("route"), "path", ascii(shortened(scope["path"], 200)))
            log.info("%s %s %s %s %.1f ms", request_id, scope["method"], path, status or "-", 1000 * seconds)
            self._metrics.answered({**inner, "method": scope["method"]}, status, seconds)

    def _check(self, scope: Scope) -> None:
        headers = Headers(scope=scope)
        hosts = headers.getlist("host")
        name = _host_name(hosts[0]) if len(hosts) == 1 else None
        if name is None or not self._is_ours(name):
            raise ProblemError(
                "foreign-host",
                "This service is not called so.",
                known=f"The request is for {shortened(', '.join(hosts) or 'no host', LONGEST_HOST)!r}.",
                remedy="Use its address, or start it with --allow-host NAME.",
            )
        for origin in headers.getlist("origin"):
            if origin.lower() not in (f"http://{hosts[0]}".lower(), f"https://{hosts[0]}".lower()):
                raise ProblemError(
                    "foreign-origin",
                    "A page of another site has sent this request.",
                    known=f"Its origin is {shortened(origin, LONGEST_HOST)!r}.",
                    remedy="Use the page that the service itself shows at /.",
                )
        if self._settings.token and not _is_open(scope):
            self._check_token(headers)

    def _check_token(self, headers: Headers) -> None:
        scheme, _, given = headers.get("authorization", "").partition(" ")
        wanted = self._settings.token.encode()
        if scheme.lower() != "bearer" or not hmac.compare_digest(given.strip().encode(), wanted):
            raise ProblemError(
                "no-token",
                "This service wants a token with every request, and this one has none or a wrong one."
                if given
                else "This service wants a token with every request.",
                remedy="Send Authorization: Bearer TOKEN.",
                headers={"WWW-Authenticate": 'Bearer realm="gnomon"'},
            )

    def _is_ours(self, name: str) -> bool:
        if name in self._names:
            return True
        try:
            address = ipaddress.ip_address(name)
        except ValueError:
            return False
        # Nobody can let another's name point to it: an address is no name.
        return address.is_loopback or self._any_address


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches what listens there."""
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host.lower() in LOOPBACK_NAMES


def _names(settings: Settings) -> frozenset[str]:
    own = () if is_loopback(settings.host) else (settings.host, socket.gethostname())
    return frozenset(name.lower().rstrip(".") for name in (*LOOPBACK_NAMES, *own, *settings.names))


def _host_name(host: str) -> str | None:
    """The name or address in a `Host`, in lower case; None where it is none."""
    try:
        parts = urlsplit(f"//{host}")
        port_is_none_or_number = parts.port is None or parts.port >= 0
    except ValueError:
        return None
    plain = port_is_none_or_number and parts.netloc == host and "@" not in host
    return parts.hostname.rstrip(".") if plain and parts.hostname else None


def _is_open(scope: Scope) -> bool:
    """The page holds nothing of anybody's: its script asks for the token."""
    return scope["path"] in OPEN_PATHS or scope["path"].startswith(PAGE_FOLDER)


def _as_get(scope: Scope) -> Scope:
    """HEAD is answered as GET is; the server leaves the body out. Events would never end."""
    if scope["method"] != "HEAD" or scope["path"].endswith(ENDLESS):
        return scope
    return {**scope, "method": "GET"}


def _body_limit(scope: Scope, settings: Settings) -> tuple[int, str]:
    """How many bytes a body may have, and what to do about more."""
    limits = settings.limits
    if scope["path"] in LEVEL_PATHS:
        remedy = "Leave out what the level does not need for its shadows, such as textures."
        return limits.upload_bytes, remedy
    if scope["path"] == QUESTIONS:
        return limits.question_bytes, "Ask about one light, in as many views as it takes."
    return limits.question_bytes, "Send no body here."


def _complete(message: Message, request_id: str, *, closing: bool) -> None:
    headers = MutableHeaders(scope=message)
    for name, value in SECURITY_HEADERS.items():
        headers.setdefault(name, value)
    headers["X-Request-Id"] = request_id
    if closing:
        # The rest of its body is not waited for.
        headers["Connection"] = "close"


def _bug(request_id: str) -> ProblemError:
    return ProblemError(
        "internal",
        "Something went wrong inside Gnomon. This is a bug, not your fault.",
        known=f"The service's log says more about request {request_id}.",
        remedy="Please report it.",
    )
