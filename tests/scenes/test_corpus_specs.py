"""Specs survive JSON and refuse nonsense; the sampler reaches every bin of every axis."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import fields
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.corpus.corpora import CORPORA, corpus
from scenes.corpus.registry import families
from scenes.corpus.rigs import RIGS
from scenes.corpus.sampler import CUT_OFF_BINS_DEG, REACHES, TRIANGLE_BINS, Sampler
from scenes.corpus.spec import STEPS, Closure, Rig, Spec, SpecError, Standpoint
from scenes.corpus.staging import instance
from scenes.scene import LightKind
from scenes.thesis.set_ups import set_ups

GOOD: dict[str, Any] = {"family": "forest", "seed": 4, "rig": "overhead"}

any_spec = st.builds(
    Spec,
    family=st.sampled_from(sorted(families())),
    seed=st.integers(0, 2**53 - 1),
    triangles=st.integers(24, 1_000_000),
    crowding=st.integers(0, STEPS - 1),
    grain=st.integers(0, STEPS - 1),
    closure=st.sampled_from(Closure),
    kind=st.sampled_from(LightKind),
    cut_off_deg=st.floats(2.0, 80.0),
    reach=st.none() | st.floats(1e-3, 10.0),
    rig=st.sampled_from(Rig),
    standpoint=st.sampled_from(Standpoint),
    merged=st.booleans(),
    lights=st.integers(1, 64),
    cameras=st.integers(1, 4),
)


@given(spec=any_spec)
def test_a_spec_survives_json(spec: Spec) -> None:
    again = Spec.from_text(spec.text)
    assert again == spec
    assert hash(again) == hash(spec)
    shuffled = json.dumps(dict(reversed(json.loads(spec.text).items())))
    assert Spec.from_text(shuffled).text == spec.text


def test_what_is_left_out_has_its_default() -> None:
    assert Spec.from_record({"family": "cave"}) == Spec("cave")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"seed": -1}, "seed must be from 0"),
        ({"seed": 1.5}, "seed must be a whole number"),
        ({"seed": True}, "seed must be a whole number"),
        ({"triangles": 3}, "triangles must be from 24"),
        ({"triangles": 10**7}, "triangles must be from 24 to 1,000,000"),
        ({"crowding": 5}, "crowding must be from 0 to 4"),
        ({"grain": -1}, "grain must be from 0 to 4"),
        ({"closure": "ajar"}, "closure must be one of as_built, bottomless, flipped"),
        ({"kind": "area"}, "kind must be one of spot, point, directional"),
        ({"rig": 7}, "rig must be one of miners_lamp"),
        ({"standpoint": None}, "standpoint must be one of vista, near, far"),
        ({"cut_off_deg": 85.0}, "cut_off_deg must be from 2 to 80"),
        ({"cut_off_deg": float("nan")}, "cut_off_deg must be from 2 to 80"),
        ({"cut_off_deg": "wide"}, "cut_off_deg must be from 2 to 80"),
        ({"reach": 0.0}, "reach must be over 0"),
        ({"reach": float("inf")}, "reach must be over 0"),
        ({"merged": 1}, "merged must be true or false"),
        ({"lights": 0}, "lights must be from 1"),
        ({"cameras": 9}, "cameras must be from 1"),
        ({"family": 3}, "family must be a text"),
        ({"colour": "red"}, 'A spec has no "colour"'),
    ],
)
def test_a_bad_value_is_refused_in_a_sentence(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(SpecError, match=sentence):
        Spec.from_record(GOOD | changes)


@pytest.mark.parametrize("text", ["", "{", "[]", "3", '{"seed": 3}', "[" * 100_000])
def test_what_is_no_spec_is_refused(text: str) -> None:
    with pytest.raises(SpecError):
        Spec.from_text(text)


@pytest.mark.parametrize(
    ("spec", "sentence"),
    [
        (Spec("atlantis"), 'no family "atlantis"'),
        (Spec("water_tower", triangles=100), "8,000 to 1,000,000 triangles"),
        (Spec("cave", kind=LightKind.DIRECTIONAL, rig=Rig.OVERHEAD), "not lit by a directional light"),
        (Spec("forest", kind=LightKind.DIRECTIONAL, rig=Rig.BETWEEN), "directional light cannot be between"),
        (Spec("forest", rig=Rig.AT_THE_WALL), "spot light cannot be at_the_wall"),
        (Spec("cave", kind=LightKind.POINT, standpoint=Standpoint.REMOTE), "its camera cannot be remote"),
        (Spec("forest", set_up="Figure 99"), 'no set-up "Figure 99"'),
    ],
)
def test_a_spec_that_no_family_can_be_is_refused(spec: Spec, sentence: str) -> None:
    with pytest.raises(SpecError, match=sentence):
        instance(spec)


@pytest.mark.parametrize("name", CORPORA)
def test_a_corpus_is_a_list_of_distinct_good_specs(name: str) -> None:
    specs = corpus(name)
    assert len(set(specs)) == len(specs)
    for spec in specs:
        family = families()[spec.family]
        if not spec.set_up:
            assert family.TRIANGLES[0] <= spec.triangles <= family.TRIANGLES[1]
            assert spec.kind in family.KINDS
            assert spec.rig in RIGS[spec.kind]
            assert spec.standpoint is not Standpoint.REMOTE or not family.INDOOR


def test_sizes_of_the_corpora() -> None:
    assert 48 <= len(corpus("quick")) <= 60
    assert len(corpus("standard")) >= 1000
    assert {spec.family for spec in corpus("quick")} == set(families())
    each = Counter(spec.family for spec in corpus("standard"))
    assert max(each.values()) == min(each.values())
    with pytest.raises(SpecError, match='no corpus "huge"'):
        corpus("huge")


def test_the_thesis_corpus_is_its_set_ups() -> None:
    specs = corpus("thesis")
    assert [spec.set_up for spec in specs] == [set_up.name for set_up in set_ups()]
    staged = set_ups()[2].staged()
    assert instance(specs[2]).digest == staged.digest


def test_the_standard_corpus_reaches_every_bin_of_every_axis() -> None:
    specs = corpus("standard")
    for name, values in {
        "crowding": range(STEPS),
        "grain": range(STEPS),
        "closure": Closure,
        "kind": LightKind,
        "rig": Rig,
        "standpoint": Standpoint,
        "reach": set(REACHES),
        "triangles": set(TRIANGLE_BINS),
        "merged": (False, True),
    }.items():
        dealt = Counter(getattr(spec, name) for spec in specs)
        assert set(dealt) >= set(values), name
        assert min(dealt[value] for value in values) >= 5, (name, dealt)
    spots = [spec.cut_off_deg for spec in specs if spec.kind is LightKind.SPOT]
    for low, high in CUT_OFF_BINS_DEG:
        assert sum(low <= angle <= high for angle in spots) > len(spots) / 20
    pairs = Counter((spec.kind, spec.rig) for spec in specs)
    assert len(pairs) == sum(map(len, RIGS.values()))
    assert min(pairs.values()) > 20


def test_every_family_is_stretched_by_itself() -> None:
    by_family: dict[str, list[Spec]] = {}
    for spec in corpus("standard"):
        by_family.setdefault(spec.family, []).append(spec)
    for name, specs in by_family.items():
        assert {spec.crowding for spec in specs} == set(range(STEPS)), name
        assert {spec.grain for spec in specs} == set(range(STEPS)), name
        assert {spec.kind for spec in specs} == set(families()[name].KINDS), name
        assert max(spec.triangles for spec in specs) == 1_000_000, name
        assert min(spec.triangles for spec in specs) <= 2 * families()[name].TRIANGLES[0], name


def test_the_sampler_deals_the_same_again() -> None:
    assert Sampler(5).specs(60) == Sampler(5).specs(60)
    assert Sampler(5).specs(60) != Sampler(6).specs(60)
    assert all(spec.triangles <= 20_000 for spec in Sampler(1, most_triangles=20_000).specs(60))
    assert {spec.family for spec in Sampler(1, ["cave"]).specs(4)} == {"cave"}


def test_every_axis_of_a_spec_is_told_apart_by_its_text() -> None:
    texts = {Spec("cave").text} | {
        Spec("cave", **{name: value}).text  # type: ignore[arg-type]
        for name, value in {
            "seed": 1,
            "triangles": 5000,
            "crowding": 0,
            "grain": 0,
            "closure": Closure.FLIPPED,
            "kind": LightKind.POINT,
            "cut_off_deg": 10.0,
            "reach": 1.0,
            "rig": Rig.BETWEEN,
            "standpoint": Standpoint.FAR,
            "merged": True,
            "lights": 2,
            "cameras": 2,
            "set_up": "x",
        }.items()
    }
    assert len(texts) == len(fields(Spec))
