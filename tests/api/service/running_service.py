"""The service as tests run it: with a real server and real connections, in a thread of this process."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import httpx
import uvicorn

from api.service.application import Entries, create_app
from api.service.listening import configuration, listening
from api.service.settings import Settings
from api.service.state import Service
from features.table import NAMES

GLB, GLTF, PROBLEM = "model/gltf-binary", "model/gltf+json", "application/problem+json"
PATIENCE_S = 120.0

Json = dict[str, Any]


@dataclass(frozen=True)
class Running:
    """A service that answers.

    Attributes:
        client: Speaks with it.
        port: Where it is.
        parts: Its insides.
    """

    client: httpx.Client
    port: int
    parts: Service

    def level(
        self, content: bytes, path: str = "/v1/levels", kind: str = GLB, **query: Any
    ) -> httpx.Response:
        return self.client.post(path, params=query, content=content, headers={"Content-Type": kind})

    def job(self, content: bytes, **query: Any) -> Json:
        response = self.level(content, "/v1/jobs", **query)
        assert response.status_code == 202, response.text
        return record(response)

    def state(self, job: str) -> Json:
        response = self.client.get(f"/v1/jobs/{job}")
        assert response.status_code == 200, response.text
        return record(response)

    def ended(self, job: str) -> Json:
        """The record of a job once it has ended."""
        until = time.monotonic() + PATIENCE_S
        while time.monotonic() < until:
            found = self.state(job)
            if found["finished"]:
                return found
            time.sleep(0.02)
        raise AssertionError(f"the job has not ended: {found}")

    def answered(self, route: str) -> int:
        """How many requests for a route were answered well."""
        wanted = f'route="{route}",status="200"'
        lines = self.parts.metrics.text().decode().splitlines()
        return sum(int(float(line.split()[-1])) for line in lines if wanted in line)

    def connected(self) -> socket.socket:
        """A connection on which anything can be sent."""
        made = socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE_S)
        made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return made


@contextmanager
def running(settings: Settings, entries: Entries | None = None) -> Iterator[Running]:
    app = create_app(settings, entries)
    server = uvicorn.Server(configuration(app, settings))
    with listening(replace(settings, host="127.0.0.1", port=0)) as listener:
        port = listener.getsockname()[1]
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            while not server.started:
                assert thread.is_alive(), "the service did not start"
                time.sleep(0.01)
            headers = {"Authorization": f"Bearer {settings.token}"} if settings.token else {}
            url = f"http://127.0.0.1:{port}"
            with httpx.Client(base_url=url, headers=headers, timeout=PATIENCE_S) as client:
                yield Running(client, port, app.state.service)
        finally:
            server.should_exit = True
            thread.join()


def record(response: httpx.Response) -> Json:
    found = response.json()
    assert isinstance(found, dict)
    return found


def problem(response: httpx.Response, status: int, kind: str) -> Json:
    """The problem that is expected, as every problem should be."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == PROBLEM
    found = record(response)
    assert found["status"] == status
    assert found["type"] == f"urn:gnomon:problem:{kind}"
    assert_is_a_problem(found)
    return found


def assert_is_a_problem(found: Json) -> None:
    needed = {"type", "title", "status", "detail"}
    assert needed <= set(found) <= needed | {"known", "remedy"}
    for text in (found["detail"], found.get("known", "."), found.get("remedy", ".")):
        assert text
        # No place of this machine, and nothing of the program.
        assert "/tmp" not in text  # noqa: S108  what must not be there
        assert "Traceback" not in text
        assert ".py:" not in text
    assert found["detail"].endswith("."), found["detail"]


def features(kind: str = "spot") -> Json:
    values = dict.fromkeys(NAMES, 0.5)
    return values | {f"is_{one}": float(one == kind) for one in ("spot", "point", "directional")}


def events(lines: Iterator[str]) -> Iterator[tuple[str, str, Json]]:
    """Id, name and data of server-sent events."""
    fields: dict[str, str] = {}
    for line in lines:
        if line:
            name, _, value = line.partition(": ")
            fields[name] = value
        elif "data" in fields:
            yield fields["id"], fields["event"], json.loads(fields["data"])
            fields = {}
