from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.formats.registry import format_of, read_level
from scenes.light_annotation import LightAnnotation

# The same examples in every test run; `make fuzz` asks for more, and other ones each time.
EXAMPLES = os.environ.get("GNOMON_FUZZ_EXAMPLES")
FUZZ = settings(
    max_examples=int(EXAMPLES or 500),
    deadline=None,
    derandomize=EXAMPLES is None,
    suppress_health_check=[HealthCheck.too_slow],
)
ADVICE = LightAnnotation({"gnomon_technique": "SM"}, {"reason": "}"})
BOX = trimesh.creation.box()
OBJ = (
    b"mtllib a.mtl\no first\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nusemtl red\n"
    b"f 1/1/1 2/1/1 3/1/1 4/1/1\no second\ng group\ns 1\nv 0 0 1\nf 1 2 5\nf -1 -2 -3\nl 1 2\n"
)
WHOLE = {
    ".obj": OBJ,
    ".ply": BOX.export(file_type="ply", encoding="binary"),
    ".stl": BOX.export(file_type="stl"),
}
TEXTS = {
    ".obj": OBJ,
    ".ply": BOX.export(file_type="ply", encoding="ascii"),
    ".stl": BOX.export(file_type="stl_ascii").encode(),
}
LIGHTS = {
    "unit_m": 0.5,
    "up": "Z",
    "lights": [
        {"name": "a", "kind": "spot", "position_m": [0, 1, 2], "target_m": [0, 0, 0], "outer_cone_deg": 30},
        {"kind": "directional", "direction": [0, -1, 0], "color": [1, 1, 0.5], "mobility": "static"},
        {"kind": "point", "position_m": [0, 1, 2], "range_m": 9, "intensity": 3, "gnomon_technique": "SV"},
    ],
    "cameras": [{"position_m": [0, 1, 2], "forward": [0, 0, -1], "up": [0, 1, 0], "near_m": 0.2}],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fuzz")
    (folder / "base.obj").write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    return folder


def read_or_refuse(path: Path, content: bytes) -> bool:
    path.write_bytes(content)
    refusal = None
    try:
        level = read_level(path)
    except LevelError as error:
        refusal = str(error)
    if refusal is not None:
        assert refusal.startswith(str(path.parent))
        return False
    scene = level.scene
    assert len(scene.digest) == 64
    assert np.isfinite(scene.bounds).all()
    for mesh in scene.meshes:
        assert mesh.triangles.min() >= 0
        assert mesh.triangles.max() < len(mesh.positions)
    level_format = format_of(path)
    nodes = [light.node for light in scene.lights if light.node is not None]
    annotated = level_format.annotate(content, dict.fromkeys(nodes, ADVICE))
    assert level_format.clear(annotated).data == level_format.clear(content).data
    return True


@pytest.mark.parametrize("suffix", WHOLE)
def test_what_the_fuzzer_starts_from_is_read(folder: Path, suffix: str) -> None:
    assert read_or_refuse(folder / f"a{suffix}", WHOLE[suffix])
    assert read_or_refuse(folder / f"a{suffix}", TEXTS[suffix])
    assert read_or_refuse(folder / "base.json", json.dumps(LIGHTS).encode())


EDITS = st.lists(
    st.tuples(
        st.sampled_from(["set", "cut", "insert", "end"]),
        st.one_of(st.floats(0, 1), st.floats(0, 0.2)),
        st.one_of(
            st.binary(min_size=1, max_size=4),
            st.sampled_from(
                [b"\n", b"-", b"9999999999", b"nan", b"1e400", b"f 1 2 3\n", b"0", b"/", b"\xff" * 4]
            ),
        ),
    ),
    min_size=1,
    max_size=5,
)


def damaged(content: bytes, edits: list[tuple[str, float, bytes]]) -> bytes:
    for action, share, value in edits:
        place = int(share * len(content))
        tail = {"set": place + len(value), "cut": place + len(value), "insert": place, "end": len(content)}
        content = content[:place] + (b"" if action in ("cut", "end") else value) + content[tail[action] :]
    return content


@FUZZ
@given(st.sampled_from(sorted(WHOLE)), EDITS)
def test_damaged_geometry_is_read_or_refused(
    folder: Path, suffix: str, edits: list[tuple[str, float, bytes]]
) -> None:
    read_or_refuse(folder / f"damaged{suffix}", damaged(WHOLE[suffix], edits))


@FUZZ
@given(st.sampled_from(sorted(TEXTS)), EDITS)
def test_damaged_text_geometry_is_read_or_refused(
    folder: Path, suffix: str, edits: list[tuple[str, float, bytes]]
) -> None:
    read_or_refuse(folder / f"text{suffix}", damaged(TEXTS[suffix], edits))


@FUZZ
@given(EDITS)
def test_damaged_lights_are_read_or_refused(folder: Path, edits: list[tuple[str, float, bytes]]) -> None:
    read_or_refuse(folder / "base.lights.json", damaged(json.dumps(LIGHTS).encode(), edits))


VALUES = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.floats(),
        st.sampled_from(
            [0, 1, -1, 1e-40, 1e31, 10**400, "spot", "point", "Z", "static", "", "\ud800", "base.obj"]
        ),
    ),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(["kind", "name"]), inner),
    max_leaves=6,
)
KEYS = ["kind", "position_m", "direction", "target_m", "range_m", "outer_cone_deg", "inner_cone_rad", "color"]
KEYS += ["intensity", "mobility", "name", "gnomon", "gnomon_filter"]


@FUZZ
@given(
    st.sampled_from(["lights", "cameras", "unit_m", "up", "geometry", "new"]),
    st.integers(0, 2),
    st.sampled_from([*KEYS, "forward", "up", "yfov_deg", "near_m"]),
    VALUES,
    st.booleans(),
)
def test_any_value_in_a_lights_file_is_read_or_refused(
    folder: Path,
    root: str,
    index: int,
    key: str,
    value: object,
    whole: bool,  # noqa: FBT001
) -> None:
    lights = json.loads(json.dumps(LIGHTS))
    if whole or not isinstance(lights.get(root), list):
        lights[root] = value
    else:
        lights[root][index % len(lights[root])][key] = value
    try:
        content = json.dumps(lights).encode()
    except ValueError:  # Numbers of more digits than Python prints.
        return
    read_or_refuse(folder / "base.lights.json", content)
