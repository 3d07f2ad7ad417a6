from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.formats import quake_map
from scenes.formats.registry import read_level
from scenes.light_annotation import LightAnnotation
from tests.scenes.quake_samples import box, brush, entity, face

# The same examples in every test run; `make fuzz` asks for more, and other ones each time.
EXAMPLES = os.environ.get("GNOMON_FUZZ_EXAMPLES")
FUZZ = settings(
    max_examples=int(EXAMPLES or 400),
    deadline=None,
    derandomize=EXAMPLES is None,
    suppress_health_check=[HealthCheck.too_slow],
)
ADVICE = LightAnnotation({"gnomon_technique": "SM", "gnomon_map_size": 64}, {"reason": "a } reason"})

WHOLE = (
    "// Game: Quake\n"
    + entity(
        box((0, 0, 0), (64, 64, 8))
        + brush([((x, y, z), 24.0) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], "{fence")
        + box((0, 0, 64), (64, 64, 72), "sky1", "[ 1 0 0 0 ] [ 0 1 0 0 ] 0 1 1")
        + "{\npatchDef2\n{\na\n( ( 0 0 0 0 0 ) )\n}\n}\n",
        classname="worldspawn",
        _sunlight="100",
        _sunlight_mangle="10 -40 0",
    )
    + entity(box((0, 0, 8), (8, 8, 16), "*water"), classname="func_door", targetname="door")
    + entity(classname="light", origin="8 8 40", light="200", delay="2", wait="0.5")
    + entity(classname="light", origin="40 8 40", target="door", angle="30", _color="1 0 0")
    + entity(classname="info_player_start", origin="32 32 32", angle="90")
    + entity(classname="info_intermission", origin="0 0 64", mangle="10 20 0")
).encode()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


def read_or_refuse(folder: Path, content: bytes) -> bool:
    """Whether the file is a level; what the reader returns must be sound, what it raises a LevelError."""
    path = folder / "level.map"
    path.write_bytes(content)
    refusal = None
    try:
        level = read_level(path)
    except LevelError as error:
        refusal = str(error)
    if refusal is not None:
        assert refusal.startswith(str(path))
        return False
    scene = level.scene
    assert len(scene.digest) == 64
    assert np.isfinite(scene.bounds).all()
    for mesh in scene.meshes:
        assert mesh.triangles.min() >= 0
        assert mesh.triangles.max() < len(mesh.positions)
    for light in scene.lights:
        assert math.isclose(math.hypot(*light.direction), 1.0)
        assert light.range_m > 0
    nodes = [light.node for light in scene.lights if light.node is not None]
    annotated = quake_map.annotate(content, dict.fromkeys(nodes, ADVICE))
    cleared = quake_map.clear(annotated)
    assert cleared.data == quake_map.clear(content).data
    path.write_bytes(annotated)
    assert read_level(path).scene.digest == scene.digest
    return True


def test_the_level_that_the_fuzzer_starts_from_is_read(folder: Path) -> None:
    assert read_or_refuse(folder, WHOLE)


TOKENS = [
    b"{",
    b"}",
    b"(",
    b")",
    b'"',
    b"//",
    b"\n",
    b"\r\n",
    b"\0",
    b" ",
    b"-",
    b".",
    b"e9",
    b"nan",
    b"1e40",
]
TOKENS += [b'"classname" "light"', b'"origin" "1 2 3"', b"brushDef", b"patchDef3", b"[", b"]", b"9" * 400]
TOKENS += [b"// gnomon {}", b'"_gnomon_filter" "x"', b"\xff", b"\xc3", b"\xef\xbb\xbf", b"99999999", b"0"]
EDITS = st.lists(
    st.tuples(
        st.sampled_from(["set", "cut", "insert", "end", "repeat"]),
        st.integers(0, len(WHOLE) - 1),
        st.one_of(st.sampled_from(TOKENS), st.binary(min_size=1, max_size=4)),
    ),
    min_size=1,
    max_size=6,
)


@FUZZ
@given(edits=EDITS)
def test_damaged_maps_are_read_or_refused(folder: Path, edits: list[tuple[str, int, bytes]]) -> None:
    content = WHOLE
    for action, place, value in edits:
        tail = {"set": place + len(value), "cut": place + 8 * len(value), "end": len(content)}
        middle = b"" if action in ("cut", "end") else value
        if action == "repeat":
            middle = content[place : place + 40]
        content = content[:place] + middle + content[tail.get(action, place) :]
    read_or_refuse(folder, content)


LINES = WHOLE.splitlines(keepends=True)


@FUZZ
@given(st.lists(st.tuples(st.integers(0, len(LINES) - 1), st.integers(0, len(LINES) - 1)), max_size=8))
def test_maps_with_lines_lost_and_moved_are_read_or_refused(
    folder: Path, moves: list[tuple[int, int]]
) -> None:
    lines = list(LINES)
    for source, target in moves:
        line = lines.pop(source % len(lines))
        if source % 3:
            lines.insert(target % (len(lines) + 1), line)
    read_or_refuse(folder, b"".join(lines))


@FUZZ
@given(st.lists(st.sampled_from([*TOKENS, b"( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) a 0 0 0 1 1"]), max_size=24))
def test_sentences_of_tokens_are_read_or_refused(folder: Path, tokens: list[bytes]) -> None:
    read_or_refuse(folder, b" ".join(tokens))


NUMBERS = st.one_of(
    st.integers(-64, 64).map(float),
    st.sampled_from([0.0, -0.0, 1e-300, 1e-9, 0.001, 131072.0, 1048576.0, 1e7, 1e300, 0.1, 1 / 3]),
    st.floats(-4096, 4096, width=32),
)
POINTS = st.tuples(NUMBERS, NUMBERS, NUMBERS)


@FUZZ
@given(st.lists(st.tuples(POINTS, POINTS, POINTS), min_size=1, max_size=10))
def test_brushes_of_any_planes_are_read_or_refused(
    folder: Path, planes: list[tuple[tuple[float, float, float], ...]]
) -> None:
    faces = "".join(face(points) for points in planes)
    text = entity(box((0, 0, 0), (8, 8, 8)) + "{\n" + faces + "}\n", classname="worldspawn")
    near = all(abs(value) <= 2**20 for points in planes for point in points for value in point)
    assert read_or_refuse(folder, text.encode()) == near


@FUZZ
@given(
    st.sampled_from(
        ["light", "wait", "delay", "angle", "origin", "mangle", "_color", "target", "_sun", "style"]
    ),
    st.one_of(
        st.text(st.characters(codec="utf-8", exclude_characters='"\r\n'), max_size=12),
        st.lists(NUMBERS, min_size=1, max_size=4).map(lambda values: " ".join(map(repr, values))),
    ),
    st.sampled_from(["light", "light_environment", "info_player_start", "info_intermission", "worldspawn"]),
)
def test_any_value_of_a_key_is_read_or_refused(folder: Path, key: str, value: str, kind: str) -> None:
    keys = {"classname": kind, "origin": "1 2 3", "mangle": "1 2 3", key: value}
    read_or_refuse(folder, (WHOLE.decode() + entity(**keys)).encode())
