"""A disk that takes nothing more is told as such, and what could not be said is said later."""

from __future__ import annotations

import errno
import shutil
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

from api.service.application import Entries
from api.service.problems import is_full
from api.service.settings import Settings
from api.service.state_folder import shortage
from scenes.errors import OutputError
from tests.api.service import strange_workers
from tests.api.service.running_service import PATIENCE_S, Running, problem, running

STRANGE = Entries(strange_workers.read, strange_workers.measure)


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    with running(Settings(state=tmp_path_factory.mktemp("state"), readers=1), STRANGE) as up:
        yield up


@contextmanager
def unwritable(service: Running) -> Iterator[None]:
    """The queue cannot be written, as where the disk is full."""
    db: sqlite3.Connection = service.parts.desk._store._db
    db.execute("PRAGMA query_only=ON")
    try:
        yield
    finally:
        db.execute("PRAGMA query_only=OFF")


def test_what_cannot_be_written_is_told(service: Running) -> None:
    job = service.job(b"stop")
    with unwritable(service):
        problem(service.client.delete(job["links"]["self"]), 507, "storage")
        problem(service.level(b"work", "/v1/jobs"), 507, "storage")
        found = problem(service.client.get("/readyz"), 503, "not-ready")
        assert "queue" in found["detail"]
        assert service.client.get(job["links"]["self"]).status_code == 200
    assert service.client.delete(job["links"]["self"]).status_code == 200


def test_a_disk_without_room_for_a_level_is_told(
    service: Running, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    free = shutil.disk_usage(tmp_path).free
    assert shortage(tmp_path, free // 2) is None
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=3 * 2**20))
    found = problem(service.client.get("/readyz"), 503, "not-ready")
    assert "room: The disk has 3 MiB left, and one level may take 256 MiB." in found["detail"]
    assert "--state" in found["remedy"]
    monkeypatch.undo()
    away = service.parts.settings.state.rename(tmp_path / "away")
    try:
        assert "room: The folder" in problem(service.client.get("/readyz"), 503, "not-ready")["detail"]
    finally:
        away.rename(service.parts.settings.state)


def test_an_end_that_could_not_be_written_is_written_later(service: Running) -> None:
    job = service.job(b"work")
    results = service.parts.settings.state / "jobs" / job["id"] / "results"
    until = time.monotonic() + PATIENCE_S
    while not service.state(job["id"])["progress"]["total"] and time.monotonic() < until:
        time.sleep(0.005)
    with unwritable(service):
        while not results.exists() and time.monotonic() < until:
            time.sleep(0.02)
        time.sleep(0.3)
        assert service.state(job["id"])["state"] == "running"
    assert service.ended(job["id"])["state"] == "done"


def test_a_process_that_finds_the_disk_full_says_so(service: Running) -> None:
    assert "secret" not in str(problem(service.level(b"full"), 507, "storage"))
    found = service.ended(service.job(b"full")["id"])
    assert found["state"] == "failed"
    assert found["problem"]["type"].endswith("storage")


def test_a_full_disk_is_known_by_its_cause() -> None:
    wrapped = OutputError("It could not be written.")
    assert not is_full(wrapped)
    wrapped.__cause__ = OSError(errno.EDQUOT, "quota")
    assert is_full(wrapped)
    assert not is_full(FileNotFoundError(errno.ENOENT, "gone"))
    assert not is_full(None)


def test_files_that_cannot_be_written_are_told(service: Running, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> Path:
        raise OSError(errno.ENOSPC, "full")

    monkeypatch.setattr(service.parts.desk._folders, "take", full)
    problem(service.level(b"work", "/v1/jobs"), 507, "storage")
