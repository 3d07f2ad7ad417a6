from __future__ import annotations

import copy
import errno
import json
import math
import os
import struct
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from tests.scenes.gltf_samples import (
    CORNERS,
    TETRAHEDRON,
    Json,
    carrying,
    chunk,
    document,
    glb,
    glb_of,
    lit,
    read,
    tetrahedron,
)


def refusal(folder: Path, source: Json | bytes, name: str | None = None) -> str:
    """What the user is told; it names the file, says what to do and ends as a sentence."""
    with pytest.raises(LevelError) as error:
        read(folder, source, name)
    text = str(error.value)
    assert text.startswith(str(folder))
    assert error.value.remedy
    assert text.endswith(".")
    assert error.value.exit_code == 3
    return text


def changed(source: Json, place: str, value: Any) -> Json:
    """A copy with the property at a place such as `nodes.0.mesh` set to a value."""
    made = copy.deepcopy(source)
    *parents, last = place.split(".")
    at: Any = made
    for key in parents:
        at = at[int(key)] if isinstance(at, list) else at[key]
    at[int(last) if isinstance(at, list) else last] = value
    return made


WHOLE = glb(tetrahedron(), b"\0" * 16)
JSON_END = 20 + struct.unpack_from("<I", WHOLE, 12)[0]


@pytest.mark.parametrize(
    ("length", "said"),
    [
        (4, "ends inside its header"),
        (11, "ends inside its header"),
        (12, "first chunk of this GLB is not its JSON"),
        (16, "ends inside the chunk header at byte 12"),
        (100, "ends inside the chunk at byte 12"),
        (JSON_END + 3, f"ends inside the chunk header at byte {JSON_END}"),
        (JSON_END + 12, f"ends inside the chunk at byte {JSON_END}"),
    ],
)
def test_a_glb_that_ends_early(tmp_path: Path, length: int, said: str) -> None:
    """Once with a header that knows it, once with one that still promises the whole."""
    cut = WHOLE[:length]
    honest = cut if length < 12 else cut[:8] + struct.pack("<I", length) + cut[12:]
    assert said in refusal(tmp_path, honest)
    expected = said if length < 12 else f"It has {length} bytes and needs {len(WHOLE)}"
    assert expected in refusal(tmp_path, cut)


@pytest.mark.parametrize("version", [0, 1, 3])
def test_a_glb_of_another_version(tmp_path: Path, version: int) -> None:
    assert f"binary glTF version {version}" in refusal(
        tmp_path, glb_of(chunk(b"JSON", b"{}"), version=version)
    )


def test_a_glb_whose_first_chunk_is_binary(tmp_path: Path) -> None:
    assert "first chunk" in refusal(tmp_path, glb_of(chunk(b"BIN\0", b"1234")))


def test_a_glb_whose_chunk_claims_4_gigabytes(tmp_path: Path) -> None:
    lie = glb_of(struct.pack("<I", 2**32 - 1) + b"JSON{}")
    assert "ends inside the chunk at byte 12" in refusal(tmp_path, lie)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"a shopping list", "not a binary glTF file"),
        (b'{"asset": {"version": "2.0"}}', "name it .gltf"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", "git lfs pull"),
        (b"", "empty"),
    ],
)
def test_files_that_are_no_glb(tmp_path: Path, content: bytes, said: str) -> None:
    assert said in refusal(tmp_path, content)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b'{\n  "asset": 1,,\n}', "JSON line 2, column 14"),
        (b"not json", "JSON line 1, column 1: The JSON is not valid. Expecting value: found 'not json'."),
        (b'{"a": 1', "the text ends there"),
        (b'"glTF"', "must be an object"),
        (b"[" * 200_000, "nested too deep"),
        (b'{"a":' * 200_000, "nested too deep"),
        (b'{"a": NaN}', "NaN is not a JSON number"),
        (b'{"a": ' + b"9" * 5001 + b"}", "has too many digits. At most 4300 digits are read."),
        ('{"asset": {"version": "2.0"}}'.encode("utf-16"), "not UTF-8"),
        (b'{"name": "caf\xe9"}', "not UTF-8"),
        (b"{}", "states no version"),
        (b'{"asset": {"version": "1.0"}}', 'asks for version "1.0"'),
        (b'{"asset": {"version": "2.0", "minVersion": "2.1"}}', 'asks for version "2.1"'),
        (b'{"asset": {"version": 2.0}}', '"version" must be a string'),
        (b'{"asset": []}', '"asset" must be an object'),
    ],
)
def test_bad_json(tmp_path: Path, content: bytes, said: str) -> None:
    assert said in refusal(tmp_path, content, "level.gltf")


