from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.errors import LevelError
from scenes.json_splice import Edit, Item, RawJson, Span, spliced
from tests.scenes.gltf_texts import NAMES, SCALARS, containers, gltf_texts, objects, values


def refuse_constant(name: str) -> float:
    raise ValueError(name)


def accepted_by_python(text: bytes) -> bool:
    try:
        root = json.loads(text.decode(), parse_constant=refuse_constant)
    except ValueError:
        return False
    return isinstance(root, dict)


def accepted(text: bytes) -> bool:
    try:
        RawJson(text)
    except LevelError:
        return False
    return True


def decoded(raw: RawJson, span: Span) -> Any:
    """The value, put together from the spans alone."""
    if raw.kind(span) == "{":
        return {item.name: decoded(raw, item.value) for item in raw.items(span)}
    if raw.kind(span) == "[":
        return [decoded(raw, item.value) for item in raw.items(span)]
    return json.loads(raw.text[span.start : span.end])


@given(gltf_texts())
def test_spans_hold_the_same_values_as_json_loads(made: Any) -> None:
    raw = RawJson(made.text)
    assert decoded(raw, raw.root) == json.loads(made.text.decode("utf-8-sig"))


@given(gltf_texts(), st.data())
def test_a_broken_text_is_refused_exactly_where_json_loads_refuses_it(made: Any, data: st.DataObject) -> None:
    text = made.text.removeprefix(b"\xef\xbb\xbf")
    at = data.draw(st.integers(0, len(text) - 1))
    length = data.draw(st.integers(0, 2))
    junk = data.draw(
        st.sampled_from([b"", b",", b"}", b"]", b"{", b'"', b"\\", b"0", b"-", b".", b"NaN", b"\x01", b":"])
    )
    broken = text[:at] + junk + text[at + length :]
    assert accepted(broken) == accepted_by_python(broken)


@pytest.mark.parametrize(
    "number",
    ["01", "-", "+1", "1.", ".5", "1e", "1e+", "0x1", "NaN", "Infinity", "-Infinity", "1 2", "--1", "tru"],
)
@pytest.mark.parametrize(
    "place", ['{"a":%s}', '{"a":[%s]}', '{"a":[1,%s,2]}', '{"a":[[],%s]}', '{"b":{},"a":%s}']
)
def test_what_json_has_no_spelling_for_is_refused(place: str, number: str) -> None:
    assert not accepted((place % number).encode())


@pytest.mark.parametrize(
    "text", ["[1,]", "[,1]", "[1 1]", "[[],]", "[[]1]", "[[]", '["\\x"]', '["\\u12g4"]', "[]]", "{1:2}"]
)
def test_broken_structure_is_refused(text: str) -> None:
    assert not accepted(b'{"a":' + text.encode() + b"}")


@pytest.mark.parametrize("count", [1, 254, 255, 256, 257, 512, 513, 1000])
@pytest.mark.parametrize("last", ["7", "{}", '{"k": [] }', '"x"'])
def test_segments_of_every_length_are_followed(count: int, last: str) -> None:
    array = [*(str(i) for i in range(count)), last]
    text = ('{"a":[' + " , ".join(array) + "]}").encode()
    raw = RawJson(text)
    assert decoded(raw, raw.root) == json.loads(text)
    assert not accepted(text.replace(b"]}", b",]}"))


def test_errors_name_file_byte_and_what_is_there() -> None:
    text = b'{"nodes": [1, 2,\n  oops]}'
    with pytest.raises(LevelError) as caught:
        RawJson(text, where="level.glb", offset=20)
    assert caught.value.where == f"level.glb, byte {20 + text.index(b'oops')}"
    assert "oops" in caught.value.known
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("text", "byte"),
    [
        (b"", 0),
        (b"[1]", 0),
        (b'{"a":"\xff"}', 6),
        (b"{} x", 3),
        (b"version https://git-lfs", 0),
        (b'{"a":1', 6),
    ],
)
def test_other_bad_texts_name_the_byte(text: bytes, byte: int) -> None:
    with pytest.raises(LevelError) as caught:
        RawJson(text)
    assert caught.value.where.startswith("byte ")
    assert int(caught.value.where.removeprefix("byte ")) <= byte
    assert caught.value.known


