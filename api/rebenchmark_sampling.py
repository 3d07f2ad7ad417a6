"""The sample of a re-benchmark job: part of the evidence is measured again and held against what is known.

Errors are judged in every family in turn, for they do not depend on how busy the machine is or was. Times are
taken where those of before are worth comparing with.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from api.wording import counted
from selector.benchmark.running import Benchmark
from selector.evidence.rows import DeviceRow, InstanceRow, Judgement, Purpose, Timing
from selector.evidence.store import Store
from selector.measurement import Status
from selector.rebenchmark.drift import shifts
from selector.rebenchmark.origins import Asking
from selector.rebenchmark.pairing import Paired, differences, holding, newest_code, paired
from selector.rebenchmark.remeasuring import Bench, sample_orders
from selector.rebenchmark.report import Sampled
from selector.rebenchmark.sampling import sample
from selector.rebenchmark.staleness import Part
from selector.rebenchmark.telling import Told, telling, told

RETRIES = 2
"""Instances that other programs have disturbed are timed again so often."""


@dataclass
class Sampling:
    """Where a sample comes from, and where it is taken into.

    Attributes:
        store: The evidence.
        scratch: A store for the sample.
        bench: How all is measured.
        device: On which.
        former: The device by its driver of before, if there was one.
        rows: Instance's key -> instance.
        asked: What can be asked again.
        runs: Drives a benchmark to its end.
    """

    store: Store
    scratch: Store
    bench: Bench
    device: DeviceRow
    former: DeviceRow | None
    rows: Mapping[str, InstanceRow]
    asked: Asking
    runs: Callable[[Benchmark, str], None]
    _failed: dict[str, str] = field(default_factory=dict)
    _remarks: dict[str, None] = field(default_factory=dict)

    def taken(self, parts: Collection[Part], size: int) -> Sampled:
        """Measures the sample, and says what has come out.

        Args:
            parts: Instances and techniques that there is evidence of.
            size: How many instances.
        """
        techniques = self._askable(parts)
        families = {key: self.rows[key].family for key in techniques}
        judged = sample(techniques, families, size, self.bench.seed)
        self._take(Purpose.ERRORS, {key: techniques[key] for key in judged})
        compared, differing = differences(self._judgements(judged), self.scratch.judgements())
        worth = self._telling(techniques)
        timed = sample(worth, families, size, self.bench.seed)
        found = self._timed({key: worth[key] for key in timed})
        measured = {key for by_instance in found.ratios.values() for key in by_instance}
        return Sampled(
            seed=self.bench.seed,
            wanted=len(timed),
            measured=len(measured),
            disturbed=len(found.disturbed),
            canary_ratio=found.canary_ratio,
            families=len({families[key] for key in measured}),
            shifts=shifts({subject: list(logs.values()) for subject, logs in found.ratios.items()}),
            compared=compared,
            differences=differing,
            failed=tuple(self._failed.items()),
            remarks=tuple(self._remarks),
        )

    def _askable(self, parts: Collection[Part]) -> dict[str, list[str]]:
        """Instance's key -> techniques of which times are known."""
        here = {self.device.key, self.former.key if self.former else None}
        timed = {
            (one.instance, one.technique)
            for one in self.store.dated()
            if one.status is Status.OK and one.device in here
        }
        found: dict[str, list[str]] = defaultdict(list)
        for instance, name in sorted(timed.intersection(parts)):
            if instance in self.asked.questions:
                found[instance].append(name)
        return found

    def _telling(self, techniques: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
        """Of those, what has times of before that are worth comparing with."""
        names = {row.key: row.technique for row in self.store.candidates()}
        started = {row.key: row.started for row in self.store.runs()}
        here, former = (
            told(self.store.timings(device=one.key), started, self.store.marks(), names) if one else Told()
            for one in (self.device, self.former)
        )
        return telling(here, former, techniques)

    def _take(self, purpose: Purpose, wanted: Mapping[str, Sequence[str]], *, again: bool = False) -> None:
        orders = sample_orders(self.bench, purpose, wanted, self.asked.questions, self.rows, again=again)
        for order in orders:
            benchmark = Benchmark(self.scratch, order)
            self.runs(benchmark, f"Sample, {purpose} of {counted(len(order.questions), 'instance')}")
            self._failed |= dict(benchmark.score.failed)
            self._remarks |= dict.fromkeys(benchmark.notary.remarks)

    def _timed(self, wanted: Mapping[str, Sequence[str]]) -> Paired:
        """Times the sample, and again what other programs have disturbed; old and new side by side."""
        left = wanted
        for attempt in range(1 + RETRIES):
            self._take(Purpose.TIMES, left, again=attempt > 0)
            found = self._paired(list(wanted))
            left = {key: names for key, names in wanted.items() if key in found.disturbed}
            if not left or self._late():
                break
        return found

    def _paired(self, keys: Sequence[str]) -> Paired:
        techniques = {row.key: row.technique for row in self.store.candidates()}
        techniques |= {row.key: row.technique for row in self.scratch.candidates()}
        started = {row.key: row.started for row in self.store.runs()}
        marks = self.store.marks()

        def before(device: DeviceRow | None) -> list[Timing]:
            if device is None:
                return []
            timings = [row for key in keys for row in self.store.timings(device=device.key, instance=key)]
            return holding(newest_code(timings, started), started, marks, techniques)

        # A sample that a killed job has left may hold other instances too.
        new = [row for row in self.scratch.timings() if row.asked.instance in set(keys)]
        return paired(before(self.device), new, before(self.former), techniques)

    def _late(self) -> bool:
        return self.bench.deadline is not None and time.monotonic() >= self.bench.deadline

    def _judgements(self, keys: Iterable[str]) -> list[Judgement]:
        codes = list(self.bench.codes.values())
        return [
            row
            for key in keys
            for row in self.store.judgements(device=self.device.key, instance=key, codes=codes)
        ]
