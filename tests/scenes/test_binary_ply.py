"""Binary PLY: every layout gives the triangles that the text of the same gives, and lies are refused."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.plain.binary_ply import read_binary_ply

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 5]], np.float32)
QUADS = np.array([[0, 1, 2, 3], [0, 1, 2, 4]])
TRIANGLES = QUADS[:, :3]
ENDIAN = {"<": "little", ">": "big"}


def ply(
    faces: np.ndarray,
    *,
    order: str = "<",
    length: str = "uchar",
    more: bool = False,
    name: str = "vertex_indices",
) -> bytes:
    """A file of `CORNERS` and faces, with further properties of both where `more` is wanted."""
    kinds = [(axis, f"{order}f4") for axis in "xyz"]
    vertices = np.zeros(len(CORNERS), [("nx", f"{order}f8"), *kinds, ("red", "u1")] if more else kinds)
    for axis, values in zip("xyz", CORNERS.T, strict=True):
        vertices[axis] = values
    size = {"uchar": "u1", "uint": f"{order}u4", "char": "i1"}[length]
    row = [("n", size), ("i", f"{order}i4", (faces.shape[1],))]
    rows = np.zeros(len(faces), [("flags", "u1"), *row, ("q", f"{order}f4")] if more else row)
    rows["n"], rows["i"] = faces.shape[1], faces
    before, after = ("property double nx\n", "property uchar red\n") if more else ("", "")
    flags, quality = ("property uchar flags\n", "property float q\n") if more else ("", "")
    head = (
        f"ply\nformat binary_{ENDIAN[order]}_endian 1.0\ncomment of ours\n"
        f"element vertex {len(CORNERS)}\n{before}"
        f"property float x\nproperty float y\nproperty float z\n{after}element face {len(faces)}\n"
        f"{flags}property list {length} int {name}\n{quality}end_header\n"
    )
    return head.encode() + vertices.tobytes() + rows.tobytes()


def level(tmp_path: Path, content: bytes) -> tuple[np.ndarray, np.ndarray]:
    path = tmp_path / "level.ply"
    path.write_bytes(content)
    (mesh,) = read_level(path).scene.meshes
    return mesh.positions, mesh.triangles


@pytest.mark.parametrize(
    ("order", "length", "more", "name"),
    [
        ("<", "uchar", False, "vertex_indices"),
        (">", "uchar", True, "vertex_indices"),
        ("<", "uint", True, "vertex_index"),
        (">", "uint", False, "vertex_index"),
    ],
)
def test_every_layout_gives_the_same(
    tmp_path: Path,
    order: str,
    length: str,
    more: bool,  # noqa: FBT001
    name: str,
) -> None:
    content = ply(TRIANGLES, order=order, length=length, more=more, name=name)
    assert read_binary_ply(content) is not None
    positions, triangles = level(tmp_path, content)
    np.testing.assert_array_equal(positions, CORNERS)
    np.testing.assert_array_equal(triangles, TRIANGLES)
    assert positions.dtype == np.float32
    assert triangles.dtype == np.int32
    assert not positions.flags.writeable


def test_polygons_become_fans(tmp_path: Path) -> None:
    _, triangles = level(tmp_path, ply(QUADS))
    np.testing.assert_array_equal(triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 4]])


def test_windows_line_ends_in_the_header_are_none_of_the_data() -> None:
    head, end, body = ply(TRIANGLES).partition(b"end_header\n")
    found = read_binary_ply((head + end).replace(b"\n", b"\r\n") + body)
    assert found is not None
    np.testing.assert_array_equal(found[1], TRIANGLES)


def test_a_unit_and_an_axis_are_those_of_the_lights_file(tmp_path: Path) -> None:
    (tmp_path / "level.lights.json").write_text('{"unit_m": 0.01, "up": "Z"}')
    positions, _ = level(tmp_path, ply(TRIANGLES))
    x, y, z = CORNERS.astype(np.float64).T * 0.01
    np.testing.assert_array_equal(positions, np.stack([x, z, -y], axis=1).astype(np.float32))


@pytest.mark.parametrize("second", [2, 4, 255])
def test_faces_of_different_numbers_of_corners_are_refused(tmp_path: Path, second: int) -> None:
    content = bytearray(ply(TRIANGLES))
    content[-13] = second
    with pytest.raises(LevelError, match="different numbers of corners") as caught:
        level(tmp_path, bytes(content))
    assert "face 1" in caught.value.where
    assert caught.value.remedy


@pytest.mark.parametrize("cut", range(1, 40, 3))
def test_what_ends_early_is_refused(tmp_path: Path, cut: int) -> None:
    with pytest.raises(LevelError, match="cut short"):
        level(tmp_path, ply(TRIANGLES)[:-cut])


@pytest.mark.parametrize("length", ["uint", "char"])
def test_a_claim_of_4_gigabytes_allocates_nothing(tmp_path: Path, length: str) -> None:
    content = ply(TRIANGLES[:1], length=length)
    size = {"uint": 4, "char": 1}[length]
    lie = content[: -12 - size] + b"\xff" * size + content[-12:]
    with pytest.raises(LevelError):
        level(tmp_path, lie)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"int vertex_indices", b"float vertex_indices"),
        (b"property float x", b"property float w"),
        (b"property float y", b"property float x"),
        (b"property float x", b"property list uchar int x"),
        (b"element face", b"element edge"),
        (b"binary_little", b"binary_middle"),
        (b"element vertex 5", b"element vertex five"),
        (b"vertex_indices", b"corner_indices"),
        (b"comment", b"remark"),
    ],
)
def test_other_layouts_are_left_to_trimesh(old: bytes, new: bytes) -> None:
    assert read_binary_ply(ply(TRIANGLES).replace(old, new, 1)) is None


@given(
    st.lists(st.tuples(st.integers(0, 400), st.binary(min_size=1, max_size=4)), max_size=4),
    st.sampled_from([ply(TRIANGLES), ply(QUADS, order=">", more=True)]),
)
def test_damaged_files_are_read_or_refused(edits: list[tuple[int, bytes]], source: bytes) -> None:
    content = bytearray(source)
    for place, put in edits:
        content[place : place + len(put)] = put
    try:
        found = read_binary_ply(bytes(content))
    except LevelError as error:
        assert error.remedy  # noqa: PT017  any of several
        return
    assert found is None or all(part.shape[1:] == (3,) for part in found)


def test_what_lies_behind_the_faces_is_passed_over(tmp_path: Path) -> None:
    plain = level(tmp_path, ply(TRIANGLES))
    longer = level(tmp_path, ply(TRIANGLES) + bytes(99))
    for one, other in itertools.zip_longest(plain, longer):
        np.testing.assert_array_equal(one, other)
