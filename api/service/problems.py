"""Everything that goes wrong, as `application/problem+json` (RFC 9457) with a sentence."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from fastapi import Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException

from api.wording import shortened
from scenes.errors import GnomonError

JSON, MEDIA_TYPE = "application/json", "application/problem+json"
TYPE_PREFIX = "urn:gnomon:problem:"
LONGEST = 2000
MOST_MISTAKES = 5

# Kind -> status and title.
KINDS: dict[str, tuple[int, str]] = {
    "bad-request": (400, "The request cannot be understood"),
    "no-token": (401, "The token is missing or wrong"),
    "foreign-origin": (403, "The request comes from another site"),
    "not-found": (404, "There is nothing here"),
    "bad-method": (405, "This cannot be done here"),
    "slow-client": (408, "The request took too long to arrive"),
    "not-done": (409, "The job is not done"),
    "already-ended": (409, "The job has ended"),
    "too-large": (413, "The request is too large"),
    "bad-media-type": (415, "Bodies of this type are not read"),
    "foreign-host": (421, "This service is not called so"),
    "bad-value": (422, "A value is wrong"),
    "bad-level": (422, "The level cannot be used"),
    "internal": (500, "Something went wrong inside Gnomon"),
    "not-ready": (503, "The service cannot do this now"),
    "busy": (503, "The service is busy"),
    "queue-full": (503, "The queue is full"),
    "too-long": (504, "The level took too long"),
    "storage": (507, "Nothing more can be stored"),
}
_OF_STATUS = {404: "not-found", 405: "bad-method", 413: "too-large", 415: "bad-media-type"}

Json = dict[str, Any]


class ProblemError(HTTPException):
    """What a client did wrong, or what the service cannot do.

    Args:
        kind: One of `KINDS`.
        detail: One sentence about this very request.
        known: What was found.
        remedy: What the client can do.
        headers: Of the answer.
    """

    def __init__(
        self,
        kind: str,
        detail: str,
        *,
        known: str = "",
        remedy: str = "",
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(KINDS[kind][0], detail, dict(headers or {}))
        self.kind = kind
        self.known = known
        self.remedy = remedy

    def record(self) -> Json:
        """The problem as JSON values."""
        return problem_record(self.kind, self.detail, self.known, self.remedy)


def problem_record(kind: str, detail: str, known: str = "", remedy: str = "") -> Json:
    """A problem as JSON values."""
    status, title = KINDS[kind]
    found: Json = {"type": TYPE_PREFIX + kind, "title": title, "status": status}
    found["detail"] = shortened(detail, LONGEST)
    more = {"known": known, "remedy": remedy}
    return found | {name: shortened(text, LONGEST) for name, text in more.items() if text}


def of_error(error: GnomonError, kind: str = "bad-level") -> ProblemError:
    """One of our errors as a problem."""
    # Where the service's own files lie is nobody's business.
    shown = error.where and kind == "bad-level"
    detail = f"{error.where}: {error.what}" if shown else error.what
    return ProblemError(kind, detail, known=error.known, remedy=error.remedy)


def bytes_of(values: Any) -> bytes:
    """JSON as it is sent: names of levels may hold what UTF-8 has no bytes for, so it is escaped."""
    return json.dumps(values, allow_nan=False, separators=(",", ":")).encode()


def response_of(problem: ProblemError) -> Response:
    """What is sent."""
    return Response(bytes_of(problem.record()), problem.status_code, problem.headers, MEDIA_TYPE)


async def on_http_error(request: Request, error: Exception) -> Response:
    """The answer to what our own code or the framework refuses."""
    if isinstance(error, ProblemError):
        return response_of(error)
    assert isinstance(error, HTTPException)
    kind = _OF_STATUS.get(error.status_code, "bad-request" if error.status_code < 500 else "internal")
    details = {
        "not-found": f"There is no {shortened(request.url.path, 200)} here; /openapi.json lists what is.",
        "bad-method": f"{request.method} cannot be done here.",
    }
    detail = details.get(kind) or f"{str(error.detail).rstrip('.')}."
    return response_of(ProblemError(kind, detail, headers=error.headers))


async def on_invalid(request: Request, error: Exception) -> Response:
    """The answer to values that are not what /openapi.json says."""
    assert isinstance(error, RequestValidationError)
    mistakes: Sequence[Any] = error.errors()
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != JSON and any(one["loc"] == ("body",) for one in mistakes):
        known = f"This came as {shortened(kind, 100)}." if kind else "The request has no Content-Type."
        return response_of(ProblemError("bad-media-type", f"Questions come as {JSON}.", known=known))
    if any(one["type"] == "json_invalid" for one in mistakes):
        known = str(mistakes[0].get("ctx", {}).get("error", ""))
        return response_of(ProblemError("bad-request", "The body is not valid JSON.", known=known))
    words = [_words(one) for one in mistakes[:MOST_MISTAKES]]
    more = len(mistakes) - len(words)
    known = f"There are {more} more such mistakes." if more > 0 else ""
    problem = ProblemError(
        "bad-value", "; ".join(words) + ".", known=known, remedy="/openapi.json says what is taken."
    )
    return response_of(problem)


def _words(mistake: Any) -> str:
    place = ".".join(str(part) for part in mistake["loc"][1:]) or "The body"
    return shortened(f"{place}: {str(mistake['msg']).rstrip('.')}", 300)
