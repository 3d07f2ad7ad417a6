"""Broken uploads through the whole service: each gets an answer or a problem, and nothing else happens."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from typing import Any

import psutil
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from api.service.settings import Settings
from tests.api.service.conftest import LIMITS
from tests.api.service.running_service import (
    GLB,
    GLTF,
    PATIENCE_S,
    Running,
    assert_is_a_problem,
    features,
    record,
    running,
)
from tests.scenes.gltf_samples import glb
from tests.scenes.test_gltf_fuzz import BINARY, BYTE_EDITS, EDITS, SOURCE, WHOLE, edited

# As in tests/scenes/test_gltf_fuzz.py; 2,000 in all.
EXAMPLES = os.environ.get("GNOMON_FUZZ_EXAMPLES")
FUZZ = settings(
    max_examples=int(EXAMPLES or 500),
    deadline=None,
    derandomize=EXAMPLES is None,
    suppress_health_check=[HealthCheck.too_slow],
)
MOST_BYTES = 3 << 30
# Answers to the few that are levels would take all the time: they are the business of other tests.
QUERY = {"light": "0", "resolution": "32x32"}


@pytest.fixture(scope="module")
def fuzzed(model: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    state = tmp_path_factory.mktemp("state")
    with running(Settings(state=state, model=model, readers=1, limits=LIMITS)) as up:
        yield up
        # No file is left, no reader was lost, and none has grown.
        until = time.monotonic() + PATIENCE_S
        while list((state / "incoming").iterdir()) and time.monotonic() < until:
            time.sleep(0.02)
        assert list((state / "incoming").iterdir()) == []
        assert up.parts.pool.lost == {}
        # After 500 answers a reader makes room for the next, which takes a moment.
        while not up.parts.pool.pids and time.monotonic() < until:
            time.sleep(0.02)
        held = [psutil.Process(pid).memory_info().rss for pid in up.parts.pool.pids]
        assert held
        assert max(held) < MOST_BYTES
        assert up.client.get("/readyz").status_code == 200


def take(service: Running, content: bytes, kind: str, path: str = "/v1/levels") -> None:
    response = service.level(content, path, kind, **QUERY)
    check(response)


def check(response: Any) -> None:
    if response.status_code == 200:
        return
    assert response.status_code in (400, 413, 415, 422), response.text
    assert_is_a_problem(record(response))


@FUZZ
@given(edits=EDITS)
def test_edited_levels_are_answered_or_refused(
    fuzzed: Running, edits: list[tuple[str, tuple[Any, ...], Any]]
) -> None:
    try:
        content = glb(edited(edits), BINARY)
    except ValueError:  # Numbers of more digits than Python prints.
        return
    take(fuzzed, content, GLB)


@FUZZ
@given(edits=BYTE_EDITS, kind=st.sampled_from([GLB, GLTF]))
def test_damaged_levels_are_answered_or_refused(
    fuzzed: Running, edits: list[tuple[str, int, bytes]], kind: str
) -> None:
    content = WHOLE if kind == GLB else json.dumps(SOURCE).encode()
    for action, place, value in edits:
        tail = {"set": place + len(value), "cut": place + len(value), "insert": place, "end": len(content)}
        middle = b"" if action in ("cut", "end") else value
        content = content[:place] + middle + content[tail[action] :]
    take(fuzzed, content, kind, "/v1/levels/annotated")


NAMES = st.one_of(
    st.sampled_from(
        ["a.gltf", "a.glb", "a.bin", "../a.bin", "/etc/passwd", "b/a.bin", "", "x" * 300, "C:\\a.bin"]
    ),
    st.text(max_size=12),
)
CONTENTS = st.one_of(
    st.binary(max_size=40),
    st.sampled_from([WHOLE, json.dumps(SOURCE).encode(), b"{}", b"[]"]),
    st.text(max_size=20).map(
        lambda uri: json.dumps(
            {"asset": {"version": "2.0"}, "buffers": [{"byteLength": 3, "uri": uri}, {"uri": f"../{uri}"}]}
        ).encode()
    ),
)


@FUZZ
@given(
    parts=st.lists(st.tuples(NAMES, CONTENTS), max_size=4),
    edits=st.lists(st.tuples(st.integers(0, 400), st.binary(max_size=3)), max_size=3),
)
def test_multipart_uploads_are_answered_or_refused(
    fuzzed: Running, parts: list[tuple[str, bytes]], edits: list[tuple[int, bytes]]
) -> None:
    body = b""
    for name, content in parts:
        quoted = name.encode(errors="replace").replace(b'"', b"%22")
        body += b'--x\r\nContent-Disposition: form-data; name="f"; filename="' + quoted + b'"\r\n\r\n'
        body += content + b"\r\n"
    body += b"--x--\r\n"
    for place, value in edits:
        body = body[:place] + value + body[place + len(value) :]
    take(fuzzed, body, "multipart/form-data; boundary=x")


VALUES = st.one_of(
    st.none(), st.booleans(), st.floats(), st.integers(), st.text(max_size=5), st.lists(st.none(), max_size=2)
)


@FUZZ
@given(
    changes=st.dictionaries(st.sampled_from([*features(), "other"]), VALUES, max_size=3),
    more=st.dictionaries(
        st.sampled_from(["kind", "views", "policy", "mobility", "techniques"]), VALUES, max_size=2
    ),
    cut=st.integers(0, 2000),
)
def test_questions_are_answered_or_refused(
    fuzzed: Running, changes: dict[str, Any], more: dict[str, Any], cut: int
) -> None:
    wanted = {"kind": "spot", "views": [features() | changes], "techniques": ["SV"], **more}
    text = json.dumps(wanted).encode()
    content = text if cut > len(text) / 2 else text[:cut]
    headers = {"Content-Type": "application/json"}
    check(fuzzed.client.post("/v1/recommendations", content=content, headers=headers))
