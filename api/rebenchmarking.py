"""Re-benchmark jobs from outside: a request goes in, and a report is left behind."""

from __future__ import annotations

import json
import os
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Protocol

from api.benchmarking import Request as BenchmarkRequest
from api.benchmarking import benchmarks, found_sources
from api.rebenchmark_model import Fitting, judged_model, previous_digest
from api.rebenchmark_page import page_bytes
from api.rebenchmark_sampling import Sampling
from api.rebenchmark_watch import watched, watched_levels
from models.artifact import Artifact
from models.evaluation import OUTER_FOLDS
from renderers.clock import truthful_clock
from renderers.context import Gpu
from renderers.registry import TECHNIQUES, technique
from scenes.atomic_file import write_atomically
from selector.benchmark.code_version import code_versions, commit
from selector.benchmark.device_rows import device_row, software_threads
from selector.benchmark.running import Benchmark
from selector.evidence.rows import DeviceRow, InstanceRow, Purpose
from selector.evidence.store import Store
from selector.evidence.superseding import remark
from selector.policy import Policy
from selector.rebenchmark.locking import beside, locked
from selector.rebenchmark.origins import Asking, asking
from selector.rebenchmark.remeasuring import Bench, stale_orders
from selector.rebenchmark.report import Json, Judged, Report, Sampled, Watched, record
from selector.rebenchmark.scratch import began, begun_sample, bring_in, discard
from selector.rebenchmark.staleness import Freshness, Reason, freshness, predecessor

LOCK, SAMPLE = ".rebenchmark.lock", ".rebenchmark.sample"
JSON_BEGINNING = b'{\n  "format": "gnomon rebenchmark"'
"""How the JSON of a report begins, and no other JSON does."""


@dataclass(frozen=True)
class Request:
    """What a job is to do.

    Attributes:
        store: Path or URL of the evidence.
        model: The model in force, which a better one replaces.
        report: The page; the JSON lies beside it.
        levels: Files and folders: watched levels, and where levels are that evidence comes from.
        policy: Under which watched lights are asked about.
        size: Of the views of watched lights, in pixels.
        sample: How many instances are measured again to find drift.
        seed: Of the sample; the day's date where None.
        max_age: Times that are older are stale.
        rounds: Timed at most.
        time_limit_s: After that no further instance is asked; None for no limit.
        workers: Processes for errors; as many as there are cores where None.
        device: Index or name; the first that works where None.
        techniques: Ids or labels of those that are looked after; all where empty.
        corpus: What a first run measures.
        resolution: Of the views of a first run.
        learn: Whether a model is learnt at all.
        folds: In which two models are compared.
    """

    store: str
    model: Path
    report: Path
    levels: Sequence[Path]
    policy: Policy
    size: tuple[int, int]
    sample: int = 24
    seed: int | None = None
    max_age: timedelta = timedelta(days=90)
    rounds: int = 10
    time_limit_s: float | None = None
    workers: int | None = None
    device: str | None = None
    techniques: tuple[str, ...] = ()
    corpus: Sequence[str] = ("quick",)
    resolution: tuple[int, int] = (640, 512)
    learn: bool = True
    folds: int = OUTER_FOLDS


class Listener(Protocol):
    """Hears how far a job is, and may end it by raising KeyboardInterrupt."""

    def begins(self, words: str) -> None:
        """The next step begins."""

    def runs(self, benchmark: Benchmark, words: str) -> None:
        """Drives a benchmark to its end."""

    def advances(self, done: int, total: int, words: str = "") -> None:
        """So much of the step is done."""


@dataclass(frozen=True)
class Machine:
    """Where all is measured.

    Attributes:
        bench: How.
        device: The device as the store keeps it.
    """

    bench: Bench
    device: DeviceRow


def machine(request: Request) -> Machine:
    """The device and the code of today.

    Raises:
        DeviceError: There is no such device.
        UnknownTechniqueError: A technique is not known.
    """
    wanted = {technique(name).name for name in request.techniques} or {one.name for one in TECHNIQUES}
    codes = {name: code for name, code in code_versions().items() if name in wanted}
    threads = software_threads()
    with Gpu(request.device) as gpu:
        row = device_row(gpu.device, truthful_clock(gpu), threads)
    bench = Bench(
        codes=codes,
        device=request.device,
        threads=threads,
        rounds=request.rounds,
        workers=request.workers or len(os.sched_getaffinity(0)),
    )
    return Machine(bench, row)


