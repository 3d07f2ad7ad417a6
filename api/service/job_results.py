"""The files of a job that is done, and the step that makes it so."""

from __future__ import annotations

import os
from pathlib import Path

RESULTS, PARTIAL = "results", "results.partial"
RESULT, REPORT, ANNOTATED = "result.json", "report.html", "annotated"


def finish(folder: Path) -> None:
    """Gives results that are complete their name: from now on the job is done, whatever happens.

    Args:
        folder: Of the job; its files have been synced.
    """
    sync_folder(folder / PARTIAL)
    (folder / PARTIAL).rename(folder / RESULTS)
    sync_folder(folder)


def sync_folder(folder: Path) -> None:
    """The names in it survive a power cut."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
