"""KHR_draco_mesh_compression, encoded here by DracoPy and read back; and data that is none."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.gltf import amounts, draco, draco_process
from tests.scenes.gltf_samples import CORNERS, TETRAHEDRON, Json, data_uri, read, tetrahedron

DracoPy = pytest.importorskip("DracoPy", reason="the extra draco is not installed")
EXTENSION = "KHR_draco_mesh_compression"


def encoded(positions: np.ndarray = CORNERS, triangles: np.ndarray = TETRAHEDRON, **options: Any) -> bytes:
    defaults = {"preserve_order": True, "quantization_bits": 16, "compression_level": 7}
    block: bytes = DracoPy.encode(positions, triangles.astype(np.uint32), **defaults | options)
    return block


BLOCK = encoded()


def compressed(block: bytes = BLOCK, vertices: int = 4, corners: int = 12) -> Json:
    """A level of one primitive that lies in a Draco block alone."""
    source = tetrahedron()
    source["buffers"] = [{"byteLength": len(block), "uri": data_uri(block)}]
    source["bufferViews"] = [{"buffer": 0, "byteLength": len(block)}]
    source["accessors"] = [{"componentType": 5126, "type": "VEC3", "count": vertices}]
    primitive = source["meshes"][0]["primitives"][0]
    primitive["extensions"] = {EXTENSION: {"bufferView": 0, "attributes": {"POSITION": 0}}}
    source["accessors"].append({"componentType": 5123, "type": "SCALAR", "count": corners})
    source["extensionsUsed"] = source["extensionsRequired"] = [EXTENSION]
    return source


@pytest.mark.parametrize(("mode", "corners"), [(4, 12), (5, 6), (5, 99)])
def test_positions_and_triangles_are_what_was_encoded(tmp_path: Path, mode: int, corners: int) -> None:
    """Draco gives triangles for strips, too, of which only the number of corners is stated."""
    source = compressed(corners=corners)
    source["meshes"][0]["primitives"][0]["mode"] = mode
    (mesh,) = read(tmp_path, source).scene.meshes
    np.testing.assert_array_equal(mesh.triangles, TETRAHEDRON)
    np.testing.assert_array_equal(mesh.positions, DracoPy.decode(BLOCK).points)
    np.testing.assert_array_equal(np.round(mesh.positions), CORNERS)
    assert mesh.positions.dtype == np.float32
    assert not mesh.positions.flags.writeable


def test_edgebreaker_gives_the_triangles_that_dracopy_gives(tmp_path: Path) -> None:
    block = encoded(preserve_order=False, compression_level=10)
    other = DracoPy.decode(block)
    (mesh,) = read(tmp_path, compressed(block, len(other.points), other.faces.size)).scene.meshes
    np.testing.assert_array_equal(mesh.positions, other.points)
    np.testing.assert_array_equal(mesh.triangles, other.faces)


def test_the_attribute_is_found_by_its_id(tmp_path: Path) -> None:
    offsets = {7: CORNERS * 3}
    source = compressed(encoded(generic_attributes=offsets))
    attributes = source["meshes"][0]["primitives"][0]["extensions"][EXTENSION]["attributes"]
    attributes["POSITION"] = 7
    (mesh,) = read(tmp_path, source).scene.meshes
    np.testing.assert_array_equal(mesh.positions, CORNERS * 3)


def test_normalised_integers_in_draco_data(tmp_path: Path) -> None:
    stored = np.array([[0, 0, 0], [65535, 0, 0], [0, 65535, 0], [0, 0, 13107]], np.uint16)
    source = compressed(encoded(generic_attributes={3: stored}))
    source["meshes"][0]["primitives"][0]["extensions"][EXTENSION]["attributes"]["POSITION"] = 3
    source["accessors"][0] |= {"componentType": 5123, "normalized": True}
    (mesh,) = read(tmp_path, source).scene.meshes
    expected = (stored / np.float64(65535)).astype(np.float32)
    np.testing.assert_array_equal(mesh.positions, expected)


def test_nodes_and_primitives_that_share_a_block_share_arrays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    original = draco.DracoReader.primitive

    def counted(*arguments: Any, **options: Any) -> Any:
        asked.append(1)
        return original(*arguments, **options)

    monkeypatch.setattr(draco.DracoReader, "primitive", counted)
    source = compressed()
    source["meshes"][0]["primitives"] *= 2
    source["nodes"], source["scenes"] = [{"mesh": 0}, {"mesh": 0}], [{"nodes": [0, 1]}]
    meshes = read(tmp_path, source).scene.meshes
    assert len(meshes) == 4
    assert len({id(mesh.positions) for mesh in meshes}) == len(asked) == 1


def test_where_the_accessors_hold_the_same_they_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that a level has one digest, whether or not the extra is installed."""
    monkeypatch.setattr(draco, "find_spec", lambda _: None)
    source = tetrahedron()
    block = {"bufferView": 0, "attributes": {"POSITION": 0}}
    source["meshes"][0]["primitives"][0]["extensions"] = {EXTENSION: block}
    assert read(tmp_path, source).scene.digest == read(tmp_path, tetrahedron()).scene.digest


