"""A service's no, from whatever it answered."""

from __future__ import annotations

import time
from email.utils import parsedate_to_datetime
from http.client import responses

from .errors import BadAnswerError, ProblemError
from .reading import parsed, record
from .records import Problem
from .transport import Reply

PROBLEM = "application/problem+json"
MOST_PROBLEM_BYTES = 1 << 20
LONGEST_WAIT_S = 60.0


def refusal(reply: Reply) -> ProblemError:
    """The problem that an answer with an error status stands for.

    Raises:
        BadAnswerError: It says that it is a problem in JSON, and is none.
    """
    status, phrase = reply.status, responses.get(reply.status, "")
    wait = retry_after_s(reply)
    if 300 <= status < 400:
        detail = "The address leads elsewhere, and that is not followed. Give the service's own address."
        return ProblemError(status, phrase, detail, retry_after_s=wait)
    if reply.media_type != PROBLEM:
        detail = f"The answer was {status} {phrase}".rstrip() + ", without a reason: is that the service?"
        return ProblemError(status, phrase, detail, retry_after_s=wait)
    found = record(Problem, parsed(reply.all(MOST_PROBLEM_BYTES)), "problem")
    return ProblemError(
        status,
        found.title,
        found.detail,
        known=found.known or "",
        remedy=found.remedy or "",
        retry_after_s=wait,
    )


def retry_after_s(reply: Reply) -> float | None:
    """When to ask again, in seconds from now, at most a minute; None where the answer does not say."""
    text = (reply.header("Retry-After") or "").strip()
    if text.isascii() and text.isdigit() and len(text) < 9:
        return min(float(text), LONGEST_WAIT_S)
    try:
        moment = parsedate_to_datetime(text)
        return min(max(moment.timestamp() - time.time(), 0.0), LONGEST_WAIT_S)
    except (ValueError, TypeError, OverflowError):
        return None


def require_type(reply: Reply, *wanted: str) -> None:
    """Goes on only if the answer is of one of these media types.

    Raises:
        BadAnswerError: It is of another.
    """
    if reply.media_type not in wanted:
        found = f"is {reply.media_type[:80]}" if reply.media_type else "does not say what it is"
        raise BadAnswerError(
            f"The answer {found} where {' or '.join(wanted)} was expected: is that the service?"
        )
