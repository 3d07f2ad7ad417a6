"""Whatever happens to a store: a sentence, and nothing lost or doubled."""

from __future__ import annotations

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from sqlalchemy import text

from selector.evidence import migrations, opening, versions
from selector.evidence.store import Store, StoreError
from selector.evidence.writing import Batch
from tests.selector.evidence_rows import (
    DEVICE,
    SM,
    SV,
    TIMES,
    asked,
    everything,
    filled,
    instance,
    timing,
)

ROOT = Path(__file__).parents[2]
WRITER = Path(__file__).with_name("evidence_writer.py")


def writer(store: Path, first: int, count: int) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, str(WRITER), str(store), str(first), str(count)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        text=True,
    )


@contextmanager
def database(path: Path) -> Iterator[sqlite3.Connection]:
    """Leaving a connection of sqlite3 commits, and does not close."""
    with closing(sqlite3.connect(path)) as connection, connection:
        yield connection


def sound(path: Path) -> bool:
    with database(path) as connection:
        (answer,) = connection.execute("PRAGMA integrity_check").fetchone()
        return answer == "ok" and connection.execute("PRAGMA foreign_key_check").fetchall() == []


def refused(url: str | Path, *, write: bool = True, wait_s: float = 0.1) -> str:
    with pytest.raises(StoreError) as caught:
        Store.open(str(url), write=write, wait_s=wait_s)
    assert caught.value.where
    return str(caught.value)


def test_what_is_no_store_is_refused_with_a_sentence(tmp_path: Path) -> None:
    assert "folder, not an evidence store" in refused(tmp_path)
    assert "does not exist" in refused(tmp_path / "nowhere" / "evidence.sqlite")
    assert "There is no such" in refused(tmp_path / "missing.sqlite", write=False)
    assert not (tmp_path / "missing.sqlite").exists()
    text_file = tmp_path / "text.sqlite"
    text_file.write_text("What is written here is no database, and longer than a header. " * 20)
    before = text_file.read_bytes()
    for write in (False, True):
        assert "no evidence store" in refused(text_file, write=write)
    assert text_file.read_bytes() == before
    other = tmp_path / "other.sqlite"
    with database(other) as connection:
        connection.execute("CREATE TABLE bookmarks (page TEXT)")
    assert "bookmarks" in refused(other)
    empty = tmp_path / "empty.sqlite"
    empty.touch()
    assert "no evidence yet" in refused(empty, write=False)
    Store.open(str(empty)).close()
    Store.open(str(empty), write=False).close()


def test_other_addresses_are_refused_with_a_sentence() -> None:
    assert "kinds sqlite and postgresql" in refused("mysql+pymysql://me:secret@host/base")
    assert "secret" not in refused("mysql+pymysql://me:secret@host/base")
    assert "no address" in refused("://")
    assert "driver" in refused("postgresql+pg8000://me@host/base")


