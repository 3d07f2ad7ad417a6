"""A folder that is somebody else's is left as it is, and whatever is odd about one is told."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from api.service.application import Entries, create_app
from api.service.job_folders import JobFolders
from api.service.job_store import JobStore, JobStoreError
from api.service.listening import serve
from api.service.receiving import Reception
from api.service.settings import Limits, Settings
from tests.api.command import started
from tests.api.service import strange_workers
from tests.api.service.running_service import running

STRANGE = Entries(strange_workers.read, strange_workers.measure)


def contents(folder: Path) -> dict[str, bytes | None]:
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in folder.rglob("*")
    }


def _link(folder: Path) -> None:
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere" / "a").touch()
    (folder / "incoming").symlink_to(folder / "elsewhere")


def _database(version: int, table: str) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        with closing(sqlite3.connect(folder / "jobs.sqlite", isolation_level=None)) as db:
            if table:
                db.execute(f"CREATE TABLE {table} (id TEXT)")
                db.execute(f"INSERT INTO {table} VALUES ('mine')")  # noqa: S608  our own names
            db.execute(f"PRAGMA user_version={version}")

    return make


def _files(*names: str) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        for name in names:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text("mine")

    return make


STRANGERS = {
    "jobs and uploads of somebody": (_files("jobs/important/a.txt", "incoming/b.txt"), "jobs/important"),
    "a file": (_files("letter.txt"), "letter.txt"),
    "results without a queue": (_files(f"jobs/{'a' * 32}/results/result.json"), "no queue of jobs"),
    "results and an empty queue": (
        lambda folder: (_files(f"jobs/{'a' * 32}/b")(folder), (folder / "jobs.sqlite").touch()),
        "results that belong to one",
    ),
    "incoming is a file": (_files("incoming"), "It is a file"),
    "incoming is a link": (_link, "It is a link"),
    "jobs is a file": (_files("jobs"), "It is a file"),
    "another version 1": (_database(1, ""), "another program"),
    "another table jobs": (_database(1, "jobs"), "another program"),
    "another program": (_database(0, "notes"), "another program"),
    "a negative version": (_database(-3, "jobs"), "another program"),
}


@pytest.mark.parametrize("name", STRANGERS)
def test_a_folder_of_somebody_else_is_left_alone(tmp_path: Path, name: str) -> None:
    make, words = STRANGERS[name]
    make(tmp_path)
    before = contents(tmp_path)
    with pytest.raises(JobStoreError, match=r"folder|queue|program") as found:
        serve(Settings(state=tmp_path, port=0, readers=1), lambda _: None, STRANGE)
    assert words in str(found.value)
    assert "--state" in found.value.remedy
    after = contents(tmp_path)
    assert {one: after.get(one, b"gone") for one in before} == before


def test_an_odd_folder_is_told_on_the_command_line(tmp_path: Path) -> None:
    _database(1, "")(tmp_path)
    found = started("serve", "--port", 0, "--state", tmp_path)
    assert found.returncode == 7
    assert "another program" in found.stderr
    assert "Traceback" not in found.stderr


def test_rows_that_mean_nothing_are_told(tmp_path: Path) -> None:
    with JobStore(tmp_path) as store:
        store.add("a", "level.glb", "model/gltf-binary", {}, 1)
    with closing(sqlite3.connect(tmp_path / "jobs.sqlite", isolation_level=None)) as db:
        db.execute("UPDATE jobs SET state = 'lost'")
    with pytest.raises(JobStoreError, match="cannot be used"):
        serve(Settings(state=tmp_path, port=0, readers=1), lambda _: None, STRANGE)


def test_a_bug_at_the_start_is_not_silent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("api.service.application._show", wrong)
    with pytest.raises(ZeroDivisionError):
        serve(Settings(state=tmp_path, port=0, readers=1), lambda _: None, STRANGE)


def test_only_what_the_service_names_is_removed(tmp_path: Path) -> None:
    with closing(JobFolders(tmp_path)) as folders, JobStore(tmp_path):
        old, job = tmp_path / "incoming" / ("0a" * 16), tmp_path / "jobs" / ("aZ_-" * 8)
        kept = [tmp_path / "incoming" / "notes", tmp_path / "jobs" / "important", tmp_path / "jobs" / "short"]
        for path in (old, job, *kept):
            path.mkdir(parents=True)
        Reception(folders.incoming, Limits())
        folders.drop_unknown([])
        assert not old.exists()
        assert not job.exists()
        assert all(path.is_dir() for path in kept)


def test_a_queue_of_the_first_days_is_still_read(tmp_path: Path) -> None:
    with JobStore(tmp_path) as store:
        store.add("a", "level.glb", "model/gltf-binary", {}, 1)
    with closing(sqlite3.connect(tmp_path / "jobs.sqlite", isolation_level=None)) as db:
        db.execute("PRAGMA application_id=0")
    with JobStore(tmp_path) as store:
        assert store.get("a") is not None


def test_a_folder_is_taken_again(tmp_path: Path) -> None:
    assert create_app(Settings(state=tmp_path))
    for _ in range(2):
        with running(Settings(state=tmp_path / "new", readers=1), STRANGE) as up:
            assert up.client.get("/healthz").status_code == 200
