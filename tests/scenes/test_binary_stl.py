"""Binary STL: the triangles that trimesh finds in it, and what is no such file is left to trimesh."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.plain.binary_stl import read_binary_stl, triangle_count

BOX: bytes = trimesh.creation.box().export(file_type="stl")


def stl(corners: np.ndarray, header: bytes = b"", attributes: int = 0) -> bytes:
    """A file of (t, 3, 3) corners."""
    rows = np.zeros(len(corners), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
    rows["corners"], rows["attributes"] = corners, attributes
    return header.ljust(80, b"\0") + len(corners).to_bytes(4, "little") + rows.tobytes()


@given(st.integers(0, 2**32), st.integers(1, 40), st.sampled_from([b"", b"solid box", b"\xff" * 80]))
def test_it_says_what_trimesh_says(seed: int, count: int, header: bytes) -> None:
    corners = np.random.default_rng(seed).normal(size=(count, 3, 3)).astype(np.float32)
    source = stl(corners, header, attributes=seed % 65536)
    found = read_binary_stl(source)
    theirs = trimesh.load(BytesIO(source), file_type="stl", process=False)
    assert found is not None
    assert np.array_equal(found[0][found[1]], theirs.vertices[theirs.faces])


def test_a_level_that_begins_as_text_may_be_binary(tmp_path: Path) -> None:
    path = tmp_path / "level.stl"
    path.write_bytes(b"solid box".ljust(80) + BOX[80:])
    scene = read_level(path).scene
    assert (scene.triangle_count, scene.bounds.tolist()) == (12, [[-0.5] * 3, [0.5] * 3])


@pytest.mark.parametrize(
    "source",
    [
        b"",
        BOX[:83],
        BOX[:-1],
        BOX + b"\0",
        BOX[:80] + bytes(4) + BOX[84:],
        BOX[:80] + b"\xff\xff\xff\xff" + BOX[84:],
        trimesh.creation.box().export(file_type="stl_ascii").encode(),
    ],
    ids=["nothing", "header cut", "cut", "longer", "no triangles", "too many", "text"],
)
def test_another_length_is_no_binary_file(source: bytes) -> None:
    assert read_binary_stl(source) is None
    assert triangle_count(source) in (None, 0, 12)


def test_corners_that_are_no_numbers_are_refused(tmp_path: Path) -> None:
    corners = np.zeros((2, 3, 3), np.float32)
    corners[1, 2, 0] = np.nan
    path = tmp_path / "level.stl"
    path.write_bytes(stl(corners))
    with pytest.raises(LevelError, match="no number"):
        read_level(path)