def test_folders_missing_files_devices_and_odd_names(tmp_path: Path) -> None:
    (tmp_path / "folder.glb").mkdir()
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe.glb")
    (tmp_path / "file.gltf").write_bytes(b"{}")
    for name, said in {
        "folder.glb": "a folder",
        "folder": "a folder",
        "missing.glb": "no such file",
        "pipe.glb": "a device or a pipe",
        "file.gltf/level.glb": "no such file",
        "x" * 300 + ".glb": "cannot be read",
        "nul\0.glb": "cannot be read",
    }.items():
        with pytest.raises(LevelError, match=said):
            read_level(tmp_path / name)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (
            PermissionError(errno.EACCES, "Permission denied"),
            "may not be read. Give yourself read permission",
        ),
        (OSError(errno.EIO, "Input/output error"), "cannot be read. .*Input/output error"),
    ],
)
def test_files_that_the_system_does_not_hand_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: OSError, said: str
) -> None:
    path = tmp_path / "level.glb"
    path.write_bytes(WHOLE)

    def refuse(_path: Path, _mode: str) -> None:
        raise error

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(LevelError, match=said):
        read_level(path)


@pytest.mark.parametrize(
    ("nodes", "said"),
    [
        ([{"children": [0]}], "node 0: This node is its own ancestor. Its descent is 0 > 0."),
        ([{"children": [1]}, {"children": [2], "name": "B"}, {"children": [1]}], 'node 1 "B": This node'),
        ([{"children": [1]}, {"children": [0]}], "own ancestor"),
        ([{"children": [2]}, {"children": [2]}, {}], "child of node 0 and of node 1"),
        ([{"children": [1, 1]}, {}], "child of node 0 and of node 0"),
        ([{"children": [7]}], "node 7 does not exist"),
        ([{"children": [-1]}], '"children" must be a list of whole numbers'),
        ([{"children": [True]}], '"children" must be a list of whole numbers'),
        ([{"children": 1}], '"children" must be a list'),
        ([{"children": [i + 1]} for i in range(50)] + [{"children": [0]}], "> ..."),
    ],
)
def test_node_graphs_that_are_no_trees(tmp_path: Path, nodes: list[Json], said: str) -> None:
    assert said in refusal(tmp_path, tetrahedron(nodes=nodes))


