from __future__ import annotations

import copy
import hashlib
import json
import struct
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.gltf.annotation import annotate, clear, is_annotated
from scenes.gltf.annotation_record import EXTENSION
from scenes.light_annotation import OWN_KEYS, LightAnnotation
from tests.scenes.gltf_texts import glb, gltf_files

LEVELS = Path(__file__).parents[2] / "../shared/levels"
LEVEL_FILES = sorted([*LEVELS.rglob("*.glb"), *LEVELS.rglob("*.gltf")])

ADVICE = LightAnnotation(
    {
        "gnomon_technique": "SM",
        "gnomon_map_size": 1024,
        "gnomon_shadow_ms": 0.1 + 0.2,
        "gnomon_source": "measured",
    },
    {"technique": "SM", "reason": 'é "quoted" \n', "alternatives": [{"technique": "SV", "shadow_ms": 1e-05}]},
)
OTHER = LightAnnotation({"gnomon_technique": "SV"}, {"technique": "SV"})
NO_EXTRAS = LightAnnotation({}, {"technique": "SV"})

annotations = st.sampled_from([ADVICE, OTHER, NO_EXTRAS])


def json_of(source: bytes) -> Any:
    text = source
    if source[:4] == b"glTF":
        (length,) = struct.unpack_from("<I", source, 12)
        text = source[20 : 20 + length].rstrip(b"\0")
    return json.loads(text.decode("utf-8-sig"))


def without_ours(annotated: Any, original: Any) -> Any:
    """The annotated JSON less our keys, taken out by what the extension says, not by `clear`."""
    left = copy.deepcopy(annotated)
    for node, before in zip(left["nodes"], original["nodes"], strict=True):
        ours = node.get("extensions", {}).get(EXTENSION) if isinstance(node.get("extensions"), dict) else None
        if ours is None:
            continue
        del node["extensions"][EXTENSION]
        for key in ours["original"]["extras"]:
            del node["extras"][key]
        for container in ("extras", "extensions"):
            if container in node and container not in before:
                assert node.pop(container) == {}
                assert container in ours["original"]["absent"]
    left["extensionsUsed"].remove(EXTENSION)
    if "extensionsUsed" not in original:
        assert left.pop("extensionsUsed") == []
    return left


def without_strays(document: Any) -> Any:
    """The JSON of a file without annotation less the keys and the declaration that are ours."""
    left = copy.deepcopy(document)
    for node in left["nodes"]:
        extras = node.get("extras")
        if isinstance(extras, dict) and OWN_KEYS & extras.keys():
            node["extras"] = {key: value for key, value in extras.items() if key not in OWN_KEYS}
            if not node["extras"]:
                del node["extras"]
    if EXTENSION in left.get("extensionsUsed", []):
        left["extensionsUsed"].remove(EXTENSION)
        if not left["extensionsUsed"]:
            del left["extensionsUsed"]
    return left


def without_extensions(annotated: bytes) -> bytes:
    """What a program writes that keeps `extras` and drops extensions that it does not know."""
    document = json_of(annotated)
    for node in document["nodes"]:
        node.get("extensions", {}).pop(EXTENSION, None)
    document["extensionsUsed"].remove(EXTENSION)
    return json.dumps(document).encode()


@st.composite
def files_and_advice(draw: Any) -> tuple[bytes, dict[int, LightAnnotation]]:
    source, count = draw(gltf_files())
    indices = draw(st.lists(st.integers(0, count - 1), min_size=1, unique=True))
    return source, {index: draw(annotations) for index in indices}


