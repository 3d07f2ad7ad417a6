from __future__ import annotations

from pathlib import Path

import pytest

from scenes.errors import LevelError
from tests.scenes.gltf_samples import (
    notes_of,
    read,
    tetrahedron,
)


def compressed(kind: str) -> dict:
    """The tetrahedron, and beside it the same again in a form that is not read."""
    source = tetrahedron()
    second = {"attributes": {"POSITION": 2}, "indices": 1}
    source["meshes"][0]["primitives"].append(second)
    source["accessors"].append({"componentType": 5126, "type": "VEC3", "count": 4})
    if kind == "Draco":
        second["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}
    elif kind == "meshopt":
        source["buffers"].append(
            {"byteLength": 48, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}
        )
        source["bufferViews"].append(
            {"buffer": 2, "byteLength": 48, "extensions": {"EXT_meshopt_compression": {"buffer": 0}}}
        )
        source["accessors"][2]["bufferView"] = 2
    return source


@pytest.mark.parametrize(
    ("kind", "named"),
    [
        ("meshopt", "EXT_meshopt_compression"),
        ("empty", "accessors without data"),
    ],
)
def test_geometry_in_a_form_that_is_not_read_is_named(tmp_path: Path, kind: str, named: str) -> None:
    level = read(tmp_path, compressed(kind))
    assert level.scene.triangle_count == 4
    assert "warning mesh 0, primitive 1: Skipped" in notes_of(level)
    assert named in notes_of(level)
    lost = compressed(kind)
    del lost["meshes"][0]["primitives"][0]
    with pytest.raises(LevelError, match="All geometry of this level") as error:
        read(tmp_path, lost)
    assert named in error.value.known


@pytest.mark.parametrize("kind", ["Draco", "meshopt"])
def test_uncompressed_fallbacks_of_optional_compression_are_read(tmp_path: Path, kind: str) -> None:
    source = compressed(kind)
    if kind == "Draco":
        source["accessors"][2]["bufferView"] = 0
    else:
        source["buffers"][2]["uri"] = source["buffers"][0]["uri"]
    assert read(tmp_path, source).scene.triangle_count == 8


@pytest.mark.parametrize(
    ("extension", "need"),
    [
        ("EXT_meshopt_compression", "meshopt decompression"),
        ("KHR_meshopt_compression", "meshopt decompression"),
    ],
)
def test_required_extensions_that_hold_geometry_are_refused_by_name(
    tmp_path: Path, extension: str, need: str
) -> None:
    with pytest.raises(LevelError, match=f"needs {need}, which this version does not read yet") as error:
        read(tmp_path, tetrahedron(extensionsRequired=[extension]))
    assert extension in error.value.known


@pytest.mark.parametrize(
    ("extension", "severity"),
    [
        ("KHR_texture_basisu", "info"),
        ("KHR_materials_unlit", "info"),
        ("VENDOR_walls", "warning"),
        ("KHR_node_visibility", "warning"),
        ("KHR_lights_punctual", None),
        ("KHR_mesh_quantization", None),
        ("EXT_mesh_gpu_instancing", None),
        ("KHR_draco_mesh_compression", None),
        ("EXT_mesh_manifold", None),
    ],
)
def test_required_extensions_that_hold_no_geometry_are_noted(
    tmp_path: Path, extension: str, severity: str | None
) -> None:
    level = read(tmp_path, tetrahedron(extensionsRequired=[extension]))
    found = {
        note.severity.value for note in level.notes if extension in note.text and "no lights" not in note.text
    }
    assert found == ({severity} if severity else set())
