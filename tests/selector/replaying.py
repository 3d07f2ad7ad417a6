"""Benchmarks that measure nothing: what they ask is answered from `repeats.npz`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime

from selector.benchmark.running import Benchmark
from selector.evidence.rows import DeviceRow, Purpose, RunRow
from selector.evidence.writing import Batch
from tests.selector.repeated_runs import repeats, techniques, timings

NOW = datetime(2030, 2, 20, 3, 0, 0, tzinfo=UTC)


class Replay:
    """Listens to a job, and answers its benchmarks from a recorded run.

    Args:
        number: Which run.
        slowed: Technique's id -> factor of its times.
        codes: Technique's id -> hash of its code.
        changed: Added to every error.
        device: Where, in place of the device that was recorded.
    """

    def __init__(
        self,
        number: int,
        slowed: Mapping[str, float] | None = None,
        codes: Mapping[str, str] | None = None,
        changed: float = 0.0,
        device: DeviceRow | None = None,
    ) -> None:
        self.device = device or repeats().device
        self.number, self.slowed, self.codes, self.changed = number, slowed or {}, codes or {}, changed
        self.words: list[str] = []
        self.asked: list[tuple[Purpose, int, tuple[str, ...]]] = []

    def begins(self, words: str) -> None:
        self.words.append(words)

    def advances(self, done: int, total: int, words: str = "") -> None:
        assert done <= total, words

    def runs(self, benchmark: Benchmark, words: str) -> None:
        job, questions = benchmark.order.job, benchmark.order.questions
        self.words.append(words)
        self.asked.append((job.purpose, len(questions), job.techniques))
        origins = {question.origin for question in questions}
        found = repeats()
        keys = {row.key for row in found.instances if row.origin in origins}
        named = techniques()
        wanted = {key for key, name in named.items() if name in job.techniques}
        run = RunRow(f"{len(self.asked):032x}", NOW.isoformat(), "abc124", job.purpose, job.seed)
        batch = Batch([run], [self.device], found.instances, found.candidates)
        if job.purpose is Purpose.ERRORS:
            rows = [
                replace(
                    row,
                    run=run.key,
                    asked=replace(
                        row.asked,
                        code=self.codes.get(named[row.asked.candidate], row.asked.code),
                        device=self.device.key,
                    ),
                    figures={
                        name: value if value is None or not self.changed else value + self.changed
                        for name, value in row.figures.items()
                    },
                )
                for row in found.judgements
                if row.asked.instance in keys and row.asked.candidate in wanted
            ]
            batch = replace(batch, judgements=rows)
        else:
            taken = timings([self.number], self.slowed, self.codes)
            batch = replace(
                batch,
                timings=[
                    replace(row, run=run.key, asked=replace(row.asked, device=self.device.key))
                    for row in taken
                    if row.asked.instance in keys and row.asked.candidate in wanted
                ],
            )
        benchmark._store.add_batch(batch)
        benchmark.score.done = len(questions)
