from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest

from api.rebenchmark_page import PAGE_BEGINNING, page_bytes
from api.rebenchmark_watch import watched_levels
from api.rebenchmarking import (
    JSON_BEGINNING,
    LOCK,
    SAMPLE,
    Machine,
    Request,
    json_path,
    rebenchmark,
    report_record,
)
from models import fitting
from models.artifact import load
from scenes.errors import OutputError
from scenes.scene import Mobility
from selector.benchmark.running import Benchmark
from selector.evidence.rows import Purpose
from selector.evidence.store import Store
from selector.rebenchmark.locking import BusyError, beside, locked
from selector.rebenchmark.origins import level_paths
from selector.rebenchmark.report import Report, verdict
from tests.api.command import environment, gnomon, program, succeeded
from tests.api.rebenchmark_request import HOSTILE, lights, machine, request
from tests.selector.repeated_runs import fill, repeats
from tests.selector.replaying import NOW, Replay
from tests.small_level import small_level, small_scene

CALM = 6
"""A run of `repeats.npz` that was taken on a calm machine, as was the next."""


@pytest.fixture(scope="module", autouse=True)
def _few_trees() -> Iterator[None]:
    """Models of a tenth of their trees: what is tested is what becomes of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(fitting.BOOSTING, "max_iter", 8)
        patch.setitem(fitting.FOREST, "n_estimators", 6)
        yield


@pytest.fixture(scope="module")
def ready(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a store, a model that was learnt from it, and a level that is watched."""
    folder = tmp_path_factory.mktemp("ready")
    small_level(folder, "yard.glb", small_scene(lights()))
    with Store.open(str(folder / "e.sqlite")) as store:
        fill(store, [CALM])
    report = rebenchmark(request(folder), Replay(CALM), machine(), NOW)
    assert report.judged is not None
    assert report.judged.decision.promoted
    assert "no model before" in report.judged.decision.why
    return folder


@pytest.fixture
def folder(ready: Path, tmp_path: Path) -> Path:
    for path in ready.iterdir():
        if LOCK not in path.name:
            (tmp_path / path.name).write_bytes(path.read_bytes())
    return tmp_path


def values(report: Report, wanted: Request) -> dict[str, object]:
    with Store.open(wanted.store, write=False) as store:
        found: dict[str, object] = json.loads(json.dumps(report_record(report, store)))
    return found


def facts(path: Path) -> tuple[int, int]:
    with Store.open(str(path), write=False) as store:
        return len(list(store.judgements())), len(store.dated())


def test_a_calm_night_changes_nothing(folder: Path) -> None:
    wanted = request(folder)
    model, before = wanted.model.read_bytes(), facts(folder / "e.sqlite")
    listener = Replay(CALM + 1)
    report = rebenchmark(wanted, listener, machine(), NOW)
    assert not report.calls
    assert report.causes == ()
    assert report.judged is None
    assert report.sampled is not None
    assert report.sampled.compared == len(repeats().judgements)
    assert report.watched is not None
    assert report.watched.lights > 9
    assert report.watched.moves == ()
    assert wanted.model.read_bytes() == model
    assert facts(folder / "e.sqlite") == before
    assert not beside(wanted.store, SAMPLE).exists()
    # Both purposes of one sample, and nothing else.
    assert [purpose for purpose, _, _ in listener.asked] == list(Purpose)
    page = wanted.report.read_text()
    assert "Nothing has moved." in page
    assert json.loads(json_path(wanted.report).read_text()) == values(report, wanted)


def test_a_slowdown_of_15_percent_is_found_and_moves_lights(folder: Path) -> None:
    wanted = request(folder)
    old = wanted.model.read_bytes()
    slow = {"shadow_map": 1.15}
    listener = Replay(CALM + 1, slow)
    report = rebenchmark(wanted, listener, machine(), NOW)
    assert {one.technique for one in report.drifted} == {"shadow_map"}
    assert report.calls
    assert report.causes == ("times have drifted",)
    assert report.left == 0
    # All instances are in the sample, so nothing is left to be measured again.
    assert [purpose for purpose, _, _ in listener.asked] == list(Purpose)
    assert report.judged is not None
    assert report.judged.contest is not None
    assert not report.judged.as_is
    # With 24 instances the models may go either way; the lights are named in both cases.
    decision = report.judged.decision
    kept = [decision.kept.read_bytes()] if decision.kept else []
    assert kept == ([old] if decision.promoted else [])
    assert (wanted.model.read_bytes() != old) == decision.promoted
    assert report.watched is not None
    assert report.watched.in_force == decision.promoted
    moves = report.watched.moves
    assert moves, "lights change their answer"
    page = wanted.report.read_text()
    record = json.loads(json_path(wanted.report).read_text())
    assert [move["light"] for move in record["watched"]["moves"]] == [one.light for one in moves]
    assert all(move["from"]["label"] != move["to"]["label"] for move in record["watched"]["moves"])
    for one in moves:
        assert one.light.split(" <")[0] in page
        assert one.why
    # The next night nothing is new: the slow times are the evidence now.
    again = Replay(CALM + 1, slow)
    calm = rebenchmark(wanted, again, machine(), NOW + timedelta(days=1))
    assert not calm.calls
    assert calm.causes == ()
    assert calm.judged is None


