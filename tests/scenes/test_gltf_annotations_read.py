from __future__ import annotations

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.gltf.annotation import annotate, read_annotations
from scenes.gltf.annotation_record import EXTENSION
from scenes.light_annotation import OWN_KEYS, LightAnnotation
from tests.scenes.gltf_texts import gltf_files
from tests.scenes.test_gltf_annotation import ADVICE, files_and_advice, json_of, light, without_extensions

# As many values as an annotation can hold, so that one that changes on its way is found.
numbers = st.one_of(st.integers(), st.floats(allow_nan=False, allow_infinity=False), st.booleans())
scalars = st.one_of(numbers, st.text())
stories = st.dictionaries(
    st.text().filter(lambda key: key not in {"original", "withheldExtras"}),
    st.recursive(
        st.one_of(scalars, st.none()),
        lambda inner: st.one_of(st.lists(inner), st.dictionaries(st.text(), inner)),
        max_leaves=8,
    ),
    max_size=4,
)
any_annotations = st.builds(
    LightAnnotation, st.dictionaries(st.sampled_from(sorted(OWN_KEYS)), scalars), stories
)


@given(gltf_files(), st.data())
@settings(max_examples=150, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
def test_lights_can_be_annotated_one_after_the_other(case: tuple[bytes, int], data: st.DataObject) -> None:
    source, count = case
    advice = st.dictionaries(st.integers(0, count - 1), any_annotations, min_size=1)
    earlier, later = data.draw(advice), data.draw(advice)
    annotated = annotate(source, earlier)
    assert read_annotations(annotated) == earlier
    assert annotate(annotated, read_annotations(annotated)) == annotated
    both = annotate(source, {**earlier, **later})
    assert annotate(annotated, {**read_annotations(annotated), **later}) == both


@given(files_and_advice())
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
def test_annotations_are_read_after_another_tool_has_rewritten_the_file(
    case: tuple[bytes, dict[int, LightAnnotation]],
) -> None:
    source, advice = case
    rewritten = json.dumps(json_of(annotate(source, advice)), sort_keys=True, indent=3).encode()
    assert read_annotations(rewritten) == advice


def test_keys_of_ours_that_another_program_kept_are_read() -> None:
    kept = without_extensions(annotate(light(), {1: ADVICE}))
    assert read_annotations(kept) == {1: LightAnnotation(ADVICE.extras, {})}


@pytest.mark.parametrize(
    ("node", "found"),
    [
        ('"extras":{"gnomon_technique":["SM"],"gnomon_filter":"2x2"}', {"gnomon_filter": "2x2"}),
        ('"extras":{"gnomon_shadow_ms":1e999,"gnomon_technique":null}', {}),
        ('"extensions":{"%s":5}', {}),
        ('"extensions":{"%s":{"deep":' + 2000 * "[" + 2000 * "]" + "}}", {}),
        ('"extensions":{"%s":{"number":1e999}}', {}),
        (
            '"extensions":{"%s":{"withheldExtras":{"gnomon_note":1,"gnomon_filter":"1x1"}}}',
            {"gnomon_filter": "1x1"},
        ),
        ('"extras":{"gnomon_filter":"2x2"},"extensions":5', None),
    ],
)
def test_what_we_cannot_have_written_is_no_annotation(node: str, found: dict[str, str] | None) -> None:
    source = ('{"nodes":[{' + node.replace("%s", EXTENSION) + "}]}").encode()
    standing = read_annotations(source)
    assert standing == ({} if found is None else {0: LightAnnotation(found, {})})
    annotate(source, standing)
