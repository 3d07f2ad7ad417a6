from __future__ import annotations

import errno
import os
import random
import signal
import stat
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from scenes.atomic_file import write_atomically
from scenes.errors import OutputError

REPOSITORY = Path(__file__).parents[2]
NOBODY = 65534


@contextmanager
def ordinary_user() -> Iterator[None]:
    """Root may write everywhere: step down where the tests run as root."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def open_folder() -> Iterator[Path]:
    """A folder that every user may enter; pytest's own are closed to others."""
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        yield Path(name)
        Path(name).chmod(0o755)


@contextmanager
def mounted(folder: Path, options: str) -> Iterator[None]:
    command = ["mount", "-t", "tmpfs", "-o", options, "none", str(folder)]
    try:
        done = subprocess.run(command, check=False, capture_output=True, text=True)
    except FileNotFoundError:
        pytest.skip("needs the mount command")
    if done.returncode:
        pytest.skip(f"needs the right to mount a tmpfs: {done.stderr.strip()}")
    try:
        yield
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def refused(path: Path, data: bytes = b"new") -> OutputError:
    with pytest.raises(OutputError) as caught:
        write_atomically(path, data)
    assert str(path) in caught.value.where
    assert caught.value.what.endswith(".")
    assert caught.value.remedy
    return caught.value


def test_a_new_file_is_written_whole_with_the_usual_permissions(tmp_path: Path) -> None:
    data = bytes(range(256)) * 5000
    target, usual = tmp_path / "level.glb", tmp_path / "usual"
    write_atomically(target, data)
    usual.touch()
    assert target.read_bytes() == data
    assert target.stat().st_mode == usual.stat().st_mode
    assert {entry.name for entry in tmp_path.iterdir()} == {"level.glb", "usual"}


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664, 0o755])
def test_an_old_file_is_replaced_and_keeps_its_permissions(tmp_path: Path, mode: int) -> None:
    target = tmp_path / "level.glb"
    target.write_bytes(b"old and longer")
    target.chmod(mode)
    write_atomically(target, b"")
    assert target.read_bytes() == b""
    assert stat.S_IMODE(target.stat().st_mode) == mode


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
def test_root_leaves_a_file_to_its_owner(tmp_path: Path) -> None:
    target = tmp_path / "level.glb"
    target.write_bytes(b"old")
    os.chown(target, NOBODY, NOBODY)
    write_atomically(target, b"new")
    assert (target.stat().st_uid, target.stat().st_gid) == (NOBODY, NOBODY)


def test_a_symbolic_link_stays_and_its_file_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    target, link = tmp_path / "real" / "level.glb", tmp_path / "link.glb"
    target.write_bytes(b"old")
    link.symlink_to(target)
    write_atomically(link, b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    assert "does not exist" in refused(tmp_path / "absent" / "level.glb").what


def test_a_file_in_place_of_a_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    assert "not a folder" in refused(tmp_path / "file" / "level.glb").what


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    (tmp_path / "level.glb").mkdir()
    assert "folder, not a file" in refused(tmp_path / "level.glb").what
    assert (tmp_path / "level.glb").is_dir()


def test_a_pipe_or_device_is_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert "device or a pipe" in refused(tmp_path / "pipe").what
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)
    assert [entry.name for entry in tmp_path.iterdir()] == ["pipe"]


def test_circular_links_are_named(tmp_path: Path) -> None:
    (tmp_path / "a").symlink_to(tmp_path / "b")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    assert "circle" in refused(tmp_path / "a").what


def test_a_name_too_long_is_named(tmp_path: Path) -> None:
    assert "too long" in refused(tmp_path / ("x" * 300)).what
    assert not list(tmp_path.iterdir())


def test_a_folder_without_permission_is_named(open_folder: Path) -> None:
    open_folder.chmod(0o555)
    with ordinary_user():
        assert "permission" in refused(open_folder / "level.glb").what
    assert not list(open_folder.iterdir())