def test_scenes_list_roots_once(tmp_path: Path) -> None:
    nodes = [{"children": [1]}, {}]
    assert "node 1 is no root" in refusal(tmp_path, tetrahedron(nodes=nodes, scenes=[{"nodes": [1]}]))
    assert "node 0 is listed twice" in refusal(tmp_path, tetrahedron(scenes=[{"nodes": [0, 0]}]))


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        ("nodes", 5, '"nodes" must be a list'),
        ("nodes.0", "lamp", "node 0: This entry is not a JSON object"),
        ("nodes.0.mesh", -1, '"mesh" must be a whole number'),
        ("nodes.0.mesh", True, '"mesh" must be a whole number'),
        ("nodes.0.mesh", 0.0, '"mesh" must be a whole number'),
        ("nodes.0.mesh", 2**70, '"mesh" must be a whole number'),
        ("nodes.0.mesh", 1, "node 0: mesh 1 does not exist. The file has 1"),
        ("nodes.0.name", 5, '"name" must be a string'),
        ("nodes.0.extensions", [], '"extensions" must be an object'),
        ("scene", 1, "scene 1 does not exist"),
        ("scene", "0", '"scene" must be a whole number'),
        ("scenes", {}, '"scenes" must be a list'),
        ("scenes.0.nodes", [9], "node 9 does not exist"),
        ("meshes", ["box"], "mesh 0: This entry is not a JSON object"),
        ("meshes", "box", '"meshes" must be a list'),
        ("meshes.0.primitives", [[]], '"primitives" must be a list of objects'),
        ("meshes.0.primitives.0.mode", 7, '"mode" must be a whole number from 0 to 6'),
        ("meshes.0.primitives.0.mode", "4", '"mode" must be a whole number'),
        ("meshes.0.primitives.0.attributes", [], '"attributes" must be an object'),
        ("meshes.0.primitives.0.attributes.POSITION", 9, "accessor 9 does not exist"),
        ("meshes.0.primitives.0.attributes.POSITION", 1, '"type" must be "VEC3"'),
        ("meshes.0.primitives.0.indices", 9, "accessor 9 does not exist"),
        ("meshes.0.primitives.0.indices", 0, '"componentType" must be one of 5121'),
        ("meshes.0.primitives.0.material", 0, "material 0 does not exist"),
        ("meshes.0.primitives.0.targets", 3, '"targets" must be a list'),
        ("accessors.0.componentType", 5130, '"componentType" must be one of 5120'),
        ("accessors.0.componentType", [], '"componentType" must be a whole number'),
        ("accessors.0.count", -1, '"count" must be a whole number'),
        ("accessors.0.count", 5, "ends at byte 60 of its buffer view. The buffer view 0 has 48 bytes"),
        ("accessors.0.count", 2**53 - 1, "draws 9,007,199,254,740,991 vertices; at most 24,000,000"),
        ("accessors.0.byteOffset", 1, "ends at byte 49"),
        ("accessors.0.byteOffset", 2**53 - 1, "of its buffer view"),
        ("accessors.0.normalized", 1, '"normalized" must be true or false'),
        ("accessors.0.bufferView", 2, "buffer view 2 does not exist"),
        ("accessors.1.componentType", 5122, "(unsigned) for indices"),
        ("accessors.1.count", 13, "ends at byte 26"),
        ("bufferViews.0.byteStride", 8, '"byteStride" must be at least 12'),
        ("bufferViews.0.byteStride", 16, "ends at byte 60"),
        ("bufferViews.0.byteLength", 49, "ends at byte 49 of its buffer"),
        ("bufferViews.0.byteOffset", 1, "ends at byte 49 of its buffer"),
        ("bufferViews.0.buffer", 2, "buffer 2 does not exist"),
        ("buffers.0.byteLength", 49, "has 48 bytes. Its byteLength is 49"),
        ("buffers.0.byteLength", 4 * 2**30, "has 48 bytes"),
        ("buffers.0.byteLength", None, '"byteLength" is missing'),
        ("buffers.0.uri", None, "has no data"),
        ("buffers.0.uri", 7, '"uri" must be a string'),
        ("buffers.0.uri", "data:;base64,AAA", "not valid base64"),
        ("buffers.0.uri", "data:;base64,*", "not valid base64"),
        ("buffers.0.uri", "data:nothing", "no comma"),
        ("buffers.0.uri", "missing.bin", "buffer 0: The buffer file missing.bin cannot be used"),
        ("buffers.0.uri", "parts\\mesh.bin", "Write / instead of"),
        ("buffers.0.uri", ".", "This is a folder"),
        ("buffers.0.uri", "a%00b.bin", "cannot be read"),
        ("buffers.0.uri", "https://example.com/mesh.bin", "is absolute"),
        ("buffers.0.uri", "HTTP://example.com/mesh.bin", "is absolute"),
        ("buffers.0.uri", "file:///etc/passwd", "is absolute"),
        ("buffers.0.uri", "C:/mesh.bin", "is absolute"),
        ("buffers.0.uri", "/etc/passwd", "is absolute"),
        ("buffers.0.uri", "//server/mesh.bin", "is absolute"),
        ("buffers.0.uri", "%2Fetc/passwd", "is absolute"),
        ("buffers.0.uri", "../mesh.bin", "leaves the level's folder"),
        ("buffers.0.uri", "a/%2e%2e/../mesh.bin", "leaves the level's folder"),
        ("buffers.0.uri", "..", "leaves the level's folder"),
        ("extensionsRequired", "KHR_draco_mesh_compression", '"extensionsRequired" must be a list'),
        ("extensionsRequired", [1], '"extensionsRequired" must be a list of strings'),
        ("extensions", {"KHR_lights_punctual": {"lights": 3}}, '"lights" must be a list'),
        ("materials", [[]], None),
        ("nodes.0.rotation", [0, 0, 0, 0], '"rotation" must be a quaternion of length 1'),
        ("nodes.0.rotation", [1e200, 0, 0, 0], '"rotation" must be a quaternion of length 1'),
        ("nodes.0.rotation", [1e-160, 0, 0, 0], '"rotation" must be a quaternion of length 1'),
        ("nodes.0.rotation", [0, 0, 1], '"rotation" must be a list of 4 finite numbers'),
        ("nodes.0.translation", [0, True, 0], '"translation" must be a list of 3 finite numbers'),
        ("nodes.0.translation", ["0", 0, 0], '"translation" must be a list of 3 finite numbers'),
        ("nodes.0.scale", [1, 0, 1], "squashes its mesh"),
        ("nodes.0.scale", [1e39, 1, 1], "reaches farther than 1e+30 metres"),
        ("nodes.0.translation", [0, -1e39, 0], "reaches farther than 1e+30 metres"),
        ("nodes.0.scale", [1e29, 1, 1], None),
        ("nodes.0.matrix", [1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1], "squashes its mesh"),
        ("nodes.0.matrix", [1] * 16, '"matrix" must be affine'),
        ("nodes.0.matrix", [1] * 15, '"matrix" must be a list of 16 finite numbers'),
        ("nodes.0.camera", 0, "camera 0 does not exist"),
    ],
)
def test_properties_that_are_wrong(tmp_path: Path, place: str, value: Any, said: str | None) -> None:
    source = changed(tetrahedron(), place, value)
    if said is None:
        assert read(tmp_path, source).scene.triangle_count == 4
    else:
        assert said in refusal(tmp_path, source)


