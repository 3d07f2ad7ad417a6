"""Sparse accessors, with and without a buffer view under them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenes.errors import LevelError
from scenes.level import Level
from tests.scenes.gltf_samples import COMPONENTS, CORNERS, TETRAHEDRON, Json, document, read, tetrahedron

PLACES = np.array([1, 3], np.uint16)
MOVED = np.array([[7, 8, 9], [-1, -2, -3]], np.float32)
EXPECTED = CORNERS.copy()
EXPECTED[PLACES] = MOVED


def sparse(places: np.ndarray = PLACES, values: np.ndarray = MOVED, *, based: bool = True) -> Json:
    """The tetrahedron with some of its corners elsewhere; without `based` the others are 0."""
    source = tetrahedron() | document(CORNERS, TETRAHEDRON.ravel(), places, values)
    source["accessors"] = source["accessors"][:2]
    accessor = source["accessors"][0]
    accessor["componentType"] = COMPONENTS[values.dtype.str[1:]]
    accessor["sparse"] = {
        "count": len(places),
        "indices": {"bufferView": 2, "componentType": COMPONENTS[places.dtype.str[1:]]},
        "values": {"bufferView": 3},
    }
    if not based:
        del accessor["bufferView"]
    return source


def positions(level: Level) -> np.ndarray:
    (mesh,) = level.scene.meshes
    return mesh.positions


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.uint32])
def test_elements_take_the_places_of_those_of_the_buffer_view(tmp_path: Path, dtype: type) -> None:
    np.testing.assert_array_equal(positions(read(tmp_path, sparse(PLACES.astype(dtype)))), EXPECTED)


def test_without_a_buffer_view_the_others_are_zero(tmp_path: Path) -> None:
    expected = np.zeros_like(CORNERS)
    expected[PLACES] = MOVED
    np.testing.assert_array_equal(positions(read(tmp_path, sparse(based=False))), expected)


def test_another_use_of_the_buffer_view_sees_what_it_holds(tmp_path: Path) -> None:
    source = sparse()
    source["accessors"].append({k: v for k, v in source["accessors"][0].items() if k != "sparse"})
    source["meshes"][0]["primitives"].append({"attributes": {"POSITION": 2}, "indices": 1})
    changed, plain = read(tmp_path, source).scene.meshes
    np.testing.assert_array_equal(changed.positions, EXPECTED)
    np.testing.assert_array_equal(plain.positions, CORNERS)


def test_quantised_normalised_and_strided(tmp_path: Path) -> None:
    values = np.zeros((2, 4), np.int16)
    values[:, :3] = [[32767, 0, -32768], [1, -32767, 2]]
    source = sparse(values=values, based=False)
    source["accessors"][0]["normalized"] = True
    source["bufferViews"][3]["byteStride"] = 8
    expected = np.zeros_like(CORNERS)
    expected[PLACES] = [[1, 0, -1], [1 / 32767, -1, 2 / 32767]]
    np.testing.assert_array_equal(positions(read(tmp_path, source)), expected)


def test_sparse_indices_of_triangles(tmp_path: Path) -> None:
    """A triangle list whose first corners are replaced; unaligned data and byte offsets on the way."""
    places, values = np.array([0, 11], np.uint8), np.array([9, 9, 3, 0], np.uint16)
    source = tetrahedron() | document(CORNERS, TETRAHEDRON.ravel(), places, values)
    source["accessors"] = source["accessors"][:2]
    source["accessors"][1]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": 2, "componentType": 5121},
        "values": {"bufferView": 3, "byteOffset": 4},
    }
    (mesh,) = read(tmp_path, source).scene.meshes
    expected = TETRAHEDRON.ravel().copy()
    expected[[0, 11]] = [3, 0]
    np.testing.assert_array_equal(mesh.triangles.ravel(), expected)


def place(name: str, value: Any) -> Callable[[Json], None]:
    def change(source: Json) -> None:
        *parents, last = name.split(".")
        at = source["accessors"][0]
        for key in parents:
            at = at[key]
        at[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (place("sparse", 7), '"sparse" must be an object'),
        (place("sparse.count", 0), '"count" must be from 1 to 4'),
        (place("sparse.count", 5), '"count" must be from 1 to 4'),
        (place("sparse.count", 2**52), '"count" must be from 1 to 4'),
        (place("sparse.count", -1), '"count" must be a whole number'),
        (place("sparse.count", 3), "ends at byte 6 of its buffer view"),
        (place("sparse.count", None), '"count" is missing'),
        (place("sparse.indices", None), '"componentType" is missing'),
        (place("sparse.indices.componentType", 5122), "one of 5121, 5123, 5125"),
        (place("sparse.indices.componentType", 5126), "one of 5121, 5123, 5125"),
        (place("sparse.indices.componentType", 5125), "ends at byte 8 of its buffer view"),
        (place("sparse.indices.bufferView", 99), "buffer view 99 does not exist"),
        (place("sparse.indices.bufferView", None), '"bufferView" is missing'),
        (place("sparse.indices.byteOffset", 2), "ends at byte 6"),
        (place("sparse.indices.byteOffset", 2**53 - 1), "ends at byte"),
        (place("sparse.values", None), '"bufferView" is missing'),
        (place("sparse.values.bufferView", 2), "ends at byte 24 of its buffer view"),
        (place("sparse.values.byteOffset", 1), "ends at byte 25"),
        (place("count", 2**40), "at most 24,000,000 are read"),
        (place("count", 0), '"count" must be from 1 to 0'),
        (place("type", "VEC4"), '"VEC3" for this use'),
    ],
)
@pytest.mark.parametrize("based", [True, False])
def test_bad_descriptions_are_refused(
    tmp_path: Path, change: Callable[[Json], None], said: str, *, based: bool
) -> None:
    source = sparse(based=based)
    change(source)
    with pytest.raises(LevelError) as error:
        read(tmp_path, source)
    assert said in str(error.value)
    assert error.value.remedy


@pytest.mark.parametrize(
    ("places", "said"),
    [
        ([3, 1], "Sparse index 1 is not above the one before it. They are 3 and 1."),
        ([2, 2], "They are 2 and 2."),
        ([1, 4], "Sparse index 1 stands for element 4, which does not exist."),
        ([0, 65535], "stands for element 65535"),
    ],
)
def test_places_rise_and_exist(tmp_path: Path, places: list[int], said: str) -> None:
    with pytest.raises(LevelError) as error:
        read(tmp_path, sparse(np.array(places, np.uint16)))
    assert said in str(error.value)
    assert "mesh 0" in error.value.where


def test_replaced_positions_must_be_finite(tmp_path: Path) -> None:
    with pytest.raises(LevelError, match="vertex 3 is not finite"):
        read(tmp_path, sparse(values=np.array([[1, 2, 3], [0, np.nan, 0]], np.float32)))


def test_a_place_that_holds_nan_may_be_replaced(tmp_path: Path) -> None:
    broken = CORNERS.copy()
    broken[1] = np.nan
    source = sparse()
    source["buffers"][0] = document(broken)["buffers"][0]
    np.testing.assert_array_equal(positions(read(tmp_path, source)), EXPECTED)
