from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from api.service.application import Entries
from api.service.settings import Limits, Settings
from tests.api.service import strange_workers
from tests.api.service.running_service import PATIENCE_S, Running, problem, record, running
from tests.small_level import small_level

LIMITS = replace(Limits(), reading_s=1.0, reading_bytes=400 << 20, waiting_s=200.0, uploads=4)
STRANGE = Entries(strange_workers.read, strange_workers.measure)


@pytest.fixture(scope="module")
def strange(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    with running(Settings(state=tmp_path_factory.mktemp("state"), readers=1, limits=LIMITS), STRANGE) as up:
        yield up


@pytest.fixture(scope="module")
def patient(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    limits = replace(LIMITS, reading_s=10 * PATIENCE_S, waiting_s=2 * PATIENCE_S)
    with running(Settings(state=tmp_path_factory.mktemp("state"), readers=1, limits=limits), STRANGE) as up:
        yield up


def reader(strange: Running) -> int:
    """The process that answers."""
    response = strange.level(b"work")
    assert response.status_code == 200, response.text
    return int(record(response)["pid"])


def test_a_reader_answers_again_and_again(strange: Running) -> None:
    assert reader(strange) == reader(strange)


@pytest.mark.parametrize(
    ("word", "status", "kind", "words"),
    [
        (b"hang", 504, "too-long", "more than the 1 s"),
        (b"crash", 422, "bad-level", "died of it"),
        (b"exit", 422, "bad-level", "died of it"),
        (b"eat", 422, "bad-level", "more memory"),
        (b"feed", 422, "bad-level", "more memory"),
    ],
)
def test_what_a_level_does_to_a_reader_it_does_to_nobody_else(
    strange: Running, word: bytes, status: int, kind: str, words: str
) -> None:
    before = reader(strange)
    assert words in problem(strange.level(word), status, kind)["detail"]
    after = reader(strange)
    # One that ran out of memory is still there: it was told so by the system.
    assert (before == after) == (word == b"eat")
    assert psutil.pid_exists(before) == (word == b"eat")


def test_a_level_that_nobody_waits_for_frees_its_reader(patient: Running) -> None:
    # Alone, it would hang for as long as a level may take.
    with patient.connected() as connection:
        head = "POST /v1/levels HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/gltf-binary\r\n"
        connection.sendall(f"{head}Content-Length: 4\r\n\r\nhang".encode())
        time.sleep(1.0)
    began = time.monotonic()
    assert reader(patient)
    assert time.monotonic() - began < PATIENCE_S


def test_a_bug_is_told_without_its_place(strange: Running) -> None:
    found = problem(strange.level(b"bug"), 500, "internal")
    assert "ZeroDivisionError" in found["detail"]
    assert reader(strange)


def test_a_reader_takes_what_it_started_along(strange: Running) -> None:
    strange.level(b"feed")
    reader(strange)
    mine = psutil.Process().children(recursive=True)
    assert not [one for one in mine if "held = bytearray" in " ".join(one.cmdline())]


def test_a_reader_that_is_killed_between_two_levels_is_replaced(strange: Running) -> None:
    for wait_s in (0.0, 0.5):
        killed = reader(strange)
        os.kill(killed, signal.SIGKILL)
        time.sleep(wait_s)
        # It is not the fault of the level that comes next.
        assert reader(strange) != killed


def test_a_level_that_never_reached_its_reader_is_read_by_another(strange: Running) -> None:
    pid = reader(strange)
    os.kill(pid, signal.SIGSTOP)
    with ThreadPoolExecutor(1) as threads:
        asked = threads.submit(strange.level, b"work")
        time.sleep(0.5)
        os.kill(pid, signal.SIGKILL)
        assert asked.result().status_code == 200
    assert reader(strange) != pid


def test_the_service_answers_while_all_readers_hang(strange: Running) -> None:
    with ThreadPoolExecutor(2) as threads:
        hanging = threads.submit(strange.level, b"hang")
        waiting = threads.submit(strange.level, b"work")
        assert strange.client.get("/healthz").status_code == 200
        assert hanging.result().status_code == 504
        assert waiting.result().status_code == 200


def test_more_levels_than_can_be_held_are_sent_away(strange: Running) -> None:
    with ThreadPoolExecutor(12) as threads:
        answers = list(threads.map(lambda _: strange.level(b"hang"), range(12)))
    busy = [one for one in answers if one.status_code == 503]
    assert busy
    for one in busy:
        problem(one, 503, "busy")
        assert int(one.headers["retry-after"]) > 0
    assert {one.status_code for one in answers} <= {503, 504}
    assert reader(strange)


def test_lost_readers_are_counted(strange: Running) -> None:
    strange.level(b"exit")
    assert 'gnomon_lost_readers_total{cause="crash"}' in strange.client.get("/metrics").text


def test_without_a_model_it_says_so(tmp_path: Path) -> None:
    entries = Entries(strange_workers.refuse, strange_workers.measure)
    settings = Settings(state=tmp_path, model=tmp_path / "none.model", readers=1)
    with running(settings, entries) as up:
        until = time.monotonic() + PATIENCE_S
        while up.level(b"work").status_code != 503 and time.monotonic() < until:
            time.sleep(0.1)
        assert "There is no model" in problem(up.level(b"work"), 503, "not-ready")["detail"]
        assert "cannot be read" in problem(up.client.get("/readyz"), 503, "not-ready")["detail"]
        assert up.client.get("/v1/techniques").status_code == 200


def test_no_process_outlives_the_service(tmp_path: Path) -> None:
    with running(Settings(state=tmp_path, readers=2, limits=LIMITS), STRANGE) as up:
        pids = {reader(up) for _ in range(3)} | set(up.parts.pool.pids)
    assert not [pid for pid in pids if psutil.pid_exists(pid)]


def test_a_model_that_can_be_read_again_is_read_again(tmp_path: Path, model: Path) -> None:
    path = tmp_path / "kept.model"
    path.write_bytes(model.read_bytes())
    level = small_level(tmp_path).read_bytes()
    with running(Settings(state=tmp_path / "state", model=path, readers=2)) as up:
        until = time.monotonic() + PATIENCE_S
        while len(up.parts.pool.pids) < 2 and time.monotonic() < until:
            time.sleep(0.02)
        path.write_bytes(b"junk")
        one, other = up.parts.pool.pids
        os.kill(one, signal.SIGKILL)
        # The other one goes on.
        assert [up.level(level).status_code for _ in range(3)] == [200] * 3
        assert up.client.get("/readyz").status_code == 200
        os.kill(other, signal.SIGKILL)
        while up.client.get("/readyz").status_code == 200 and time.monotonic() < until:
            up.level(level)
        assert "model" in problem(up.level(level), 503, "not-ready")["detail"]
        path.write_bytes(model.read_bytes())
        while up.level(level).status_code != 200 and time.monotonic() < until:
            time.sleep(0.1)
        assert up.level(level).status_code == 200
        assert up.client.get("/readyz").status_code == 200
