"""What is of no more use goes, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from selector.evidence.pruning import Pruned, Useless
from selector.evidence.store import Store
from tests.selector.evidence_rows import (
    CARD,
    CODE,
    DEVICE,
    ERRORS,
    OLD_CODE,
    SM,
    SV,
    TIMES,
    asked,
    everything,
    instance,
    judgement,
    timing,
)

FRESH, STALE = instance(1), instance(2)
LATER = replace(TIMES, key="1" * 32, started="2031-06-01T00:00:00Z")
CURRENT = {"shadow_map": CODE, "shadow_volume": OLD_CODE}


@pytest.fixture
def store(tmp_path: Path) -> Store:
    """One instance with fresh and stale facts, one with stale ones only, one that was never measured."""
    made = Store.open(str(tmp_path / "evidence.sqlite"))
    for run, device in ((ERRORS, DEVICE), (TIMES, DEVICE), (LATER, CARD)):
        made.begin(run, device)
    fresh, stale = asked(FRESH, SM), asked(FRESH, SV)
    made.add(
        FRESH, [SM, SV], [judgement(fresh), judgement(stale)], [timing(fresh, 1.0, 2.0), timing(stale, 3.0)]
    )
    made.add(
        STALE,
        [],
        [judgement(asked(STALE, SM, code=OLD_CODE))],
        [timing(asked(STALE, SM, CARD, OLD_CODE), 5.0, run=LATER)],
    )
    made.add(instance(3), [], [], [])
    made.add_features("first", {FRESH.key: {"a": 1.0}, STALE.key: {"a": 2.0}})
    return made


def test_what_another_version_of_the_code_said_goes(store: Store) -> None:
    pruned = Pruned(judgements=2, timings=2, samples=4, instances=1, runs=1, devices=1)
    before = everything(store)
    assert store.prune(Useless(current=CURRENT), dry_run=True) == pruned
    assert everything(store) == before
    assert store.prune(Useless(current=CURRENT)) == pruned
    after = everything(store)
    assert (
        [one.asked for one in after.judgements] == [one.asked for one in after.timings] == [asked(FRESH, SM)]
    )
    assert after.instances == (FRESH, instance(3))
    assert (after.runs, after.devices, after.candidates) == ((ERRORS, TIMES), (DEVICE,), (SM,))
    assert store.features("first") == {FRESH.key: {"a": 1.0}}
    assert store.prune(Useless(current=CURRENT)) == Pruned(0, 0, 0, 0, 0, 0)


def test_a_technique_that_is_no_more_is_stale(store: Store) -> None:
    assert store.prune(Useless(current={})).judgements == 3
    assert everything(store).timings == ()


def test_what_was_measured_before_a_day_goes(store: Store) -> None:
    assert store.prune(Useless(before=ERRORS.started)) == Pruned(0, 0, 0, 0, 0, 0)
    assert store.prune(Useless(before="2031-01-01")) == Pruned(3, 2, 6, 1, 2, 1)
    assert [one.run for one in store.timings()] == [LATER.key]


def test_what_one_device_measured_goes(store: Store) -> None:
    assert store.prune(Useless(device=CARD.key)) == Pruned(0, 1, 2, 0, 1, 1)
    assert list(store.devices()) == [DEVICE]


def test_all_that_is_said_must_hold(store: Store) -> None:
    assert store.prune(Useless(current=CURRENT, device=DEVICE.key, before="2031"), dry_run=True).timings == 1
    assert store.prune(Useless(current=CURRENT, device="nobody")) == Pruned(0, 0, 0, 0, 0, 0)


def test_a_pruned_file_is_smaller(store: Store, tmp_path: Path) -> None:
    many = timing(asked(STALE, SV), *map(float, range(5000)))
    store.add(STALE, [], [], [many])
    before = (tmp_path / "evidence.sqlite").stat().st_size + (tmp_path / "evidence.sqlite-wal").stat().st_size
    store.prune(Useless(current=CURRENT))
    store.close()
    assert (tmp_path / "evidence.sqlite").stat().st_size < before / 3
