from __future__ import annotations

import json
from copy import deepcopy
from typing import Any

import pytest
from hypothesis import event, given
from hypothesis import strategies as st

from api.client.errors import BadAnswerError
from api.client.reading import parsed, record
from api.client.records import Job, LevelAnswer, MeasuredLevel
from tests.api.client.sample_answers import JOB, LEVEL, MEASURED

SAMPLES = [(LevelAnswer, LEVEL), (Job, JOB), (MeasuredLevel, MEASURED)]
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)


def places(value: Any) -> list[tuple[Any, Any]]:
    """Every container with every key into it."""
    entries = (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    )
    return [place for key, inner in entries for place in ((value, key), *places(inner))]


def test_a_level_s_answer_has_types() -> None:
    lamp, dark = record(LevelAnswer, LEVEL).lights
    assert (lamp.node, lamp.problem, dark.recommendation) == (3, "", None)
    assert dark.problem == "No camera sees it."
    assert lamp.recommendation is not None
    assert lamp.recommendation.settings == {"map_size": 512, "filter": "2x2", "focus": "light"}
    assert lamp.recommendation.shadow_ms_range == (1.0, 2.0)
    assert isinstance(lamp.recommendation.works, float)
    assert lamp.recommendation.runner_up is not None
    assert lamp.recommendation.runner_up.id == "shadow_map"


def test_a_measured_level_has_types() -> None:
    lamp, dark = record(MeasuredLevel, MEASURED).lights
    assert lamp.recommendation is not None
    assert lamp.recommendation.chosen.label == "SV"
    assert (dark.problem, dark.recommendation) == ("It lights nothing.", None)


def test_keys_that_are_not_known_are_left_out() -> None:
    assert record(Job, {**JOB, "new": 1}) == record(Job, JOB)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"state": "asleep"}, "The answer.state is 'asleep' where one of queued, running"),
        ({"lights": True}, "The answer.lights is True where an integer was expected."),
        ({"lights": 1.5}, "The answer.lights is 1.5 where an integer"),
        ({"progress": None}, "The answer.progress is None where an object"),
        ({"progress": {"done": 1}}, "The answer.progress has no total."),
        ({"links": {"self": 3}}, "The answer.links.self is 3 where a string"),
        ({"id": "x" * 5 + "\n"}, None),
    ],
)
def test_what_is_wrong_is_said(change: dict[str, Any], words: str | None) -> None:
    if words is None:
        record(Job, {**JOB, **change})
        return
    with pytest.raises(BadAnswerError) as caught:
        record(Job, {**JOB, **change})
    assert words in str(caught.value)


@pytest.mark.parametrize(
    "data",
    [b"", b"{", b"\xff", b"[1e999", b"NaN", b'{"a": Infinity}', b"[" * 100_000, b"1" * 5000, b"<html>"],
)
def test_what_is_no_json_is_told(data: bytes) -> None:
    with pytest.raises(BadAnswerError, match=r"^The answer is not JSON: .{1,120}\.$"):
        parsed(data)


def test_a_number_without_end_is_no_number() -> None:
    changed = {**LEVEL, "max_edge_error_px": json.loads("1e999")}
    with pytest.raises(BadAnswerError, match="max_edge_error_px is inf where a number"):
        record(LevelAnswer, changed)


@given(st.data())
def test_whatever_comes_is_a_record_or_a_bad_answer(data: st.DataObject) -> None:
    kind, sample = data.draw(st.sampled_from(SAMPLES))
    changed = deepcopy(sample)
    container, key = data.draw(st.sampled_from(places(changed)))
    container[key] = data.draw(VALUES)
    try:
        assert isinstance(record(kind, changed), kind)
    except BadAnswerError as error:
        event(f"at most {len(str(error)) // 100 + 1}00 characters")
