from __future__ import annotations

import base64
import copy
import gzip
import json
import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

from api.service.level_folder import Part, arranged
from api.service.level_names import safe_name
from api.service.settings import Settings
from scenes.errors import LevelError
from tests.api.service.conftest import LIMITS
from tests.api.service.running_service import (
    GLB,
    GLTF,
    PATIENCE_S,
    Json,
    Running,
    assert_is_a_problem,
    problem,
    record,
    running,
)
from tests.scenes.gltf_samples import carrying, glb, tetrahedron
from tests.scenes.test_gltf_draco import bomb, claiming, compressed
from tests.small_level import POINT, small_level, small_scene
from tests.solids import floor


def source_with(uri: str | None) -> Json:
    """A level whose only buffer is at a uri."""
    source = tetrahedron(nodes=[{"mesh": 0}, carrying(0, translation=[0, 6, 0])], scenes=[{"nodes": [0, 1]}])
    source["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
    if uri is not None:
        source["buffers"][0]["uri"] = uri
    return source


def bytes_of(source: Json) -> bytes:
    return json.dumps(source).encode()


def buffer_of(source: Json) -> bytes:
    return base64.b64decode(source["buffers"][0]["uri"].partition(",")[2])


def sent(
    service: Running, source: Json, files: dict[str, bytes], path: str = "/v1/levels"
) -> tuple[int, Json]:
    parts = [("files", (name, content)) for name, content in files.items()]
    response = service.client.post(path, files=[("files", ("room.gltf", bytes_of(source))), *parts])
    return response.status_code, record(response)


NEIGHBOUR = "neighbour.bin"
LEADING_OUT = [
    "http://127.0.0.1:{port}/v1/policies",
    "https://example.org/a.bin",
    "file:///etc/passwd",
    "file:{folder}/neighbour.bin",
    "FILE:///etc/passwd",
    "ftp://example.org/a.bin",
    "{folder}/neighbour.bin",
    "//example.org/share/a.bin",
    "/etc/passwd",
    "../neighbour.bin",
    "../../../../../../../../../../etc/passwd",
    "a/../../neighbour.bin",
    "./../neighbour.bin",
    "%2e%2e/neighbour.bin",
    "%2e%2e%2fneighbour.bin",
    "..%2fneighbour.bin",
    "..%5cneighbour.bin",
    "%2e%2e%5cneighbour.bin",
    "..\\neighbour.bin",
    "a\\..\\..\\neighbour.bin",
    "\\\\host\\share\\a.bin",
    "C:\\neighbour.bin",
    "C:/neighbour.bin",
    "%2fetc%2fpasswd",
    "/proc/self/environ",
    "..%00/neighbour.bin",
    "neighbour.bin%00.txt",
    ".",
    "",
    "..",
    "%252e%252e/neighbour.bin",
    "....//neighbour.bin",
    "~/neighbour.bin",
    "$HOME/neighbour.bin",
    "javascript:alert(1)",
    "a" * 5000,
    "a/" * 2000 + "b",
    "\u202e/neighbour.bin",
]


@pytest.fixture(scope="module")
def folder(service: Running) -> Path:
    """Where uploads lie, with a file in reach of `..` that would be read gladly."""
    state = service.parts.settings.state
    for place in (
        state / "incoming" / NEIGHBOUR,
        state / NEIGHBOUR,
        state / "incoming" / "parts" / NEIGHBOUR,
    ):
        place.parent.mkdir(exist_ok=True)
        place.write_bytes(buffer_of(source_with(None)))
    return state


@pytest.mark.parametrize("uri", LEADING_OUT)
def test_a_uri_is_not_followed_out_of_the_upload(service: Running, folder: Path, uri: str) -> None:
    meant = uri.format(port=service.port, folder=folder)
    asked = service.answered("/v1/policies")
    source = source_with(meant)
    for response in (
        service.level(bytes_of(source), kind=GLTF),
        service.level(glb(source, b""), kind=GLB),
        service.client.post("/v1/levels", files=[("files", ("room.gltf", bytes_of(source)))]),
        # What is sent along has a name, not a place.
        service.client.post(
            "/v1/levels", files=[("files", ("room.gltf", bytes_of(source))), ("files", (meant, b"x" * 8))]
        ),
    ):
        assert response.status_code in (400, 422), response.text
        # What the client itself has said may be repeated.
        said = json.dumps(record(response)).replace(json.dumps(meant[:40])[1:-1], "")
        assert str(folder) not in said
        assert "Traceback" not in said
    assert service.answered("/v1/policies") == asked


def test_files_go_where_the_level_names_them(service: Running) -> None:
    data = buffer_of(source_with(None))
    for uri, name in (
        ("room.bin", "room.bin"),
        ("data/room.bin", "data/room.bin"),
        ("data/room.bin", "room.bin"),
        ("data/room.bin", "anything/else/room.bin"),
        ("a%20room.bin", "a room.bin"),
        ("r%C3%B6mer.bin", "r\u00f6mer.bin"),
        ("data/room.bin", "..\\..\\room.bin"),
        ("data/room.bin", "../../../room.bin"),
    ):
        status, found = sent(service, source_with(uri), {name: data, "unused.png": b"?"})
        assert status == 200, (uri, name, found)
        assert found["level"] == "room.gltf"


def test_the_annotated_level_is_the_gltf(service: Running) -> None:
    source = source_with("room.bin")
    response = service.client.post(
        "/v1/levels/annotated",
        files=[("a", ("room.gltf", bytes_of(source))), ("b", ("room.bin", buffer_of(source_with(None))))],
    )
    assert response.status_code == 200, response.text
    assert response.headers["content-type"] == GLTF
    assert 'filename="room.annotated.gltf"' in response.headers["content-disposition"]
    back = response.json()
    assert back["buffers"] == source["buffers"]
    assert back["nodes"][1]["extras"]["gnomon_source"] == "predicted"


def test_what_was_not_sent_is_named(service: Running) -> None:
    status, found = sent(service, source_with("data/room.bin"), {"other.bin": b"x"})
    assert status == 422
    assert "not sent along" in found["detail"]
    assert "data/room.bin" in found["known"]


def test_pictures_are_not_asked_for(service: Running) -> None:
    source = source_with(None)
    source["images"] = [{"uri": "http://example.org/a.png"}, {"uri": "/etc/passwd"}, {"uri": "missing.png"}]
    assert service.level(bytes_of(source), kind=GLTF).status_code == 200


@pytest.mark.parametrize(
    "files",
    [
        {},
        {"a.bin": b"x"},
        {"a.gltf": b"{}", "b.gltf": b"{}"},
        {"a.glb": b"x", "b.GLB": b"x"},
    ],
)
def test_an_upload_holds_one_level(service: Running, files: dict[str, bytes]) -> None:
    parts = [("files", (name, content)) for name, content in files.items()]
    response = service.client.post("/v1/levels", files=parts or [("files", ("", b""))])
    assert response.status_code in (400, 413, 422)
    assert_is_a_problem(record(response))


def test_names_that_get_in_each_others_way_are_refused(service: Running) -> None:
    source = source_with("a")
    source["buffers"].append({"uri": "a/b", "byteLength": 1})
    status, found = sent(service, source, {"a": buffer_of(source_with(None)), "a/b": b"x"})
    assert status == 422
    assert_is_a_problem(found)


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"--x\r\n",
        b"--x\r\n\r\n\r\n--x--\r\n",
        b'--x\r\nContent-Disposition: form-data; name="a"\r\n\r\nvalue\r\n--x--\r\n',
        b'--x\r\nContent-Disposition: form-data; filename="a.glb"\r\n\r\nvalue\r\n--x--\r\n',
        b'--x\r\nContent-Disposition: form-data; name="a"; filename="a.glb"\r\n\r\ncut off',
        b"--y\r\n" * 100,
        b"\x00\xff" * 500,
        b"--x\r\n" + b"A: b\r\n" * 5000 + b"\r\n\r\n--x--",
    ],
)
def test_damaged_multipart_bodies_are_refused(service: Running, body: bytes) -> None:
    for kind in (
        "multipart/form-data; boundary=x",
        "multipart/form-data",
        'multipart/form-data; boundary=""',
    ):
        response = service.client.post("/v1/levels", content=body, headers={"Content-Type": kind})
        assert response.status_code in (400, 413, 422), response.text
        assert_is_a_problem(record(response))