@given(files_and_advice())
@settings(max_examples=250, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
def test_any_file_is_annotated_and_restored_byte_for_byte(
    case: tuple[bytes, dict[int, LightAnnotation]],
) -> None:
    source, advice = case
    bare = clear(source)
    assert json_of(bare.data) == without_strays(json_of(source))
    assert (bare.data == source) == bare.restored == (json_of(bare.data) == json_of(source))

    annotated = annotate(source, advice)
    assert is_annotated(annotated)
    assert not is_annotated(source)
    assert without_ours(json_of(annotated), json_of(bare.data)) == json_of(bare.data)

    cleared = clear(annotated)
    assert cleared.data == bare.data
    assert cleared.restored == (bare.data == source)

    assert annotate(source, advice) == annotated
    assert annotate(annotated, advice) == annotated
    assert annotate(annotate(source, {0: OTHER}), advice) == annotated
    assert annotate(annotated, {}) == bare.data

    for index, one in advice.items():
        node = json_of(annotated)["nodes"][index]
        ours = node["extensions"][EXTENSION]
        assert {key: ours[key] for key in one.extension} == one.extension
        for key, value in one.extras.items():
            seen = ours["withheldExtras"] if key in ours.get("withheldExtras", {}) else node["extras"]
            assert seen[key] == value


@given(files_and_advice())
@settings(max_examples=100, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
def test_after_another_tool_has_rewritten_it_our_keys_are_removed(
    case: tuple[bytes, dict[int, LightAnnotation]],
) -> None:
    source, advice = case
    rewritten = json.dumps(json_of(annotate(source, advice)), sort_keys=True, indent=3).encode()
    cleared = clear(rewritten)
    assert json_of(cleared.data) == without_strays(json_of(source))
    assert not is_annotated(cleared.data)
    if not cleared.restored:
        assert "another program" in cleared.note
    assert cleared.restored == (cleared.data == source)


@given(files_and_advice())
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
def test_a_glb_stays_well_formed_and_keeps_what_follows_the_json(
    case: tuple[bytes, dict[int, LightAnnotation]],
) -> None:
    source, advice = case
    if source[:4] != b"glTF":
        source = glb(source, (b"BIN\0", b"1234"), (b"XTRA", b"5"))
    annotated = annotate(source, advice)
    (before,), (after,) = struct.unpack_from("<I", source, 12), struct.unpack_from("<I", annotated, 12)
    (total_before,), (total_after,) = (
        struct.unpack_from("<I", source, 8),
        struct.unpack_from("<I", annotated, 8),
    )
    assert after % 4 == 0
    assert total_after - total_before == len(annotated) - len(source) == after - before
    assert annotated[20 + after :] == source[20 + before :]


def light(extras: str = "", used: str = '"extensionsUsed":["KHR_lights_punctual"],') -> bytes:
    return (
        "{"
        + used
        + '"nodes":[{"name":"no light"},{'
        + extras
        + '"extensions":{"KHR_lights_punctual":{"light":0}}}]}'
    ).encode()


def test_the_annotation_looks_as_documented() -> None:
    source = light()
    node = {"extensions": {"KHR_lights_punctual": {"light": 0}}}
    node["extensions"][EXTENSION] = {
        "technique": "SV",
        "original": {
            "sha256": hashlib.sha256(source).hexdigest(),
            "absent": ["extras"],
            "extras": ["gnomon_technique"],
        },
    }
    assert json_of(annotate(source, {1: OTHER})) == {
        "extensionsUsed": ["KHR_lights_punctual", EXTENSION],
        "nodes": [{"name": "no light"}, {**node, "extras": {"gnomon_technique": "SV"}}],
    }


def test_the_authors_keys_are_left_alone() -> None:
    source = light('"extras":{"gnomon_mobility":"static","gnomon_note":"mine","technique":"PCF"},')
    annotated = annotate(source, {1: ADVICE})
    authors = {"gnomon_mobility": "static", "gnomon_note": "mine", "technique": "PCF"}
    assert json_of(annotated)["nodes"][1]["extras"] == {**authors, **ADVICE.extras}
    assert clear(annotated).data == source
    assert json_of(clear(without_extensions(annotated)).data) == json_of(source)


@pytest.mark.parametrize("extras", ["", '"extras":{"gnomon_mobility":"static"},'])
def test_keys_of_ours_that_another_program_kept_are_replaced(extras: str) -> None:
    source = light(extras)
    kept = without_extensions(annotate(source, {1: ADVICE}))
    assert json_of(kept)["nodes"][1]["extras"].items() >= ADVICE.extras.items()

    annotated = annotate(kept, {1: OTHER})
    assert annotated.count(b"gnomon_technique") == 2  # in the extras and in the record
    assert b"gnomon_map_size" not in annotated
    assert json_of(annotated)["nodes"][1]["extras"].items() >= OTHER.extras.items()
    fresh = annotate(clear(kept).data, {1: OTHER})
    assert annotated.replace(b'"hadStrays": true, ', b"", 1) == fresh

    for left in (kept, annotated, annotate(annotated, {0: ADVICE})):
        cleared = clear(left)
        assert json_of(cleared.data) == json_of(source)
        assert not cleared.restored
        assert "another program" in cleared.note
        assert "cannot be restored" in cleared.note


def test_keys_of_ours_go_from_nodes_without_advice_too() -> None:
    kept = without_extensions(annotate(light(), {0: ADVICE, 1: ADVICE}))
    assert "extras" not in json_of(annotate(kept, {1: OTHER}))["nodes"][0]


def test_a_declaration_without_any_annotation_goes() -> None:
    for others in ([], ["KHR_lights_punctual"]):
        used = json.dumps([*others, EXTENSION])
        cleared = clear(light(used=f'"extensionsUsed":{used},'))
        assert json_of(cleared.data).get("extensionsUsed", []) == others
        assert ("extensionsUsed" in json_of(cleared.data)) == bool(others)
        assert not cleared.restored


def test_a_key_of_ours_added_to_an_annotated_node_is_no_loss() -> None:
    source = light()
    edited = annotate(source, {1: OTHER}).replace(
        b'{"gnomon_technique":"SV"}', b'{"gnomon_technique":"SV","gnomon_filter":"2x2"}'
    )
    assert b"2x2" in edited
    cleared = clear(edited)
    assert (cleared.data, cleared.restored) == (source, True)


@pytest.mark.parametrize("extras", ["5", "null", '"text"', "[1, 2]", "true"])
def test_extras_that_are_no_object_are_left_alone(extras: str) -> None:
    source = light(f'"extras":{extras},')
    annotated = annotate(source, {1: ADVICE})
    node = json_of(annotated)["nodes"][1]
    assert node["extras"] == json.loads(extras)
    assert node["extensions"][EXTENSION]["withheldExtras"] == ADVICE.extras
    assert clear(annotated).data == source


@pytest.mark.parametrize(
    "used",
    ["", '"extensionsUsed":[],', '"extensionsUsed":[ \n ],', '"extensionsUsed":["KHR_lights_punctual"],'],
)
def test_the_extension_is_declared_once_and_never_required(used: str) -> None:
    source = light(used=used)
    annotated = annotate(source, {1: ADVICE, 0: OTHER})
    assert json_of(annotated)["extensionsUsed"].count(EXTENSION) == 1
    assert "extensionsRequired" not in json_of(annotated)
    assert clear(annotated).data == source
    rewritten = json.dumps(json_of(annotated)).encode()
    assert json_of(clear(rewritten).data) == json_of(source)


def test_floats_are_written_by_repr_and_text_in_ascii() -> None:
    annotated = annotate(light(), {1: ADVICE})
    assert b'"gnomon_shadow_ms":0.30000000000000004' in annotated
    assert annotated.isascii()


def test_lines_and_indentation_follow_the_file() -> None:
    lines = [
        "{",
        '\t"nodes": [',
        "\t\t{",
        '\t\t\t"extensions": {',
        '\t\t\t\t"A": {}',
        "\t\t\t}",
        "\t\t}",
        "\t]",
        "}",
    ]
    annotated = annotate(
        "\r\n".join(lines).encode(),
        {0: LightAnnotation({"gnomon_technique": "SM", "gnomon_map_size": 2}, {})},
    )
    written = annotated.decode().split("\r\n")
    assert '\t\t\t"extras": {' in written
    assert '\t\t\t\t"gnomon_map_size": 2' in written
    assert f'\t\t\t\t"{EXTENSION}": {{' in written
    assert f'\t\t"{EXTENSION}"' in written
    assert "\n" not in "".join(written)


def test_a_file_without_annotation_is_returned_as_it_is() -> None:
    source = light('"extras":{"gnomon_mobility":"static"},')
    cleared = clear(source)
    assert (cleared.data, cleared.restored) == (source, True)
    assert "nothing to clear" in cleared.note


def test_an_edit_elsewhere_is_kept_but_not_called_a_restoration() -> None:
    source = glb(light() + b"   ", (b"BIN\0", b"1234"))
    edited = annotate(source, {1: ADVICE}).replace(b'"no light"', b'"no lamps"')
    cleared = clear(edited)
    assert not cleared.restored
    assert json_of(cleared.data)["nodes"][0]["name"] == "no lamps"
    assert EXTENSION.encode() not in cleared.data
    assert cleared.data.endswith(b"1234")
    assert struct.unpack_from("<I", cleared.data, 12)[0] % 4 == 0
    assert struct.unpack_from("<I", cleared.data, 8)[0] == len(cleared.data)


@pytest.mark.parametrize(
    "extension",
    [
        "5",
        "null",
        "{}",
        '{"original":7}',
        '{"original":{"sha256":1,"jsonLength":"x","extras":[5,"name","gnomon_mobility","gnomon_x"],"absent":{}}}',
        '{"original":{"jsonLength":-5,"extras":"gnomon_x","declared":"yes"}}',
        '{"original":' + "[" * 100_000 + "]" * 100_000 + "}",
        '{"original":{"jsonLength":' + "9" * 5000 + "}}",
    ],
)
@pytest.mark.parametrize("binary", [False, True])
def test_a_forged_or_broken_record_costs_only_the_restoration(extension: str, binary: bool) -> None:  # noqa: FBT001
    text = (
        f'{{"nodes":[{{"extras":{{"name":1,"gnomon_mobility":3,"gnomon_x":2}},"extensions":{{"{EXTENSION}":{extension},"A":{{}}}}}}]}}'
    ).encode()
    cleared = clear(glb(text) if binary else text)
    assert not cleared.restored
    node = json_of(cleared.data)["nodes"][0]
    assert node["extensions"] == {"A": {}}
    assert node["extras"].items() >= {"name": 1, "gnomon_mobility": 3}.items()
    assert ("gnomon_x" in node["extras"]) == ("[5," not in extension)


@pytest.mark.parametrize("index", [-1, 2, 10**9])
def test_a_node_that_does_not_exist_is_named(index: int) -> None:
    with pytest.raises(LevelError) as caught:
        annotate(light(), {index: ADVICE}, where="level.gltf")
    assert f"no node {index}" in caught.value.what
    assert caught.value.where == "level.gltf"
    assert "2 nodes" in caught.value.known


@pytest.mark.parametrize(
    "text",
    [
        b'{"nodes":[5]}',
        b'{"nodes":[{"extensions":[]}]}',
        b'{"nodes":[{}],"extensionsUsed":{}}',
        b'{"nodes":{}}',
        b'{"asset":{}}',
        b"{}",
    ],
)
def test_json_of_another_shape_is_refused(text: bytes) -> None:
    with pytest.raises(LevelError) as caught:
        annotate(text, {0: ADVICE}, where="level.gltf")
    assert caught.value.where.startswith("level.gltf")
    assert caught.value.remedy
    assert not is_annotated(text)


def changed(source: bytes, at: int, new: bytes) -> bytes:
    return source[:at] + new + source[at + len(new) :]


GOOD_GLB = glb(light() + b" ", (b"BIN\0", b"1234"))


@pytest.mark.parametrize(
    ("source", "byte"),
    [
        (GOOD_GLB[:15], 15),
        (GOOD_GLB[:-1], len(GOOD_GLB) - 1),
        (changed(GOOD_GLB, 4, b"\1"), 4),
        (changed(GOOD_GLB, 12, b"\xff\xff\xff\xff"), len(GOOD_GLB)),
        (changed(GOOD_GLB, 16, b"BIN\0"), 12),
        (changed(GOOD_GLB, 8, b"\0\0\0\0"), 12),
        (changed(GOOD_GLB, 20, b"]"), 20),
        (glb(b'{"a":1,}'), 27),
        (glb(b""), 20),
        (b"", 0),
        (b"version https://git-lfs.github.com/spec/v1\n", 0),
        (b'{"asset":}', 1),
    ],
)
@pytest.mark.parametrize("do", [clear, lambda source, where: annotate(source, {0: ADVICE}, where=where)])
def test_a_broken_file_is_refused_with_its_byte(source: bytes, byte: int, do: Any) -> None:
    with pytest.raises(LevelError) as caught:
        do(source, where="level.glb")
    assert caught.value.where == f"level.glb, byte {byte}"
    assert caught.value.what
    assert caught.value.known
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("extras", "extension"),
    [
        ({"gnomon_shadow_ms": float("nan")}, {}),
        ({"gnomon_shadow_ms": float("inf")}, {}),
        ({"gnomon_filter": [1]}, {}),
        ({"gnomon_filter": None}, {}),
        ({"technique": "SM"}, {}),
        ({"gnomon_mobility": "static"}, {}),
        ({}, {"deep": [{"value": float("-inf")}]}),
    ],
)
def test_what_must_not_be_written_is_refused(extras: Any, extension: Any) -> None:
    with pytest.raises(ValueError, match=r"extras|extension|JSON"):
        LightAnnotation(extras, extension)


@pytest.mark.parametrize("key", ["original", "withheldExtras"])
def test_keys_that_the_annotation_itself_writes_are_refused(key: str) -> None:
    with pytest.raises(ValueError, match=key):
        annotate(light(), {1: LightAnnotation({}, {key: 1})})


def test_many_nodes_in_a_large_file_are_restored() -> None:
    node = '{"name":"\\u006e","extensions":{"KHR_lights_punctual":{"light":0}},"translation":[1.0,2.50,3e0]}'
    source = ('{"asset":{"version":"2.0"},"nodes":[' + ",\n".join([node] * 5000) + "]}").encode()
    annotated = annotate(source, dict.fromkeys(range(0, 5000, 7), ADVICE))
    assert annotated.count(b'"gnomon_technique":"SM"') == len(range(0, 5000, 7))
    assert clear(annotated).data == source


@pytest.mark.skipif(not LEVEL_FILES, reason="the shared levels are not beside this repository")
@pytest.mark.parametrize("path", LEVEL_FILES, ids=lambda path: path.name)
def test_real_levels_are_annotated_and_restored(path: Path) -> None:
    source = path.read_bytes()
    document = json_of(source)
    lights = [
        i for i, node in enumerate(document["nodes"]) if "KHR_lights_punctual" in node.get("extensions", {})
    ]
    chosen = lights or range(0, len(document["nodes"]), 3)
    advice = dict.fromkeys(chosen, ADVICE)
    annotated = annotate(source, advice)
    assert without_ours(json_of(annotated), document) == document
    nodes = json_of(annotated)["nodes"]
    assert all(EXTENSION in nodes[index]["extensions"] for index in chosen)
    assert annotate(annotated, advice) == annotated
    cleared = clear(annotated)
    assert cleared.restored
    assert cleared.data == source


@pytest.mark.parametrize("padding", [b"\0", b"\0\0\0", b" \n\0\0\n"])
def test_zeros_behind_a_gltf_stay_byte_for_byte(padding: bytes) -> None:
    source = light() + padding
    annotated = annotate(source, {1: ADVICE})
    assert annotated.endswith(b"}" + padding)
    assert EXTENSION in json.loads(annotated.removesuffix(padding))["extensionsUsed"]
    cleared = clear(annotated)
    assert cleared.data == source
    assert cleared.restored
