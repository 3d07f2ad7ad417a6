"""When each candidate was timed, without the samples: what tells fresh evidence from stale."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, select

from selector.evidence.reading import joined
from selector.evidence.schema import candidates, codes, devices, instances, runs, timings
from selector.measurement import Status


@dataclass(frozen=True)
class Dated:
    """One timing.

    Attributes:
        instance: Key of the instance.
        candidate: Key of the candidate.
        technique: Id of its technique.
        device: Key of the device.
        code: Hash of the technique's code.
        started: When its run began; UTC, ISO 8601.
        status: How it ended.
    """

    instance: str
    candidate: str
    technique: str
    device: str
    code: str
    started: str
    status: Status


def read_dated(connection: Connection) -> list[Dated]:
    """Every timing, the oldest first."""
    columns = (
        instances.c.key,
        candidates.c.key,
        candidates.c.technique,
        devices.c.key,
        codes.c.key,
        runs.c.started,
        timings.c.status,
    )
    query = select(*columns).select_from(joined(timings)).order_by(runs.c.started, runs.c.key, timings.c.id)
    return [Dated(*row[:-1], status=Status(row[-1])) for row in connection.execute(query)]
