from __future__ import annotations

import copy
import json
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.magnitudes import LARGEST
from tests.scenes.gltf_samples import CORNERS, TETRAHEDRON, Json, carrying, document, glb

# The same examples in every test run: a fuzzer that finds something new on a Friday breaks somebody else's
# work. `make fuzz` asks for more, and other ones each time.
EXAMPLES = os.environ.get("GNOMON_FUZZ_EXAMPLES")
FUZZ = settings(
    max_examples=int(EXAMPLES or 400),
    deadline=None,
    derandomize=EXAMPLES is None,
    suppress_health_check=[HealthCheck.too_slow],
)


def rich_level() -> tuple[Json, bytes]:
    """A GLB that uses every part of the reader: strides, strips, materials, lights, cameras, extensions."""
    primitives = [
        {"attributes": {"POSITION": 0}, "indices": 1, "material": 0},
        {"attributes": {"POSITION": 2}, "indices": 1, "mode": 5, "material": 1, "targets": [{"POSITION": 0}]},
        {"attributes": {"POSITION": 7}, "indices": 1},
        {"attributes": {"POSITION": 0}, "mode": 6, "extensions": {"KHR_draco_mesh_compression": {}}},
    ]
    instances = {"TRANSLATION": 3, "ROTATION": 4}
    promise = {"manifoldPrimitive": {"indices": 1, "attributes": {"POSITION": 0}}}
    pose = [0.0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]
    source = document(
        CORNERS,
        TETRAHEDRON.ravel(),
        CORNERS.astype(np.int16),
        CORNERS[:3] * 7,
        np.array([[0, 0, 0, 1], [0, 0.6, 0, 0.8], [1, 0, 0, 0]], np.float32),
        np.array([1, 3], np.uint8),
        CORNERS[2:] + 1,
        scene=0,
        scenes=[{"nodes": [0, 4], "name": "main"}, {"nodes": [4]}],
        nodes=[
            {"children": [1, 2, 3], "translation": [1, 2, 3], "name": "root"},
            {"mesh": 0, "rotation": [0, 0.6, 0, 0.8], "scale": [1, -2, 3], "skin": 0},
            carrying(0, matrix=pose, extras={"gnomon_mobility": "static"}),
            {"camera": 0, "mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": instances}}},
            carrying(1, children=[5]),
            carrying(2, mesh=0, weights=[0.5]),
        ],
        meshes=[
            {"primitives": primitives, "name": "box", "weights": [0.0]},
            {"primitives": primitives[:1], "extensions": {"EXT_mesh_manifold": promise}},
        ],
        skins=[{"joints": [5, 4]}],
        materials=[{"alphaMode": "MASK"}, {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}}],
        cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        animations=[{}],
        extensionsUsed=["KHR_lights_punctual"],
        extensionsRequired=["KHR_texture_basisu"],
    )
    lights = [
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}, "range": 9},
        {"type": "point", "color": [1, 0.5, 0.2], "intensity": 3},
        {"type": "directional", "name": "sun"},
    ]
    source["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    packed = np.zeros((4, 20), np.uint8)
    packed[:, 4:16] = CORNERS.view(np.uint8).reshape(4, 12)
    source["buffers"][0] = {"byteLength": packed.size}
    source["bufferViews"][0] |= {"byteLength": packed.size, "byteStride": 20}
    source["accessors"][0]["byteOffset"] = 4
    source["accessors"][2]["normalized"] = True
    sparse = {"count": 2, "indices": {"bufferView": 5, "componentType": 5121}, "values": {"bufferView": 6}}
    source["accessors"].append({"componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse})
    return source, packed.tobytes()


SOURCE, BINARY = rich_level()
WHOLE = glb(SOURCE, BINARY)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


def read_or_refuse(path: Path, content: bytes) -> bool:
    """Whether the file is a level; what the reader returns must be sound, what it raises a LevelError."""
    path.write_bytes(content)
    try:
        level = read_level(path)
        refusal = None
    except LevelError as error:
        refusal = str(error)
    if refusal is not None:
        assert refusal.encode().startswith(str(path).encode())
        return False
    scene = level.scene
    assert len(scene.digest) == 64
    assert np.isfinite(scene.bounds).all()
    for mesh in scene.meshes:
        assert mesh.triangles.min(initial=0) >= 0
        assert mesh.triangles.max(initial=-1) < len(mesh.positions)
    for light in scene.lights:
        assert math.isclose(math.hypot(*light.direction), 1.0)
        assert 0 <= light.inner_cone_rad <= light.outer_cone_rad <= math.pi / 2
        assert light.range_m > 0
    return True


def test_the_level_that_the_fuzzer_starts_from_is_read(folder: Path) -> None:
    assert read_or_refuse(folder / "whole.glb", WHOLE)


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path to every value of a JSON document."""
    if path:
        yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in items:
        yield from places(child, (*path, key))


PLACES = list(places(SOURCE))
NUMBERS = [0, 1, 2, 3, 4, 5, 6, 7, 255, 2**31, 2**32, 2**53 - 1, 2**64, 10**400, -1, 1.0, 0.5, -0.0, 1e-320]
NUMBERS += [1e300, 1.8e308, -1e39, 5120, 5121, 5122, 5123, 5125, 5126, 0x7FFFFFFF]
TEXTS = ["", "0", "VEC3", "SCALAR", "MAT4", "BLEND", "spot", "orthographic", "perspective", "\ud800", "\0"]
TEXTS += ["../x", "x" * 5000, "data:,", "data:;base64,AAAA", "http://x", "[", "//", "a%ff%00", "."]
LEAVES = st.sampled_from([None, True, False, [], {}, [[]], [{}], *NUMBERS, *TEXTS])
VALUES = st.one_of(
    LEAVES,
    st.lists(LEAVES, max_size=4),
    st.lists(st.sampled_from(NUMBERS), min_size=3, max_size=4),
    st.lists(st.sampled_from(NUMBERS), min_size=16, max_size=16),
    # A part of this very file, in a place where it does not belong.
    st.sampled_from(PLACES).map(lambda path: at(SOURCE, path)),
)
EDITS = st.lists(
    st.tuples(st.sampled_from(["set", "drop", "repeat"]), st.sampled_from(PLACES), VALUES),
    min_size=1,
    max_size=4,
)


def at(value: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        value = value[key]
    return value


def edited(edits: list[tuple[str, tuple[Any, ...], Any]]) -> Json:
    source = copy.deepcopy(SOURCE)
    for action, path, value in edits:
        try:
            parent = at(source, path[:-1])
            here = parent[path[-1]]
        except (KeyError, IndexError, TypeError):
            continue  # An earlier edit took this place away.
        if isinstance(parent, str):
            continue
        if action == "set":
            parent[path[-1]] = copy.deepcopy(value)
        elif action == "drop":
            del parent[path[-1]]
        elif isinstance(here, list):
            here.extend(copy.deepcopy(here))
    return source


@FUZZ
@given(edits=EDITS)
def test_edited_json_is_read_or_refused(folder: Path, edits: list[tuple[str, tuple[Any, ...], Any]]) -> None:
    source = edited(edits)
    try:
        content = glb(source, BINARY)
    except ValueError:  # Numbers of more digits than Python prints.
        return
    read_or_refuse(folder / "json.glb", content)


BYTE_EDITS = st.lists(
    st.tuples(
        st.sampled_from(["set", "cut", "insert", "end"]),
        st.one_of(st.integers(0, len(WHOLE) - 1), st.integers(0, 40)),
        st.binary(min_size=1, max_size=4),
    ),
    min_size=1,
    max_size=6,
)


@FUZZ
@given(edits=BYTE_EDITS, suffix=st.sampled_from([".glb", ".gltf"]))
def test_damaged_files_are_read_or_refused(
    folder: Path, edits: list[tuple[str, int, bytes]], suffix: str
) -> None:
    content = WHOLE if suffix == ".glb" else json.dumps(SOURCE).encode()
    for action, place, value in edits:
        tail = {"set": place + len(value), "cut": place + len(value), "insert": place, "end": len(content)}
        middle = b"" if action in ("cut", "end") else value
        content = content[:place] + middle + content[tail[action] :]
    read_or_refuse(folder / f"bytes{suffix}", content)


@FUZZ
@given(
    data=st.binary(max_size=64),
    start=st.sampled_from([b"", b"glTF\2\0\0\0", b"{", b"\xef\xbb\xbf{", WHOLE[:20]]),
)
def test_noise_is_refused(folder: Path, data: bytes, start: bytes) -> None:
    for suffix in (".glb", ".gltf"):
        assert not read_or_refuse(folder / f"noise{suffix}", start + data)


@FUZZ
@given(st.floats(width=32), st.integers(0, 11), st.integers(0, 255), st.integers(0, 11))
def test_random_geometry_is_read_or_refused(
    folder: Path, coordinate: float, place: int, index: int, corner: int
) -> None:
    corners, indices = CORNERS.copy(), TETRAHEDRON.astype(np.uint8).ravel()
    corners.flat[place], indices[corner] = coordinate, index
    source = document(
        corners,
        indices,
        nodes=[{"mesh": 0}],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    )
    path = folder / "geometry.gltf"
    # A NaN is not within any limit.
    assert read_or_refuse(path, json.dumps(source).encode()) == (abs(coordinate) <= LARGEST and index < 4)