@pytest.mark.parametrize(("opening", "closing"), [(b"[", b"]"), (b'{"a":', b"}")])
def test_nesting_deeper_than_any_stack_is_followed(opening: bytes, closing: bytes) -> None:
    text = b'{"deep":' + opening * 200_000 + b"0" + closing * 200_000 + b',"nodes":[]}'
    if opening == b"[":
        text = text.replace(b"[0]", b"[]", 1)
    nodes = RawJson(text).member(Span(0, len(text)), "nodes")
    assert nodes is not None
    assert text[nodes.start : nodes.end] == b'"nodes":[]'


def test_the_last_of_two_equal_keys_counts_also_when_spelt_with_escapes() -> None:
    raw = RawJson(b'{"nodes":1,"n\\u006fdes":2,"other":3}')
    found = raw.member(raw.root, "nodes")
    assert found is not None
    assert raw.value(found.value) == 2
    assert raw.member(raw.root, "absent") is None


@given(st.data(), st.booleans())
def test_removing_undoes_appending(data: st.DataObject, in_object: bool) -> None:  # noqa: FBT001
    count = data.draw(st.integers(0, 3))
    parts = [data.draw(values(1)) for _ in range(count)]
    names = [data.draw(NAMES) for _ in range(count)]
    container = objects(list(zip(names, parts, strict=True))) if in_object else containers(parts, "[]")
    before = ('{"c":' + data.draw(container) + "}").encode()
    additions = [
        b'"ours%d":%d' % (i, i) if in_object else b"%d" % i for i in range(data.draw(st.integers(1, 3)))
    ]

    raw = RawJson(before)
    longer = RawJson(spliced(before, [raw.appending(raw.items(raw.root)[0].value, additions)]))
    place = longer.items(longer.root)[0].value
    items = longer.items(place)
    assert len(items) == count + len(additions)
    assert [longer.text[item.start : item.end] for item in items[count:]] == additions
    assert spliced(longer.text, longer.removing(place, items[count:])) == before


@given(st.data())
def test_removing_any_items_leaves_the_others(data: st.DataObject) -> None:
    parts = [data.draw(SCALARS) for _ in range(data.draw(st.integers(0, 5)))]
    text = ('{"c":' + data.draw(containers(parts, "[]")) + "}").encode()
    raw = RawJson(text)
    place = raw.items(raw.root)[0].value
    items = raw.items(place)
    dropped = [item for item in items if data.draw(st.booleans())]
    left = json.loads(spliced(text, raw.removing(place, dropped)))["c"]
    assert left == [raw.value(item.value) for item in items if item not in dropped]


def test_additions_are_spaced_like_the_items_before_them() -> None:
    raw = RawJson(b'{"c": [\r\n\t1,\r\n\t2\r\n]}')
    edit = raw.appending(raw.items(raw.root)[0].value, [b"3", b"4"])
    assert spliced(raw.text, [edit]) == b'{"c": [\r\n\t1,\r\n\t2,\r\n\t3,\r\n\t4\r\n]}'


def test_overlapping_edits_are_our_own_bug() -> None:
    with pytest.raises(AssertionError):
        spliced(b"abcdef", [Edit(0, 3, b""), Edit(2, 4, b"")])


def test_removing_many_items_never_searches_a_list() -> None:
    class Unsearched(list[Item]):
        def __contains__(self, item: object) -> bool:
            raise AssertionError("this takes as long as the list is")

    raw = RawJson(b'{"a":[1,2,3,4,5]}')
    member = raw.member(raw.root, "a")
    assert member is not None
    items = raw.items(member.value)
    edits = raw.removing(member.value, Unsearched([items[0], items[2], items[4]]))
    assert spliced(raw.text, edits) == b'{"a":[2,4]}'