def test_names_from_levels_stay_text(folder: Path) -> None:
    wanted = request(folder)
    record = json.loads(json_path(wanted.report).read_text())
    level = f"{HOSTILE}.glb"
    record["watched"]["problems"] = [{"level": level, "reason": HOSTILE}]
    record["unreachable"] = {HOSTILE: 1}
    page = page_bytes(record).decode()
    assert page.encode().startswith(PAGE_BEGINNING)
    assert "<script" not in page
    assert re.search(r'(src|href)="?http', page) is None


def test_a_sample_that_is_held_against_nothing_is_no_calm_night(folder: Path) -> None:
    class Elsewhere(Replay):
        """What is measured is of other instances, so nothing can be compared."""

        def runs(self, benchmark: Benchmark, words: str) -> None:
            pass

    wanted = request(folder, learn=False)
    report = rebenchmark(wanted, Elsewhere(CALM + 1), machine(), NOW)
    assert report.blind
    assert report.calls
    assert verdict(report) == "Nothing could be compared with before."
    page = wanted.report.read_text()
    assert "could be held against evidence of before" in page
    assert "there was no model before" in page
    assert "no answer has moved" not in page


def test_copies_of_a_level_are_watched_once(folder: Path) -> None:
    (folder / "copies").mkdir()
    for name in ("yard.glb", "yard.annotated.glb"):
        (folder / "copies" / name).write_bytes((folder / "yard.glb").read_bytes())
    levels, problems = watched_levels([folder / "yard.glb", folder / "copies"])
    assert [one.path for one in levels] == [folder / "yard.glb"]
    assert problems == []


def test_without_a_model_none_is_said_to_stay(folder: Path) -> None:
    wanted = request(folder)
    record = json.loads(json_path(wanted.report).read_text())
    record["model"] = {**record["model"], "promoted": False, "champion": False, "why": "Run `gnomon <b>`."}
    page = page_bytes(record).decode()
    assert "There is no model yet" in page
    assert "The old model stays" not in page
    assert "<code>gnomon &lt;b&gt;</code>" in page


def test_errors_that_differ_though_the_code_is_the_same_are_an_alarm(folder: Path) -> None:
    report = rebenchmark(request(folder), Replay(CALM + 1, changed=0.25), machine(), NOW)
    assert report.calls
    assert report.drifted == ()
    assert report.differs
    assert "edge_error_px" in request(folder).report.read_text()


def test_changed_code_is_measured_again_and_nothing_else(folder: Path) -> None:
    changed = {"shadow_volume": "f" * 32}
    listener = Replay(CALM + 1, codes=changed)
    report = rebenchmark(request(folder, sample=10, learn=False), listener, machine(**changed), NOW)
    assert report.stale["shadow_volume"] == {"code": len(repeats().instances)}
    assert report.stale["shadow_map"] == {"fresh": len(repeats().instances)}
    assert report.causes == ("the code of a technique has changed",)
    sampled, rest = listener.asked[:2], listener.asked[2:]
    assert all(count == 10 for _, count, _ in sampled)
    left = len(repeats().instances) - 10
    assert rest == [(purpose, left, ("shadow_volume",)) for purpose in Purpose]
    assert report.left == 0


def test_what_the_time_limit_leaves_is_done_by_the_next_job(folder: Path) -> None:
    class Late(Replay):
        """Its job has no time left after the sample."""

        def runs(self, benchmark: Benchmark, words: str) -> None:
            if words.startswith("Sample"):
                super().runs(benchmark, words)

    slow = {"chan_hybrid": 1.3}
    wanted = request(folder, sample=12, learn=False, seed=1)
    first = rebenchmark(wanted, Late(CALM + 1, slow), machine(), NOW)
    assert {one.technique for one in first.drifted} == {"chan_hybrid"}
    assert first.left == len(repeats().instances) - 12
    listener = Replay(CALM + 1, slow)
    second = rebenchmark(wanted, listener, machine(), NOW + timedelta(hours=24))
    assert second.causes == ("times that had drifted were left to be measured again",)
    assert second.stale["chan_hybrid"]["drift"] == first.left
    assert listener.asked[-1] == (Purpose.TIMES, first.left, ("chan_hybrid",))
    assert second.left == 0


