"""Records `repeats.npz`: small instances timed again and again by code that does not change.

    python -m tests.selector.record_repeats STORE    # one run more; 22 times, the first judges errors
    python -m tests.selector.record_repeats --pack STORE

A run takes about a minute. What is in the file, and how it becomes a store again, is in `repeated_runs.py`.
"""

from __future__ import annotations

import sys
from dataclasses import replace

from scenes.corpus.corpora import corpus
from selector.benchmark.code_version import code_versions
from selector.benchmark.device_rows import software_threads
from selector.benchmark.messages import Job
from selector.benchmark.questions import SpecQuestion
from selector.benchmark.running import Benchmark, Order
from selector.evidence.rows import Purpose
from selector.evidence.store import Store
from selector.learning.featuring import features_of
from tests.selector.repeated_runs import PATH, pack

INSTANCES, ROUNDS = 24, 5
WIDTH, HEIGHT = 160, 128
TECHNIQUES = ("SM", "SV", "Chan")


def run(store: Store) -> str:
    """Judges all instances where that is still to be done, else times them once more."""
    smallest = sorted(corpus("quick"), key=lambda one: one.triangles)[:INSTANCES]
    asked = [SpecQuestion(spec) for spec in smallest]
    threads = software_threads()
    job = Job(Purpose.ERRORS, WIDTH, HEIGHT, TECHNIQUES, threads=threads, rounds=ROUNDS, timeout_s=60.0)
    order = Order(job, asked, code_versions(), resume=False)
    if not any(True for _ in store.judgements()):
        _run(store, order)
        features_of(store, list(store.instances()), None, lambda *_: None)
        return "errors and features"
    number = len({row.seed for row in store.runs() if row.purpose is Purpose.TIMES})
    _run(store, replace(order, job=replace(job, purpose=Purpose.TIMES, seed=number)))
    return f"run {number}"


def _run(store: Store, order: Order) -> None:
    for _ in Benchmark(store, order).run():
        pass


if __name__ == "__main__":
    *wish, path = sys.argv[1:]
    with Store.open(path) as opened:
        if wish:
            PATH.write_bytes(pack(opened))
        else:
            sys.stdout.write(run(opened) + "\n")