def test_a_read_only_file_is_not_replaced(open_folder: Path) -> None:
    target = open_folder / "level.glb"
    target.write_bytes(b"old")
    target.chmod(0o444)
    open_folder.chmod(0o777)
    with ordinary_user():
        assert "permission" in refused(target).what
    assert target.read_bytes() == b"old"


@pytest.mark.parametrize("call", ["write", "fsync", "open", "replace"])
@pytest.mark.parametrize(
    ("code", "word"),
    [
        (errno.ENOSPC, "full"),
        (errno.EROFS, "read-only"),
        (errno.EDQUOT, "quota"),
        (errno.EIO, "not be written"),
    ],
)
def test_a_failing_call_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str, code: int, word: str
) -> None:
    target = tmp_path / "level.glb"
    target.write_bytes(b"old")

    def failing(*_: object, **__: object) -> None:
        raise OSError(code, os.strerror(code))

    with monkeypatch.context() as patched:
        patched.setattr(os, call, failing)
        error = refused(target)
    assert word in error.what
    assert os.strerror(code) in error.known
    assert target.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["level.glb"]


def test_an_interrupt_while_writing_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "level.glb"
    target.write_bytes(b"old")

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(os, "write", interrupted)
        with pytest.raises(KeyboardInterrupt):
            write_atomically(target, b"new")
    assert target.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["level.glb"]


def test_an_interrupt_just_after_the_file_got_its_name_stays_an_interrupt(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "level.glb"
    rename = Path.replace

    def interrupted(source: Path, to: Path) -> None:
        rename(source, to)
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Path, "replace", interrupted)
        with pytest.raises(KeyboardInterrupt):
            write_atomically(target, b"new")
    assert target.read_bytes() == b"new"
    assert [entry.name for entry in tmp_path.iterdir()] == ["level.glb"]


def test_a_folder_that_cannot_be_synced_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "level.glb"
    sync = os.fsync

    def folders_fail(descriptor: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        sync(descriptor)

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", folders_fail)
        assert "written whole" in refused(target).what
    assert target.read_bytes() == b"new"


def test_short_writes_are_continued(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = os.write
    with monkeypatch.context() as patched:
        patched.setattr(os, "write", lambda descriptor, data: write(descriptor, data[:7]))
        write_atomically(tmp_path / "level.glb", bytes(range(100)))
    assert (tmp_path / "level.glb").read_bytes() == bytes(range(100))


def test_a_disk_that_is_really_full(tmp_path: Path) -> None:
    with mounted(tmp_path, "size=64k"):
        target = tmp_path / "level.glb"
        write_atomically(target, b"old")
        assert "disk is full" in refused(target, b"x" * 1_000_000).what
        assert target.read_bytes() == b"old"
        assert [entry.name for entry in tmp_path.iterdir()] == ["level.glb"]


def test_a_file_system_that_is_really_read_only(tmp_path: Path) -> None:
    with mounted(tmp_path, "ro"):
        assert "read-only" in refused(tmp_path / "level.glb").what


WRITER = """
import sys
from pathlib import Path
from scenes.atomic_file import write_atomically
while True:
    for letter in (b"n", b"o"):
        write_atomically(Path(sys.argv[1]), letter * int(sys.argv[2]))
"""


def test_a_writer_killed_at_any_moment_leaves_a_whole_file(tmp_path: Path) -> None:
    target, size = tmp_path / "level.glb", 4_000_000
    old, new = b"o" * size, b"n" * size
    target.write_bytes(old)
    moments = random.Random(2)  # noqa: S311
    for _ in range(12):
        writer = subprocess.Popen([sys.executable, "-c", WRITER, str(target), str(size)], cwd=REPOSITORY)
        try:
            while not list(tmp_path.glob(".gnomon-*.partial")):
                assert writer.poll() is None
            time.sleep(moments.uniform(0, 0.01))
        finally:
            writer.send_signal(signal.SIGKILL)
            writer.wait()
        assert target.read_bytes() in (old, new)
        for left in tmp_path.glob(".gnomon-*.partial"):
            left.unlink()
    assert [entry.name for entry in tmp_path.iterdir()] == ["level.glb"]
