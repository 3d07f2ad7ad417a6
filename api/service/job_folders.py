"""The folders of jobs: the level that came in, and the results once they are there."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from api.service.job_results import PARTIAL, RESULTS, sync_folder
from api.service.job_store import JOBS, JobStoreError
from api.service.level_folder import LEVEL, PARTS
from api.service.state_folder import INCOMING, JOB_NAME, LOCK, check_is_ours, remove_folders


class JobFolders:
    """The service's folder on disk, which only one service may use.

    Args:
        state: The folder; made where it is not there.

    Raises:
        JobStoreError: It cannot be made or written, is somebody else's, or another service uses it.
    """

    def __init__(self, state: Path) -> None:
        self.state = state
        try:
            check_is_ours(state)
            (state / JOBS).mkdir(parents=True, exist_ok=True, mode=0o700)
            self._lock = os.open(state / LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError as error:
            raise JobStoreError(
                "The service's folder cannot be used.",
                where=str(state),
                known=f"The system says: {error.strerror or error}.",
                remedy="Choose another with --state.",
            ) from error
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(self._lock)
            raise JobStoreError(
                "Another service uses this folder.",
                where=str(state),
                remedy="Stop it, or choose another with --state.",
            ) from error

    def close(self) -> None:
        """Another service may use it."""
        os.close(self._lock)

    @property
    def incoming(self) -> Path:
        """Where uploads are worked on."""
        return self.state / INCOMING

    def of(self, job: str) -> Path:
        """The folder of a job."""
        return self.state / JOBS / job

    def take(self, upload: Path, job: str) -> None:
        """An upload that was looked at becomes a job's folder; it is there after a power cut."""
        shutil.rmtree(upload / PARTS)
        upload.rename(self.of(job))
        sync_folder(self.state / JOBS)

    def has_level(self, job: str, name: str) -> bool:
        """Whether the level of a job is there."""
        return (self.of(job) / LEVEL / name).is_file()

    def has_results(self, job: str) -> bool:
        """Whether all of them are there."""
        return (self.of(job) / RESULTS).is_dir()

    def drop_level(self, job: str) -> None:
        """What only measuring needed."""
        shutil.rmtree(self.of(job) / LEVEL, ignore_errors=True)
        shutil.rmtree(self.of(job) / PARTIAL, ignore_errors=True)

    def drop(self, job: str) -> None:
        """Everything."""
        shutil.rmtree(self.of(job), ignore_errors=True)

    def drop_unknown(self, known: Iterable[str]) -> None:
        """Folders of jobs that were never promised, or are forgotten; what has no job's name stays."""
        remove_folders(self.state / JOBS, JOB_NAME, frozenset(known))

    def size(self, job: str) -> int:
        """Bytes of its files."""
        return sum(path.stat().st_size for path in self.of(job).rglob("*") if path.is_file())
