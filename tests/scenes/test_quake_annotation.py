"""Annotations in .map files: every foreign byte stays, and clearing gives the original back."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.formats.quake_map import annotate, clear, read_annotations
from scenes.light_annotation import LightAnnotation, Scalar
from scenes.quake.map_parser import parse_map
from tests.scenes.quake_samples import WORLD, entity

LEVELS = Path(__file__).parents[2] / "../shared/levels/quake"
REASON = 'the "cheapest" // { é } \\n\n'
ADVICE = LightAnnotation(
    {"gnomon_technique": "SM", "gnomon_map_size": 1024, "gnomon_shadow_ms": 0.25},
    {"technique": "SM", "reason": REASON, "alternatives": [{"settings": {}}]},
)
OTHER = LightAnnotation({"gnomon_technique": "SV"}, {})
EMPTY = LightAnnotation({}, {})
LIGHT = entity(classname="light", origin="0 0 0")

LAYOUTS = {
    "plain": WORLD + LIGHT,
    "tabs": WORLD + '{\n\t"classname"\t"light"\n\t"origin" "0 0 0"\n}\n',
    "CRLF": (WORLD + LIGHT).replace("\n", "\r\n"),
    "CR": (WORLD + LIGHT).replace("\n", "\r"),
    "one line": WORLD + '{ "classname" "light" "origin" "0 0 0" }',
    "no blanks": WORLD + '{"classname""light""origin""0 0 0"}',
    "comments": WORLD + '// entity 1\n{ // "first"\n\n// a {\n  "classname" "light" // why\n// }\n}// end',
    "many blanks": WORLD + "{" + 300 * " \n" + 300 * " " + '"classname" "light"\n}\n',
    "no line end": WORLD + LIGHT[:-1],
    "brush first": WORLD + '{\n{\n( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) a 0 0 0 1 1\n}\n"classname" "light"\n}\n',
    "latin-1": WORLD + LIGHT + '{\n"message" "Grüße"\n}\n',
    "BOM": "\ufeff" + WORLD + LIGHT,
    "Windows comment": WORLD + '{\r\n// a\r\n"classname" "light"\r\n}\r\n',
    "stale": WORLD + LIGHT + '{\n"classname" "worldspawn"\n"_gnomon_mobility" "static"\n}\n',
}


@pytest.fixture(params=LAYOUTS)
def source(request: pytest.FixtureRequest) -> bytes:
    text = LAYOUTS[request.param]
    return text.encode("latin-1" if request.param == "latin-1" else "utf-8")


def without(data: bytes, pieces: bytes) -> bytes:
    """`data` without one contiguous piece: what it would be if nothing else had changed."""
    shared = 0
    while shared < len(pieces) and data[shared] == pieces[shared]:
        shared += 1
    return data[:shared] + data[shared + len(data) - len(pieces) :]


def test_one_contiguous_piece_is_put_in_and_taken_out(source: bytes) -> None:
    annotated = annotate(source, {1: ADVICE})
    assert without(annotated, source) == source
    assert clear(annotated).data == source
    assert clear(annotated).restored
    assert read_annotations(annotated) == {1: ADVICE}
    assert annotate(annotated, {1: ADVICE}) == annotated
    assert annotate(annotated, {1: OTHER}) == annotate(source, {1: OTHER})
    assert read_annotations(source) == {}
    assert clear(source).data == source


def test_everything_else_is_parsed_as_before(source: bytes) -> None:
    before, after = parse_map(source), parse_map(annotate(source, {0: OTHER, 1: ADVICE}))
    assert len(after.entities) == len(before.entities)
    assert (after.points == before.points).all()
    for one, other in zip(after.entities, before.entities, strict=True):
        kept = [(pair.key, pair.value) for pair in one.pairs if pair.key[:8] != "_gnomon_" or one.index > 1]
        assert kept == [(pair.key, pair.value) for pair in other.pairs]


def test_an_annotation_without_keys_does_not_swallow_the_next_line(source: bytes) -> None:
    annotated = annotate(source, {1: EMPTY})
    assert read_annotations(annotated) == {1: EMPTY}
    assert clear(annotated).data == source


@pytest.mark.parametrize(("layout", "line_end"), [("plain", b"\n"), ("CRLF", b"\r\n"), ("tabs", b"\n\t")])
def test_line_ends_and_indentation_are_followed(layout: str, line_end: bytes) -> None:
    annotated = annotate(LAYOUTS[layout].encode(), {1: ADVICE})
    assert line_end + b'"_gnomon_map_size" "1024"' + line_end in annotated
    assert annotated.count(b"\r") in (0, annotated.count(b"\n"))


def test_what_is_written() -> None:
    digest = hashlib.sha256((WORLD + LIGHT).encode()).hexdigest()
    annotated = annotate((WORLD + LIGHT).encode(), {1: ADVICE}).decode("ascii")
    lines = annotated[len(WORLD) :].splitlines()
    assert lines[0] == "{"
    assert lines[1].startswith("// gnomon {")
    story = json.loads(lines[1].removeprefix("// gnomon "))
    assert story == {**ADVICE.extension, "original": {"sha256": digest}}
    assert lines[2:5] == [
        '"_gnomon_technique" "SM"',
        '"_gnomon_map_size" "1024"',
        '"_gnomon_shadow_ms" "0.25"',
    ]
    assert "\n".join(lines[5:]) == LIGHT[2:-1]
    # The game reads keys of 31 and values of 1,023 characters at most.
    assert max(len(line) for line in lines[2:]) < 100


@settings(derandomize=True, deadline=None)
@given(
    st.one_of(
        st.text(),
        st.booleans(),
        st.integers(),
        st.floats(allow_nan=False, allow_infinity=False),
        st.sampled_from(
            ["", "1024", "true", "null", "1e5", "NaN", '"', "'a'", "%31", "a\\n", "{}", "\ud800"]
        ),
    )
)
def test_any_value_survives(value: Scalar) -> None:
    advice = LightAnnotation({"gnomon_filter": value}, {})
    annotated = annotate((WORLD + LIGHT).encode(), {1: advice})
    [found] = read_annotations(annotated).values()
    assert found == advice
    assert type(found.extras["gnomon_filter"]) is type(value)
    assert clear(annotated).restored


def test_a_file_that_was_changed_since_is_cleared_but_not_restored() -> None:
    annotated = annotate((WORLD + LIGHT).encode(), {1: ADVICE})
    changed = annotated.replace(b'"origin" "0 0 0"', b'"origin" "0 0 8"')
    cleared = clear(changed)
    assert cleared.data == (WORLD + LIGHT.replace('"0 0 0"', '"0 0 8"')).encode()
    assert not cleared.restored
    assert "another program has changed" in cleared.note


def test_keys_that_an_editor_kept_without_the_comment_are_found() -> None:
    annotated = annotate((WORLD + LIGHT).encode(), {1: ADVICE})
    saved = b"\n".join(line for line in annotated.split(b"\n") if not line.startswith(b"//"))
    assert read_annotations(saved) == {1: LightAnnotation(ADVICE.extras, {})}
    cleared = clear(saved)
    assert cleared.data == (WORLD + LIGHT).encode()
    assert not cleared.restored
    assert "dropped the record" in cleared.note
    again = annotate(saved, {1: OTHER})
    assert b"_gnomon_map_size" not in again
    assert not clear(again).restored
    assert annotate(again, {1: OTHER}) == again


@pytest.mark.parametrize(
    "story", ["{", "{}", "[]", '{"original": 5}', '{"a": NaN}', "{" * 100_000, '{"a": 1e999}']
)
def test_a_forged_or_broken_comment_costs_only_the_restoration(story: str) -> None:
    text = LIGHT.replace("{\n", f"{{\n// gnomon {story}\n")
    cleared = clear((WORLD + text).encode())
    if story == "[]":
        assert cleared.data == (WORLD + text).encode()
        return
    assert cleared.data == (WORLD + LIGHT).encode()
    assert not cleared.restored


def test_comments_of_others_stay() -> None:
    text = LIGHT.replace("{\n", "{\n// gnomon is a sundial\n//gnomon {}\n")
    assert clear((WORLD + text).encode()).data == (WORLD + text).encode()


@pytest.mark.parametrize("node", [-1, 2, 10**9])
def test_an_entity_that_is_not_there_is_refused(node: int) -> None:
    with pytest.raises(LevelError, match=f"no node {node}") as caught:
        annotate((WORLD + LIGHT).encode(), {node: ADVICE})
    assert "2 entities" in caught.value.known


def test_an_entity_without_keys_is_refused() -> None:
    with pytest.raises(LevelError, match="no keys"):
        annotate((WORLD + "{\n}\n").encode(), {1: ADVICE})


def test_a_key_that_the_annotation_writes_itself_is_refused() -> None:
    with pytest.raises(ValueError, match="original"):
        annotate((WORLD + LIGHT).encode(), {1: LightAnnotation({}, {"original": 1})})


@pytest.mark.skipif(not LEVELS.is_dir(), reason="the folder of real levels is not here")
@pytest.mark.parametrize("name", ["start", "e1m1", "dm4", "dm6"])
def test_real_maps_are_annotated_and_restored(name: str) -> None:
    source = (LEVELS / f"{name}.map").read_bytes()
    lights = [one.index for one in parse_map(source).entities if one.kind.startswith("light")]
    annotated = annotate(source, dict.fromkeys(lights, ADVICE))
    ours = [b"// gnomon", b'"_gnomon_']
    kept = [line for line in annotated.split(b"\n") if not any(line.startswith(mark) for mark in ours)]
    assert b"\n".join(kept) == source
    assert read_annotations(annotated) == dict.fromkeys(lights, ADVICE)
    cleared = clear(annotated)
    assert (cleared.data, cleared.restored) == (source, True)