def test_old_times_are_stale_and_give_way(folder: Path) -> None:
    wanted = request(folder, max_age=timedelta(days=10), learn=False)
    report = rebenchmark(wanted, Replay(CALM + 1), machine(), NOW)
    assert report.causes == ("times are older than they may be",)
    assert report.left == 0
    device = repeats().device.key
    with Store.open(wanted.store, write=False) as store:
        table = store.table(device)
        before = store.table(device, before=NOW.isoformat())
    most = int(before.times[Mobility.DYNAMIC].rounds.max())
    assert table.times[Mobility.DYNAMIC].rounds.max() <= most, "old rounds and new ones do not add up"


def test_another_driver_is_compared_with_the_one_before(folder: Path) -> None:
    device = replace(repeats().device, gl_version="4.6 of tomorrow")
    on = Machine(machine().bench, device)

    report = rebenchmark(request(folder, learn=False), Replay(CALM + 1, device=device), on, NOW)
    assert report.former == repeats().device
    assert report.causes == ("the driver or the device has changed",)
    assert all(set(counts) == {"device"} for counts in report.stale.values())
    # What was compared were times of another driver: errors may differ there.
    assert report.sampled is not None
    assert report.sampled.measured > 0


def test_a_model_that_cannot_be_read_is_replaced_and_kept(folder: Path) -> None:
    wanted = request(folder)
    wanted.model.write_bytes(b"no model")
    report = rebenchmark(wanted, Replay(CALM + 1), machine(), NOW)
    assert report.judged is not None
    assert "cannot be used" in report.judged.decision.why
    assert report.judged.decision.kept is not None
    assert report.judged.decision.kept.read_bytes() == b"no model"
    assert load(wanted.model).card["training"]["instances"] == len(repeats().instances)


def test_a_job_that_is_stopped_leaves_all_whole_and_the_next_goes_on(folder: Path) -> None:
    class Stopped(Replay):
        def begins(self, words: str) -> None:
            super().begins(words)
            if words.startswith("Gathering"):
                raise KeyboardInterrupt

    wanted = request(folder)
    model = wanted.model.read_bytes()
    slow = {"shadow_map": 1.15}
    with pytest.raises(KeyboardInterrupt):
        rebenchmark(wanted, Stopped(CALM + 1, slow), machine(), NOW)
    # Drift is in the report already, and the model is the old one.
    record = json.loads(json_path(wanted.report).read_text())
    assert (record["finished"], record["alarm"]) == (False, True)
    assert wanted.report.read_bytes().startswith(PAGE_BEGINNING)
    assert wanted.model.read_bytes() == model
    # The evidence has changed since the model was learnt, which the next job finds out by itself.
    report = rebenchmark(wanted, Replay(CALM + 1, slow), machine(), NOW + timedelta(days=1))
    assert report.causes == ()
    assert report.judged is not None
    assert report.judged.contest is not None
    assert not report.judged.as_is


def test_a_begun_sample_is_gone_on_with(folder: Path) -> None:
    class Stopped(Replay):
        def runs(self, benchmark: Benchmark, words: str) -> None:
            if benchmark.order.job.purpose is Purpose.TIMES:
                raise KeyboardInterrupt
            super().runs(benchmark, words)

    wanted = request(folder, sample=10)
    before = facts(folder / "e.sqlite")
    with pytest.raises(KeyboardInterrupt):
        rebenchmark(wanted, Stopped(CALM + 1), machine(), NOW)
    assert beside(wanted.store, SAMPLE).exists()
    assert facts(folder / "e.sqlite") == before
    today, tomorrow = NOW + timedelta(hours=3), NOW + timedelta(days=1)
    report = rebenchmark(wanted, Replay(CALM + 1), machine(), today)
    assert report.sampled is not None
    assert report.sampled.seed == 20300220
    assert rebenchmark(wanted, Replay(CALM + 1), machine(), tomorrow).sampled.seed == 20300221  # type: ignore[union-attr]


def test_two_jobs_are_kept_apart(folder: Path) -> None:
    wanted = request(folder)
    mine = f"process {os.getpid()}, since 20"
    with locked(beside(wanted.store, LOCK)), pytest.raises(BusyError, match=mine):
        rebenchmark(wanted, Replay(CALM), machine(), NOW)
    # The command says so, with its own exit code.
    with locked(beside(wanted.store, LOCK)):
        result = gnomon("rebenchmark", "--store", wanted.store, "-o", folder / "other.html")
    assert result.exit_code == BusyError.exit_code
    assert "Another re-benchmark job is running" in result.stderr
    assert str(beside("postgresql://host/evidence", LOCK)).endswith(LOCK)


