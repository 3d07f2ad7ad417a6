from __future__ import annotations

from collections import Counter
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from models.contesting import Contest
from models.examples import Question
from scenes.scene import Mobility
from selector.evidence.dating import Dated
from selector.evidence.rows import Purpose, RunRow
from selector.evidence.store import Store
from selector.evidence.superseding import latest, remark
from selector.measurement import Status
from selector.rebenchmark.drift import FEWEST
from selector.rebenchmark.promotion import decide, put_in_force
from selector.rebenchmark.sampling import sample
from selector.rebenchmark.staleness import Reason, freshness, predecessor
from tests.selector.evidence_rows import CARD, DEVICE, ERRORS, SM, TIMES, asked, instance, judgement, timing

CODES = {"shadow_map": "new", "shadow_volume": "same"}
QUESTIONS = (Question("speed", "dynamic", 4.0), Question("quality", "static", 0.5))

families = st.dictionaries(st.integers(0, 400).map(str), st.sampled_from("abcdef"), min_size=1, max_size=60)


@given(families, st.integers(1, 40), st.integers(0, 9))
@settings(max_examples=60, deadline=None)
def test_families_take_turns_and_every_technique_has_enough(
    known: dict[str, str], size: int, seed: int
) -> None:
    techniques = {key: ["common", *(["rare"] if int(key) % 7 == 0 else [])] for key in known}
    found = sample(techniques, known, size, seed)
    assert found == sample(techniques, known, size, seed)
    assert len(set(found)) == len(found)
    assert len(found) >= min(size, len(known))
    counts = Counter(known[key] for key in found[:size])
    total = Counter(known.values())
    unfinished = [name for name in total if counts[name] < total[name]]
    # Whoever has more to give has given as much as anybody, give or take one.
    assert all(counts[name] >= max(counts.values()) - 1 for name in unfinished)
    if size >= FEWEST:
        of_all = Counter(name for names in techniques.values() for name in names)
        of_some = Counter(name for key in found for name in techniques[key])
        assert all(of_some[name] >= min(FEWEST, of_all[name]) for name in of_all)


def test_another_seed_is_another_sample() -> None:
    known = {str(number): "abc"[number % 3] for number in range(60)}
    techniques = {key: ["one"] for key in known}
    assert sample(techniques, known, 12, 1) != sample(techniques, known, 12, 2)


def dated(
    one: str, technique: str = "shadow_map", code: str = "new", device: str = "here", started: str = "2030-02"
) -> Dated:
    return Dated(one, f"of {technique}", technique, device, code, started, Status.OK)


def test_reasons_for_being_stale() -> None:
    known = [
        dated("fresh"),
        dated("old", started="2029-01"),
        dated("changed", code="old"),
        dated("elsewhere", device="before"),
        dated("elsewhere", device="another machine"),
        dated("drifted", "shadow_volume", code="same", started="2030-01"),
        dated("again", "shadow_volume", code="same", started="2030-01"),
        dated("again", "shadow_volume", code="same", started="2030-03"),
        dated("renewed", code="old", started="2030-01"),
        dated("renewed", started="2030-01"),
        dated("forgotten", "retired_technique"),
    ]
    marks = {("here", "shadow_volume"): "2030-02"}
    found = freshness(known, "here", "before", CODES, marks, oldest_allowed="2030-01")
    assert found.stale == {
        ("old", "shadow_map"): Reason.AGE,
        ("changed", "shadow_map"): Reason.CODE,
        ("elsewhere", "shadow_map"): Reason.DEVICE,
        ("drifted", "shadow_volume"): Reason.DRIFT,
    }
    assert {instance for instance, _ in found.fresh} == {"fresh", "again", "renewed"}
    assert found.counts()["shadow_volume"] == {"drift": 1, "fresh": 1}


def test_the_driver_of_before_is_known_by_the_hardware() -> None:
    now = replace(DEVICE, renderer="softpipe 1 (LLVM 20)", gl_version="5.0")
    other = replace(DEVICE, threads=7)
    known = [DEVICE, CARD, other, now]
    rows = [dated("one", device=one.key) for one in known]
    assert predecessor(now, known, rows) == DEVICE
    assert predecessor(other, known, rows) is None
    assert predecessor(now, known, []) is None


def test_times_that_no_longer_hold_give_way_once_there_are_others(tmp_path: Path) -> None:
    one, two = instance(1), instance(2)
    again = RunRow(
        "9" * 32,
        "2030-02-01T00:00:00Z",
        "abc",
        Purpose.TIMES,
        1,
        (remark("shadow_map", "2030-01-31T00:00:00Z"),),
    )
    with Store.open(str(tmp_path / "e.sqlite")) as store:
        for run in (ERRORS, TIMES, again):
            store.begin(run, DEVICE)
        for about in (one, two):
            rows = [timing(asked(about, SM), 1.0, 1.0, 1.0)]
            store.add(about, [SM], [judgement(asked(about, SM))], rows)
        store.add(one, [SM], [], [timing(asked(one, SM), 2.0, run=again)])
        table = store.table(DEVICE.key)
        then = store.table(DEVICE.key, before=again.started)
        assert store.marks() == {(DEVICE.key, "shadow_map"): "2030-01-31T00:00:00Z"}
        assert [row.started for row in store.dated()] == [TIMES.started, TIMES.started, again.started]
    rounds = table.times[Mobility.DYNAMIC].rounds[:, 0]
    assert rounds.tolist() == [1, 3]
    assert table.shadow_ms(Mobility.DYNAMIC)[:, 0].tolist() == [2.0, 1.0]
    assert then.times[Mobility.DYNAMIC].rounds[:, 0].tolist() == [3, 3]


def test_the_latest_mark_counts() -> None:
    marks = latest([("d", (remark("sm", "2030-01"), "busy")), ("d", (remark("sm", "2030-03"),)), ("e", ())])
    assert marks == {("d", "sm"): "2030-03"}


def contest(change: list[list[float]]) -> Contest:
    """Two questions, eight families of one instance."""
    champion = np.full((2, 8), 2.0)
    return Contest(
        QUESTIONS, np.array(list("abcdefgh")), champion, champion + np.array(change), np.ones((2, 8))
    )


def test_a_model_is_promoted_unless_it_is_worse() -> None:
    same, better, worse = [0.0] * 8, [-0.5] * 8, [0.1] * 8
    assert decide(contest([same, same])).promoted
    assert decide(contest([better, same])).promoted
    assert not decide(contest([worse, same])).promoted
    # Better on the whole, and surely worse for one question.
    refused = decide(contest([better, worse]))
    assert not refused.promoted
    assert "quality" in refused.why
    # Worse for one family of eight is not surely worse.
    assert decide(contest([better, [0.4, *same[1:]]])).promoted


def test_the_old_model_is_kept(tmp_path: Path) -> None:
    target, now = tmp_path / "town.model", datetime(2030, 1, 31, 2, 3, 4, tzinfo=UTC)
    assert put_in_force(target, b"first", now) is None
    kept = put_in_force(target, b"second", now)
    assert kept == tmp_path / "town.previous-2030-01-31T020304Z.model"
    assert (kept.read_bytes(), target.read_bytes()) == (b"first", b"second")