def test_without_the_extra_the_error_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(draco, "find_spec", lambda _: None)
    with pytest.raises(LevelError, match="compressed by Draco") as error:
        read(tmp_path, compressed())
    assert "DracoPy" in error.value.known
    assert "pip install 'gnomon[draco]'" in error.value.remedy
    assert "mesh 0, primitive 0" in error.value.where


def refusal(folder: Path, source: Json) -> str:
    with pytest.raises(LevelError) as error:
        read(folder, source)
    assert error.value.remedy
    assert "mesh 0, primitive 0" in error.value.where
    return str(error.value)


@pytest.mark.parametrize(
    ("block", "said"),
    [
        (b"", "It is damaged or no Draco data"),
        (b"DRACO", "It is damaged or no Draco data"),
        (b"glTF" * 9, "It is damaged or no Draco data"),
        (BLOCK[:11], "It is damaged or no Draco data"),
        (BLOCK[: len(BLOCK) // 2], "It is damaged or no Draco data"),
        (BLOCK[:5] + b"\xff\xff" + BLOCK[7:], "It is damaged or no Draco data"),
        (DracoPy.encode(CORNERS), "It holds points without triangles"),
    ],
)
def test_data_that_is_none(tmp_path: Path, block: bytes, said: str) -> None:
    assert f"The Draco data cannot be decoded. {said}." in refusal(tmp_path, compressed(block))


@pytest.mark.parametrize(
    ("vertices", "corners", "said"),
    [
        (5, 12, "holds 4 vertices and 4 triangles. The accessors state 5 vertices and 12 indices."),
        (3, 12, "holds 4 vertices"),
        (4, 9, "state 4 vertices and 9 indices"),
        (4, 13, "state 4 vertices and 13 indices"),
        (4, 0, "state 4 vertices and 0 indices"),
        (2**50, 12, "4 vertices"),
    ],
)
def test_accessors_that_lie(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, vertices: int, corners: int, said: str
) -> None:
    monkeypatch.setattr(amounts, "MOST_VERTICES", 2**60)
    assert said in refusal(tmp_path, compressed(vertices=vertices, corners=corners))


def test_claims_are_refused_before_anything_is_decoded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def too_late(*_: object) -> None:
        raise AssertionError("a block is decoded")

    monkeypatch.setattr(draco.DracoReader, "primitive", too_late)
    for counts in ((2**32, 12), (4, 2**32)):
        with pytest.raises(LevelError, match="are read"):
            read(tmp_path, compressed(vertices=counts[0], corners=counts[1]))


def setting(name: str, value: Any) -> Callable[[Json], None]:
    def change(source: Json) -> None:
        source["meshes"][0]["primitives"][0]["extensions"][EXTENSION][name] = value

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (setting("bufferView", 9), "buffer view 9 does not exist"),
        (setting("bufferView", None), '"bufferView" is missing'),
        (setting("attributes", 5), '"attributes" must be an object'),
        (setting("attributes", {}), '"POSITION" is missing'),
        (setting("attributes", {"POSITION": 2**33}), '"POSITION" must be below 4294967296'),
        (setting("attributes", {"POSITION": 5}), "It has no attribute 5"),
        (lambda source: source["meshes"][0]["primitives"][0].update(mode=6), '"mode" must be 4 or 5'),
        (lambda source: source["meshes"][0]["primitives"][0].pop("indices"), '"indices" is missing'),
        (lambda source: source["bufferViews"][0].update(byteLength=10**6), "ends at byte 1000000"),
    ],
)
def test_malformed_extensions(tmp_path: Path, change: Callable[[Json], None], said: str) -> None:
    source = compressed()
    change(source)
    with pytest.raises(LevelError) as error:
        read(tmp_path, source)
    assert said in str(error.value)