def test_an_upload_has_only_so_many_parts(service: Running) -> None:
    most = service.parts.settings.limits.parts
    level = ("files", ("a.gltf", bytes_of(source_with(None))))
    many = [("files", (f"{index}.png", b"")) for index in range(most)]
    problem(service.client.post("/v1/levels", files=[level, *many]), 413, "too-large")
    assert service.client.post("/v1/levels", files=[level, *many[1:]]).status_code == 200


def test_a_body_that_states_its_length_is_refused_by_it(service: Running) -> None:
    with service.connected() as made:
        made.sendall(
            b"POST /v1/levels HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/gltf-binary\r\n"
            b"Content-Length: 99999999999999999999\r\nExpect: 100-continue\r\n\r\n"
        )
        # Before any of it was sent.
        assert made.recv(1000).startswith(b"HTTP/1.1 413")


def test_a_body_that_does_not_state_its_length_is_refused_while_it_flows(service: Running) -> None:
    pieces = service.parts.settings.limits.upload_bytes * 3 // 2 >> 16
    body = (bytes(1 << 16) for _ in range(pieces))
    problem(service.client.post("/v1/levels", content=body, headers={"Content-Type": GLB}), 413, "too-large")


def test_whoever_does_not_stop_sending_is_cut_off(service: Running) -> None:
    most = service.parts.settings.limits.upload_bytes
    taken = 0

    def endless() -> Iterator[bytes]:
        nonlocal taken
        while taken < 100 * most:
            taken += 1 << 16
            yield bytes(1 << 16)

    # It is told so, but does not listen before it has sent all.
    with suppress(httpx.TransportError):
        service.client.post("/v1/levels", content=endless(), headers={"Content-Type": GLB})
    assert taken < 10 * most


