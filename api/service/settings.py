"""How the service is set up: where it listens, what it may use, and where everything ends."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

from models.shipped import SHIPPED_MODEL

DEFAULT_HOST = "127.0.0.1"
DEFAULT_PORT = 8420
MEBIBYTE = 1 << 20
STATE_VARIABLE = "XDG_STATE_HOME"


@dataclass(frozen=True)
class Limits:
    """Where everything ends that a stranger could make endless.

    Attributes:
        upload_bytes: Of a level with its files, on its way in.
        question_bytes: Of any other body.
        parts: Files of one upload.
        uploads: That come in or are read at the same time.
        connections: That are open at the same time.
        streams: Of events that are open at the same time.
        questions: Recommendations from features that wait at the same time.
        header_s: For the head of a request to arrive.
        body_idle_s: Between two pieces of a body.
        body_s: For the whole of a body to arrive.
        response_idle_s: For a client to take the next piece of an answer.
        triangles: Of a level, as drawn.
        lights: Of a level that are asked about at once.
        reading_s: To read a level, and to predict or annotate.
        reading_bytes: Memory of a process that does so, with what it starts.
        waiting_s: For such a process to become free.
        measuring_s: For one job.
        measuring_idle_s: Between two steps of a job.
        measuring_bytes: Memory of the process that measures.
        queue: Jobs that wait or run.
        attempts: At a job, whose process died in those before.
        starts: Of a job, whoever ended those before: one that takes the whole service along must not do so
            for ever.
        kept_jobs: That have ended, before the oldest are forgotten.
        kept_s: For which such a job is kept.
        kept_bytes: Which the files of all such jobs take together.
    """

    upload_bytes: int = 256 * MEBIBYTE
    question_bytes: int = MEBIBYTE
    parts: int = 256
    uploads: int = 8
    connections: int = 256
    streams: int = 64
    questions: int = 128
    header_s: float = 10.0
    body_idle_s: float = 15.0
    body_s: float = 300.0
    response_idle_s: float = 60.0
    triangles: int = 2_000_000
    lights: int = 500
    reading_s: float = 120.0
    reading_bytes: int = 4096 * MEBIBYTE
    waiting_s: float = 30.0
    measuring_s: float = 4 * 3600.0
    measuring_idle_s: float = 900.0
    measuring_bytes: int = 8192 * MEBIBYTE
    queue: int = 32
    attempts: int = 3
    starts: int = 10
    kept_jobs: int = 100
    kept_s: float = 7 * 86400.0
    kept_bytes: int = 4096 * MEBIBYTE


def default_state() -> Path:
    """Where the queue lies if nobody says otherwise: the user's folder for states of programs."""
    named = os.environ.get(STATE_VARIABLE, "")
    # The XDG Base Directory Specification takes no notice of relative ones.
    folder = Path(named) if Path(named).is_absolute() else Path.home() / ".local" / "state"
    return folder / "gnomon"


@dataclass(frozen=True)
class Settings:
    """One service.

    Attributes:
        state: Folder of its queue, its uploads and its results.
        model: The model's file.
        host: Address that it listens at.
        port: At that address; any free one where 0.
        token: What every request has to show; nothing where empty.
        names: Host names, beside its own address, by which it may be called.
        device: Index or name of the GPU that measures; the first that works where None.
        readers: Processes that read levels.
        limits: Where everything ends.
    """

    state: Path = field(default_factory=default_state)
    model: Path = SHIPPED_MODEL
    host: str = DEFAULT_HOST
    port: int = DEFAULT_PORT
    token: str = ""
    names: tuple[str, ...] = ()
    device: str | None = None
    readers: int = 2
    limits: Limits = field(default_factory=Limits)