def test_a_damaged_store_is_told(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    with Store.open(str(path)) as store:
        filled(store, 40)
    data = bytearray(path.read_bytes())
    for page in range(4096, len(data), 4096):
        data[page : page + 200] = b"\xff" * 200
    path.write_bytes(data)
    with pytest.raises(StoreError, match="damaged"), Store.open(str(path), write=False) as store:
        everything(store)


def test_a_newer_store_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    Store.open(str(path)).close()
    with database(path) as connection:
        connection.execute("UPDATE gnomon_meta SET value = '999'")
    for write in (False, True):
        assert "newer Gnomon" in refused(path, write=write)
    with database(path) as connection:
        connection.execute("UPDATE gnomon_meta SET value = 'soon'")
    assert "which version" in refused(path)


def test_an_older_store_is_brought_up_to_date_or_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "evidence.sqlite"
    with Store.open(str(path)) as store:
        filled(store)
        before = everything(store)
    newest = versions.SCHEMA_VERSION

    def half(connection: object) -> None:
        next_step(connection)
        raise RuntimeError

    def next_step(connection: object) -> None:
        connection.execute(text("ALTER TABLE runs ADD COLUMN weather TEXT NOT NULL DEFAULT 'fair'"))  # type: ignore[attr-defined]

    for module in (versions, opening):
        monkeypatch.setattr(module, "SCHEMA_VERSION", newest + 1)
    for failing, step in ((True, half), (False, next_step)):
        monkeypatch.setattr(versions, "MIGRATIONS", {**migrations.MIGRATIONS, newest: step})
        if failing:
            with pytest.raises(RuntimeError):
                Store.open(str(path))
            with database(path) as connection:
                assert connection.execute("SELECT value FROM gnomon_meta").fetchone() == (str(newest),)
                assert (
                    "weather"
                    not in connection.execute("SELECT sql FROM sqlite_master WHERE name='runs'").fetchone()[0]
                )
    # A reader brings it up to date as well.
    with Store.open(str(path), write=False) as store:
        assert everything(store) == before
    with database(path) as connection:
        assert connection.execute("SELECT value FROM gnomon_meta").fetchone() == (str(newest + 1),)
        assert connection.execute("SELECT DISTINCT weather FROM runs").fetchall() == [("fair",)]


def test_a_second_writer_waits_and_then_gets_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    with Store.open(str(path), wait_s=0.1) as store:
        filled(store, 1)
        other = sqlite3.connect(path, isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(StoreError, match="Another program"):
            filled(store, 1, 5)
        assert len(list(store.instances())) == 1
        other.execute("ROLLBACK")
        other.close()
        filled(store, 1, 5)
        assert len(list(store.instances())) == 2


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = shutil.which("mount")
    if (
        not mount
        or subprocess.run([mount, "-t", "tmpfs", "-o", "size=512k", "tmpfs", folder], check=False).returncode
    ):
        pytest.skip("only who may mount a file system can fill one")
    yield folder
    subprocess.run(["umount", folder], check=True)


def fill_up(path: Path) -> int:
    """How many instances were stored when the store was full."""
    with Store.open(str(path)) as store:
        for index in range(10_000):
            try:
                filled(store, 1, index)
            except StoreError as error:
                return index if "full" in error.what and error.where == str(path) else -1
    return -1


def test_a_full_disk_stops_with_a_sentence_and_a_sound_store(small_disk: Path) -> None:
    path = small_disk / "evidence.sqlite"
    stored = fill_up(path)
    assert stored > 0
    with Store.open(str(path), write=False) as store:
        kept = everything(store)
    assert stored <= len(kept.instances) <= stored + 1
    assert len(kept.judgements) == 2 * len({one.asked.instance for one in kept.judgements})
    assert sound(path)


def test_a_store_that_may_not_grow_stays_sound(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    with Store.open(str(path)) as store:
        filled(store, 3)
        before = everything(store)

        def small(connection: sqlite3.Connection, _record: object) -> None:
            connection.execute("PRAGMA max_page_count=1")

        opening.event.listen(store._engine, "connect", small)
        store._engine.dispose()
        many = timing(asked(instance(0), SM), *map(float, range(20_000)), first=10)
        with pytest.raises(StoreError, match="full"):
            store.add_batch(Batch(timings=(many,)))
        assert everything(store) == before
    assert sound(path)


def test_a_read_only_store_can_be_read_and_says_that_it_cannot_be_written(small_disk: Path) -> None:
    path = small_disk / "evidence.sqlite"
    with Store.open(str(path)) as store:
        filled(store, 1)
        before = everything(store)
    subprocess.run(["mount", "-o", "remount,ro", small_disk], check=True)
    with Store.open(str(path), write=False) as store:
        assert everything(store) == before
    with (
        pytest.raises(StoreError, match="may not be written"),
        Store.open(str(path)) as store,
    ):
        filled(store, 1, 1)


def test_what_is_opened_for_reading_cannot_be_written(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    Store.open(str(path)).close()
    with Store.open(str(path), write=False) as store, pytest.raises(StoreError, match="may not be written"):
        filled(store, 1)


def test_two_programs_write_at_once_and_one_is_killed(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    # Both make the store, and share ten instances.
    victim, other = writer(path, 0, 10_000), writer(path, 5, 30)
    assert victim.stdout is not None
    said = [victim.stdout.readline() for _ in range(15)]
    victim.send_signal(signal.SIGKILL)
    rest, _ = victim.communicate()
    other.communicate()
    assert (victim.returncode, other.returncode) == (-signal.SIGKILL, 0)
    told = {int(line) for line in [*said, *rest.splitlines()] if line.strip()}
    assert len(told) >= 15
    assert sound(path)
    with Store.open(str(path)) as store:
        found = everything(store)
        whole = {one.asked.instance for one in found.judgements}
        assert {instance(index).scene_digest for index in told | set(range(5, 35))} <= {
            one.scene_digest for one in found.instances if one.key in whole
        }
        for facts in (found.judgements, found.timings):
            names = [(one.asked, one.run) for one in facts]
            assert len(set(names)) == len(names) == 2 * len(whole)
        assert {len(one.samples) for one in found.timings} == {6}
        filled(store, 35)
        again = everything(store)
        assert len(again.instances) == max(35, len(found.instances))


def test_a_reader_sees_whole_transactions_while_another_writes(tmp_path: Path) -> None:
    path = tmp_path / "evidence.sqlite"
    with Store.open(str(path)) as store:
        filled(store, 2)
        reading = store.judgements()
        first = next(reading)
        store.begin(TIMES, DEVICE)
        filled(store, 1, 9)
        assert len([first, *reading]) == 4
        assert len(list(store.judgements())) == 6
        assert {one.asked.candidate for one in store.judgements()} == {SM.key, SV.key}
