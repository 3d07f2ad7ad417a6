"""Server-sent events, read from the lines of an answer.

Source: HTML standard, section 9.2 "Server-sent events".
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from .errors import BadAnswerError

LONGEST_LINE = 1 << 20
MOST_DATA = 1 << 22


@dataclass(frozen=True)
class Event:
    """One event: its kind, its data, and the id by which a stream is taken up again."""

    kind: str
    data: str
    id: str


def events(lines: Iterable[bytes]) -> Iterator[Event]:
    """The events that lines make up; one that is cut short is left out.

    Raises:
        BadAnswerError: A line is no UTF-8, or an event is too long.
    """
    kind, last_id, size = "", "", 0
    data: list[str] = []
    for raw in lines:
        line = _text(raw)
        if not line:
            if data:
                yield Event(kind or "message", "\n".join(data), last_id)
            kind, data, size = "", [], 0
            continue
        name, _, value = line.partition(":")
        value = value.removeprefix(" ")
        if name == "event":
            kind = value
        elif name == "data":
            size += len(value)
            if size > MOST_DATA:
                raise BadAnswerError(f"An event is longer than {MOST_DATA:,} characters.")
            data.append(value)
        elif name == "id" and "\0" not in value:
            last_id = value


def _text(raw: bytes) -> str:
    try:
        return raw.decode().rstrip("\r\n")
    except UnicodeDecodeError:
        raise BadAnswerError("The stream of events is not text.") from None
