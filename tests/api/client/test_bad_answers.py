"""Whatever answers, or does not, there is a sentence, and never a wait without end."""

from __future__ import annotations

import socket
import threading

import pytest

from api.client.address import Address
from api.client.cancellation import Cancellation
from api.client.errors import (
    AddressError,
    BadAnswerError,
    CancelledRequestError,
    ClientError,
    ProblemError,
    ServiceUnreachableError,
    TimedOutError,
)
from api.client.service import MOST_JSON_BYTES, Service
from tests.api.client.scripted_service import Script, answer, json_answer, problem, scripted, silent, slowly

TECHNIQUES = {"techniques": [{"id": "shadow_map", "label": "SM", "summary": "A map."}]}


def test_nobody_is_there() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    with pytest.raises(ServiceUnreachableError) as caught:
        Service(f"http://127.0.0.1:{port}").techniques()
    assert str(caught.value) == f"Nobody answers at http://127.0.0.1:{port}. Start it with `gnomon serve`."


def test_no_such_host() -> None:
    with pytest.raises(ServiceUnreachableError, match="cannot be reached"):
        Service("http://nowhere.invalid:1").alive()


@pytest.mark.parametrize(
    "script",
    [
        b"",
        b"garbage\r\n\r\n",
        b"\0" * 100_000,
        b"HTTP/1.1 200 OK\r\n" + b"A: b\r\n" * 500 + b"\r\n",
        b"HTTP/1.1 200 OK\r\nA: " + b"b" * 100_000 + b"\r\n\r\n",
        b"HTTP/1.1 abc OK\r\n\r\n",
        answer("{"),
        answer("[]"),
        answer('{"techniques": 3}'),
        answer("<html>", kind="text/html"),
        answer("{}", kind=""),
        answer(b"\x1f\x8b", "Content-Encoding: gzip"),
        answer("{}")[:-1],
        b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n5\r\n{",
        b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\nxyz\r\n{",
        b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: -5\r\n\r\n{",
        b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 99999999999\r\n\r\n{",
        b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n\r\n" + b" " * (MOST_JSON_BYTES + 1),
        b"HTTP/1.1 500 Oops\r\nContent-Type: application/problem+json\r\nContent-Length: 2\r\n\r\n[]",
        b"HTTP/1.1 100 Continue\r\n\r\n" * 300,
    ],
)
def test_garbage_is_told(script: bytes) -> None:
    with scripted(script) as service, pytest.raises(ClientError) as caught:
        Service(service.url, timeout_s=20).techniques()
    assert not isinstance(caught.value, (TimedOutError, ProblemError))
    assert 20 < len(str(caught.value)) < 300


def test_an_answer_that_was_cut_short_says_where() -> None:
    with scripted(answer("{}")[:-1]) as service, pytest.raises(BadAnswerError, match="after 1 of 2 bytes"):
        Service(service.url).techniques()


def test_what_is_too_long_is_not_even_read() -> None:
    head = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 99999999999\r\n\r\n"
    with scripted(head) as service, pytest.raises(BadAnswerError, match="longer than the 67,108,864 bytes"):
        Service(service.url).techniques()


DROPS = [b"x"] * 2_000
JSON_HEAD = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n"


@pytest.mark.parametrize(
    "script",
    [
        silent,
        slowly(JSON_HEAD, b"A: ", *DROPS),
        slowly(JSON_HEAD + b"\r\n", *DROPS),
        slowly(JSON_HEAD + b"Transfer-Encoding: chunked\r\n\r\n", *[b"1\r\nx\r\n"] * 2_000),
    ],
    ids=["silent", "a header letter by letter", "a body letter by letter", "chunks"],
)
def test_no_answer_takes_longer_than_allowed(script: Script) -> None:
    with scripted(script) as service, pytest.raises(TimedOutError):
        Service(service.url, timeout_s=0.3).techniques()


def test_cancelling_ends_a_request_that_waits() -> None:
    cancellation = Cancellation()
    timer = threading.Timer(0.2, cancellation.cancel)
    with scripted(silent) as service:
        asking = Service(service.url, timeout_s=200, cancellation=cancellation)
        timer.start()
        with pytest.raises(CancelledRequestError):
            asking.techniques()
        timer.join()
        with pytest.raises(CancelledRequestError):
            asking.techniques()
    assert len(service.asked) == 1


def test_a_problem_is_told_with_all_its_parts() -> None:
    script = problem(422, "It has no triangles.", known="It has 2 nodes.", remedy="Export it with geometry.")
    with scripted(script) as service, pytest.raises(ProblemError) as caught:
        Service(service.url).techniques()
    error = caught.value
    assert (error.status, error.title, error.detail) == (422, "T", "It has no triangles.")
    assert (error.known, error.remedy) == ("It has 2 nodes.", "Export it with geometry.")
    assert str(error) == "It has no triangles. It has 2 nodes. Export it with geometry."


def test_an_error_without_a_problem_is_one_all_the_same() -> None:
    script = answer("<h1>Bad gateway</h1>", status=502, kind="text/html")
    with scripted(script) as service, pytest.raises(ProblemError, match="502 Bad Gateway, without a reason"):
        Service(service.url).techniques()


def test_nobody_is_sent_elsewhere() -> None:
    with scripted(json_answer(TECHNIQUES)) as other:
        moved = answer("", f"Location: {other.url}/v1/techniques", status=307)
        with scripted(moved) as service, pytest.raises(ProblemError, match="not followed"):
            Service(service.url, token="secret").techniques()  # noqa: S106  no secret
        assert other.asked == []


@pytest.mark.parametrize(
    ("header", "seconds"),
    [("7", 7.0), ("99999", 60.0), ("Wed, 21 Oct 2015 07:28:00 GMT", 0.0), ("soon", None), ("-1", None)],
)
def test_when_to_come_back_is_told(header: str, seconds: float | None) -> None:
    script = problem(503, "The queue is full.", f"Retry-After: {header}")
    with scripted(script) as service, pytest.raises(ProblemError) as caught:
        Service(service.url).techniques()
    assert caught.value.retry_after_s == seconds


def test_patience_asks_again() -> None:
    busy = problem(503, "The queue is full.", "Retry-After: 0")
    with scripted(busy, json_answer(TECHNIQUES)) as service:
        found = Service(service.url, patience_s=30).techniques()
    assert [one.label for one in found.techniques] == ["SM"]
    assert len(service.asked) == 2


def test_impatience_does_not() -> None:
    busy = problem(503, "The queue is full.", "Retry-After: 30")
    with scripted(busy) as service, pytest.raises(ProblemError):
        Service(service.url, patience_s=2).techniques()
    assert len(service.asked) == 1


def test_an_upload_that_is_refused_before_its_end_has_its_reason() -> None:
    def script(connection: socket.socket) -> None:
        connection.recv(1 << 12)
        connection.sendall(problem(413, "The level is too large."))
        connection.shutdown(socket.SHUT_WR)
        while connection.recv(1 << 20):
            pass

    with socket.create_server(("127.0.0.1", 0)) as listener:

        def serve() -> None:
            connection, _ = listener.accept()
            with connection:
                script(connection)

        thread = threading.Thread(target=serve)
        thread.start()
        with pytest.raises(ProblemError, match="too large"):
            Service(f"http://127.0.0.1:{listener.getsockname()[1]}").level(b"glTF" + bytes(50_000_000))
        thread.join()


@pytest.mark.parametrize(
    "url",
    [
        *("", "127.0.0.1:8420", "ftp://a", "http://", "http://a:b", "http://a:99999", "http://u:p@a"),
        *("http://a?b", "http://a/é", "http://a b", "http://[::1"),
    ],
)
def test_what_is_no_address_is_told(url: str) -> None:
    with pytest.raises(AddressError):
        Service(url)


@pytest.mark.parametrize("token", ["a b", "a\r\nHost: b", "é"])
def test_what_is_no_token_is_told(token: str) -> None:
    with pytest.raises(AddressError):
        Service(token=token)


@pytest.mark.parametrize(
    ("url", "loopback"),
    [
        ("http://127.0.0.1:1", True),
        ("http://localhost", True),
        ("http://[::1]:1/a", True),
        ("http://127.0.0.1.example.org", False),
        ("http://192.168.0.1", False),
        ("https://example.org", False),
    ],
)
def test_loopback_is_this_machine_only(url: str, loopback: bool) -> None:  # noqa: FBT001  a parameter of a test
    assert Address.of(url).is_loopback is loopback
