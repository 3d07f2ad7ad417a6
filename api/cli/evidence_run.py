"""What `gnomon evidence` does."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import asdict
from datetime import date
from pathlib import Path

import typer
from rich.text import Text

from api.cli.evidence_tables import print_instance, print_listed, print_run
from api.cli.failures import UsageError
from api.cli.terminal import print_json, printable, results
from api.evidence import ExportFormat, device_of, exported, listed, shown
from api.wording import counted
from selector.benchmark.code_version import code_versions
from selector.evidence.importing import bring_in
from selector.evidence.merging import merge
from selector.evidence.pruning import Pruned, Useless
from selector.evidence.store import Store
from selector.evidence.surveying import Counts


def run_ls(url: str, *, as_json: bool) -> None:
    """Prints what a store holds."""
    with Store.open(url, write=False) as store:
        found = {"store": url, "bytes": _size(url), **listed(store)}
    if as_json:
        print_json(found)
    else:
        print_listed(results(), found)


def run_show(url: str, key: str, *, as_json: bool) -> None:
    """Prints everything about an instance or a run."""
    with Store.open(url, write=False) as store:
        found = shown(store, key)
    if as_json:
        print_json(found)
    elif "run" in found:
        print_run(results(), found)
    else:
        print_instance(results(), found)


def run_export(
    url: str, folder: Path, form: str, device: str | None, extractor: str | None, *, as_json: bool
) -> None:
    """Writes files, and says which."""
    with Store.open(url, write=False) as store:
        written = exported(store, folder, ExportFormat(form), device, extractor)
    if as_json:
        print_json(written)
        return
    for path in written:
        results().print(Text(printable(path)), soft_wrap=True)


def run_import(url: str, files: Sequence[Path], *, as_json: bool) -> None:
    """Adds files, and says what was new."""
    with Store.open(url) as store:
        before = _totals(store)
        bring_in(store, files)
        _print_added(before, _totals(store), as_json=as_json)


def run_merge(url: str, others: Sequence[str], *, as_json: bool) -> None:
    """Adds stores, and says what was new."""
    with Store.open(url) as store:
        before = _totals(store)
        for other in others:
            with Store.open(other, write=False) as opened:
                merge(store, opened)
        _print_added(before, _totals(store), as_json=as_json)


def run_prune(
    url: str,
    what: tuple[bool, str | None, str | None],
    *,
    asking: bool,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Takes facts out, having said what goes."""
    stale, older_than, device = what
    before = _day(older_than) if older_than is not None else None
    with Store.open(url) as store:
        key = device_of(store, device).key if device is not None else None
        useless = Useless(code_versions() if stale else None, before, key)
        pruned = store.prune(useless, dry_run=dry_run or asking)
        if as_json:
            print_json({"dry_run": dry_run, **asdict(pruned)})
            return
        results().print(_pruned_words(pruned, done=not (dry_run or asking)))
        if asking and pruned.judgements + pruned.timings and _agreed():
            store.prune(useless)
            results().print("Done.")


def _agreed() -> bool:
    if not sys.stdin.isatty():
        raise UsageError("Nobody can be asked here.", remedy="Add --yes, or --dry-run.")
    return typer.confirm("Take it out?", err=True)


def _pruned_words(pruned: Pruned, *, done: bool) -> str:
    if not pruned.judgements + pruned.timings:
        return "There is nothing that would go."
    parts = [
        counted(number, name.removesuffix("s"))
        for name, number in asdict(pruned).items()
        if number or name in ("judgements", "timings")
    ]
    return f"{', '.join(parts)} {'are gone' if done else 'would go'}."


def _totals(store: Store) -> dict[str, int]:
    survey = store.survey()
    every = [Counts(), *survey.techniques.values()]
    return {
        "instances": sum(survey.instances.values()),
        "runs": len(list(store.runs())),
        "judgements": sum(one.judgements for one in every),
        "timings": sum(one.timings for one in every),
        "samples": sum(one.samples for one in every),
    }


def _print_added(before: dict[str, int], after: dict[str, int], *, as_json: bool) -> None:
    added = {name: after[name] - number for name, number in before.items()}
    if as_json:
        print_json(added)
        return
    words = ", ".join(counted(number, name.removesuffix("s")) for name, number in added.items())
    results().print(f"New: {words}.")


def _day(text: str) -> str:
    try:
        # Python would also read 20301231 and weeks.
        day = date.fromisoformat(text if re.fullmatch(r"\d{4}-\d\d-\d\d", text) else "")
    except ValueError as error:
        raise UsageError(f'"{text}" is no day such as 2030-12-31.') from error
    return day.isoformat()


def _size(url: str) -> int | None:
    """Bytes of a file with its log; None where the store is no file."""
    path = Path(url.removeprefix("sqlite:///"))
    log = path.with_name(f"{path.name}-wal")
    if not path.is_file():
        return None
    return path.stat().st_size + (log.stat().st_size if log.is_file() else 0)
