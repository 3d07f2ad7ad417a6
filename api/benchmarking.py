"""Benchmarks from outside: a request goes in, its plans are run one by one, and a summary comes out."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from api.corpus import level_files
from renderers.registry import technique
from scenes.errors import LevelError
from scenes.level_file import is_folder
from scenes.scene import Mobility
from selector.benchmark.code_version import code_versions, commit
from selector.benchmark.device_rows import software_threads
from selector.benchmark.messages import Job
from selector.benchmark.planning import corpus_questions, is_corpus, level_questions, planned
from selector.benchmark.questions import Question
from selector.benchmark.running import FRAME_TIMEOUT_S, UNTIMED_FACTOR, Benchmark, Order
from selector.evidence.rows import Purpose, Role
from selector.evidence.store import Store
from selector.policy import POLICIES

Json = dict[str, Any]


@dataclass(frozen=True)
class Request:
    """What to benchmark, and how.

    Attributes:
        sources: Corpora by name, level files, and folders of these.
        purposes: What is asked, in this order.
        store: Path or URL.
        width: Pixels across.
        height: Pixels down.
        techniques: Ids or labels; all where empty.
        rounds: Timed at most.
        time_limit_s: After that no further question is asked; None for no limit.
        workers: Processes for errors; as many as there are cores where None.
        device: Index or name; the first that works where None.
        role: What levels may be used for; corpora are for training.
        lights: At most so many of each level; all where None.
        views: At most so many of each light; all where None.
        seed: Of the shuffling.
        resume: Whether what is fresh in the store is left out.
        flip: Whether pictures are compared by FLIP.
    """

    sources: Sequence[str]
    purposes: Sequence[Purpose]
    store: str
    width: int
    height: int
    techniques: tuple[str, ...] = ()
    rounds: int = 10
    time_limit_s: float | None = None
    workers: int | None = None
    device: str | None = None
    role: Role = Role.TRAINING
    lights: int | None = None
    views: int | None = None
    seed: int = 1
    resume: bool = True
    flip: bool = False


@dataclass(frozen=True)
class Sources:
    """What was found of what is to be benchmarked.

    Attributes:
        questions: The most informative first.
        left_out: Levels in folders that no question can be asked about, with the reason.
    """

    questions: Sequence[Question]
    left_out: Sequence[LevelError] = field(default_factory=list)


def found_sources(request: Request) -> Sources:
    """Every question that the sources hold; levels are read for it.

    Raises:
        LevelError: A level that was named cannot be read, or holds nothing to ask.
        SpecError: A corpus cannot be made.
        UnknownTechniqueError: A technique is not known.
    """
    for name in request.techniques:
        technique(name)
    questions: list[Question] = []
    left_out: list[LevelError] = []
    for source in request.sources:
        if is_corpus(source):
            questions += corpus_questions(source)
            continue
        path = Path(source)
        for file in level_files(path) if is_folder(path) else [path]:
            try:
                questions += level_questions(file, request.role, request.lights, request.views)
            except LevelError as error:
                if file == path:
                    raise
                left_out.append(error)
    return Sources(planned(questions), left_out)


def benchmarks(request: Request, sources: Sources, store: Store) -> Iterator[Benchmark]:
    """The benchmarks of all purposes, each ready to be run when it is asked for."""
    begun = time.monotonic()
    deadline = None if request.time_limit_s is None else begun + request.time_limit_s
    codes = code_versions()
    for purpose in request.purposes:
        errors = purpose is Purpose.ERRORS
        job = Job(
            purpose=purpose,
            width=request.width,
            height=request.height,
            techniques=request.techniques,
            device=request.device,
            threads=software_threads(),
            rounds=request.rounds,
            timeout_s=FRAME_TIMEOUT_S * (UNTIMED_FACTOR if errors else 1.0),
            flip=request.flip,
            seed=request.seed,
        )
        workers = (request.workers or len(os.sched_getaffinity(0))) if errors else 1
        yield Benchmark(store, Order(job, sources.questions, codes, workers, deadline, request.resume))


def summary(request: Request, done: Sequence[Benchmark]) -> Json:
    """What came out, as JSON values."""
    device = next((asdict(one.device) for one in done if one.device), None)
    return {
        "store": request.store,
        "commit": commit(),
        "device": device,
        "resolution": [request.width, request.height],
        "runs": [_run_record(one) for one in done],
    }


def _run_record(benchmark: Benchmark) -> Json:
    score, tally = benchmark.score, benchmark.tally
    record = {
        "purpose": str(benchmark.order.job.purpose),
        "instances": score.total,
        "fresh": score.fresh,
        "answered": score.done - len(score.failed),
        "failed": [{"origin": origin, "reason": reason} for origin, reason in score.failed],
        "left": score.total - score.fresh - score.done,
        "statuses": {str(status): count for status, count in score.statuses.items()},
        "workers_lost": score.lost,
        "elapsed_s": round(benchmark.elapsed_s, 3),
        "seconds": {part: round(seconds, 3) for part, seconds in score.seconds.items()},
        "instances_per_minute": rate(benchmark),
        "remarks": list(benchmark.notary.remarks),
        "good_enough": {policy.name: dict(tally.good_enough(policy)) for policy in POLICIES},
    }
    if benchmark.order.job.purpose is Purpose.TIMES:
        record["wins"] = {
            str(mobility): {policy.name: dict(tally.wins(mobility, policy.name)) for policy in POLICIES}
            for mobility in Mobility
        }
        record["winner_is_right"] = {
            str(mobility): {policy.name: tally.sureness(mobility, policy.name) for policy in POLICIES}
            for mobility in Mobility
        }
        record["kendall_tau"] = tally.tau()
    return record


def rate(benchmark: Benchmark) -> float | None:
    """Instances a minute, start-up included; None before the first is done."""
    done = benchmark.score.done
    return round(done / benchmark.elapsed_s * 60, 2) if done else None