def test_files_of_others_are_not_overwritten(folder: Path) -> None:
    page = folder / "page.html"
    page.write_text("mine")
    result = gnomon("rebenchmark", "--store", folder / "e.sqlite", "-o", page)
    assert (result.exit_code, page.read_text()) == (5, "mine")
    page.unlink()
    (folder / "page.json").write_text('{"mine": 1}')
    result = gnomon("rebenchmark", "--store", folder / "e.sqlite", "-o", page)
    assert result.exit_code == 5
    assert "page.json" in result.stderr
    assert json_path(request(folder).report).read_bytes().startswith(JSON_BEGINNING)
    model = folder / "notes.txt"
    model.write_text("hi")
    result = gnomon("rebenchmark", "--store", folder / "e.sqlite", "--model", model)
    assert (result.exit_code, model.read_text()) == (5, "hi")
    assert "which is no model" in result.stderr
    sample = beside(str(folder / "e.sqlite"), SAMPLE)
    for make in (sample.mkdir, lambda: sample.write_text("mine")):
        make()
        with pytest.raises(OutputError, match=r"keeps its sample|folder"):
            rebenchmark(request(folder), Replay(CALM), machine(), NOW)
        assert sample.exists()
        sample.rmdir() if sample.is_dir() else sample.unlink()


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("--model", "night.html", "-o", "night.html"), 5, "would be the same file"),
        (("--model", "night.json", "-o", "night.html"), 5, "would be the same file"),
        (("--store", "night.html", "-o", "night.html"), 5, "would be the same file"),
        (("--levels", "nowhere"), 3, "There is no such file or folder"),
        (("--store", ""), 7, "names no file"),
        (("--store", ":memory:"), 7, "names no file"),
        (("--store", "sqlite://"), 7, "names no file"),
    ],
)
def test_what_would_waste_a_night_is_refused_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], code: int, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    result = gnomon("rebenchmark", *options)
    assert result.exit_code == code, result.stderr
    assert words in " ".join(result.stderr.split())
    assert list(tmp_path.iterdir()) == []


def test_a_refused_store_leaves_no_lock(tmp_path: Path) -> None:
    store = tmp_path / "e.sqlite"
    store.write_text("not a database, though long enough to be asked whether it is one" * 20)
    result = gnomon("rebenchmark", "--store", store, "-o", tmp_path / "night.html")
    assert result.exit_code == 7
    assert list(tmp_path.iterdir()) == [store]


def test_levels_that_go_away_are_left_out(tmp_path: Path) -> None:
    small_level(tmp_path, "yard.glb")
    (tmp_path / "gone.glb").symlink_to(tmp_path / "nothing.glb")
    (tmp_path / "folder.glb").mkdir()
    assert level_paths([tmp_path]) == [tmp_path / "yard.glb"]


@pytest.mark.parametrize("text", ["1", "0h", "soon", "-3h", "3 weeks"])
def test_times_are_checked(text: str) -> None:
    assert gnomon("rebenchmark", "--every", text).exit_code == 2


def test_a_first_job_measures_a_baseline_and_the_second_compares(tmp_path: Path) -> None:
    level = small_level(tmp_path)
    options = [
        *("rebenchmark", "--store", tmp_path / "e.sqlite", "--corpus", level, "--levels", level),
        *("--resolution", "96x64", "-t", "SV", "--rounds", 3, "--workers", 1, "-o", tmp_path / "night.html"),
        *("--model", tmp_path / "m.model"),
    ]
    first = succeeded(*options)
    assert "a baseline was measured" in first.stdout
    assert "too little evidence" in first.stdout
    second = succeeded(*options)
    assert "Nothing has moved" in second.stdout
    assert not (tmp_path / "m.model").exists()


def test_sigterm_ends_the_waiting_well(tmp_path: Path) -> None:
    level = small_level(tmp_path)
    command = program(
        *("rebenchmark", "--store", tmp_path / "e.sqlite", "--corpus", level, "--every", "24h"),
        *("--resolution", "32x32", "-t", "SV", "--rounds", 1, "-o", tmp_path / "night.html", "--no-train"),
    )
    with subprocess.Popen(command, env=environment(), stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        said = []
        for line in process.stderr:
            said.append(line)
            if "The next job begins" in line:
                break
        time.sleep(0.2)
        process.send_signal(signal.SIGTERM)
        said.append(process.stderr.read())
        assert process.wait(60) == 0, said
    assert "no job was running" in said[-1]
