"""A service that says what a test tells it to, byte for byte, and remembers what it was asked."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from email.parser import BytesParser
from email.policy import HTTP
from threading import Event, Thread
from typing import Any


@dataclass
class Asked:
    """One request as it came."""

    method: str
    target: str
    headers: dict[str, str]
    body: bytes

    def part(self, index: int) -> tuple[str, str, bytes]:
        """File name, media type and content of a part of a multipart body."""
        head = f"Content-Type: {self.headers['content-type']}\r\n\r\n".encode()
        message = BytesParser(policy=HTTP).parsebytes(head + self.body)
        part = list(message.iter_parts())[index]
        content = part.get_payload(decode=True)
        assert isinstance(content, bytes)
        return part.get_filename() or "", part.get_content_type(), content


@dataclass
class Scripted:
    """Where it is, and what it was asked so far."""

    url: str
    asked: list[Asked] = field(default_factory=list)
    over: Event = field(default_factory=Event)


Script = bytes | Callable[[socket.socket, Scripted], None]


def silent(_: socket.socket, service: Scripted) -> None:
    """A script that says nothing until the test is over."""
    service.over.wait()


def slowly(*pieces: bytes) -> Script:
    """A script that pauses after each piece, until the test is over."""

    def script(connection: socket.socket, service: Scripted) -> None:
        for piece in pieces:
            connection.sendall(piece)
            if service.over.wait(0.05):
                return

    return script


def answer(body: bytes | str, *headers: str, status: int = 200, kind: str = "application/json") -> bytes:
    data = body.encode() if isinstance(body, str) else body
    lines = [f"HTTP/1.1 {status} X", f"Content-Type: {kind}", f"Content-Length: {len(data)}", *headers]
    return "\r\n".join([*lines, "", ""]).encode() + data


def json_answer(value: Any, *headers: str, status: int = 200) -> bytes:
    return answer(json.dumps(value), *headers, status=status)


def problem(status: int, detail: str, *headers: str, **more: str) -> bytes:
    value = {"type": "about:blank", "title": "T", "status": status, "detail": detail, **more}
    return answer(json.dumps(value), *headers, status=status, kind="application/problem+json")


@contextmanager
def scripted(*scripts: Script) -> Iterator[Scripted]:
    """Answers one connection after the other by the scripts; the last one holds for all that follow."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        service = Scripted(f"http://127.0.0.1:{listener.getsockname()[1]}")
        threads: list[Thread] = []

        def serve() -> None:
            for index in range(10_000):
                try:
                    connection, _ = listener.accept()
                except OSError:
                    return
                script = scripts[min(index, len(scripts) - 1)]
                thread = Thread(target=_talk, args=(connection, script, service))
                threads.append(thread)
                thread.start()

        server = Thread(target=serve)
        server.start()
        try:
            yield service
        finally:
            service.over.set()
            listener.shutdown(socket.SHUT_RDWR)
            listener.close()
            server.join()
            for thread in threads:
                thread.join()


def _talk(connection: socket.socket, script: Script, service: Scripted) -> None:
    with connection, suppress(OSError):
        asked = _read(connection)
        if asked:
            service.asked.append(asked)
        if isinstance(script, bytes):
            connection.sendall(script)
        else:
            script(connection, service)


def _read(connection: socket.socket) -> Asked | None:
    data = b""
    while b"\r\n\r\n" not in data:
        more = connection.recv(1 << 16)
        if not more:
            return None
        data += more
    head, _, body = data.partition(b"\r\n\r\n")
    first, *lines = head.decode("latin-1").split("\r\n")
    headers = {name.lower(): value for name, _, value in (line.partition(": ") for line in lines)}
    while len(body) < int(headers.get("content-length", "0")):
        more = connection.recv(1 << 16)
        if not more:
            return None
        body += more
    method, target, _ = first.split(" ")
    return Asked(method, target, headers, body)
