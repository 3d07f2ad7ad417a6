"""Small benchmarks for tests: cheap scenes, few pixels, and code that never changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from renderers.registry import TECHNIQUES
from scenes.corpus.spec import Spec
from selector.benchmark.crew import Bounds
from selector.benchmark.messages import Job, Part
from selector.benchmark.questions import Question, SpecQuestion
from selector.benchmark.running import Benchmark, Order
from selector.evidence.rows import InstanceRow, Judgement, Purpose, Timing
from selector.evidence.store import Store
from tests.selector.faulty_techniques import FAULTS, enter_faulty

WIDTH, HEIGHT = 64, 48
SPECS = (Spec("still_life", seed=3, triangles=100), Spec("box_grid", seed=5, triangles=178))
CODES = {name: f"{number:032x}" for number, name in enumerate([*(one.name for one in TECHNIQUES), *FAULTS])}
SILENCE_S = 10.0


def questions() -> list[Question]:
    return [SpecQuestion(spec) for spec in SPECS]


def job(purpose: Purpose, **more: Any) -> Job:
    return Job(purpose, WIDTH, HEIGHT, **{"techniques": ("SM", "SV"), "timeout_s": 60.0, "rounds": 3, **more})


def order(purpose: Purpose, asked: Sequence[Question] | None = None, **more: Any) -> Order:
    return Order(job(purpose), questions() if asked is None else asked, CODES, **more)


def faulty_order(
    purpose: Purpose, *faults: str, memory_bytes: int = 1 << 40, silence_s: float = 120.0
) -> Order:
    """One question to a worker that knows these faults, and is soon given up."""
    return Order(
        job(purpose, techniques=()),
        questions()[:1],
        CODES,
        bounds=Bounds(dict.fromkeys(Part, 120.0) | {Part.CANDIDATE: silence_s}, memory_bytes),
        entry=partial(enter_faulty, faults),
    )


def ran(path: Path, wanted: Order) -> Benchmark:
    """A benchmark that has run to its end."""
    with Store.open(str(path)) as store:
        benchmark = Benchmark(store, wanted)
        for _ in benchmark.run():
            pass
    return benchmark


def judgements(path: Path, codes: Mapping[str, str] = CODES) -> dict[tuple[str, str], Judgement]:
    """(instance, technique and settings) -> judgement by this code; each is there once."""
    with Store.open(str(path), write=False) as store:
        names = {row.key: f"{row.technique} {dict(row.settings)}" for row in store.candidates()}
        rows = list(store.judgements(codes=list(codes.values())))
    found = {(row.asked.instance, names[row.asked.candidate]): row for row in rows}
    assert len(found) == len(rows)
    return found


def timings(path: Path) -> list[Timing]:
    with Store.open(str(path), write=False) as store:
        return list(store.timings())


def instances(path: Path) -> list[InstanceRow]:
    with Store.open(str(path), write=False) as store:
        return list(store.instances())


def facts(path: Path) -> dict[tuple[str, str], object]:
    """What was found out, without the run that did."""
    return {
        key: (row.asked, row.status, row.reason, row.memory_bytes, row.truth, row.figures, row.counters)
        for key, row in judgements(path).items()
    }
