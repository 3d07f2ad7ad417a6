"""How `gnomon rebenchmark` goes: progress, a summary, and the exit code; or one job after the other."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import typer
from rich.console import Console
from rich.text import Text

from api.cli.benchmark_progress import BenchmarkProgress
from api.cli.failures import EXIT_CALLS, InterruptedRunError, report
from api.cli.interruption import Interruption
from api.cli.progress import SECONDS_BETWEEN_LINES
from api.cli.rebenchmark_tables import print_report
from api.cli.terminal import errors, flush_results, print_json, printable, results
from api.destinations import check_page, check_writable
from api.rebenchmark_page import PAGE_BEGINNING
from api.rebenchmarking import (
    JSON_BEGINNING,
    LOCK,
    SAMPLE,
    Request,
    json_path,
    rebenchmark,
    report_record,
)
from scenes.errors import GnomonError, LevelError, OutputError
from selector.benchmark.running import Benchmark
from selector.evidence.store import Store
from selector.rebenchmark.locking import beside
from selector.rebenchmark.report import Report

TICK_S = 0.5
MODEL_BEGINNING = b"PK"
"""Models are ZIP archives."""


def run_rebenchmark(request: Request, every_s: float | None, *, as_json: bool) -> None:
    """Does the job, once or again and again.

    Raises:
        GnomonError: It cannot be done. What was stored before stays.
        Exit: Somebody should look: times have drifted, errors differ, or answers have moved.
    """
    _check_outputs(request)
    with Interruption() as interruption, _terminable():
        if every_s is None:
            calls = _once(request, interruption, as_json=as_json)
        else:
            calls = _again_and_again(request, every_s, interruption, as_json=as_json)
    if calls:
        flush_results()
        raise typer.Exit(EXIT_CALLS)


def _check_outputs(request: Request) -> None:
    """Refuse outputs that would destroy something, and levels that are not there, before hours are spent.

    Raises:
        OutputError: An output would.
        LevelError: There is no such level or folder.
    """
    _check_apart(request)
    check_page(request.report, PAGE_BEGINNING)
    _check_ours(json_path(request.report), JSON_BEGINNING, "no report of a re-benchmark", "-o")
    if request.learn:
        _check_ours(request.model, MODEL_BEGINNING, "no model", "--model")
    for place in request.levels:
        if not place.exists():
            raise LevelError(
                "There is no such file or folder.",
                where=str(place),
                remedy="Name levels, or folders that hold them, with --levels.",
            )


def _check_ours(path: Path, beginning: bytes, what: str, option: str) -> None:
    check_writable(path)
    with suppress(FileNotFoundError), path.open("rb") as file:
        if file.read(len(beginning)) not in (b"", beginning):
            raise OutputError(
                f"Another file is there, which is {what}: it is not overwritten.",
                where=str(path),
                remedy=f"Choose another name with {option}, or move that file away.",
            )


def _check_apart(request: Request) -> None:
    """The store, its companions, the model and the report are files of their own."""
    store = [Path(request.store)] if "://" not in request.store else []
    names = [*store, *(beside(request.store, suffix) for suffix in (LOCK, SAMPLE))]
    names += [request.model, request.report, json_path(request.report)]
    places = [os.path.realpath(name) for name in names]
    for name, place in zip(names, places, strict=True):
        if places.count(place) > 1:
            raise OutputError(
                "Two of the store, the model, the report and its JSON would be the same file.",
                where=str(name),
                remedy="Choose other names with --store, --model and -o.",
            )


def _once(request: Request, interruption: Interruption, *, as_json: bool) -> bool:
    try:
        found = rebenchmark(request, _Shown(errors(), interruption))
    except KeyboardInterrupt:
        raise InterruptedRunError(
            "The job was stopped before its end.",
            where=request.store,
            known="What was measured is kept, and the model in force is as it was.",
            remedy="The next job goes on from here.",
        ) from None
    _print(request, found, as_json=as_json)
    return found.calls


def _again_and_again(request: Request, every_s: float, interruption: Interruption, *, as_json: bool) -> bool:
    """Until it is stopped; stopped while it waits, it ends well."""
    console = errors()
    while True:
        begun = time.monotonic()
        try:
            _once(request, interruption, as_json=as_json)
            flush_results()
        except InterruptedRunError:
            raise
        except GnomonError as error:
            # What fails tonight may work tomorrow: a store that is held, a device that is gone.
            report(error)
        # A job that took longer than the interval lets one beginning go by.
        wait_s = every_s - (time.monotonic() - begun) % every_s
        console.print(
            Text(f"The next job begins in {wait_s / 3600:.1f} h; Ctrl-C ends this."), soft_wrap=True
        )
        try:
            _wait(wait_s, interruption)
        except KeyboardInterrupt:
            console.print(Text("Stopped; no job was running."), soft_wrap=True)
            interruption.forget()
            return False


def _wait(seconds: float, interruption: Interruption) -> None:
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        interruption.check()
        time.sleep(min(left, TICK_S))


@contextmanager
def _terminable() -> Iterator[None]:
    """In the block, SIGTERM, by which systemd stops a service, is as Ctrl-C."""

    def stop(number: int, frame: FrameType | None) -> None:
        del number, frame
        signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _print(request: Request, found: Report, *, as_json: bool) -> None:
    if not as_json:
        print_report(results(), found, request.report)
        return
    with Store.open(request.store, write=False) as store:
        print_json(report_record(found, store))


@dataclass
class _Shown:
    """Shows on a console how far a job is."""

    console: Console
    interruption: Interruption
    _last: float = 0.0

    def begins(self, words: str) -> None:
        """The next step begins."""
        self.interruption.check()
        self.console.print(Text(printable(words)), soft_wrap=True)

    def runs(self, benchmark: Benchmark, words: str) -> None:
        """Drives a benchmark to its end."""
        self.begins(words)
        with BenchmarkProgress(self.console, benchmark) as progress:
            for said in benchmark.run():
                self.interruption.check()
                progress.show(said)
        for remark in benchmark.notary.remarks:
            self.console.print(Text(f"The machine was not idle: {printable(remark)}"), soft_wrap=True)

    def advances(self, done: int, total: int, words: str = "") -> None:
        """So much of the step is done."""
        self.interruption.check()
        now = time.monotonic()
        if now - self._last >= SECONDS_BETWEEN_LINES:
            self._last = now
            more = f", {words}" if words else ""
            self.console.print(Text(printable(f"  {done} of {total}{more}")), soft_wrap=True)
