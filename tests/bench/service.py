"""`make bench`: recommendations a second over HTTP, beside a bare FastAPI route that returns the same bytes.

The server is a process of its own; this one asks, over connections that stay open, each its next question as
soon as it has its answer.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import uvicorn
from fastapi import FastAPI, Request, Response
from rich.console import Console
from rich.table import Table

from api.service.listening import serve
from api.service.settings import Settings
from features.table import NAMES
from models.artifact import load
from models.shipped import SHIPPED_MODEL

ROUTE = "/v1/recommendations"
CONNECTIONS = (1, 8, 64)
VIEWS = (1, 4)
WARM_UP_S = 1.0

Json = dict[str, Any]


def question(model: Path, views: int) -> bytes:
    """A spot of which every feature is as usual."""
    ranges = load(model).card["ranges"]
    values = {name: ranges[name][1] for name in NAMES} | {"is_spot": 1, "is_point": 0, "is_directional": 0}
    return json.dumps({"kind": "spot", "views": [values] * views}).encode()


def bare(answer: bytes) -> FastAPI:
    """What the framework costs without us: it takes the same body, and gives the same bytes."""
    app = FastAPI()

    @app.post(ROUTE)
    async def route(request: Request) -> Response:
        await request.body()
        return Response(answer, media_type="application/json")

    return app


def run_server(kind: str, model: Path, state: Path) -> None:
    """The process that answers; it says its port on its first line."""

    def say(url: str) -> None:
        sys.stdout.write(f"{url.rpartition(':')[2]}\n")
        sys.stdout.flush()

    if kind == "ours":
        serve(Settings(state=state, model=model, port=0, readers=1), say)
        return
    server = uvicorn.Server(
        uvicorn.Config(bare((state / "answer").read_bytes()), http="h11", log_level="error")
    )
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        say(f":{listener.getsockname()[1]}")
        server.run(sockets=[listener])


@contextmanager
def served(kind: str, model: Path, state: Path) -> Iterator[int]:
    """The port of a server in a process of its own."""
    command = [sys.executable, __file__, "--serve", kind, "--model", str(model), "--state", str(state)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        yield int(process.stdout.readline())
    finally:
        process.terminate()
        process.communicate()


async def asked(port: int, body: bytes, until: float, times: list[float]) -> bytes:
    """Asks over one connection until the time is over; gives the last answer."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    head = f"POST {ROUTE} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    request = f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body
    answer = b""
    while time.perf_counter() < until:
        start = time.perf_counter()
        writer.write(request)
        headers = await reader.readuntil(b"\r\n\r\n")
        assert headers.startswith(b"HTTP/1.1 200"), headers
        (length,) = (line for line in headers.lower().split(b"\r\n") if line.startswith(b"content-length:"))
        answer = await reader.readexactly(int(length.partition(b":")[2]))
        times.append(time.perf_counter() - start)
    writer.close()
    await writer.wait_closed()
    return answer


async def loaded(port: int, body: bytes, connections: int, seconds: float) -> tuple[Json, bytes]:
    """Figures of so many connections at once, and an answer."""
    await asked(port, body, time.perf_counter() + WARM_UP_S, [])
    times: list[float] = []
    start = time.perf_counter()
    answers = await asyncio.gather(*(asked(port, body, start + seconds, times) for _ in range(connections)))
    took_s = time.perf_counter() - start
    middle, late = np.percentile(times, (50, 99)) * 1000
    figures = {"connections": connections, "a_second": len(times) / took_s, "p50_ms": middle, "p99_ms": late}
    return figures, answers[0]


def measured(model: Path, views: int, seconds: float) -> list[Json]:
    """Ours and the bare one, at each number of connections."""
    body, rows = question(model, views), []
    with tempfile.TemporaryDirectory() as name:
        state = Path(name)
        answer = b""
        with served("ours", model, state / "state") as port:
            for connections in CONNECTIONS:
                figures, answer = asyncio.run(loaded(port, body, connections, seconds))
                rows.append({"server": "gnomon serve", "views": views, "bytes": len(answer), **figures})
        (state / "answer").write_bytes(answer)
        with served("bare", model, state) as port:
            for connections in CONNECTIONS:
                figures, same = asyncio.run(loaded(port, body, connections, seconds))
                assert same == answer
                rows.append({"server": "bare route", "views": views, "bytes": len(answer), **figures})
    return rows


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--model", type=Path, default=SHIPPED_MODEL)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--serve", choices=("ours", "bare"), help=argparse.SUPPRESS)
    parser.add_argument("--state", type=Path, help=argparse.SUPPRESS)
    wanted = parser.parse_args()
    if wanted.serve:
        run_server(wanted.serve, wanted.model, wanted.state)
        return
    rows = [row for views in VIEWS for row in measured(wanted.model, views, wanted.seconds)]
    table = Table("server", "views", "connections", "a second", "p50 ms", "p99 ms", title="Recommendations")
    for row in rows:
        numbers = f"{row['a_second']:.0f}", f"{row['p50_ms']:.1f}", f"{row['p99_ms']:.1f}"
        table.add_row(row["server"], str(row["views"]), str(row["connections"]), *numbers)
    Console().print(table)
    if wanted.json:
        wanted.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
