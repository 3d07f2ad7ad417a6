"""How `gnomon annotate` goes: progress while it measures, a table when it is done."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import typer
from rich.console import Console
from rich.text import Text

from api.annotating import Order, Workload, clear_level, result_record, workload, write_results
from api.cli.annotation_table import print_answers
from api.cli.failures import EXIT_INCOMPLETE, InterruptedRunError, internal, report
from api.cli.level_warnings import print_left_behind, print_warnings
from api.cli.progress import MeasuringProgress
from api.cli.terminal import errors, flush_results, print_json, printable, results
from api.wording import counted, path_words
from scenes.errors import GnomonError, OutputError
from selector.candidate import candidates
from selector.level_measuring import Answer

MOST_FILES = 10
LONGEST_PATH = 4096
"""What Linux takes: the path of a result is never shortened."""


def run_annotate(order: Order, *, as_json: bool) -> None:
    """Measures, writes, and says what came out.

    Raises:
        GnomonError: Something is wrong with the level, the device or an output, before any light was done.
        Exit: Some lights have no recommendation, or an output could not be written.
    """
    with workload(order) as work:
        found = _measured(work)
        written = write_results(work, found)
    try:
        _print_result(work, found, written, as_json=as_json)
    except OutputError as error:
        work.problems.append(error)
    for problem in work.problems:
        report(problem)
    if work.problems:
        raise typer.Exit(work.problems[0].exit_code)
    if any(answer.recommendation is None for answer in found):
        raise typer.Exit(EXIT_INCOMPLETE)


def _print_result(work: Workload, found: Sequence[Answer], written: Sequence[Path], *, as_json: bool) -> None:
    if as_json:
        print_json(result_record(work, found, written))
    else:
        console = results()
        print_answers(console, work, found)
        _print_outputs(console, work, written)
    flush_results()


def run_clear(level: Path, target: Path, *, in_place: bool, as_json: bool) -> None:
    """Takes the annotation out, and says whether the original bytes are back.

    Raises:
        GnomonError: Something is wrong with the level or the output.
    """
    clearing = clear_level(level, target, in_place=in_place)
    print_left_behind(errors(), clearing.left_behind)
    if as_json:
        print_json(
            {
                "level": path_words(level),
                "output": path_words(target) if clearing.written else None,
                "restored": clearing.restored,
                "note": clearing.note,
            }
        )
        return
    console = results()
    console.print(Text(clearing.note), soft_wrap=True)
    if clearing.written:
        console.print(Text(f"Wrote {printable(str(target))}."), soft_wrap=True)


def _measured(work: Workload) -> list[Answer]:
    console = errors()
    _announce(console, work)
    found: list[Answer] = []
    progress = MeasuringProgress(console, work.steps)
    try:
        with progress:
            for answer in work.measured(progress.step):
                found.append(answer)
                progress.light_done()
    except KeyboardInterrupt:
        raise _interrupted(work, len(found)) from None
    except Exception as error:
        if not found:
            raise
        # What was measured until then is still worth its level.
        work.problems.append(error if isinstance(error, GnomonError) else internal(error))
    return found


def _announce(console: Console, work: Workload) -> None:
    plan, lights = work.order.request.plan, [one.light for one in work.seen]
    techniques = work.order.request.techniques
    counts = {len(candidates(light.kind, work.device.limits, techniques)) for light in lights}
    views = {len(one.cameras) for one in work.seen}
    text = (
        f"Measuring {counted(len(lights), 'light')} with {_range(counts, 'candidate')} "
        f"in {_range(views, 'view')}, {plan.width}x{plan.height}, {counted(plan.rounds, 'round')}, "
        f"on {work.device.renderer}"
    )
    if work.lights_file:
        name = printable(str(work.lights_file), LONGEST_PATH)
        console.print(Text(f"Wrote {name} with the lights added."), soft_wrap=True)
    console.print(Text(printable(text)), soft_wrap=True)
    print_warnings(console, work.level)
    print_left_behind(console, work.left_behind)


def _interrupted(work: Workload, done: int) -> InterruptedRunError:
    order = work.order
    beside = f" Pictures of the lights that were done are in {order.pictures}." if order.pictures else ""
    lights = f" {work.lights_file} was written before." if work.lights_file else ""
    return InterruptedRunError(
        f"{done} of {counted(len(work.seen), 'light')} were measured; {order.target} was not written.",
        known=f"{order.level} is untouched.{lights}{beside}",
    )


def _print_outputs(console: Console, work: Workload, written: Sequence[Path]) -> None:
    order, problems = work.order, work.problems
    if written:
        more = len(written) - MOST_FILES
        first = [] if more <= 0 else [f"{counted(more, 'more file')}"]
        listed = [*map(str, written[: MOST_FILES - 1]), *first, str(written[-1])] if more > 0 else written
        console.print(
            Text(f"Wrote {', '.join(printable(str(one), LONGEST_PATH) for one in listed)}."), soft_wrap=True
        )
    elif not problems:
        console.print(Text("No level was written: there is nothing to annotate it with."), soft_wrap=True)
    if order.pictures and not problems:
        console.print(Text(f"Pictures are in {printable(str(order.pictures))}."), soft_wrap=True)
    if order.measurements and not problems:
        console.print(Text(f"Measurements are in {printable(str(order.measurements))}."), soft_wrap=True)


def _range(numbers: set[int], what: str) -> str:
    low, high = min(numbers), max(numbers)
    return counted(low, what) if low == high else f"{low} to {high} {what}s"
