"""EXT_mesh_manifold: the author's promise of closed geometry."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenes.shells import Shells
from tests.scenes.gltf_samples import CORNERS, TETRAHEDRON, Json, document, notes_of, read, tetrahedron


def promising(promise: Any = None, **primitive: Any) -> Json:
    """Two primitives of two faces each, which close together; the promise is about accessor 3."""
    triangles = TETRAHEDRON.ravel()
    source = tetrahedron() | document(CORNERS, triangles[:6], triangles[6:], triangles)
    attributes = {"POSITION": 0}
    primitives = [
        {"attributes": attributes, "indices": 1},
        {"attributes": attributes, "indices": 2, **primitive},
    ]
    kept = {"manifoldPrimitive": {"indices": 3, "mode": 4, "attributes": attributes}}
    extensions = {"EXT_mesh_manifold": kept if promise is None else promise}
    source["meshes"] = [{"primitives": primitives, "name": "Box", "extensions": extensions}]
    source["materials"] = [{"alphaMode": "BLEND"}]
    return source | {"extensionsUsed": ["EXT_mesh_manifold"]}


def test_the_promise_is_kept_with_the_meshes_and_changes_neither_them_nor_the_digest(tmp_path: Path) -> None:
    source = promising()
    level = read(tmp_path, source)
    assert [mesh.promised_closed for mesh in level.scene.meshes] == [True, True]
    assert Shells.of(level.scene) == Shells(4, 0, 0)
    assert "EXT_mesh_manifold" not in notes_of(level)
    del source["meshes"][0]["extensions"]
    plain = read(tmp_path, source)
    assert [mesh.promised_closed for mesh in plain.scene.meshes] == [False, False]
    assert plain.scene.digest == level.scene.digest
    assert Shells.of(plain.scene) == Shells(0, 0, 4)


def test_inspect_believes_a_promise_only_where_no_edge_is_open(tmp_path: Path) -> None:
    source = promising()
    source["nodes"], source["scenes"] = [{"mesh": 0}, {"mesh": 0, "scale": [2, 2, 2]}], [{"nodes": [0, 1]}]
    assert Shells.of(read(tmp_path, source).scene) == Shells(8, 0, 0)
    source["buffers"][2] = document(TETRAHEDRON.ravel()[[6, 7, 8, 6, 7, 8]])["buffers"][0]
    assert Shells.of(read(tmp_path, source).scene) == Shells(0, 0, 8)


def test_a_sparse_manifold_primitive_with_merged_vertices(tmp_path: Path) -> None:
    """As the extension's own sample: doubled corners, merged by the sparse part of its indices."""
    doubled = np.concatenate([CORNERS, CORNERS[:1]])
    triangles = TETRAHEDRON.copy()
    triangles[1][triangles[1] == 0] = 4
    order = triangles.ravel()
    places = np.flatnonzero(order == 4).astype(np.uint16)
    source = tetrahedron() | document(doubled, order, places, np.zeros(len(places), np.uint16))
    merged = {
        **source["accessors"][1],
        "sparse": {
            "count": len(places),
            "indices": {"bufferView": 2, "componentType": 5123},
            "values": {"bufferView": 3},
        },
    }
    source["accessors"].append(merged)
    primitive = {"indices": 4, "mode": 4, "attributes": {"POSITION": 0}}
    extension = {"manifoldPrimitive": primitive, "mergeIndices": 2, "mergeValues": 3}
    source["meshes"][0]["extensions"] = {"EXT_mesh_manifold": extension}
    (mesh,) = read(tmp_path, source).scene.meshes
    assert mesh.promised_closed
    np.testing.assert_array_equal(mesh.triangles, triangles)


def test_parts_that_do_not_cast_open_the_rest(tmp_path: Path) -> None:
    level = read(tmp_path, promising(material=0))
    assert [mesh.promised_closed for mesh in level.scene.meshes] == [False, False]
    assert 'info mesh 0 "Box": Promised to be closed, but parts of it cast no shadow' in notes_of(level)


@pytest.mark.parametrize(
    ("promise", "primitive", "said"),
    [
        (
            {"manifoldPrimitive": {"indices": 1}},
            {},
            "for 6 indices, and the primitives that are read have 12",
        ),
        ({"manifoldPrimitive": {"indices": 3, "mode": 5}}, {}, "ignored"),
        (
            {"manifoldPrimitive": {"indices": 3}},
            {"mode": 1},
            "for 12 indices, and the primitives that are read",
        ),
        ({"manifoldPrimitive": {"indices": 99}}, {}, "is not understood and ignored: accessor 99 does not"),
        ({"manifoldPrimitive": {}}, {}, 'is not understood and ignored: "indices" is missing'),
        ({"manifoldPrimitive": 5}, {}, "is not understood and ignored"),
        ({}, {}, "is not understood and ignored"),
        (5, {}, "is not understood and ignored"),
    ],
)
def test_a_promise_that_is_broken_at_once_is_ignored_with_a_warning(
    tmp_path: Path, promise: Any, primitive: Json, said: str
) -> None:
    level = read(tmp_path, promising(promise, **primitive))
    assert not any(mesh.promised_closed for mesh in level.scene.meshes)
    assert 'warning mesh 0 "Box": EXT_mesh_manifold' in notes_of(level)
    assert said in notes_of(level)