def test_questions_are_shorter_than_levels(service: Running) -> None:
    body = b" " * (service.parts.settings.limits.question_bytes + 1)
    headers = {"Content-Type": "application/json"}
    problem(service.client.post("/v1/recommendations", content=body, headers=headers), 413, "too-large")


def test_a_level_may_draw_only_so_many_triangles(service: Running, tmp_path: Path) -> None:
    scene = small_scene()
    large = replace(scene, meshes=(floor(8.0, cells=40),))
    found = problem(service.level(small_level(tmp_path, scene=large).read_bytes()), 422, "bad-level")
    assert "3,200 triangles" in found["detail"]
    assert "2,000" in found["detail"]


def test_few_bytes_may_not_stand_for_many_triangles(service: Running) -> None:
    source = source_with(None)
    source["nodes"] = [{"mesh": 0} for _ in range(5000)]
    source["scenes"] = [{"nodes": list(range(5000))}]
    problem(service.level(bytes_of(source), kind=GLTF), 422, "bad-level")
    claims = copy.deepcopy(source_with(None))
    claims["accessors"][1]["count"] = 3_000_000_000
    problem(service.level(bytes_of(claims), kind=GLTF), 422, "bad-level")


@pytest.mark.parametrize(("faces", "points"), [(10**9, 10**9), (2**31 - 1, 3), (3, 2**32 - 1)])
def test_draco_data_may_claim_what_it_likes(service: Running, faces: int, points: int) -> None:
    content = bytes_of(compressed(claiming(faces, points)))
    problem(service.level(content, kind=GLTF), 422, "bad-level")


def test_draco_data_that_unpacks_to_much_is_answered_or_refused(service: Running) -> None:
    response = service.level(bytes_of(compressed(bomb(), 1500, 1500)), kind=GLTF)
    problem(response, 422, "bad-level")
    assert service.parts.pool.lost == {}


def test_compression_on_the_way_is_not_undone(service: Running) -> None:
    packed = gzip.compress(bytes(2 * service.parts.settings.limits.upload_bytes))
    headers = {"Content-Type": GLB, "Content-Encoding": "gzip"}
    problem(service.client.post("/v1/levels", content=packed, headers=headers), 415, "bad-media-type")


