"""How `gnomon thesis` goes: progress while it measures, two tables when it is done."""

from __future__ import annotations

from pathlib import Path

from rich.text import Text

from api.cli.failures import InterruptedRunError
from api.cli.progress import MeasuringProgress
from api.cli.terminal import errors, print_json, printable, results
from api.cli.thesis_tables import print_findings, print_grades
from api.thesis import Order, Workload, export_scenes, result_record, thesis_check
from api.wording import counted, path_words

LONGEST_PATH = 4096


def run_thesis(order: Order, *, as_json: bool) -> None:
    """Measures, and says which orderings hold. One that does not is an answer, not a failure.

    Raises:
        DeviceError: There is no such device, or it cannot hold a scene.
    """
    with thesis_check(order) as work:
        _measure(work)
    if as_json:
        print_json(result_record(work))
        return
    console = results()
    print_findings(console, work.findings(), timed=work.order.thoroughness.rounds > 0)
    print_grades(console, work.grades())


def run_export(folder: Path, *, as_json: bool) -> None:
    """Writes the scenes, and says which files these are.

    Raises:
        OutputError: They cannot be written there.
    """
    paths = export_scenes(folder)
    if as_json:
        print_json({"written": [path_words(path) for path in paths]})
        return
    for path in paths:
        results().print(Text(f"Wrote {printable(str(path), LONGEST_PATH)}."), soft_wrap=True)


def _measure(work: Workload) -> None:
    console = errors()
    how = work.order.thoroughness
    rounds = counted(how.rounds, "round") if how.rounds else "no times"
    text = (
        f"Checking {counted(len(work.order.orderings), 'ordering')} by {counted(len(work.asks), 'set-up')} "
        f"at {how.width}x{how.height}, {rounds}, on {work.device.renderer}"
    )
    console.print(Text(printable(text)), soft_wrap=True)
    try:
        with MeasuringProgress(console, work.steps, "set-up") as progress:
            for _ in work.measured(progress.step):
                progress.light_done()
    except KeyboardInterrupt:
        done = f"{len(work.trials)} of {counted(len(work.asks), 'set-up')}"
        raise InterruptedRunError(f"{done} were measured.") from None
