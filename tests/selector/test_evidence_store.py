"""What is put into a store comes out of it, once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from scenes.scene import Mobility
from selector.evidence.rows import Role
from selector.evidence.store import Store, StoreError
from selector.measurement import Status
from tests.selector.evidence_rows import (
    CODE,
    DEVICE,
    ERRORS,
    OLD_CODE,
    SM,
    SV,
    TIMES,
    Everything,
    asked,
    everything,
    filled,
    instance,
    judgement,
    sample,
    timing,
)


def new(folder: Path) -> Store:
    return Store.open(str(folder / "evidence.sqlite"))


def test_every_row_comes_out_as_it_went_in(tmp_path: Path) -> None:
    row = instance(1)
    judged = [judgement(asked(row, SM), None), judgement(asked(row, SV), status=Status.TIMEOUT)]
    timed = [timing(asked(row, SM), 2.0, 1 / 3), timing(asked(row, SV), status=Status.CRASHED)]
    with new(tmp_path) as store:
        store.begin(ERRORS, DEVICE)
        store.begin(TIMES, DEVICE)
        store.add(row, [SM, SV], judged, timed)
    with Store.open(str(tmp_path / "evidence.sqlite"), write=False) as store:
        found = everything(store)
    order = sorted([SM, SV], key=lambda candidate: candidate.key)
    assert found == Everything(
        (row,),
        (SM, SV),
        (DEVICE,),
        (ERRORS, TIMES),
        tuple(sorted(judged, key=lambda one: [c.key for c in order].index(one.asked.candidate))),
        tuple(sorted(timed, key=lambda one: [c.key for c in order].index(one.asked.candidate))),
    )
    assert list(found.candidates[0].settings) == list(SM.settings)


def test_adding_again_changes_nothing(tmp_path: Path) -> None:
    with new(tmp_path) as store:
        filled(store)
        before = everything(store)
        filled(store)
        assert everything(store) == before
        assert len(before.judgements) == len(before.timings) == 8


def test_what_is_fresh_is_told(tmp_path: Path) -> None:
    row, other = instance(1), instance(2)
    with new(tmp_path) as store:
        store.begin(ERRORS, DEVICE)
        store.begin(TIMES, DEVICE)
        store.add(row, [SM, SV], [judgement(asked(row, SM)), judgement(asked(row, SV, code=OLD_CODE))], [])
        failed = timing(asked(other, SV), status=Status.TIMEOUT)
        store.add(other, [SM, SV], [], [timing(asked(other, SM), 1.0, 2.0, 3.0), failed])
        assert store.judged(DEVICE.key, [CODE]) == {(row.key, SM.key)}
        assert store.judged(DEVICE.key, [CODE, OLD_CODE]) == {(row.key, SM.key), (row.key, SV.key)}
        assert store.judged("another", [CODE]) == set()
        assert store.judged(DEVICE.key, []) == set()
        assert store.timed(DEVICE.key, [CODE]) == {(other.key, SM.key): 3, (other.key, SV.key): 0}
        again = replace(TIMES, key="0" * 32)
        store.begin(again, DEVICE)
        store.add(other, [SM], [], [timing(asked(other, SM), 1.0, 2.0, run=again)])
        assert store.timed(DEVICE.key, [CODE])[other.key, SM.key] == 5


def test_rounds_of_one_run_are_put_together(tmp_path: Path) -> None:
    row = instance(1)
    about = asked(row, SM)
    with new(tmp_path) as store:
        store.begin(TIMES, DEVICE)
        store.add(row, [SM], [], [timing(about, 1.0, 2.0)])
        store.add(row, [], [], [timing(about, 9.0, 3.0, first=1)])
        (found,) = store.timings()
        dynamic = [one for one in found.samples if one.mobility is Mobility.DYNAMIC]
        assert dynamic == [sample(0, Mobility.DYNAMIC, 1.0), sample(1, Mobility.DYNAMIC, 2.0), dynamic[2]]
        assert dynamic[2] == sample(2, Mobility.DYNAMIC, 3.0)
        store.add(row, [], [], [timing(about, status=Status.CRASHED)])
        store.add(row, [], [], [timing(about, 1.0)])
        (found,) = store.timings()
        assert (found.status, found.reason) == (Status.CRASHED, "it is crashed")
        assert len(found.samples) == 6


def test_a_failed_judgement_gives_way_and_a_good_one_stays(tmp_path: Path) -> None:
    row = instance(1)
    about = asked(row, SM)
    with new(tmp_path) as store:
        store.begin(ERRORS, DEVICE)
        for given, kept in (
            (judgement(about, status=Status.TIMEOUT), judgement(about, status=Status.TIMEOUT)),
            (judgement(about, status=Status.CRASHED), judgement(about, status=Status.TIMEOUT)),
            (judgement(about, 1.0), judgement(about, 1.0)),
            (judgement(about, status=Status.CRASHED), judgement(about, 1.0)),
            (judgement(about, 2.0), judgement(about, 1.0)),
        ):
            store.add(row, [SM], [given], [])
            assert list(store.judgements()) == [kept]


def test_reading_is_narrowed(tmp_path: Path) -> None:
    with new(tmp_path) as store:
        filled(store)
        assert {one.family for one in store.instances(family="cave")} == {"cave"}
        assert [one.role for one in store.instances(role=Role.TEST)] == [Role.TEST]
        tests = {one.key for one in store.instances(role=Role.TEST)}
        assert {one.asked.instance for one in store.timings(role=Role.TEST)} == tests
        assert {one.asked.candidate for one in store.judgements(technique="shadow_map")} == {SM.key}
        (key,) = tests
        assert len(list(store.judgements(instance=key, device=DEVICE.key, codes=[CODE]))) == 2
        for nothing in (
            store.judgements(device="x"),
            store.judgements(codes=[OLD_CODE]),
            store.judgements(family="x"),
            store.judgements(run=TIMES.key),
            store.timings(run=ERRORS.key),
        ):
            assert list(nothing) == []


def test_a_row_that_names_a_stranger_is_refused_whole(tmp_path: Path) -> None:
    row = instance(1)
    with new(tmp_path) as store:
        with pytest.raises(StoreError, match="among its devices"):
            store.add(row, [SM], [judgement(asked(row, SM))], [])
        store.begin(ERRORS, DEVICE)
        with pytest.raises(StoreError, match="among its candidates"):
            store.add(row, [], [judgement(asked(row, SM))], [])
        with pytest.raises(StoreError, match="among its runs"):
            store.add(row, [SM], [judgement(asked(row, SM), run=TIMES)], [])
        assert list(store.instances()) == list(store.candidates()) == list(store.judgements()) == []


def test_features_are_kept_until_they_are_extracted_again(tmp_path: Path) -> None:
    rows = [instance(index) for index in range(3)]
    with new(tmp_path) as store:
        for row in rows:
            store.add(row, [], [], [])
        values = {row.key: {"triangles": float(index), "cone_rad": 0.1} for index, row in enumerate(rows)}
        store.add_features("first 1", values, {rows[0].key: {"polygons": 1.5}})
        assert store.features("first 1") == values
        assert store.feature_costs("first 1")[rows[0].key] == {"polygons": 1.5}
        assert store.features("second") == {}
        store.add_features("first 1", {rows[1].key: {"other": 4.0}})
        assert store.features("first 1") == {**values, rows[1].key: {"other": 4.0}}
        with pytest.raises(StoreError, match="among its instances"):
            store.add_features("first 1", {"0" * 32: {"other": 4.0}})
