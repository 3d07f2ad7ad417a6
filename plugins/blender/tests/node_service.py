"""A service that answers for each light node of a level with what tells the node apart: its name."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from tests.api.client.sample_answers import LEVEL, RECOMMENDATION
from tests.api.client.scripted_service import Scripted, json_answer, scripted


@contextmanager
def node_service(*, problem: str = "") -> Iterator[Scripted]:
    """Times grow with the node's index, so that the last instance of a light is the costliest."""

    def script(connection: socket.socket, service: Scripted) -> None:
        asked = service.asked[-1]
        wanted = {value for key, value in parse_qsl(urlsplit(asked.target).query) if key == "light"}
        lights = []
        for index, node in sorted(light_nodes(asked.body).items()):
            if wanted and f"node:{index}" not in wanted:
                continue
            named = {
                "light": node["name"],
                "index": len(lights),
                "node": index,
                "kind": "spot",
                "problem": problem,
            }
            more = {"shadow_ms": float(index + 1), "reason": f"This is {node['name']}."}
            lights.append(named if problem else {**named, **RECOMMENDATION, **more})
        connection.sendall(json_answer({**LEVEL, "lights": lights}))

    with scripted(script) as service:
        yield service


def light_nodes(level: bytes) -> dict[int, dict[str, Any]]:
    length = int.from_bytes(level[12:16], "little")
    nodes = json.loads(level[20 : 20 + length]).get("nodes", [])
    return {
        index: node for index, node in enumerate(nodes) if "KHR_lights_punctual" in node.get("extensions", {})
    }
