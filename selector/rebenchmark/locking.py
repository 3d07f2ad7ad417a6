"""One job at a time for each store: a lock that ends with the process that holds it, however that ends."""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from scenes.atomic_file import output_error
from scenes.errors import GnomonError

LONGEST_NOTE = 200


class BusyError(GnomonError):
    """Another job is at work on the same store."""

    exit_code = 9


def beside(store: str, suffix: str) -> Path:
    """A file beside a store that is a file; in the current folder for one that is a URL."""
    if "://" not in store:
        return Path(f"{store}{suffix}")
    return Path(f"gnomon-{hashlib.sha256(store.encode()).hexdigest()[:12]}{suffix}")


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Holds a lock in the block; the file stays, for taking it away could part two jobs' ideas of it.

    Raises:
        BusyError: Another process holds it; the message says which, and since when.
        OutputError: The file cannot be made.
    """
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
    except OSError as error:
        raise output_error(path, error) from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            note = os.read(descriptor, LONGEST_NOTE).decode("utf-8", "replace").strip()
            raise BusyError(
                "Another re-benchmark job is running on this store.",
                where=str(path),
                known=f"It is {note}." if note else "",
                remedy="Wait until it has ended.",
            ) from None
        started = datetime.now(UTC).isoformat(timespec="seconds")
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"process {os.getpid()}, since {started}\n".encode(), 0)
        yield
    finally:
        os.close(descriptor)
