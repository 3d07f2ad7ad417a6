"""How `gnomon benchmark` goes: who wins while it measures, a summary when it is done."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from api.benchmarking import Request, benchmarks, found_sources, summary
from api.cli.benchmark_progress import BenchmarkProgress
from api.cli.benchmark_tables import print_summary
from api.cli.failures import InterruptedRunError
from api.cli.interruption import Interruption
from api.cli.terminal import errors, print_json, printable, results
from api.wording import counted
from selector.benchmark.running import Benchmark
from selector.evidence.rows import Purpose
from selector.evidence.store import Store

_ASKED = {Purpose.ERRORS: "Errors and counters", Purpose.TIMES: "Times"}


def run_benchmark(request: Request, *, as_json: bool) -> None:
    """Measures, stores, and says what came out.

    Raises:
        GnomonError: A level, the device or the store cannot be used. What was stored before stays.
    """
    console = errors()
    done: list[Benchmark] = []
    with Interruption() as interruption, Store.open(request.store) as store:
        sources = found_sources(request)
        for error in sources.left_out:
            console.print(Text(f"left out: {printable(str(error))}"), soft_wrap=True)
        for benchmark in benchmarks(request, sources, store):
            done.append(benchmark)
            try:
                _run(console, benchmark, interruption)
            except KeyboardInterrupt:
                raise _interrupted(request, benchmark) from None
    if as_json:
        print_json(summary(request, done))
    else:
        print_summary(results(), request, done)


def _run(console: Console, benchmark: Benchmark, interruption: Interruption) -> None:
    job = benchmark.order.job
    asked = counted(benchmark.score.total, "instance")
    size = f"{job.width}x{job.height}"
    console.print(Text(f"{_ASKED[job.purpose]} of {asked} at {size}"), soft_wrap=True)
    with BenchmarkProgress(console, benchmark) as progress:
        for words in benchmark.run():
            interruption.check()
            progress.show(words)
    for remark in benchmark.notary.remarks:
        console.print(Text(f"The machine was not idle: {printable(remark)}"), soft_wrap=True)


def _interrupted(request: Request, benchmark: Benchmark) -> InterruptedRunError:
    score = benchmark.score
    done = f"{score.fresh + score.done} of {counted(score.total, 'instance')}"
    return InterruptedRunError(
        f"{_ASKED[benchmark.order.job.purpose]} of {done} are in the store.",
        where=request.store,
        remedy="The same command goes on from here.",
    )
