"""Annotations of plain geometry: in its lights file, every foreign byte of which stays."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scenes.errors import LevelError
from scenes.formats import plain_geometry
from scenes.formats.registry import format_of, read_level
from scenes.light_annotation import LightAnnotation

ADVICE = LightAnnotation(
    {"gnomon_technique": "SM", "gnomon_map_size": 512}, {"technique": "SM", "reason": '"é"'}
)
OTHER = LightAnnotation({"gnomon_technique": "SV"}, {})
GEOMETRY = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
LIGHTS = (
    '{"lights": [{"kind": "point", "position_m": [0, 1e0, 0]},\n'
    '  {"kind": "point","position_m":[0,2.50,0]}], "x": "\\u0041" }\n'
)
LAYOUTS = {
    "plain": LIGHTS,
    "named": LIGHTS.replace("{", '{"geometry": "level.obj", ', 1),
    "CRLF": LIGHTS.replace("\n", "\r\n"),
    "BOM": "\ufeff" + LIGHTS,
    "indented": json.dumps(json.loads(LIGHTS), indent=2),
    "compact": json.dumps(json.loads(LIGHTS), separators=(",", ":")),
}


@pytest.fixture(params=LAYOUTS)
def lights(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    (tmp_path / "level.obj").write_bytes(GEOMETRY)
    path = tmp_path / "level.lights.json"
    path.write_bytes(LAYOUTS[request.param].encode())
    return path


def test_the_same_is_written_over_geometry_and_over_its_lights(lights: Path) -> None:
    level = lights.with_name("level.obj")
    source = lights.read_bytes()
    annotated = plain_geometry.annotate(GEOMETRY, {1: ADVICE}, level)
    assert plain_geometry.annotate(source, {1: ADVICE}, lights) == annotated
    assert plain_geometry.annotate(annotated, {1: ADVICE}, level) == annotated
    assert plain_geometry.read_annotations(annotated, level) == {1: ADVICE}
    assert plain_geometry.clear(annotated, lights).data == source
    assert plain_geometry.clear(annotated, lights).restored
    assert lights.read_bytes() == source
    assert level.read_bytes() == GEOMETRY


def test_an_annotated_lights_file_is_read_under_any_name(lights: Path) -> None:
    level = lights.with_name("level.obj")
    annotated = plain_geometry.annotate(GEOMETRY, {0: OTHER, 1: ADVICE}, level)
    values = json.loads(annotated.removeprefix(b"\xef\xbb\xbf"))
    assert values["geometry"] == "level.obj"
    assert values["lights"][1]["gnomon_map_size"] == 512
    path = lights.with_name("anything.json")
    path.write_bytes(annotated)
    assert read_level(path).scene.digest == read_level(level).scene.digest
    assert format_of(path).read_annotations(annotated) == {0: OTHER, 1: ADVICE}


def test_a_change_by_others_costs_only_the_restoration(lights: Path) -> None:
    annotated = plain_geometry.annotate(lights.read_bytes(), {1: ADVICE}, lights)
    changed = annotated.replace(b'"x"', b'"y"')
    cleared = plain_geometry.clear(changed, lights)
    assert cleared.data == lights.read_bytes().replace(b'"x"', b'"y"')
    assert not cleared.restored
    assert "another program has changed" in cleared.note


def test_keys_without_a_record_are_found_and_replaced(lights: Path) -> None:
    source = lights.read_bytes()
    strays = source.replace(b'"kind"', b'"gnomon_technique": "SM", "kind"', 1)
    assert plain_geometry.read_annotations(strays, lights) == {
        0: LightAnnotation({"gnomon_technique": "SM"}, {})
    }
    assert not plain_geometry.clear(strays, lights).restored
    again = plain_geometry.annotate(strays, {0: OTHER}, lights)
    assert again.count(b"gnomon_technique") == 1
    assert not plain_geometry.clear(again, lights).restored


@pytest.mark.parametrize(
    "story", ["5", "[]", '{"original": 5}', '{"original": {"absent": 5}}', "[" * 5000 + "]" * 5000]
)
def test_a_forged_story_costs_only_the_restoration(lights: Path, story: str) -> None:
    forged = lights.read_bytes().replace(b'"kind"', f'"gnomon": {story}, "kind"'.encode(), 1)
    assert not plain_geometry.clear(forged, lights).restored
    assert plain_geometry.read_annotations(forged, lights)[0].extras == {}


@pytest.mark.parametrize("node", [-1, 2, 10**9])
def test_a_light_that_is_not_there_is_refused(lights: Path, node: int) -> None:
    with pytest.raises(LevelError, match=f"no node {node}") as caught:
        plain_geometry.annotate(lights.read_bytes(), {node: ADVICE}, lights)
    assert "2 lights" in caught.value.known


def test_a_key_that_the_annotation_writes_itself_is_refused(lights: Path) -> None:
    with pytest.raises(ValueError, match="original"):
        plain_geometry.annotate(lights.read_bytes(), {0: LightAnnotation({}, {"original": 1})}, lights)


def test_geometry_without_lights_has_nothing_to_annotate(tmp_path: Path) -> None:
    path = tmp_path / "level.obj"
    path.write_bytes(GEOMETRY)
    assert plain_geometry.read_annotations(GEOMETRY, path) == {}
    with pytest.raises(LevelError, match="no node 0"):
        plain_geometry.annotate(GEOMETRY, {0: ADVICE}, path)