def claiming(faces: int, points: int) -> bytes:
    """A sequentially encoded block that states so many of both, in 200 bytes."""

    def varint(value: int) -> bytes:
        out = b""
        while value >= 0x80:
            out, value = out + bytes([value & 0x7F | 0x80]), value >> 7
        return out + bytes([value])

    head = b"DRACO" + struct.pack("<BBBBH", 2, 2, 1, 0, 0)
    return (head + varint(faces) + varint(points) + b"\1").ljust(200, b"\0")


@pytest.mark.parametrize(("faces", "points"), [(2**28, 2**30), (2**32 - 1, 2**32 - 1), (7_000_000, 2**30)])
def test_four_gigabytes_in_200_bytes(tmp_path: Path, faces: int, points: int) -> None:
    assert "cannot be decoded" in refusal(tmp_path, compressed(claiming(faces, points)))


def bomb() -> bytes:
    """Five hundred triangles, and 12 MB of zeros that nobody asked for, in 3 kB."""
    many = np.zeros((1500, 100), np.uint32)
    corners = np.arange(4500, dtype=np.float32).reshape(1500, 3)
    triangles = np.arange(1500, dtype=np.uint32).reshape(-1, 3)
    return encoded(corners, triangles, generic_attributes=dict.fromkeys(range(1, 21), many))


def test_what_takes_too_much_memory_ends_with_an_error_and_the_next_file_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the least limit that a small block needs: to encode what exceeds the true one takes long."""
    block = bomb()
    (position,) = (one for one in DracoPy.decode(block).attributes if one["attribute_type"] == 0)
    source = compressed(block, 1500, 1500)
    attributes = source["meshes"][0]["primitives"][0]["extensions"][EXTENSION]["attributes"]
    attributes["POSITION"] = position["unique_id"]
    assert read(tmp_path, source).scene.triangle_count == 500
    script = Path(draco_process.__file__).read_text()
    tight = tmp_path / "draco_process.py"
    with monkeypatch.context() as patched:
        patched.setattr(draco_process, "__file__", str(tight))
        for limit in range(80, 1000, 10):
            tight.write_text(script.replace("MOST_BYTES = 4 * 2**30", f"MOST_BYTES = {limit}_000_000"))
            try:
                assert read(tmp_path, compressed()).scene.triangle_count == 4
            except LevelError:
                continue
            break
        assert "cannot be decoded" in refusal(tmp_path, source)
        assert read(tmp_path, compressed()).scene.triangle_count == 4
    assert read(tmp_path, source).scene.triangle_count == 500


def test_the_process_may_die(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dying = tmp_path / "dying.py"
    for script in ("import os; os.abort()", "import sys; sys.stdin.buffer.read(3)", ""):
        dying.write_text(script)
        with monkeypatch.context() as patched:
            patched.setattr(draco_process, "__file__", str(dying))
            assert "ended without a result; it may take 4,294,967,296 bytes" in refusal(
                tmp_path, compressed()
            )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("draco")


@settings(
    max_examples=25,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(st.lists(st.tuples(st.integers(0, len(BLOCK) - 1), st.integers(0, 255)), min_size=1, max_size=4))
def test_damaged_blocks_are_read_or_refused(folder: Path, edits: list[tuple[int, int]]) -> None:
    block = bytearray(BLOCK)
    for place, value in edits:
        block[place] = value
    try:
        (mesh,) = read(folder, compressed(bytes(block))).scene.meshes
    except LevelError as error:
        assert error.remedy  # noqa: PT017  either outcome is right
    else:
        assert np.isfinite(mesh.positions).all()
        assert mesh.triangles.max() < len(mesh.positions) == 4
