"""What a store knows already, so that it is not asked again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

from renderers.context import DeviceLimits
from scenes.errors import GnomonError
from scenes.scene import LightKind
from selector.benchmark.judging import candidate_rows
from selector.benchmark.messages import Job
from selector.benchmark.questions import LevelQuestion, Question, SpecQuestion, level_row, posed
from selector.benchmark.tally import Tally
from selector.candidate import candidates
from selector.evidence.rows import InstanceRow, Purpose
from selector.evidence.store import Store
from selector.measurement import Status

Fact = tuple[str, str]
"""Keys of an instance and a candidate."""


class Known:
    """The facts of a store that are fresh: found out on this device by this code.

    Args:
        store: The store.
        job: What is asked of every question.
        codes: Technique's id -> hash of its code.
        device: Key of the device.
        limits: Of the device, which decide what the candidates are.

    Attributes:
        done: Facts that need not be found out again.
        techniques: Candidate's key -> id of its technique, for every candidate of the store.
        barred: For times: facts that cannot be timed, because the candidate has failed already.
    """

    def __init__(
        self, store: Store, job: Job, codes: Mapping[str, str], device: str, limits: DeviceLimits
    ) -> None:
        self._store, self._job, self._limits = store, job, limits
        self._device, self._codes = device, sorted(set(codes.values()))
        self.techniques = {row.key: row.technique for row in store.candidates()}
        self.barred: dict[Fact, tuple[Status, str]] = {}
        if job.purpose is Purpose.ERRORS:
            self.done: set[Fact] = store.judged(device, self._codes)
        else:
            self.done = set(store.timed(device, self._codes))

    def fill(self, tally: Tally) -> None:
        """Count what is there, and learn what has failed. Errors are the same on every device."""
        for row in self._store.judgements(codes=self._codes):
            tally.judge(row)
            if row.status is not Status.OK and row.asked.device == self._device:
                self.barred[row.asked.instance, row.asked.candidate] = row.status, row.reason
        if self._job.purpose is Purpose.ERRORS:
            return
        timed = set()
        for timing in self._store.timings(device=self._device, codes=self._codes):
            tally.time(timing)
            timed.add(timing.asked.instance)
        for instance in timed:
            tally.close(instance, surely=False)

    def unanswered(self, questions: Sequence[Question]) -> list[Question]:
        """Those about which anything is missing, in their order."""
        rows = [self._row(question) for question in questions]
        complete = [row is not None and self._complete(row) for row in rows]
        changed = self._changed_families(
            [
                (question, row)
                for question, row, known in zip(questions, rows, complete, strict=True)
                if known and row and isinstance(question, SpecQuestion)
            ]
        )
        return [
            question
            for question, known in zip(questions, complete, strict=True)
            if not known or (isinstance(question, SpecQuestion) and question.family in changed)
        ]

    def _row(self, question: Question) -> InstanceRow | None:
        """As the store would keep it, without making the scene; None where only the scene can tell."""
        if isinstance(question, LevelQuestion):
            return level_row(question, self._job.width, self._job.height)
        return self._by_origin.get(question.origin)

    @cached_property
    def _by_origin(self) -> dict[str, InstanceRow]:
        size = (self._job.width, self._job.height)
        return {row.origin: row for row in self._store.instances() if (row.width, row.height) == size}

    def _complete(self, row: InstanceRow) -> bool:
        known = candidates(LightKind(row.light["kind"]), self._limits, self._job.techniques)
        return all((row.key, one.key) in self.done for one in candidate_rows(known))

    def _changed_families(self, known: Sequence[tuple[SpecQuestion, InstanceRow]]) -> set[str]:
        """Families whose smallest scene is not what the store has: the code that makes it was changed.

        Making every scene again only to see that nothing is to be done would take ten minutes.
        """
        smallest: dict[str, tuple[SpecQuestion, InstanceRow]] = {}
        for question, row in known:
            if question.family not in smallest or question.triangles < smallest[question.family][0].triangles:
                smallest[question.family] = question, row
        return {family for family, (question, row) in smallest.items() if not self._same(question, row)}

    def _same(self, question: SpecQuestion, row: InstanceRow) -> bool:
        try:
            return posed(question, self._job.width, self._job.height).row.key == row.key
        except GnomonError:
            # Whoever measures it says why.
            return False