def test_numbers_too_great_for_a_float(tmp_path: Path) -> None:
    text = json.dumps(tetrahedron(nodes=[{"mesh": 0, "translation": [0, 0, 12345]}]))
    for number in ("1e999", "-1e999", "1" * 400):
        content = text.replace("12345", number).encode()
        assert "list of 3 finite numbers" in refusal(tmp_path, content, "level.gltf")


def test_scales_that_multiply_beyond_all_floats(tmp_path: Path) -> None:
    nodes: list[Json] = [{"scale": [1e200] * 3, "children": [1]}, {"scale": [-1e200] * 3, "mesh": 0}]
    assert "node 1: The world matrix of this node is not finite" in refusal(
        tmp_path, tetrahedron(nodes=nodes)
    )


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_positions_that_are_not_finite(tmp_path: Path, bad: float) -> None:
    corners = CORNERS.copy()
    corners[2, 1] = bad
    said = refusal(tmp_path, tetrahedron() | document(corners, TETRAHEDRON.ravel()))
    assert "node 0, mesh 0, accessor 0: The position of vertex 2 is not finite" in said


@pytest.mark.parametrize(("dtype", "index"), [("<u1", 4), ("<u1", 255), ("<u4", 2**32 - 1), ("<u4", 2**31)])
def test_indices_out_of_range(tmp_path: Path, dtype: str, index: int) -> None:
    indices = np.array([0, 1, 2, 3, index, 0], dtype)
    said = refusal(tmp_path, tetrahedron() | document(CORNERS, indices))
    assert "mesh 0, primitive 0, accessor 1" in said
    assert f"Index 4 refers to vertex {index}, which does not exist. There are 4 vertices" in said


