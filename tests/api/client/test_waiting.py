from __future__ import annotations

import json
import threading
from typing import Any

import pytest

from api.client import waiting
from api.client.cancellation import Cancellation
from api.client.errors import CancelledRequestError, ProblemError, ServiceUnreachableError, TimedOutError
from api.client.service import Service
from tests.api.client.sample_answers import job
from tests.api.client.scripted_service import json_answer, problem, scripted

HEAD = b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nConnection: close\r\n\r\n"


def stream(*records: dict[str, Any], tail: str = "") -> bytes:
    parts = [f"id: {index}\nevent: state\ndata: {json.dumps(one)}\n\n" for index, one in enumerate(records)]
    return HEAD + "".join([*parts, tail]).encode()


def waited(*scripts: bytes) -> tuple[list[str], list[str]]:
    seen: list[str] = []
    with scripted(*scripts) as fake:
        found = waiting.wait_for_job(
            Service(fake.url), "abc", lambda one: seen.append(f"{one.state} {one.progress.done}"), seconds=60
        )
    assert found.ended
    assert found.state == seen[-1].split()[0]
    return seen, [f"{one.target} {one.headers.get('last-event-id', '')}".strip() for one in fake.asked]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "POLL_S", 0.01)


def test_events_tell_how_far_it_is() -> None:
    seen, asked = waited(stream(job("queued"), job("running", 4), job("running", 9), job("done", 10)))
    assert seen == ["queued 0", "running 4", "running 9", "done 10"]
    assert asked == ["/v1/jobs/abc/events"]


def test_a_stream_that_breaks_off_is_taken_up_again() -> None:
    seen, asked = waited(
        stream(job("queued"), job("running", 4), tail="event: state\ndata: {"),
        json_answer(job("running", 5), "Retry-After: 0"),
        stream(job("running", 5), job("failed", 6)),
    )
    assert seen == ["queued 0", "running 4", "running 5", "failed 6"]
    assert asked == ["/v1/jobs/abc/events", "/v1/jobs/abc", "/v1/jobs/abc/events 1"]


@pytest.mark.parametrize(
    "bad", [HEAD + b"data: garbage\n\n", HEAD + b"\xff\n", b"garbage", json_answer({}), problem(404, "No.")]
)
def test_without_events_it_is_asked(bad: bytes) -> None:
    running = json_answer(job("running", 1), "Retry-After: 0")
    seen, asked = waited(bad, running, bad, running, bad, running, json_answer(job("cancelled", 1)))
    assert seen == ["running 1", "cancelled 1"] if b"data: garbage" not in bad else seen[-1] == "cancelled 1"
    assert asked == ["/v1/jobs/abc/events", "/v1/jobs/abc"] * 3 + ["/v1/jobs/abc"]


def test_a_service_that_is_restarted_meanwhile_is_waited_for() -> None:
    seen, _ = waited(b"", b"", problem(503, "Starting.", "Retry-After: 0"), json_answer(job("done", 10)))
    assert seen == ["done 10"]


def test_a_service_that_stays_away_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "GRACE_S", 0.05)
    with scripted(b"") as fake, pytest.raises(ServiceUnreachableError):
        waiting.wait_for_job(Service(fake.url), "abc")


def test_a_job_that_is_not_known_is_told() -> None:
    with (
        scripted(problem(404, "There is no such job.")) as fake,
        pytest.raises(ProblemError, match="no such"),
    ):
        waiting.wait_for_job(Service(fake.url), "abc")


def test_waiting_ends_when_its_time_is_over() -> None:
    with scripted(json_answer(job("running", 1))) as fake, pytest.raises(TimedOutError, match="goes on"):
        waiting.wait_for_job(Service(fake.url), "abc", seconds=0.3)


def test_waiting_can_be_cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "POLL_S", 100.0)
    cancellation = Cancellation()
    timer = threading.Timer(0.2, cancellation.cancel)
    with scripted(json_answer(job("running", 1))) as fake:
        timer.start()
        with pytest.raises(CancelledRequestError):
            waiting.wait_for_job(Service(fake.url, cancellation=cancellation), "abc")
    timer.join()
