"""The answers to whatever routes raise."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from typing import Any

from fastapi import Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException

from api.service.mistakes import invalid
from api.service.problems import JSON, ProblemError, is_full, no_room, response_of, unwritten
from api.wording import shortened

_OF_STATUS = {404: "not-found", 405: "bad-method", 413: "too-large", 415: "bad-media-type"}
# What the framework says of a body that is not UTF-8, or nested too deep.
_UNREADABLE = "There was an error parsing the body"


async def on_storage(request: Request, error: Exception) -> Response:
    """The answer where the disk does not do what it should.

    Raises:
        Exception: The error, where it is another: a bug.
    """
    del request
    if isinstance(error, sqlite3.Error):
        return response_of(unwritten(error))
    if is_full(error):
        return response_of(no_room())
    raise error


async def on_http_error(request: Request, error: Exception) -> Response:
    """The answer to what our own code or the framework refuses."""
    if isinstance(error, ProblemError):
        return response_of(error)
    assert isinstance(error, HTTPException)
    if error.detail == _UNREADABLE:
        return response_of(
            ProblemError(
                "bad-request",
                "The body is not valid JSON.",
                known="It is not UTF-8, or is nested too deep.",
                remedy="Send JSON in UTF-8.",
            )
        )
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
    return response_of(invalid(request, mistakes))
