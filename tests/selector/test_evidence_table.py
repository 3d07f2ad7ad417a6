"""The training join says what the raw rows say."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np
import pytest

from scenes.scene import Mobility
from selector.evidence.rows import Role
from selector.evidence.store import Store
from selector.evidence.table import STATUSES, UNKNOWN
from selector.measurement import Status
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
    filled,
    instance,
    judgement,
    timing,
)


@pytest.fixture
def store(tmp_path: Path) -> Store:
    made = Store.open(str(tmp_path / "evidence.sqlite"))
    made.begin(ERRORS, DEVICE)
    made.begin(TIMES, DEVICE)
    return made


def test_rows_and_columns_are_what_was_measured(store: Store) -> None:
    filled(store, 6)
    store.add(instance(9), [], [], [])
    table = store.table(DEVICE.key)
    rows = tuple(one for one in store.instances() if one != instance(9))
    assert table.instances == rows
    assert table.candidates == (SM, SV)
    assert table.ok.all()
    by_key = {(one.asked.instance, one.asked.candidate): one for one in store.judgements()}
    for i, row in enumerate(rows):
        for j, candidate in enumerate(table.candidates):
            figures = by_key[row.key, candidate.key].figures
            edge = figures["edge_error_px"]
            np.testing.assert_equal(table.edge_error_px[i, j], np.nan if edge is None else edge)
            assert table.exceedance_px[i, j] == (0.01 * 6400 / 64 if edge is None else edge)
    assert set(table.counters) == {"map_texels", "triangles"}
    assert (table.counters["map_texels"] == 2**40).all()
    assert (table.memory_bytes == 4 << 20).all()
    assert (table.wrong_share == 0.01).all()
    assert np.isnan(table.figures["flip"]).all()


def test_times_are_medians_with_the_drift_divided_out(store: Store) -> None:
    row = instance(1)
    samples = (3.0, 8.0, 2.0, 5.0), (1.0, 4.0, 2.0, 2.0)
    store.add(row, [SM], [], [timing(asked(row, SM), *samples[0], canaries=samples[1])])
    table = store.table(DEVICE.key)
    assert table.canary_ms == 2.0
    steady = [2.0 * ms / canary for ms, canary in zip(*samples, strict=True)]
    assert table.shadow_ms(Mobility.DYNAMIC)[0, 0] == median(steady)
    assert table.shadow_ms(Mobility.STATIC)[0, 0] == median(steady) / 2
    times = table.times[Mobility.DYNAMIC]
    assert (times.low_ms[0, 0], times.high_ms[0, 0], times.rounds[0, 0]) == (min(steady), max(steady), 4)


def test_the_interval_of_many_rounds_is_between_order_statistics(store: Store) -> None:
    row = instance(1)
    store.add(row, [SM], [], [timing(asked(row, SM), *map(float, range(1, 21)))])
    times = store.table(DEVICE.key).times[Mobility.DYNAMIC]
    # The 6th and the 15th of twenty: David and Nagaraja, Order Statistics, section 7.1.
    assert (times.low_ms[0, 0], times.median_ms[0, 0], times.high_ms[0, 0]) == (6.0, 10.5, 15.0)


def test_runs_of_the_same_code_count_together_and_newer_code_alone(store: Store) -> None:
    row = instance(1)
    later = replace(TIMES, key="1" * 32, started="2031-01-01T00:00:00Z")
    store.begin(later, DEVICE)
    old, new = asked(row, SM, code=OLD_CODE), asked(row, SM)
    store.add(row, [SM], [], [timing(old, 50.0, 50.0, 50.0), timing(new, 1.0, run=later)])
    assert store.table(DEVICE.key).shadow_ms(Mobility.DYNAMIC)[0, 0] == 1.0
    assert store.table(DEVICE.key, codes=[OLD_CODE]).shadow_ms(Mobility.DYNAMIC)[0, 0] == 50.0
    store.add(row, [], [], [timing(new, 3.0, 5.0)])
    times = store.table(DEVICE.key).times[Mobility.DYNAMIC]
    assert (times.median_ms[0, 0], times.rounds[0, 0]) == (3.0, 3)
    store.add(row, [], [judgement(old, 9.0), judgement(new, 2.0, run=later)], [])
    assert store.table(DEVICE.key).edge_error_px[0, 0] == 2.0
    assert store.table(DEVICE.key, codes=[OLD_CODE]).edge_error_px[0, 0] == 9.0
    assert store.table(DEVICE.key, codes=["other"]).status.shape == (0, 0)


def test_a_virtual_device_borrows_what_does_not_depend_on_devices(store: Store) -> None:
    row, other = instance(1), instance(2)
    store.begin(TIMES, CARD)
    judged = [judgement(asked(row, SM), 0.25), judgement(asked(row, SV), status=Status.CRASHED)]
    timed = [timing(asked(row, candidate, CARD), 4.0, canaries=(1.0,)) for candidate in (SM, SV)]
    store.add(row, [SM, SV], judged, timed)
    store.add(other, [SM], [judgement(asked(other, SM))], [])
    table = store.table(CARD.key)
    assert table.instances == (row,)
    assert table.edge_error_px[0, 0] == 0.25
    assert np.isnan(table.edge_error_px[0, 1])
    assert (table.shadow_ms(Mobility.DYNAMIC) == 4.0).all()
    assert table.ok.all()
    store.add(row, [], [judgement(asked(row, SM, CARD), 0.5)], [])
    assert store.table(CARD.key).edge_error_px[0, 0] == 0.5
    assert store.table(DEVICE.key).edge_error_px[table.instances.index(row), 0] == 0.25


def test_status_is_the_first_failure_that_is_known_of(store: Store) -> None:
    rows = [instance(index, f"family {index}") for index in range(5)]
    outcomes = [
        (Status.OK, Status.OK, Status.OK),
        (Status.OK, Status.TIMEOUT, Status.TIMEOUT),
        (Status.REFUSED, Status.OK, Status.REFUSED),
        (None, Status.CRASHED, Status.CRASHED),
        (Status.GL_ERROR, None, Status.GL_ERROR),
    ]
    for row, (judged, timed, _) in zip(rows, outcomes, strict=True):
        about = asked(row, SM)
        store.add(
            row,
            [SM],
            [judgement(about, status=judged)] if judged else [],
            [timing(about, status=timed)] if timed else [],
        )
    store.add(rows[0], [SV], [judgement(asked(rows[0], SV))], [])
    table = store.table(DEVICE.key)
    assert [STATUSES[number] for number in table.status[:, 0]] == [outcome for *_, outcome in outcomes]
    assert table.status[:, 1].tolist() == [STATUSES.index(Status.OK), *[UNKNOWN] * 4]
    assert np.isnan(table.shadow_ms(Mobility.DYNAMIC)).all()


def test_the_table_is_narrowed_by_role_and_family(store: Store) -> None:
    filled(store, 8)
    assert {one.role for one in store.table(DEVICE.key, role=Role.TEST).instances} == {Role.TEST}
    caves = store.table(DEVICE.key, family="cave", codes=[CODE], technique="shadow_volume")
    assert {one.family for one in caves.instances} == {"cave"}
    assert caves.candidates == (SV,)
    assert store.table("nobody").status.shape == (0, 0)
