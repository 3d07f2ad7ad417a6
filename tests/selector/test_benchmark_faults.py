from __future__ import annotations

import random
import resource
import signal
import sqlite3
import subprocess
import time
from pathlib import Path

import psutil
import pytest

from selector.evidence.rows import Purpose
from selector.evidence.store import Store, StoreError
from selector.measurement import Status
from tests.api.command import ROOT, environment, program
from tests.selector.benchmarks import (
    SILENCE_S,
    Benchmark,
    facts,
    faulty_order,
    judgements,
    order,
    ran,
    timings,
)
from tests.small_level import small_level

KILLS = 20
ENOUGH_BYTES = 1 << 30


def by_technique(path: Path) -> dict[str, tuple[Status, str]]:
    return {name.split()[0]: (row.status, row.reason) for (_, name), row in judgements(path).items()}


def test_who_aborts_is_blamed_and_the_others_are_judged(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    benchmark = ran(path, faulty_order(Purpose.ERRORS, "abort"))
    found = by_technique(path)
    assert found["abort"] == (Status.CRASHED, "its process was ended by SIGABRT")
    assert found["shadow_map"][0] is found["shadow_volume"][0] is Status.OK
    assert (benchmark.score.done, benchmark.score.lost) == (1, 1)
    assert not benchmark.score.failed


def test_who_hangs_is_given_up_and_not_timed_later(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    ran(path, faulty_order(Purpose.ERRORS, "hang", silence_s=SILENCE_S))
    found = by_technique(path)
    assert found["hang"] == (Status.TIMEOUT, f"no answer within {SILENCE_S:g} s")
    assert found["shadow_map"][0] is found["shadow_volume"][0] is Status.OK
    benchmark = ran(path, faulty_order(Purpose.TIMES, "hang", silence_s=SILENCE_S))
    assert benchmark.score.lost == 0, "what hung once is not tried again"
    assert sorted(row.status for row in timings(path)) == [Status.OK, Status.OK, Status.TIMEOUT]


def test_who_takes_all_memory_is_given_up(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    ran(path, faulty_order(Purpose.ERRORS, "hog", memory_bytes=ENOUGH_BYTES))
    status, reason = by_technique(path)["hog"]
    assert status is Status.OUT_OF_MEMORY
    assert "1.0 GiB allowed" in reason
    assert by_technique(path)["shadow_volume"][0] is Status.OK


@pytest.mark.slow
def test_who_is_killed_by_others_has_a_second_chance(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    benchmark = ran(path, faulty_order(Purpose.ERRORS, "be_killed"))
    status, reason = by_technique(path)["be_killed"]
    assert status is Status.OUT_OF_MEMORY
    assert "twice" in reason
    assert benchmark.score.lost == 2


@pytest.mark.slow
def test_faults_while_times_are_taken_leave_the_others_their_times(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    ran(path, faulty_order(Purpose.TIMES, "abort", "hang", silence_s=SILENCE_S))
    rows = timings(path)
    assert sorted(row.status for row in rows) == [Status.CRASHED, Status.OK, Status.OK, Status.TIMEOUT]
    assert all(bool(row.samples) == (row.status is Status.OK) for row in rows)


def test_a_store_that_takes_no_more_stops_the_run_and_its_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "evidence.sqlite"
    take = Store.add
    taken = []

    def full(self: Store, *rows: object) -> None:
        if len(taken) == 2:
            raise StoreError("The disk is full, and this evidence store can take no more.")
        take(self, *rows)  # type: ignore[arg-type]
        taken.append(rows)

    monkeypatch.setattr(Store, "add", full)
    # Readers that other tests have started in this process stay.
    before = set(psutil.Process().children(recursive=True))
    with Store.open(str(path)) as store:
        benchmark = Benchmark(store, order(Purpose.ERRORS))
        events = benchmark.run()
        next(events)
        workers = set(psutil.Process().children(recursive=True)) - before
        with pytest.raises(StoreError, match="full"):
            list(events)
    assert len(judgements(path)) == 2
    assert not [one for one in workers if one.is_running() and "spawn_main" in " ".join(one.cmdline())]
    monkeypatch.undo()
    ran(path, order(Purpose.ERRORS))
    assert facts(path) == facts_of_a_quiet_run(tmp_path)


def facts_of_a_quiet_run(folder: Path) -> dict[tuple[str, str], object]:
    path = folder / "quiet.sqlite"
    ran(path, order(Purpose.ERRORS))
    return facts(path)


def arguments(level: Path, store: Path) -> list[str]:
    shared = ["-t", "SM", "--resolution", "64x48", "--purpose", "errors", "--workers", "2"]
    return program("benchmark", "--corpus", level, "--store", store, *shared)


def kill_at(level: Path, store: Path, delay_s: float) -> None:
    """Starts the program, kills it at some moment, and sees its workers die with it."""
    running = subprocess.Popen(
        arguments(level, store),
        cwd=ROOT,
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    time.sleep(delay_s)
    try:
        workers = psutil.Process(running.pid).children(recursive=True)
    except psutil.NoSuchProcess:
        workers = []
    running.kill()
    running.wait()
    _, alive = psutil.wait_procs(workers, timeout=10)
    assert not alive, "workers die with the program"


def sound(store: Path) -> bool:
    with sqlite3.connect(store) as connection:
        return bool(connection.execute("PRAGMA integrity_check").fetchone()[0] == "ok")


def stored(store: Path) -> dict[tuple[str, str, str], object]:
    if not store.exists():
        return {}
    try:
        with Store.open(str(store), write=False) as opened:
            rows = list(opened.judgements())
    except StoreError:
        # Killed before the first table was there.
        return {}
    found = {
        (one.asked.instance, one.asked.candidate, one.asked.code): (one.status, one.figures, one.counters)
        for one in rows
    }
    assert len(found) == len(rows), "nothing is doubled"
    return found


def killed_and_resumed(folder: Path, kills: int) -> None:
    level, store = small_level(folder), folder / "evidence.sqlite"
    moments = random.Random(5)  # noqa: S311  shuffling needs no secrecy
    before: dict[tuple[str, str, str], object] = {}
    for _ in range(kills):
        kill_at(level, store, moments.uniform(0.5, 12.0))
        after = stored(store)
        assert before.items() <= after.items(), "what is stored stays"
        assert not store.exists() or sound(store)
        before = after
    quiet = folder / "quiet.sqlite"
    for path in (store, quiet):
        subprocess.run(arguments(level, path), cwd=ROOT, env=environment(), check=True, capture_output=True)
    assert stored(store) == stored(quiet)


def test_killed_once_and_resumed_nothing_is_lost_or_doubled(tmp_path: Path) -> None:
    killed_and_resumed(tmp_path, 1)


@pytest.mark.slow
def test_killed_at_twenty_moments_and_resumed_nothing_is_lost_or_doubled(tmp_path: Path) -> None:
    killed_and_resumed(tmp_path, KILLS)


@pytest.mark.slow
def test_a_full_disk_stops_the_program_with_a_sentence(tmp_path: Path) -> None:
    level, store = small_level(tmp_path), tmp_path / "evidence.sqlite"

    def small_files() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    done = subprocess.run(
        arguments(level, store),
        cwd=ROOT,
        env=environment(MESA_SHADER_CACHE_DISABLE="true"),
        preexec_fn=small_files,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == StoreError.exit_code, done.stderr
    assert "error: " in done.stderr
    assert str(store) in done.stderr
    assert "Traceback" not in done.stderr
    assert sound(store)


@pytest.mark.slow
def test_two_programs_on_one_store_do_each_other_no_harm(tmp_path: Path) -> None:
    level, store = small_level(tmp_path), tmp_path / "evidence.sqlite"
    both = [
        subprocess.Popen(arguments(level, store), cwd=ROOT, env=environment(), stdout=subprocess.DEVNULL)
        for _ in range(2)
    ]
    assert [one.wait() for one in both] == [0, 0]
    assert sound(store)
    quiet = tmp_path / "quiet.sqlite"
    subprocess.run(arguments(level, quiet), cwd=ROOT, env=environment(), check=True, capture_output=True)
    assert stored(store) == stored(quiet)
