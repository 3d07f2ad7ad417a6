"""What a level may ask of time and memory: told from what it states, before anything is read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenes import level_file
from scenes.errors import LevelError
from scenes.gltf import amounts, buffers, nodes
from scenes.gltf.accessors import AccessorReader
from scenes.level_file import read_level_file
from scenes.ray_caster import RayCaster
from scenes.viewpoints import viewpoints
from tests.scenes.gltf_samples import CORNERS, TETRAHEDRON, Json, carrying, document, lit, read, tetrahedron


def stating(corners: int, vertices: int, **tables: Any) -> Json:
    """A tetrahedron whose accessors state other counts than they have."""
    made = tetrahedron(**tables)
    made["accessors"][0]["count"], made["accessors"][1]["count"] = vertices, corners
    return made


def drawn_by(count: int) -> Json:
    return {"nodes": [{"mesh": 0}] * count, "scenes": [{"nodes": list(range(count))}]}


@pytest.mark.parametrize(
    ("source", "known"),
    [
        (
            stating(3 * 8_000_001, 4),
            ("8,000,001 triangles", "8,000,001 triangles, and nodes and their instances draw it 1 times"),
        ),
        (
            stating(30_000, 4, **drawn_by(801)),
            ("8,010,000 triangles", "instances draw it 801 times; the file stores 10,000"),
        ),
        (
            stating(
                300_000,
                4,
                meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}] * 200}],
            ),
            ("59,999,600 triangles", "59,999,600 triangles, and nodes and their instances draw it 1 times"),
        ),
        (
            stating(3, 24_000_001),
            ("24,000,001 vertices", "instances draw it 1 times; the file stores 24,000,001"),
        ),
    ],
)
def test_more_is_refused_before_any_of_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, source: Json, known: tuple[str, str]
) -> None:
    def too_late(*_: object) -> None:
        raise AssertionError("positions are read")

    monkeypatch.setattr(AccessorReader, "positions", too_late)
    with pytest.raises(LevelError) as caught:
        read(tmp_path, source)
    limit = "24,000,000" if "vertices" in known[0] else "8,000,000"
    assert caught.value.what == f"This level draws {known[0]}; at most {limit} are read."
    assert known[1] in caught.value.known
    assert caught.value.where.endswith("level.gltf, mesh 0")
    assert caught.value.remedy


def test_primitives_without_triangles_are_work_too(tmp_path: Path) -> None:
    primitives = [{"attributes": {"POSITION": 0}, "indices": 1}] * 90
    source = stating(0, 0, meshes=[{"primitives": primitives}], **drawn_by(100_000))
    with pytest.raises(LevelError, match="draws 9,000,000 triangles"):
        read(tmp_path, source)


def test_the_limit_itself_is_read_and_what_is_not_drawn_does_not_count(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = {"attributes": {"POSITION": 0}, "mode": 1}
    hidden = {"mesh": 0, "scale": [0, 0, 0]}
    solid = {"attributes": {"POSITION": 0}, "indices": 1}
    source = tetrahedron(
        nodes=[{"mesh": 0}, hidden, {"mesh": 0}, {"mesh": 0}],
        scenes=[{"nodes": [0, 1, 2]}],
        meshes=[{"primitives": [solid, line]}],
    )
    monkeypatch.setattr(amounts, "MOST_TRIANGLES", 8)
    monkeypatch.setattr(amounts, "MOST_VERTICES", 8)
    assert read(tmp_path, source).scene.triangle_count == 8
    for limit in ("MOST_TRIANGLES", "MOST_VERTICES"):
        with monkeypatch.context() as patched:
            patched.setattr(amounts, limit, 7)
            with pytest.raises(LevelError, match="at most 7 are read"):
                read(tmp_path, source)


def test_too_many_nodes_are_refused_before_they_are_walked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tetrahedron(nodes=[{"mesh": 0}] * 5, scenes=[{"nodes": [0]}])
    monkeypatch.setattr(nodes, "MOST_NODES", 5)
    assert read(tmp_path, source).scene.triangle_count == 4
    monkeypatch.setattr(nodes, "MOST_NODES", 4)
    with pytest.raises(LevelError, match="This level has 5 nodes") as raised:
        read(tmp_path, source)
    assert "EXT_mesh_gpu_instancing" in raised.value.remedy


def in_files(*names: str) -> Json:
    """A tetrahedron whose two arrays lie in files."""
    made = tetrahedron()
    for buffer, name in zip(made["buffers"], names, strict=True):
        buffer["uri"] = name
    return made


def test_a_file_that_many_buffers_name_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    count = 50
    source = document(*[CORNERS] * count)
    source["scenes"], source["nodes"] = [{"nodes": [0]}], [{"mesh": 0}]
    source["meshes"] = [{"primitives": [{"attributes": {"POSITION": i}} for i in range(count)]}]
    for index, buffer in enumerate(source["buffers"]):
        buffer["uri"] = "a.bin" if index % 2 else "./x/../a.bin"
    (tmp_path / "a.bin").write_bytes(CORNERS.tobytes())
    monkeypatch.setattr(buffers, "MOST_BYTES", CORNERS.nbytes)
    level = read(tmp_path, source)
    assert len(level.scene.meshes) == count
    assert all(np.array_equal(mesh.positions, CORNERS) for mesh in level.scene.meshes)


def test_a_file_whose_second_buffer_is_longer(tmp_path: Path) -> None:
    (tmp_path / "both.bin").write_bytes(TETRAHEDRON.tobytes() + b"\0" * 12 + CORNERS.tobytes())
    source = in_files("both.bin", "both.bin")
    source["buffers"][0]["byteLength"] = 36 + CORNERS.nbytes
    source["bufferViews"][0]["byteOffset"] = 36
    for order in ((0, 1), (1, 0)):
        source["meshes"] = [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}, {"attributes": {"POSITION": 0}}]}
        ]
        source["bufferViews"][0]["buffer"], source["bufferViews"][1]["buffer"] = order
        if order == (1, 0):
            source["buffers"].reverse()
        (mesh, _) = read(tmp_path, source).scene.meshes
        assert np.array_equal(mesh.positions, CORNERS)
        assert np.array_equal(mesh.triangles, TETRAHEDRON)


def test_buffer_files_hold_so_much_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.bin").write_bytes(CORNERS.tobytes())
    (tmp_path / "b.bin").write_bytes(TETRAHEDRON.tobytes())
    source, together = in_files("a.bin", "b.bin"), CORNERS.nbytes + TETRAHEDRON.nbytes
    monkeypatch.setattr(buffers, "MOST_BYTES", together)
    assert read(tmp_path, source).scene.triangle_count == 4
    monkeypatch.setattr(buffers, "MOST_BYTES", together - 1)
    with pytest.raises(LevelError, match="hold more than 71 bytes") as caught:
        read(tmp_path, source)
    assert "48 bytes were read before b.bin" in caught.value.known
    assert "buffer 1" in caught.value.where


@pytest.mark.parametrize(
    ("start", "size", "longest"),
    [(b"", 30 * 2**30, 2**30), (b'{"asset"', 2**30 + 1, 2**30), (b"glTF\2\0\0\0", 2**32 + 1, 2**32)],
)
def test_sparse_giants_are_not_read(tmp_path: Path, start: bytes, size: int, longest: int) -> None:
    path = tmp_path / "sparse.glb"
    with path.open("wb") as file:
        file.write(start)
        file.truncate(size)
    with pytest.raises(LevelError, match="too long for a level") as caught:
        read_level_file(path)
    assert caught.value.known == f"It has {size:,} bytes; at most {longest:,} are read."
    assert read_level_file(path, 4) == (start + bytes(4))[:4]


def test_the_longest_files_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(level_file, "LONGEST_FILE", 9)
    monkeypatch.setattr(level_file, "LONGEST_TEXT", 8)
    for content in (b"glTF56789", b"12345678", b"123"):
        path = tmp_path / "level"
        path.write_bytes(content)
        assert read_level_file(path) == content


def test_a_text_of_zeros_behind_the_json_is_read(tmp_path: Path) -> None:
    text = json.dumps(tetrahedron()).encode()
    for padding in (b"\0", b"\0\0\n", b" \0\r\n\0"):
        assert read(tmp_path, text + padding, "level.gltf").scene.triangle_count == 4


@pytest.mark.parametrize("size", [1e-44, 1e-40, 1e-28, 1e-20, 1e20, 1e29])
@pytest.mark.parametrize("kind", ["point", "spot", "directional"])
@pytest.mark.parametrize("away", [12.0, 1e25, 1e40])
def test_tiny_and_huge_levels_and_far_lights_make_no_warnings(
    tmp_path: Path, size: float, kind: str, away: float
) -> None:
    """Warnings are errors in these tests."""
    source = tetrahedron() | document((CORNERS * size).astype(np.float32), TETRAHEDRON.ravel())
    height = min(away * size, 9e29)
    node = carrying(0, translation=[0.0, height, 0.0], rotation=[-(0.5**0.5), 0, 0, 0.5**0.5])
    lamps = lit({"type": kind}, nodes=[{"mesh": 0}, node])
    source |= {key: lamps[key] for key in ("nodes", "scenes", "extensions", "extensionsUsed")}
    scene = read(tmp_path, source).scene
    (light,) = scene.lights
    cameras = viewpoints(scene, light)
    assert len(cameras) in ((0,) if size < 1e-30 else (0, 4))
    caster = RayCaster(scene)
    # Behind the slanted side as the light sees it, and on that side.
    points = np.array([[0.2, 0.0, 0.2], [2 / 3, 1.0, 5 / 3]]) * size
    normals = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    if size > 1e-30:
        assert caster.lit(points, normals, light).tolist() == [False, True]
