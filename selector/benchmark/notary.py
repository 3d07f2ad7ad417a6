"""Writes down what workers say: every fact with the device, the code and the run that it comes from."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from uuid import uuid4

from selector.benchmark.code_version import commit
from selector.benchmark.idleness import Idleness
from selector.benchmark.messages import Job, Judged, Timed
from selector.evidence.rows import (
    Asked,
    CandidateRow,
    DeviceRow,
    InstanceRow,
    Judgement,
    Purpose,
    RunRow,
    Timing,
)
from selector.evidence.store import Store


class Notary:
    """Writes to a store, one transaction a fact: whatever ends the program, only what is in flight is lost.

    Args:
        store: Where to.
        job: What all facts have in common.
        codes: Technique's id -> hash of its code.

    Attributes:
        remarks: What may have disturbed the times, in the order in which it was noticed.
    """

    def __init__(self, store: Store, job: Job, codes: Mapping[str, str]) -> None:
        self._store, self._job, self._codes = store, job, codes
        self._started = datetime.now(UTC).isoformat(timespec="seconds")
        self._device: DeviceRow | None = None
        self._runs: dict[str, str] = {}
        self._before: tuple[str, ...] = ()
        self._current: str | None = None
        self._idleness = Idleness()
        self.remarks: list[str] = []

    def begin(self, device: DeviceRow) -> None:
        """All that follows is found out on this device."""
        self._device = device
        if remark := self._disturbance("Before the run"):
            self._before = (remark,)

    def attend(self) -> None:
        """An instance begins: from here on the machine should be idle."""
        self._current = None
        self._idleness.cores_of_others()

    def judgement(self, instance: InstanceRow, candidate: CandidateRow, word: Judged) -> Judgement:
        """Stores how wrong a candidate is, and gives it as it is stored.

        Raises:
            StoreError: The store takes no more.
        """
        row = Judgement(
            asked=self._asked(instance, candidate),
            run=self._run(""),
            status=word.status,
            reason=word.reason,
            memory_bytes=word.memory_bytes,
            truth=word.truth,
            fallback=word.fallback,
            figures=word.figures,
            counters=word.counters,
        )
        self._store.add(instance, [candidate], [row], [])
        return row

    def timing(self, instance: InstanceRow, candidate: CandidateRow, word: Timed) -> Timing:
        """Stores how long a candidate takes, and gives it as it is stored; raises what `judgement` does.

        The times of an instance that others have disturbed belong to a run of their own, whose remarks say
        so: all of its candidates were timed side by side.
        """
        if self._current is None:
            self._current = self._disturbance("While these times were taken")
        row = Timing(
            self._asked(instance, candidate), self._run(self._current), word.status, word.reason, word.samples
        )
        self._store.add(instance, [candidate], [], [row])
        return row

    def _asked(self, instance: InstanceRow, candidate: CandidateRow) -> Asked:
        assert self._device is not None
        return Asked(instance.key, candidate.key, self._device.key, self._codes[candidate.technique])

    def _disturbance(self, when: str) -> str:
        if self._job.purpose is Purpose.ERRORS:
            return ""
        remark = self._idleness.remark(when)
        if remark and remark not in self.remarks:
            self.remarks.append(remark)
        return remark

    def _run(self, remark: str) -> str:
        """Key of the run with this remark, which begins when it is first needed."""
        assert self._device is not None
        if remark not in self._runs:
            remarks = (*self._before, *filter(None, [remark]))
            key = uuid4().hex
            row = RunRow(key, self._started, commit(), self._job.purpose, self._job.seed, remarks)
            self._store.begin(row, self._device)
            self._runs[remark] = key
        return self._runs[remark]
