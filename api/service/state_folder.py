"""The folder that is the service's own: nothing of anybody else's is ever removed or written over."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

from api.service.job_store import FILE, JOBS, JobStoreError
from api.service.problems import ProblemError
from api.service.settings import MEBIBYTE

INCOMING, MEMORY, LOCK = "incoming", "memory", "lock"
MOST_SHOWN = 5
JOB_NAME, UPLOAD_NAME = re.compile(r"[A-Za-z0-9_-]{32}"), re.compile(r"[0-9a-f]{32}")
MEMORY_NAME = re.compile(r"\.?[0-9a-f]{64}\.json.*")


def check_is_ours(state: Path) -> None:
    """Refuse a folder that holds what no service has put there. Nothing is changed.

    Raises:
        JobStoreError: It is no folder, or holds somebody's files, or a part of it is not what it should be.
        OSError: It cannot be looked at.
    """
    if not state.exists():
        return
    names = {path.name for path in state.iterdir()}
    for name in (JOBS, INCOMING, MEMORY):
        path = state / name
        if name in names and (path.is_symlink() or not path.is_dir()):
            raise JobStoreError(
                f"The service keeps files in a folder {name}, and this is no folder.",
                where=str(path),
                known="It is a link." if path.is_symlink() else "It is a file.",
                remedy="Move it away, or choose another folder with --state.",
            )
    if FILE in names:
        return
    strange = sorted(names - {JOBS, INCOMING, MEMORY, LOCK})
    for name in (JOBS, INCOMING, MEMORY):
        if name in names:
            strange += sorted(f"{name}/{path.name}" for path in (state / name).iterdir())
    if strange:
        raise _not_ours(state, strange)


def empty_memory(state: Path) -> Path:
    """A folder for what readers remember, without what those of an earlier service have remembered.

    Raises:
        OSError: It cannot be made or read.
    """
    folder = state / MEMORY
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    for path in list(folder.iterdir()):
        if MEMORY_NAME.fullmatch(path.name):
            path.unlink()
    return folder


def shortage(state: Path, wanted_bytes: int) -> ProblemError | None:
    """What to say where the folder's disk has less room than that; None where it has enough."""
    try:
        free_bytes = shutil.disk_usage(state).free
    except OSError as error:
        return ProblemError("not-ready", f"The folder of the service cannot be used: {error.strerror}.")
    if free_bytes >= wanted_bytes:
        return None
    free, wanted = (f"{count // MEBIBYTE:,} MiB" for count in (free_bytes, wanted_bytes))
    return ProblemError(
        "not-ready",
        f"The disk has {free} left, and one level may take {wanted}.",
        remedy="Make room, remove jobs that have ended, or give the service another folder with --state.",
    )


def remove_folders(folder: Path, shape: re.Pattern[str], kept: frozenset[str] = frozenset()) -> None:
    """Removes the folders in a folder whose names the service itself gives, but for those that are kept."""
    for path in _folders(folder):
        if shape.fullmatch(path.name) and path.name not in kept:
            shutil.rmtree(path, ignore_errors=True)


def _folders(folder: Path) -> Iterator[Path]:
    return (path for path in list(folder.iterdir()) if path.is_dir() and not path.is_symlink())


def _not_ours(state: Path, strange: list[str]) -> JobStoreError:
    more = f" and {len(strange) - MOST_SHOWN} more" if len(strange) > MOST_SHOWN else ""
    return JobStoreError(
        "This folder holds files, and no queue of jobs that they could belong to.",
        where=str(state),
        known=f"There is no {FILE} in it, but {', '.join(map(ascii, strange[:MOST_SHOWN]))}{more}.",
        remedy="Choose an empty folder, or one that is not there yet, with --state.",
    )
