"""What is too much is refused by the level's JSON alone, before anything is built or made on disk."""

from __future__ import annotations

import json
import time
from pathlib import Path

import pytest

from api.service.level_claims import check_names, check_size
from api.service.level_folder import MOST_FILES, Part, arranged
from scenes.entry import Entry
from scenes.errors import LevelError
from tests.api.service.running_service import GLB, GLTF, Json, Running, problem
from tests.api.service.test_uploads import bytes_of, source_with

MOST_S = 20.0
"""Mostly of a busy machine: to read them all takes minutes."""


def with_lights(count: int) -> Json:
    light = {"extensions": {"KHR_lights_punctual": {"light": 0}}}
    return {"nodes": [light] * count, "scenes": [{"nodes": list(range(count))}]}


def with_meshes(nodes: int, corners: int, mode: int = 4, copies: int = 1) -> Json:
    node: Json = {"mesh": 0}
    if copies > 1:
        node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}
    return {
        "nodes": [node] * nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": mode}]}],
        "accessors": [{"count": corners}, {"count": copies}],
    }


def check(source: Json, scene: str | None = None, *, some: bool = False) -> None:
    check_size(Entry(source, "JSON root"), scene, some_lights=some, lights=5, triangles=100)


@pytest.mark.parametrize(
    ("source", "words"),
    [
        (with_lights(6), "6 lights; the service takes 5"),
        (with_meshes(101, 3), "101 triangles; the service takes 100"),
        (with_meshes(1, 303), "101 triangles"),
        (with_meshes(1, 103, mode=5), "101 triangles"),
        (with_meshes(1, 3, copies=101), "101 triangles"),
    ],
)
def test_too_much_is_counted(source: Json, words: str) -> None:
    with pytest.raises(LevelError, match=words):
        check(source)


def test_what_is_not_read_does_not_count() -> None:
    check(with_lights(5))
    check(with_lights(100), some=True)
    with pytest.raises(LevelError, match="Split"):
        check(with_lights(101), some=True)
    check(with_meshes(100, 3))
    check(with_meshes(1, 1000, mode=1))
    two = with_lights(6) | {"scenes": [{"nodes": [0]}, {"name": "7", "nodes": [0, 1, 2, 3, 4, 5]}]}
    check(two)
    check(two, "0")
    check(two, "none of these")
    for scene in ("1", "7"):
        with pytest.raises(LevelError, match="6 lights"):
            check(two, scene)


@pytest.mark.parametrize(
    "source",
    [
        {"nodes": 3, "scenes": {}},
        {"nodes": [None, {"mesh": True}, {"mesh": 9}, {"children": [0, 1, 2, -1, "x"]}]},
        {"nodes": [{"mesh": 0}], "meshes": [{"primitives": [None, {"indices": 7}, {}]}], "scenes": [None]},
        {"nodes": [{"children": [0]}], "scene": 99, "scenes": [{"nodes": [0]}]},
    ],
)
def test_what_is_malformed_counts_nothing(source: Json) -> None:
    check(source)
    check_names(Entry(source, "JSON root"))


@pytest.mark.parametrize(("table", "one"), [("nodes", "node"), ("cameras", "camera"), ("meshes", "mesh")])
def test_a_name_is_a_word(table: str, one: str) -> None:
    check_names(Entry({table: [{"name": "x" * 4096}]}, "JSON root"))
    with pytest.raises(LevelError, match="too long") as found:
        check_names(Entry({table: [{}, {"name": "x" * 4097}]}, "JSON root"))
    assert found.value.where == f"{one} 1"
    assert len(str(found.value)) < 500


def test_a_bomb_of_lights_is_refused_at_once(service: Running) -> None:
    source = source_with(None)
    source["nodes"] += [{"extensions": {"KHR_lights_punctual": {"light": 0}}}] * 30_000
    source["scenes"] = [{"nodes": list(range(30_002))}]
    content = json.dumps(source, separators=(",", ":")).encode()
    start = time.monotonic()
    found = problem(service.level(content, kind=GLTF), 422, "bad-level")
    assert "30,001 lights" in found["detail"]
    assert time.monotonic() - start < MOST_S


def test_a_long_name_is_refused(service: Running) -> None:
    source = source_with(None)
    source["nodes"][1]["name"] = "Lamp" * 2000
    found = problem(service.level(bytes_of(source), kind=GLTF, name="tower"), 422, "bad-level")
    assert found["detail"] == "tower.gltf, node 1: This name is too long."


def uploaded(folder: Path, uris: list[str]) -> None:
    source = source_with(None)
    source["buffers"] += [{"uri": uri, "byteLength": 1} for uri in uris]
    (folder / "parts").mkdir(parents=True)
    (folder / "parts" / "0").write_bytes(bytes_of(source))
    (folder / "parts" / "1").write_bytes(b"x")
    arranged(folder, [Part("parts/0", "a.gltf", ""), Part("parts/1", "x.bin", "")], "")


@pytest.mark.parametrize(
    ("uris", "words"),
    [
        ([f"{index}/x.bin" for index in range(MOST_FILES + 1)], "257 files"),
        ([f"{index}/b/c/d/x.bin" for index in range(100)], "400 folders"),
        (["/".join("a" * 30) + "/x.bin"], "no name of a file"),
    ],
)
def test_few_bytes_may_not_make_many_folders(tmp_path: Path, uris: list[str], words: str) -> None:
    with pytest.raises(LevelError, match=words) as found:
        uploaded(tmp_path, uris)
    assert found.value.where.startswith("a.gltf")
    assert [path.name for path in (tmp_path / "level").iterdir()] == ["a.gltf"]


def test_as_many_as_an_upload_may_bring_are_made(tmp_path: Path) -> None:
    uploaded(tmp_path, [f"{index}/x.bin" for index in range(MOST_FILES)])
    assert len(list((tmp_path / "level").rglob("x.bin"))) == MOST_FILES


@pytest.mark.parametrize(
    ("body", "kind", "words"),
    [
        (b"garbage", GLB, "tower.glb: This is no GLB."),
        (b'{"asset": {"version": "2.0"}}', GLB, "tower.glb: This is no GLB."),
        (b"glTF\1\0\0\0\0\0\0\0", GLB, "tower.glb, byte 4: Only version 2"),
        (b"garbage", GLTF, "tower.gltf, "),
        (bytes_of(source_with("../a.bin")), GLTF, "tower.gltf, buffer 0: "),
    ],
)
def test_whatever_is_wrong_names_the_level(service: Running, body: bytes, kind: str, words: str) -> None:
    found = problem(service.level(body, kind=kind, name="tower"), 422, "bad-level")
    assert found["detail"].startswith(words)
