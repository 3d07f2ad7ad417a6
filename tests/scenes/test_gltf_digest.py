"""The digest of a level stands for its picture, however it is spelt and packed."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.formats.gltf import annotate, clear
from scenes.formats.registry import read_level
from scenes.light_annotation import LightAnnotation
from tests.scenes.gltf_samples import CORNERS, TETRAHEDRON, Json, carrying, data_uri, document, glb

PROPERTY = settings(
    max_examples=40,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)

QUANTISED = np.zeros((4, 4), np.int16)
QUANTISED[:, :3] = CORNERS * 100
ARRAYS = {
    "corners": CORNERS,
    "faces": TETRAHEDRON.ravel(),
    "quantised": QUANTISED,
    "places": np.array([1, 2], np.uint8),
    "moved": np.array([[2, 0.5, 0], [0, 3, 0.25]], np.float32),
    "morph": np.array([[0, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0]], np.float32),
    "spots": np.array([[0, 0, 0], [5, 0, 1], [9, 0, 2]], np.float32),
    "turns": np.array([[0, 0, 0, 1], [0, 1, 0, 0], [0.6, 0, 0, 0.8]], np.float32),
    "sizes": np.array([[1, 1, 1], [2, 2, 2], [1, 3, 1]], np.float32),
    "bind": np.eye(4, dtype=np.float32).reshape(1, 16),
}


def level() -> Json:
    """A level that uses all of the reader: sparse, quantised, instanced, morphed, skinned, lit and seen."""
    source = document(*ARRAYS.values(), scene=0, scenes=[{"nodes": [0, 1, 2, 3, 4, 5]}])
    views, accessors = source["bufferViews"], source["accessors"]
    views[2]["byteStride"] = 8
    accessors[2] |= {"type": "VEC3", "normalized": True}
    accessors[9]["type"] = "MAT4"
    sparse = {
        "count": 2,
        "indices": {"bufferView": 3, "componentType": 5121},
        "values": {"bufferView": 4},
    }
    accessors.append({**accessors[0], "sparse": sparse})
    surfaces = [{"material": 0}, {"material": 1}, {}]
    parts = [
        {"attributes": {"POSITION": position}, "indices": 1, **surface}
        for position, surface in zip((10, 2, 0), surfaces, strict=True)
    ]
    source["meshes"] = [
        {"primitives": [parts[0]], "name": "a"},
        {"primitives": [parts[1]]},
        {"primitives": [{**parts[2], "targets": [{"POSITION": 5}]}], "weights": [0.5]},
    ]
    source["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1]}}, {"name": "m"}]
    attributes = {"TRANSLATION": 6, "ROTATION": 7, "SCALE": 8}
    source["nodes"] = [
        {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}},
        {"mesh": 1, "translation": [0, 2, 0], "rotation": [0, 0.6, 0, 0.8], "scale": [2, 2, 2]},
        {"mesh": 2, "skin": 0, "name": "s"},
        carrying(0, translation=[0, 9, 0], children=[6]),
        {"camera": 0, "translation": [0, 1, 5]},
        carrying(1, rotation=[0.6, 0, 0, 0.8]),
        {"translation": [1, 1, 1]},
    ]
    source["skins"] = [{"joints": [6], "inverseBindMatrices": 9}]
    spot = {"innerConeAngle": 0.3, "outerConeAngle": 0.5}
    lights = [{"type": "spot", "spot": spot, "range": 20.0, "color": [1, 1, 0.5]}, {"type": "directional"}]
    source["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    source["extensionsUsed"] = ["KHR_lights_punctual", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization"]
    source["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
    return source


SOURCE = level()
CONTENTS = [array.tobytes() for array in ARRAYS.values()]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("digest")


def digest(folder: Path, source: Json) -> str:
    path = folder / "level.gltf"
    path.write_text(json.dumps(source))
    return read_level(path).scene.digest


@pytest.fixture(scope="module")
def original(folder: Path) -> str:
    return digest(folder, SOURCE)


def reordered(value: Any, shuffler: Any) -> Any:
    """The same JSON with the keys of every object in another order."""
    if isinstance(value, list):
        return [reordered(item, shuffler) for item in value]
    if not isinstance(value, dict):
        return value
    keys = list(value)
    shuffler.shuffle(keys)
    return {key: reordered(value[key], shuffler) for key in keys}


def packed(shuffler: Any) -> tuple[Json, bytes]:
    """All arrays in one buffer, in another order and with gaps."""
    source, binary = copy.deepcopy(SOURCE), bytearray()
    order = list(range(len(CONTENTS)))
    shuffler.shuffle(order)
    for index in order:
        binary += bytes([shuffler.randrange(256)] * (4 * shuffler.randrange(3)))
        source["bufferViews"][index] |= {"buffer": 0, "byteOffset": len(binary)}
        binary += CONTENTS[index] + bytes(-len(CONTENTS[index]) % 4)
    source["buffers"] = [{"byteLength": len(binary)}]
    return source, bytes(binary)


@PROPERTY
@given(
    shuffler=st.randoms(use_true_random=False),
    form=st.sampled_from(["glb", "uri", "file", "files"]),
    indent=st.sampled_from([None, 0, 4, "\t"]),
    ascii_=st.booleans(),
)
def test_neither_spelling_nor_packing_nor_place_changes_the_digest(
    folder: Path, original: str, shuffler: Any, form: str, indent: Any, *, ascii_: bool
) -> None:
    place = folder / f"{shuffler.randrange(1000)} é" / "deep"
    place.mkdir(parents=True, exist_ok=True)
    source, binary = packed(shuffler)
    if form == "uri":
        source["buffers"][0]["uri"] = data_uri(binary)
    if form == "file":
        (place / "all.bin").write_bytes(binary)
        source["buffers"][0]["uri"] = "all.bin"
    if form == "files":
        source = copy.deepcopy(SOURCE)
        for index, content in enumerate(CONTENTS):
            (place / f"{index}.bin").write_bytes(content)
            source["buffers"][index]["uri"] = f"{index}.bin"
    source = reordered(source, shuffler)
    if form == "glb":
        path = place / "other.glb"
        path.write_bytes(glb(source, binary))
    else:
        path = place / "other.gltf"
        separators = None if indent else (",", ":")
        path.write_text(json.dumps(source, indent=indent, separators=separators, ensure_ascii=ascii_))
    assert read_level(path).scene.digest == original


@pytest.mark.parametrize("binary", [True, False])
def test_annotating_leaves_the_digest_and_the_bytes_of_the_arrays(
    folder: Path, original: str, *, binary: bool
) -> None:
    source, content = packed(random.Random(1))  # noqa: S311  an order, not a secret
    if not binary:
        source["buffers"][0]["uri"] = data_uri(content)
    before = glb(source, content) if binary else json.dumps(source).encode()
    advice = LightAnnotation({"gnomon_technique": "SM"}, {"technique": "SM"})
    after = annotate(before, {3: advice, 5: advice})
    assert after != before
    path = folder / f"annotated.{'glb' if binary else 'gltf'}"
    path.write_bytes(after)
    assert read_level(path).scene.digest == original
    assert clear(after).data == before


def put(place: str, value: Any) -> Callable[[Json], None]:
    def change(source: Json) -> None:
        *parents, last = place.split(".")
        at: Any = source
        for key in parents:
            at = at[int(key)] if isinstance(at, list) else at.setdefault(key, {})
        at[int(last) if isinstance(at, list) else last] = value

    return change


LIGHTS = "extensions.KHR_lights_punctual.lights"
SEEN = {
    "a node moves": put("nodes.1.translation.0", 1e-9),
    "a node turns": put("nodes.1.rotation", [0, 0.8, 0, 0.6]),
    "a node grows": put("nodes.1.scale.2", 2.0000001),
    "a joint moves": put("nodes.6.translation.1", 1.5),
    "a light's node moves": put("nodes.3.translation.1", 10),
    "a light's node turns": put("nodes.5.rotation.0", 0.7),
    "a camera moves": put("nodes.4.translation.2", 5.5),
    "a mesh is another": put("nodes.1.mesh", 0),
    "a node is left out": put("scenes.0.nodes", [0, 2, 3, 4, 5]),
    "instances without sizes": lambda source: source["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"][
        "attributes"
    ].pop("SCALE"),
    "a weight": put("meshes.2.weights.0", 0.25),
    "a node's weights": put("nodes.2.weights", [1.0]),
    "a material blends": put("materials.0.alphaMode", "BLEND"),
    "a colour": put("materials.0.pbrMetallicRoughness.baseColorFactor.1", 0.75),
    "a strip": put("meshes.0.primitives.0.mode", 5),
    "no longer normalised": put("accessors.2.normalized", value=False),
    "fewer faces": put("accessors.1.count", 9),
    "fewer replaced": put("accessors.10.sparse.count", 1),
    "a cone": put(f"{LIGHTS}.0.spot.outerConeAngle", 0.6),
    "a range": put(f"{LIGHTS}.0.range", 21.0),
    "a light's colour": put(f"{LIGHTS}.0.color.2", 0.25),
    "a brightness": put(f"{LIGHTS}.1.intensity", 2.0),
    "a kind": put(f"{LIGHTS}.1.type", "point"),
    "mobility": put("nodes.3.extras", {"gnomon_mobility": "static"}),
    "a lens": put("cameras.0.perspective.yfov", 1.1),
    "a near plane": put("cameras.0.perspective.znear", 0.2),
}
UNSEEN = {
    "names": lambda source: [node.update(name="other") for node in source["nodes"]],
    "extras": put("nodes.1.extras", {"a": [1]}),
    "a generator": put("asset.generator", "x"),
    "bounds in accessors": put("accessors.0.min", [0, 0, 0]),
    "a mask": put("materials.1.alphaMode", "MASK"),
    "roughness": put("materials.0.pbrMetallicRoughness.roughnessFactor", 0.5),
    "a skinned node's own place": put("nodes.2.translation", [7, 7, 7]),
    "an unused mesh": lambda source: source["meshes"].append(copy.deepcopy(source["meshes"][0])),
    "another sound extension": put("extensionsUsed", ["KHR_lights_punctual", "KHR_materials_unlit"]),
}


@pytest.mark.parametrize("what", SEEN)
def test_what_changes_the_picture_changes_the_digest(folder: Path, original: str, what: str) -> None:
    source = copy.deepcopy(SOURCE)
    SEEN[what](source)
    assert digest(folder, source) != original


@pytest.mark.parametrize("what", UNSEEN)
def test_what_does_not_change_it_does_not(folder: Path, original: str, what: str) -> None:
    source = copy.deepcopy(SOURCE)
    UNSEEN[what](source)
    assert digest(folder, source) == original


@PROPERTY
@given(
    array=st.sampled_from([name for name in ARRAYS if name not in ("faces", "places", "bind")]),
    element=st.integers(0, 11),
    step=st.sampled_from([-2.0, -0.25, 0.25, 0.5]),
)
def test_every_stored_number_that_is_drawn_counts(
    folder: Path, original: str, array: str, element: int, step: float
) -> None:
    changed = ARRAYS[array].copy()
    flat = changed.reshape(-1)
    element %= len(flat)
    if array == "quantised":
        element -= element % 4 == 3  # The fourth number of a row is padding.
        step *= 4
    if array == "turns":
        element = 8  # Of most quaternions another length of one number is the same turn.
    if array == "sizes":
        step *= 0.75  # Nothing gets a size of 0.
    flat[element] += np.asarray(step).astype(flat.dtype)
    source = copy.deepcopy(SOURCE)
    source["buffers"][list(ARRAYS).index(array)]["uri"] = data_uri(changed.tobytes())
    assert digest(folder, source) != original
