from __future__ import annotations

import pytest

from api.client.errors import BadAnswerError
from api.client.event_stream import MOST_DATA, Event, events


def found(text: str) -> list[Event]:
    return list(events(text.encode().splitlines(keepends=True)))


def test_events_end_at_an_empty_line() -> None:
    text = "event: state\nid: 7\ndata: {}\n\n: a comment\n\nevent:progress\ndata:a\r\ndata: b\r\n\r\n"
    assert found(text) == [Event("state", "{}", "7"), Event("progress", "a\nb", "7")]


def test_one_that_is_cut_short_is_left_out() -> None:
    assert found("data: a\n\ndata: b\n") == [Event("message", "a", "")]


def test_fields_that_are_not_known_are_left_out() -> None:
    assert found("retry: 5\nnonsense\nevent: state\n\ndata: a\n\n") == [Event("message", "a", "")]


def test_one_without_end_is_refused() -> None:
    lines = [b"data: " + b"x" * 60_000 + b"\n"] * (MOST_DATA // 60_000 + 1)
    with pytest.raises(BadAnswerError, match="longer than"):
        list(events(lines))


def test_what_is_no_text_is_refused() -> None:
    with pytest.raises(BadAnswerError, match="not text"):
        list(events([b"data: \xff\n", b"\n"]))
