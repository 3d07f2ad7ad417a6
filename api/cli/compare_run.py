"""How `gnomon compare` goes: progress while it measures, a line for each light when it is done."""

from __future__ import annotations

import typer
from rich.console import Console
from rich.text import Text

from api.cli.failures import EXIT_INCOMPLETE, InterruptedRunError
from api.cli.level_warnings import print_warnings
from api.cli.progress import MeasuringProgress
from api.cli.terminal import errors, print_json, printable, printable_name, results
from api.comparing import Order, Workload, comparison, result_record, write_page
from api.wording import amount, counted

LONGEST_PATH = 4096


def run_compare(order: Order, *, as_json: bool) -> None:
    """Measures, writes the page, and says what came out.

    Raises:
        GnomonError: Something is wrong with the level, the device or the page; nothing was written then.
        Exit: Some lights have no recommendation; the page says why.
    """
    with comparison(order) as work:
        _measure(work)
        size = write_page(work)
    if as_json:
        print_json(result_record(work, size))
    else:
        _print_result(results(), work, size)
    if any(answer.recommendation is None for answer in work.answers):
        raise typer.Exit(EXIT_INCOMPLETE)


def _measure(work: Workload) -> None:
    console = errors()
    plan = work.order.request.plan
    text = (
        f"Comparing {counted(len(work.seen), 'light')} at {plan.width}x{plan.height}, "
        f"{counted(plan.rounds, 'round')}, on {work.device.renderer}"
    )
    console.print(Text(printable(text)), soft_wrap=True)
    if work.left_out:
        console.print(
            Text(f"{counted(work.left_out, 'more light')} left out; --light chooses others."), soft_wrap=True
        )
    print_warnings(console, work.level)
    try:
        with MeasuringProgress(console, work.steps) as progress:
            for _ in work.measured(progress.step):
                progress.light_done()
    except KeyboardInterrupt:
        done = f"{len(work.answers)} of {counted(len(work.seen), 'light')}"
        raise InterruptedRunError(f"{done} were compared; {work.order.target} was not written.") from None


def _print_result(console: Console, work: Workload, size: int) -> None:
    for part in work.parts:
        said = part.recommendation.reason if part.recommendation else f"no recommendation. {part.problem}"
        console.print(Text.assemble((printable_name(part.name), "bold"), f": {said}"), soft_wrap=True)
    target = printable(str(work.order.target), LONGEST_PATH)
    console.print(Text(f"Wrote {target}, {amount(size)}: open it in a browser."), soft_wrap=True)