@pytest.mark.parametrize("place", ["accessors.0.count", "buffers.0.byteLength", "bufferViews.0.byteLength"])
def test_a_claim_of_4_gigabytes_allocates_nothing(tmp_path: Path, place: str) -> None:
    source = changed(tetrahedron(), place, 4 * 2**30)
    (tmp_path / "small.bin").write_bytes(b"12")
    external = changed(changed(tetrahedron(), "buffers.0.uri", "small.bin"), "buffers.0.byteLength", 2**32)
    for made in (source, external):
        tracemalloc.start()
        try:
            refusal(tmp_path, made)
            _, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        assert peak < 2**22


def test_a_buffer_file_that_is_an_lfs_pointer(tmp_path: Path) -> None:
    (tmp_path / "mesh.bin").write_bytes(
        b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 48\n"
    )
    assert "git lfs pull" in refusal(tmp_path, changed(tetrahedron(), "buffers.0.uri", "mesh.bin"))


@pytest.mark.parametrize(
    ("light", "said"),
    [
        ({"type": "area"}, '"type" must be "spot" or "point" or "directional". It is \'area\''),
        ({}, '"type" is missing'),
        ({"type": "point", "range": 0}, '"range" must be above 0 metres'),
        ({"type": "point", "range": -2}, '"range" must be above 0 metres'),
        ({"type": "point", "range": "far"}, '"range" must be a finite number'),
        ({"type": "point", "intensity": None, "color": [1, 1]}, '"color" must be a list of 3'),
        ({"type": "spot", "spot": {"outerConeAngle": 0}}, "a half angle in (0, pi/2] radians. It is 0."),
        ({"type": "spot", "spot": {"outerConeAngle": -0.5}}, "a half angle in (0, pi/2] radians"),
        ({"type": "spot", "spot": {"outerConeAngle": 1.5708}}, "a half angle in (0, pi/2] radians"),
        ({"type": "spot", "spot": {"outerConeAngle": 90}}, "90 degrees are 1.571 radians"),
        ({"type": "spot", "spot": {"innerConeAngle": 45}}, "45 degrees are 0.7854 radians"),
        ({"type": "spot", "spot": {"innerConeAngle": -0.1}}, '"innerConeAngle" must be a half angle in [0,'),
        ({"type": "spot", "spot": {"innerConeAngle": 0.8}}, "outerConeAngle = 0.785398"),
        ({"type": "spot", "spot": {"innerConeAngle": 2, "outerConeAngle": math.pi / 2}}, "innerConeAngle"),
        ({"type": "spot", "spot": 3}, '"spot" must be an object'),
        ({"type": "point", "range": 1e31}, '"range" must be from 1e-30 to 1e+30 metres'),
        ({"type": "point", "range": 1e-300}, '"range" must be from 1e-30 to 1e+30 metres'),
        ({"type": "point", "intensity": -1e31}, '"intensity" must be within 1e+30. It is -1e+31'),
        ({"type": "point", "color": [1, 1e300, 1]}, '"color" must be within 1e+30. It is [1, 1e+300, 1]'),
    ],
)
def test_lights_that_are_wrong_are_named_with_their_node(tmp_path: Path, light: Json, said: str) -> None:
    text = refusal(tmp_path, lit(light | {"name": "Torch"}, nodes=[carrying(0, name="Wall")]))
    assert said in text
    assert 'light 0 "Torch" on node 0 "Wall"' in text


@pytest.mark.parametrize("kind", ["spot", "directional"])
@pytest.mark.parametrize("scale", [[0, 0, 0], [1, 1, 0]])
def test_a_light_without_direction(tmp_path: Path, kind: str, scale: list[float]) -> None:
    text = refusal(tmp_path, lit({"type": kind}, nodes=[carrying(0, scale=scale)]))
    assert "leaves its light without a direction" in text


