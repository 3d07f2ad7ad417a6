"""Everything that goes wrong, as `application/problem+json` (RFC 9457) with a sentence."""

from __future__ import annotations

import errno
import json
import re
import sqlite3
from collections.abc import Mapping
from typing import Any

from fastapi import Response
from starlette.exceptions import HTTPException

from api.wording import shortened
from scenes.errors import GnomonError

JSON, MEDIA_TYPE = "application/json", "application/problem+json"
TYPE_PREFIX = "urn:gnomon:problem:"
LONGEST = 2000

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
    "gone": (410, "The files of the job are gone"),
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
# What the command line calls by an option is a query parameter here.
_OPTION = re.compile(r"--(scene|light|camera|technique|policy|mobility|resolution|rounds)\b")

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
    remedy = _OPTION.sub(r"the query parameter \1", error.remedy) if kind == "bad-level" else error.remedy
    return ProblemError(kind, detail, known=error.known, remedy=remedy)


def no_room() -> ProblemError:
    """What is said where the disk is full."""
    return ProblemError(
        "storage", "The disk of the service is full.", remedy="Free some space, or ask who runs it."
    )


def is_full(error: BaseException | None) -> bool:
    """Whether a full disk is what has caused an error."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
            return True
        error = error.__cause__
    return False


def unwritten(error: sqlite3.Error) -> ProblemError:
    """What is said where the queue of jobs cannot be written or read."""
    return ProblemError(
        "storage",
        "The queue of jobs cannot be written.",
        known=f"SQLite says: {error}.",
        remedy="Free some space, or ask who runs the service.",
    )


def bytes_of(values: Any) -> bytes:
    """JSON as it is sent: names of levels may hold what UTF-8 has no bytes for, so it is escaped."""
    return json.dumps(values, allow_nan=False, separators=(",", ":")).encode()


def response_of(problem: ProblemError) -> Response:
    """What is sent."""
    return Response(bytes_of(problem.record()), problem.status_code, problem.headers, MEDIA_TYPE)
