"""A service that answers every route with a sample."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlsplit

from tests.api.client.sample_answers import JOB, LEVEL, MEASURED, RECOMMENDATION, job
from tests.api.client.scripted_service import Scripted, answer, json_answer, problem, scripted

FEATURES = {"extractor": "e", "features": [{"name": "n", "group": "g", "unit": "m", "meaning": "M."}]}
NAMED = 'Content-Disposition: attachment; filename="street.annotated.glb"'
DONE = (
    "event: state\nid: 1\ndata: " + json_answer(job("done", 10)).partition(b"\r\n\r\n")[2].decode() + "\n\n"
)
ANSWERS = {
    "GET /v1/features": json_answer(FEATURES),
    "POST /v1/recommendations": json_answer(RECOMMENDATION),
    "POST /v1/levels": json_answer(LEVEL),
    "POST /v1/levels/annotated": answer(b"glTF", NAMED, kind="model/gltf-binary"),
    "POST /v1/jobs": json_answer(JOB, status=202),
    "GET /v1/jobs/abc/events": answer(DONE, kind="text/event-stream"),
    "GET /v1/jobs/abc/result": json_answer({**MEASURED, "lights": MEASURED["lights"][:1]}),
    "GET /v1/jobs/abc/annotated": answer(b"glTF", NAMED, kind="model/gltf-binary"),
    "GET /v1/jobs/abc/report": answer("<html>", kind="text/html"),
}


@contextmanager
def route_service() -> Iterator[Scripted]:
    def script(connection: socket.socket, service: Scripted) -> None:
        asked = service.asked[-1]
        route = f"{asked.method} {urlsplit(asked.target).path}"
        connection.sendall(ANSWERS.get(route, problem(404, f"There is no {route}.")))

    with scripted(script) as service:
        yield service
