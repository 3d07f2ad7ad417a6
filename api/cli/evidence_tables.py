"""The tables of `gnomon evidence`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import median
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable, printable_name
from api.wording import amount, counted

_COUNTS = ("judgements", "timings", "samples")
_MOST_FAILURES = 20


def print_listed(console: Console, found: dict[str, Any]) -> None:
    """Devices with techniques, families and runs of a store."""
    size = amount(found["bytes"]) if found["bytes"] is not None else "not a file"
    console.print(Text(f"{printable(found['store'])}: {size}"), soft_wrap=True)
    for device in found["devices"]:
        of_device = [one for one in found["techniques"] if one["device"] == device["key"]]
        kind = f"virtual, {device['virtual']}" if device["virtual"] else device["gl_version"]
        title = f"{device['key'][:8]}  {printable_name(device['renderer'])} ({printable_name(kind)})"
        console.print(
            _counted_table(title, ("technique", "code", ""), [_technique(one) for one in of_device])
        )
    families = [
        ((printable_name(one["family"]), one["role"], counted(one["instances"], "instance")), one)
        for one in found["families"]
    ]
    console.print(_counted_table("families", ("family", "role", ""), families))
    runs = [((one["started"], one["purpose"], one["key"][:8]), one) for one in found["runs"]]
    console.print(_counted_table("runs", ("started", "purpose", "key"), runs))
    for one in found["extractors"]:
        console.print(f"features of {counted(one['instances'], 'instance')} by {printable_name(one['name'])}")


def print_instance(console: Console, found: dict[str, Any]) -> None:
    """One line a candidate."""
    one = found["instance"]
    size = f"{one['width']}x{one['height']}"
    head = f"{one['key']}  {one['scene']} of family {one['family']}, {size}, {one['role']}"
    console.print(Text(printable(head)), soft_wrap=True)
    for what in ("light", "camera"):
        console.print(Text(printable(f"{what} {one[what]}")), soft_wrap=True)
    judged = _table("judgements", ("candidate", "device", "status", "edge px", "wrong", "memory"), numbers=3)
    for row in found["judgements"]:
        figures = row["figures"]
        judged.add_row(
            *_about(row),
            _number(figures.get("edge_error_px"), ".2f"),
            _number(figures.get("wrong_share"), ".2%"),
            amount(row["memory_bytes"]),
        )
    console.print(judged)
    timed = _table(
        "timings", ("candidate", "device", "status", "dynamic ms", "static ms", "frames"), numbers=3
    )
    for row in found["timings"]:
        timed.add_row(*_about(row), _median(row, "dynamic"), _median(row, "static"), str(len(row["samples"])))
    console.print(timed)
    for name, values in found["features"].items():
        words = ", ".join(f"{feature} {_number(value, '.4g')}" for feature, value in values.items())
        console.print(Text(printable(f"features by {name}: {words or 'none'}")), soft_wrap=True)


def print_run(console: Console, found: dict[str, Any]) -> None:
    """What a run did, and what failed in it."""
    run = found["run"]
    source = f"commit {run['commit']}, seed {run['seed']}"
    head = f"{run['key']}  {run['purpose']}, started {run['started']}, {source}"
    console.print(Text(printable(head)), soft_wrap=True)
    for line in (*found["devices"], *run["remarks"]):
        console.print(Text(f"  {printable(line)}"), soft_wrap=True)
    failed = found["failed"]
    kinds = ", ".join(
        f"{count} {status}" for status, count in Counter(one["status"] for one in failed).items()
    )
    done = f"{counted(found['instances'], 'instance')}, {counted(found['facts'], 'fact')}"
    console.print(f"{done}; not ok: {kinds or 'none'}")
    for one in failed[:_MOST_FAILURES]:
        words = f"{one['instance'][:8]} {_candidate(one)}: {one['status']}: {one['reason']}"
        console.print(Text(f"  {printable(words)}"), soft_wrap=True)
    if len(failed) > _MOST_FAILURES:
        console.print(f"  and {len(failed) - _MOST_FAILURES} more; --json has them all")


def _technique(one: dict[str, Any]) -> tuple[tuple[str, ...], dict[str, Any]]:
    return (printable_name(one["technique"]), one["code"][:8], "fresh" if one["fresh"] else "stale"), one


def _counted_table(
    title: str, columns: tuple[str, ...], rows: Sequence[tuple[tuple[str, ...], dict[str, Any]]]
) -> Table:
    """Words and then counts, in which what failed is said."""
    table = _table(title, (*columns, *_COUNTS), numbers=len(_COUNTS))
    for words, one in rows:
        table.add_row(*words, *(_count(one, name) for name in _COUNTS))
    return table


def _count(one: dict[str, Any], name: str) -> str:
    failed = one.get(f"{name}_failed", 0)
    return f"{one[name]:,}" + (f" ({failed:,} not ok)" if failed else "")


def _table(title: str, columns: tuple[str, ...], *, numbers: int) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), title=Text(title), title_justify="left")
    for index, column in enumerate(columns):
        table.add_column(
            column, justify="right" if index >= len(columns) - numbers else "left", overflow="fold"
        )
    return table


def _about(row: dict[str, Any]) -> tuple[str, str, str]:
    status = row["status"] + ("" if row["fresh"] else ", stale")
    return printable_name(_candidate(row)), printable_name(row["device"]), status


def _candidate(row: dict[str, Any]) -> str:
    return " ".join([row["technique"], *(f"{name}={value}" for name, value in row["settings"].items())])


def _median(row: dict[str, Any], mobility: str) -> str:
    times = [one["shadow_ms"] for one in row["samples"] if one["mobility"] == mobility]
    return _number(median(times), ".2f") if times else "-"


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