def rebenchmark(
    request: Request, listener: Listener, on: Machine | None = None, now: datetime | None = None
) -> Report:
    """Does the job, and leaves the report.

    Args:
        request: What.
        listener: Hears of every step.
        on: Where; found out where None.
        now: What the clock says.

    Raises:
        BusyError: Another job is at work on the store.
        GnomonError: The store, the device or an output cannot be used. What was there before is whole.
    """
    # A store that cannot be opened leaves no lock behind.
    with Store.open(request.store) as store, locked(beside(request.store, LOCK)):
        return _Job(request, listener, store, on or machine(request), now or datetime.now(UTC)).run()


def json_path(report: Path) -> Path:
    """Where a report's JSON lies."""
    return report.with_suffix(".json")


def report_record(report: Report, store: Store) -> Json:
    """A report as JSON values."""
    return record(
        report, {row.key: row for row in store.instances()}, {row.key: row for row in store.candidates()}
    )


@dataclass
class _Job:
    request: Request
    listener: Listener
    store: Store
    machine: Machine
    now: datetime
    begun: float = field(default_factory=time.monotonic)

    def run(self) -> Report:
        """All steps."""
        request, device = self.request, self.machine.device
        limit_s = request.time_limit_s
        deadline = None if limit_s is None else self.begun + limit_s
        sample_path = beside(request.store, SAMPLE)
        today = int(self.now.strftime("%Y%m%d"))
        # A sample that was begun before midnight is gone on with after it.
        seed = begun_sample(sample_path, self.now)
        seed = seed if seed is not None else (today if request.seed is None else request.seed)
        self.bench = replace(self.machine.bench, deadline=deadline, seed=seed)
        # The report of before is overwritten as soon as drift is known.
        self.judged_before = previous_digest(json_path(request.report))
        self.former = predecessor(device, list(self.store.devices()), self.store.dated())
        fresh = self._freshness()
        report = Report(
            started=self.now.isoformat(timespec="seconds"),
            elapsed_s=0.0,
            finished=False,
            store=request.store,
            commit=commit(),
            device=device,
            former=self._former_if_used(fresh),
        )
        return self._next(report, fresh, sample_path) if fresh.parts else self._first(report)

    def _first(self, report: Report) -> Report:
        """A baseline, where there is nothing to compare with."""
        request = self.request
        self.listener.begins("There is nothing to compare with yet: a baseline is measured")
        wanted = BenchmarkRequest(
            sources=request.corpus,
            purposes=tuple(Purpose),
            store=request.store,
            width=request.resolution[0],
            height=request.resolution[1],
            techniques=request.techniques,
            rounds=request.rounds,
            time_limit_s=request.time_limit_s,
            workers=request.workers,
            device=request.device,
        )
        counts: Counter[str] = Counter()
        for benchmark in benchmarks(wanted, found_sources(wanted), self.store):
            self._drive(benchmark, counts)
        report = replace(report, baseline=True, remeasured=dict(counts))
        return self._finish(report, ("there was no evidence of this device",))

    def _next(self, report: Report, fresh: Freshness, sample_path: Path) -> Report:
        """Sample, drift, what is affected, models, lights."""
        rows = {row.key: row for row in self.store.instances()}
        concerned = [rows[key] for key in dict.fromkeys(key for key, _ in sorted(fresh.parts))]
        self.listener.begins(f"Looking at {len(concerned):,} instances")
        asked = asking(concerned, self.request.levels)
        with ExitStack() as open_stores:
            scratch = open_stores.enter_context(Store.open(str(sample_path)))
            here, runs = self.machine.device, self.listener.runs
            sampling = Sampling(self.store, scratch, self.bench, here, self.former, rows, asked, runs)
            sampled = sampling.taken(fresh.parts, self.request.sample)
            causes = self._causes(sampled, fresh)
            report = replace(
                report, stale=fresh.counts(), unreachable=asked.problems, sampled=sampled, causes=causes
            )
            # Whatever happens to the rest of the job, what the sample says is not lost.
            self._leave(report)
            if causes:
                bring_in(self.store, scratch, self._remarks(sampled, fresh, began(scratch)))
        discard(sample_path)
        if causes:
            report = self._bring_up_to_date(report, rows, asked)
        return self._finish(report, causes)

    def _causes(self, sampled: Sampled, fresh: Freshness) -> tuple[str, ...]:
        """Why evidence and model have to change; nothing where all is as it was."""
        words = {
            Reason.DEVICE: "the driver or the device has changed",
            Reason.CODE: "the code of a technique has changed",
            Reason.DRIFT: "times that had drifted were left to be measured again",
            Reason.AGE: "times are older than they may be",
        }
        found = [words[reason] for reason in Reason if reason in fresh.stale.values()]
        if any(one.alarm for one in sampled.shifts):
            found.append("times have drifted")
        return tuple(found)

    def _remarks(self, sampled: Sampled, fresh: Freshness, moment: str) -> list[str]:
        """What no longer holds: of drifted techniques all of before, of old ones what is too old."""
        drifted = {one.technique for one in sampled.shifts if one.alarm}
        aged = {name for (_, name), reason in fresh.stale.items() if reason is Reason.AGE}
        found = [remark(name, moment) for name in sorted(drifted)]
        return found + [remark(name, self._oldest_allowed()) for name in sorted(aged - drifted)]

    def _bring_up_to_date(self, report: Report, rows: Mapping[str, InstanceRow], asked: Asking) -> Report:
        stale = self._freshness().stale
        counts: Counter[str] = Counter()
        for order in stale_orders(self.bench, stale, asked.questions, rows):
            self._drive(Benchmark(self.store, order), counts)
        left = sum(instance in asked.questions for instance, _ in self._freshness().stale)
        return replace(report, remeasured=dict(counts), left=left)

    def _drive(self, benchmark: Benchmark, counts: Counter[str]) -> None:
        order = benchmark.order
        words = f"{str(order.job.purpose).capitalize()} of {len(order.questions)} instances"
        self.listener.runs(benchmark, words)
        counts[str(order.job.purpose)] += benchmark.score.done - len(benchmark.score.failed)

    def _finish(self, report: Report, causes: tuple[str, ...]) -> Report:
        judged, old, new = None, None, None
        if self.request.learn:
            judged, old, new = self._models(causes)
        shown = report.sampled.shifts if report.sampled else ()
        found: Watched | None = None
        if self.request.levels:
            self.listener.begins("Asking about watched lights")
            levels, problems = watched_levels(self.request.levels)
            in_force = judged is not None and judged.decision.promoted
            found = watched(levels, problems, old, new, self.request, shown, in_force=in_force)
        report = replace(report, causes=causes, judged=judged, watched=found, finished=True)
        return self._leave(report)

    def _models(self, causes: tuple[str, ...]) -> tuple[Judged | None, Artifact | None, Artifact | None]:
        fitting = Fitting(
            store=self.store,
            device=self.machine.device,
            former=self.former,
            places=self.request.levels,
            target=self.request.model,
            now=self.now,
            causes=causes,
            folds=self.request.folds,
            judged_before=self.judged_before,
        )
        return judged_model(fitting, self.listener.begins, self.listener.advances)

    def _freshness(self) -> Freshness:
        return freshness(
            self.store.dated(),
            self.machine.device.key,
            self.former.key if self.former else None,
            self.bench.codes,
            self.store.marks(),
            self._oldest_allowed(),
        )

    def _oldest_allowed(self) -> str:
        return (self.now - self.request.max_age).isoformat(timespec="seconds")

    def _former_if_used(self, fresh: Freshness) -> DeviceRow | None:
        return self.former if Reason.DEVICE in fresh.stale.values() else None

    def _leave(self, report: Report) -> Report:
        """Writes the report as it stands: the JSON, then the page."""
        digest = report.judged.digest if report.judged else ""
        report = replace(
            report, elapsed_s=time.monotonic() - self.begun, judged_digest=digest or self.judged_before
        )
        values = report_record(report, self.store)
        text = json.dumps(values, indent=2, allow_nan=False).encode() + b"\n"
        write_atomically(json_path(self.request.report), text)
        write_atomically(self.request.report, page_bytes(values))
        return report