def test_a_level_may_ask_about_only_so_many_lights(model: Path, tmp_path: Path) -> None:
    limits = replace(LIMITS, lights=2)
    level = small_level(tmp_path, scene=small_scene((POINT,) * 3)).read_bytes()
    with running(Settings(state=tmp_path / "state", model=model, readers=1, limits=limits)) as up:
        found = problem(up.level(level), 422, "bad-level")
        assert "3 lights" in found["detail"]
        assert up.level(level, light="0").status_code == 200


def test_nothing_of_an_upload_is_left(service: Running, tmp_path: Path) -> None:
    service.level(small_level(tmp_path).read_bytes())
    service.level(b"broken")
    # It is removed after the answer.
    until = time.monotonic() + PATIENCE_S
    while left(service) and time.monotonic() < until:
        time.sleep(0.02)
    assert not left(service)


def left(service: Running) -> set[str]:
    """Uploads that are still there."""
    return {path.name for path in (service.parts.settings.state / "incoming").iterdir()} - {
        NEIGHBOUR,
        "parts",
    }


def test_the_answer_does_not_wait_until_all_is_removed(
    service: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    may_end = threading.Event()
    remove = shutil.rmtree

    def slow(*arguments: Any, **options: Any) -> None:
        assert may_end.wait(PATIENCE_S)
        remove(*arguments, **options)

    monkeypatch.setattr("api.service.receiving.shutil.rmtree", slow)
    try:
        problem(service.level(b"broken"), 422, "bad-level")
        assert left(service)
    finally:
        may_end.set()


def test_what_is_being_removed_is_waited_for(service: Running, monkeypatch: pytest.MonkeyPatch) -> None:
    """A client that sends one level after the other is never told that too many come in at once."""
    remove = shutil.rmtree

    def slow(*arguments: Any, **options: Any) -> None:
        time.sleep(0.2)
        remove(*arguments, **options)

    monkeypatch.setattr("api.service.receiving.shutil.rmtree", slow)
    for _ in range(3 * LIMITS.uploads):
        problem(service.level(b"broken"), 422, "bad-level")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("tower.glb", "tower.glb"),
        ("tower.gltf", "tower.glb"),
        ("tower", "tower.glb"),
        ("../../etc/passwd", "passwd.glb"),
        ("C:\\levels\\Tower 2.GLB", "Tower 2.glb"),
        ("..", "level.glb"),
        (".hidden.glb", "hidden.glb"),
        ("", "level.glb"),
        ("/", "level.glb"),
        ("a\0b\nc\r\u202ed", "a_b_c__d.glb"),
        ('"; rm -rf /', "level.glb"),
        ("x" * 500, "x" * 100 + ".glb"),
        ("\u00e9" * 500, "\u00e9" * 50 + ".glb"),
        ("\ud800", "_.glb"),
    ],
)
def test_names_are_made_harmless(name: str, expected: str) -> None:
    assert safe_name(name, GLB) == expected


def test_a_part_cannot_take_the_levels_own_place(tmp_path: Path) -> None:
    parts = tmp_path / "parts"
    parts.mkdir()
    level = bytes_of(source_with("room.gltf"))
    (parts / "0").write_bytes(level)
    (parts / "1").write_bytes(b"x")
    with suppress(LevelError):
        arranged(tmp_path, [Part("parts/0", "room", GLTF), Part("parts/1", "x/room.bin", "")], "room")
    assert (tmp_path / "level" / "room.gltf").read_bytes() == level
    assert not any(path.is_symlink() for path in tmp_path.rglob("*"))


def test_uris_lead_nowhere_even_without_a_service(tmp_path: Path) -> None:
    for index, uri in enumerate(LEADING_OUT):
        upload = tmp_path / str(index)
        (upload / "parts").mkdir(parents=True)
        (upload / "parts" / "0").write_bytes(bytes_of(source_with(uri)))
        (upload / "parts" / "1").write_bytes(b"mine")
        (tmp_path / NEIGHBOUR).write_bytes(b"theirs")
        with suppress(LevelError):
            arranged(upload, [Part("parts/0", "a.gltf", ""), Part("parts/1", uri, "")], "")
        assert (tmp_path / NEIGHBOUR).read_bytes() == b"theirs"
        assert {path.name for path in upload.iterdir()} == {"parts", "level"}
