"""A job as its client sees it."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from api.service.job_store import JobRow, State

Json = dict[str, Any]


@dataclass(frozen=True)
class Progress:
    """How far a running job is.

    Attributes:
        done: Steps.
        total: Steps.
        what: The one that is being done.
    """

    done: int = 0
    total: int = 0
    what: str = ""


def job_path(job: str) -> str:
    """Where a job is."""
    return f"/v1/jobs/{job}"


def job_record(row: JobRow, progress: Progress | None) -> Json:
    """The record of a job; its progress is known while it runs."""
    own = job_path(row.id)
    at = progress or Progress(row.steps, row.steps, "")
    return {
        "id": row.id,
        "state": str(row.state),
        "level": row.level,
        "created": _time(row.created),
        "started": _time(row.started),
        "finished": _time(row.finished),
        "progress": {"done": at.done, "total": at.total, "what": at.what},
        "options": row.options,
        "problem": row.problem,
        "lights": row.lights,
        "links": {
            "self": own,
            **{name: f"{own}/{name}" for name in ("events", "result", "annotated", "report")},
        },
    }


def event_id(row: JobRow, progress: Progress | None) -> str:
    """Differs whenever the record differs."""
    running = row.state is State.RUNNING and progress
    return f"{row.version}.{progress.done}" if running and progress else f"{row.version}"


def _time(seconds: float | None) -> str | None:
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
