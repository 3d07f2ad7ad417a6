from __future__ import annotations

import asyncio
import json
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace

import pytest
from starlette.datastructures import Headers
from starlette.types import Message

from api.service.body_flow import BodyFlow
from api.service.guard import SECURITY_HEADERS
from api.service.settings import Limits, Settings
from tests.api.service.conftest import LIMITS as LIMITS_OF_SERVICE
from tests.api.service.running_service import PATIENCE_S, Running, assert_is_a_problem, running
from tests.api.service.test_who_may_ask import STRANGE

LIMITS = replace(Limits(), header_s=0.5, body_idle_s=0.5, body_s=1.5, connections=10)
HEAD = b"POST /v1/levels HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/gltf-binary\r\n"


@pytest.fixture(scope="module")
def hurried(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    with running(Settings(state=tmp_path_factory.mktemp("state"), readers=1, limits=LIMITS), STRANGE) as up:
        yield up


def all_of(made: socket.socket) -> bytes:
    """What is sent until the other side closes."""
    found = b""
    try:
        while data := made.recv(1 << 16):
            found += data
    except ConnectionResetError:
        pass
    return found


def answer(data: bytes) -> tuple[int, dict[str, object]]:
    head, _, body = data.partition(b"\r\n\r\n")
    found = json.loads(body)
    assert_is_a_problem(found)
    assert b"application/problem+json" in head
    return int(head.split()[1]), found


def test_a_client_that_says_nothing_is_let_go(hurried: Running) -> None:
    with hurried.connected() as made:
        assert answer(all_of(made))[0] == 408


def test_a_head_that_drips_in_is_not_waited_for(hurried: Running) -> None:
    with hurried.connected() as made:
        made.sendall(b"GET / HTTP/1.1\r\n")
        assert drips(made, b"X-Drip: drop\r\n")


def drips(made: socket.socket, drop: bytes) -> bool:
    """Whether the other side stops listening."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        try:
            made.sendall(drop)
        except OSError:
            return True
        time.sleep(0.05)
    return False


def test_the_second_request_of_a_connection_has_to_come_in_time_too(hurried: Running) -> None:
    with hurried.connected() as made:
        made.sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert b"200" in made.recv(1 << 16)
        made.sendall(b"GET /healthz HT")
        assert b"408" in all_of(made)


def test_a_body_that_does_not_come_is_not_waited_for(hurried: Running) -> None:
    with hurried.connected() as made:
        made.sendall(HEAD + b"Content-Length: 100\r\n\r\nwork")
        assert answer(all_of(made))[0] == 408


def test_a_body_that_drips_in_has_to_end(hurried: Running) -> None:
    with hurried.connected() as made:
        made.sendall(HEAD + b"Content-Length: 100000\r\n\r\n")
        assert drips(made, b"x")


def test_clients_that_leave_in_the_middle_leave_nothing_behind(hurried: Running) -> None:
    for body in (b"", b"work", b"work" * 1000):
        made = hurried.connected()
        made.sendall(HEAD + b"Content-Length: 100000\r\n\r\n" + body)
        made.close()
    with hurried.connected() as made:
        made.sendall(HEAD + b"Content-Length: 4\r\n\r\nwork")
    incoming = hurried.parts.settings.state / "incoming"
    until = time.monotonic() + PATIENCE_S
    while list(incoming.iterdir()) and time.monotonic() < until:
        time.sleep(0.05)
    assert list(incoming.iterdir()) == []
    assert hurried.level(b"work").status_code == 200


def test_only_so_many_clients_are_let_in(hurried: Running) -> None:
    hurried.client.get("/healthz")
    with ExitStack() as open_ones:
        made = [open_ones.enter_context(hurried.connected()) for _ in range(LIMITS.connections + 5)]
        found = [answer(all_of(one))[0] for one in made]
        assert 503 in found
        assert set(found) <= {408, 503}
    assert hurried.client.get("/healthz").status_code == 200


@pytest.mark.parametrize(
    "request_bytes",
    [
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"GET\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET / HTTP/1.1\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: x\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nBad Name: x\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + b"X: " + b"y" * 100_000 + b"\r\n\r\n",
        b"POST /v1/levels HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n",
    ],
)
def test_what_is_no_http_is_refused(hurried: Running, request_bytes: bytes) -> None:
    with hurried.connected() as made:
        made.sendall(request_bytes)
        data = all_of(made)
    assert data.startswith(b"HTTP/1.1 4"), data[:100]
    assert b"Traceback" not in data
    assert hurried.client.get("/healthz").status_code == 200


def test_web_sockets_are_not_spoken(hurried: Running) -> None:
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    response = hurried.client.get("/v1/jobs/x/events", headers={**upgrade, "Sec-WebSocket-Key": "eA=="})
    assert response.status_code == 404


def test_answers_before_any_request_have_all_their_headers(hurried: Running) -> None:
    for request_bytes, first in (
        (b"GET\r\n\r\n", b"HTTP/1.1 400 Bad Request\r\n"),
        (b"", b"HTTP/1.1 408 Request Timeout\r\n"),
    ):
        with hurried.connected() as made:
            made.sendall(request_bytes)
            head = all_of(made).partition(b"\r\n\r\n")[0]
        assert head.startswith(first)
        for name in SECURITY_HEADERS:
            assert f"\r\n{name.lower()}: ".encode() in head.lower()


def test_a_question_without_a_body_is_not_asked_for_one(service: Running) -> None:
    start = time.monotonic()
    with service.connected() as made:
        made.sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\n")
        data = all_of(made)
    assert data.startswith(b"HTTP/1.1 200 OK\r\n")
    assert time.monotonic() - start < LIMITS_OF_SERVICE.body_idle_s


def test_the_rest_of_a_refused_body_is_waited_for_a_moment_only(monkeypatch: pytest.MonkeyPatch) -> None:
    async def receive() -> Message:
        await asyncio.sleep(PATIENCE_S)
        raise AssertionError("nobody waits so long")

    async def send(_: Message) -> None:
        raise AssertionError("nothing is sent")

    monkeypatch.setattr("api.service.body_flow.DRAIN_S", 0.05)
    flow = BodyFlow(receive, send, Limits(), 1000, "")
    flow.check_length(Headers({"content-length": "10"}))
    start = time.monotonic()
    asyncio.run(flow.drain())
    assert time.monotonic() - start < Limits().body_idle_s / 2
    assert not flow.finished
