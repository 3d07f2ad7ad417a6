"""`make bench`: how many instances a benchmark judges in a minute, and where its time goes.

First in this process, with one thread and every step watched; then as the command does it, with workers and a
store. The instances are spread evenly over the standard corpus.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

os.environ.setdefault("LP_NUM_THREADS", "1")

from rich.console import Console
from rich.table import Table

import selector.runner
import selector.truth
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.technique import ShadowPass
from renderers.world import World
from selector.benchmark.code_version import code_versions
from selector.benchmark.judging import Judge
from selector.benchmark.messages import Job
from selector.benchmark.planning import corpus_questions, planned, spread
from selector.benchmark.questions import Question, posed
from selector.benchmark.running import Benchmark, Order
from selector.benchmark.stopwatch import Stopwatch
from selector.candidate import candidates
from selector.evidence.rows import Purpose
from selector.evidence.store import Store

WIDTH, HEIGHT = 640, 512
METRICS, RENDERING = ("error figures", "continuity", "FLIP"), ("upload", "prepare", "render", "count")
OUTSIDE = ("scene",)


class Watch:
    """Wraps functions so that each adds its own seconds, less those of watched functions inside it."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._inner_s = [0.0]

    def wrapped(self, function: Callable[..., Any], part: str) -> Callable[..., Any]:
        """The function, watched."""

        def call(*arguments: Any, **named: Any) -> Any:
            self._inner_s.append(0.0)
            start = time.perf_counter()
            try:
                return function(*arguments, **named)
            finally:
                took_s = time.perf_counter() - start
                self.seconds[part] += took_s - self._inner_s.pop()
                self._inner_s[-1] += took_s

        return call


def passes() -> list[type[ShadowPass]]:
    """Every kind of pass that there is."""
    waiting, found = [ShadowPass], []
    while waiting:
        kind = waiting.pop()
        found.append(kind)
        waiting += kind.__subclasses__()
    return found


def watched(watch: Watch, alive: ExitStack) -> None:
    """Watch every step until `alive` ends."""

    def wrap(owner: Any, name: str, part: str) -> None:
        if name in vars(owner):
            alive.enter_context(patch.object(owner, name, watch.wrapped(getattr(owner, name), part)))

    for kind in passes():
        wrap(kind, "render", "render")
        wrap(kind, "count", "count")
    # These wait until the device is done.
    wrap(selector.runner.Runner, "_render", "render")
    wrap(selector.truth.Oracle, "_count_volumes", "render")
    wrap(selector.runner.Runner, "prepare", "prepare")
    wrap(selector.runner, "error_figures", "error figures")
    wrap(selector.runner, "mean_flip", "FLIP")
    wrap(selector.truth, "continuity", "continuity")
    wrap(World, "of", "upload")
    for name in ("read_mask", "read_domain", "read_picture", "read_surfaces"):
        wrap(Frame, name, "read-back")
    for name in ("draw_surfaces", "draw_domain", "shade", "look", "shine"):
        wrap(Frame, name, "render")


def alone(questions: list[Question], job: Job) -> dict[str, float]:
    """Seconds by step, in this process."""
    watch = Watch()
    with Gpu() as gpu, ExitStack() as alive:
        # Importing all techniques has defined all passes by now.
        watched(watch, alive)
        judge = Judge(gpu, job, lambda _: None)
        start = time.perf_counter()
        for question in questions:
            found = watch.wrapped(posed, "scene")(question, job.width, job.height)
            judge.answer(found, candidates(found.light.kind, gpu.device.limits), Stopwatch())
        total_s = time.perf_counter() - start
    return {**watch.seconds, "the rest": total_s - sum(watch.seconds.values())}


def together(questions: list[Question], job: Job, workers: int) -> Benchmark:
    """As the command does it."""
    with tempfile.TemporaryDirectory() as folder, Store.open(str(Path(folder, "evidence.sqlite"))) as store:
        benchmark = Benchmark(store, Order(job, questions, code_versions(), workers))
        for _ in benchmark.run():
            pass
    return benchmark


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--instances", type=int, default=52)
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--flip", action="store_true")
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    questions = spread(planned(corpus_questions("standard")), asked.instances)
    job = Job(Purpose.ERRORS, WIDTH, HEIGHT, timeout_s=16.0, flip=asked.flip)
    steps = alone(questions, job)
    rendering_s = sum(steps.get(name, 0.0) for name in RENDERING)
    harness_s = sum(s for name, s in steps.items() if name not in (*RENDERING, *METRICS, *OUTSIDE))
    table = Table("step", "s an instance", "of all", title=f"{len(questions)} instances, alone")
    total_s = sum(steps.values())
    for name, seconds in sorted(steps.items(), key=lambda one: -one[1]):
        table.add_row(name, f"{seconds / len(questions):.3f}", f"{100 * seconds / total_s:.1f} %")
    benchmark = together(questions, replace(job), asked.workers)
    minutes = benchmark.elapsed_s / 60
    store_s = benchmark.score.seconds["store"]
    overhead = (harness_s + store_s) / rendering_s
    console = Console()
    console.print(table)
    console.print(
        f"{asked.workers} workers: {len(questions) / minutes:.1f} instances a minute, "
        f"store {1e3 * store_s / sum(benchmark.score.statuses.values()):.1f} ms a candidate; "
        f"overhead of the harness over rendering {100 * overhead:.1f} % without error metrics"
    )
    if asked.json:
        record = {"steps_s": steps, "store_s": store_s, "minutes": minutes, "overhead": overhead}
        asked.json.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