def test_a_point_light_needs_no_direction(tmp_path: Path) -> None:
    nodes = [carrying(0, scale=[0, 0, 0], translation=[1, 2, 3])]
    (light,) = read(tmp_path, lit({"type": "point"}, nodes=nodes)).scene.lights
    assert light.position == (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("link", "said"),
    [({"light": 1}, "light 1 does not exist"), ({}, '"light" is missing'), ([], "an object")],
)
def test_links_to_lights_that_are_wrong(tmp_path: Path, link: Json, said: str) -> None:
    nodes = [{"extensions": {"KHR_lights_punctual": link}}]
    assert said in refusal(tmp_path, lit({"type": "point"}, nodes=nodes))


@pytest.mark.parametrize(
    ("camera", "node", "said"),
    [
        ({"type": "fisheye"}, {}, '"type" must be "perspective" or "orthographic"'),
        ({"type": "perspective"}, {}, '"yfov" is missing'),
        ({"type": "perspective", "perspective": {"yfov": 1}}, {}, '"znear" is missing'),
        ({"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}, {}, "a full angle in (0, pi)"),
        ({"type": "perspective", "perspective": {"yfov": 3.2, "znear": 1}}, {}, "a full angle in (0, pi)"),
        ({"type": "perspective", "perspective": {"yfov": 1, "znear": 0}}, {}, "above 0 metres"),
        (
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1e300}},
            {},
            '"znear" must be from 1e-30',
        ),
        (
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1e-300}},
            {},
            '"znear" must be from 1e-30',
        ),
        (
            {"type": "perspective", "perspective": {"yfov": 1e-300, "znear": 1}},
            {},
            '"yfov" must be from 1e-30',
        ),
        (
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}},
            {"name": "Eye", "translation": [0, 1e31, 0]},
            'node 0 "Eye": This camera is farther than 1e+30 metres from the origin. Its position is (0.0, ',
        ),
        (
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}},
            {"scale": [1, 1, 0]},
            "without a direction",
        ),
        (
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}},
            {"matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
            "without a direction",
        ),
    ],
)
def test_cameras_that_are_wrong(tmp_path: Path, camera: Json, node: Json, said: str) -> None:
    source = document(nodes=[{"camera": 0} | node], scenes=[{"nodes": [0]}], cameras=[camera])
    assert said in refusal(tmp_path, source)


@pytest.mark.parametrize(
    ("material", "said"),
    [
        ({"alphaMode": "GLASS"}, '"alphaMode" must be "OPAQUE", "MASK" or "BLEND"'),
        ({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1]}}, '"baseColorFactor" must be a list of 4'),
        ({"pbrMetallicRoughness": 1}, '"pbrMetallicRoughness" must be an object'),
    ],
)
def test_materials_that_are_wrong(tmp_path: Path, material: Json, said: str) -> None:
    source = changed(tetrahedron(materials=[material]), "meshes.0.primitives.0.material", 0)
    assert said in refusal(tmp_path, source)


def test_names_that_no_terminal_can_print(tmp_path: Path) -> None:
    level = read(tmp_path, tetrahedron(nodes=[{"mesh": 0, "name": "half \ud800 pair"}]))
    assert level.scene.meshes[0].name.encode() == b"half ? pair"
    wrong = changed(tetrahedron(), "nodes.0.mesh", "\udfff")
    refusal(tmp_path, wrong).encode()


@pytest.mark.parametrize("kind", ["point", "spot", "directional"])
def test_a_light_that_is_too_far_away(tmp_path: Path, kind: str) -> None:
    nodes = [carrying(0, name="Star", translation=[0, 0, -1e31])]
    said = refusal(tmp_path, lit({"type": kind}, nodes=nodes))
    assert 'node 0 "Star": This light is farther than 1e+30 metres' in said
    assert "Its position is (0.0, 0.0, -1e+31)" in said


def test_coordinates_that_float32_holds_and_no_product_of_them(tmp_path: Path) -> None:
    corners = CORNERS * np.float32(6e37)
    said = refusal(tmp_path, tetrahedron() | document(corners, TETRAHEDRON.ravel()))
    assert "reaches farther than 1e+30 metres from the origin. Its largest coordinate is 3e+38" in said
