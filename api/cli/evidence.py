"""`gnomon evidence`: what has been measured, and how it comes in and goes out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import options
from api.cli.failures import epilog, failing_cleanly
from api.cli.help_pages import PlainCommand, PlainGroup, help_text

FORMATS = ("parquet", "csv", "aslib")

evidence = typer.Typer(
    name="evidence",
    cls=PlainGroup,
    help="What has been measured: lists it, shows it, brings it in and out of a store.",
    epilog=epilog(annotates=False),
    no_args_is_help=True,
)

Folder = Annotated[
    Path, typer.Argument(metavar="FOLDER", help="Where the files go; made if need be.", show_default=False)
]
Files = Annotated[
    list[Path],
    typer.Argument(
        metavar="FOLDER|FILE...", help="Parquet or CSV files, or folders of them.", show_default=False
    ),
]
Stores = Annotated[
    list[str],
    typer.Argument(metavar="URL...", help="The stores that are added to --store.", show_default=False),
]
Key = Annotated[
    str,
    typer.Argument(
        metavar="KEY", help="Of an instance or of a run; its beginning is enough.", show_default=False
    ),
]
Device = Annotated[
    str | None,
    typer.Option(
        "--device",
        metavar="NAME|KEY",
        help="A device of the store: a part of its name, or the beginning of its key.",
        show_default=False,
    ),
]


def ls(store: options.StoreUrl = options.DEFAULT_STORE, *, as_json: options.AsJson = False) -> None:
    """List what a store holds: devices, techniques and whether they are fresh, families, runs, and its size.

    What was measured by another version of a technique's code is stale.
    """
    from api.cli.evidence_run import run_ls  # noqa: PLC0415

    run_ls(store, as_json=as_json)


def show(
    key: Key, store: options.StoreUrl = options.DEFAULT_STORE, *, as_json: options.AsJson = False
) -> None:
    """Show everything about one instance or one run.

    Of an instance every error, counter and time of every candidate; of a run what it did and what failed.
    """
    from api.cli.evidence_run import run_show  # noqa: PLC0415

    run_show(store, key, as_json=as_json)


def export(
    folder: Folder,
    form: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="NAME",
            parser=options.one_of(*FORMATS),
            autocompletion=options.completing(*FORMATS),
            help="parquet, csv, or aslib: scenarios of the Algorithm Selection Library, one for times and "
            "one for errors.",
        ),
    ] = FORMATS[0],
    device: Device = None,
    extractor: Annotated[
        str | None,
        typer.Option(
            "--extractor", metavar="NAME", help="With aslib: whose features.", show_default="the only one"
        ),
    ] = None,
    store: options.StoreUrl = options.DEFAULT_STORE,
    *,
    as_json: options.AsJson = False,
) -> None:
    """Write a store's evidence as files: a table a file, the same bytes for the same evidence.

    With --format aslib only the training instances of one device, with folds by family.
    """
    from api.cli.evidence_run import run_export  # noqa: PLC0415
    from api.cli.failures import UsageError  # noqa: PLC0415

    if form != "aslib" and (device is not None or extractor is not None):
        raise UsageError("--device and --extractor go with --format aslib.")
    run_export(store, folder, form, device, extractor, as_json=as_json)


def bring_in(
    files: Files, store: options.StoreUrl = options.DEFAULT_STORE, *, as_json: options.AsJson = False
) -> None:
    """Add what `gnomon evidence export` wrote as Parquet or CSV. What is there already is not doubled."""
    from api.cli.evidence_run import run_import  # noqa: PLC0415

    run_import(store, files, as_json=as_json)


def merge(
    stores: Stores, store: options.StoreUrl = options.DEFAULT_STORE, *, as_json: options.AsJson = False
) -> None:
    """Add other stores' evidence to this one. What is there already is not doubled."""
    from api.cli.evidence_run import run_merge  # noqa: PLC0415

    run_merge(store, stores, as_json=as_json)


def prune(
    older_than: Annotated[
        str | None,
        typer.Option(
            "--older-than", metavar="DATE", help="What was found out before it, such as 2030-12-31."
        ),
    ] = None,
    device: Device = None,
    store: options.StoreUrl = options.DEFAULT_STORE,
    *,
    stale: Annotated[
        bool, typer.Option("--stale", help="What another version of a technique's code gave.")
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would go.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False,
    as_json: options.AsJson = False,
) -> None:
    """Take out what is of no more use: that for which all holds that is said. Says what goes, and asks."""
    from api.cli.evidence_run import run_prune  # noqa: PLC0415
    from api.cli.failures import UsageError  # noqa: PLC0415

    if not stale and older_than is None and device is None:
        raise UsageError("Say what is to go: --stale, --older-than or --device.")
    if as_json and not (dry_run or yes):
        raise UsageError("With --json nobody can be asked: add --dry-run or --yes.")
    asking = not (dry_run or yes)
    run_prune(store, (stale, older_than, device), asking=asking, dry_run=dry_run, as_json=as_json)


for name, command in (
    ("ls", ls),
    ("show", show),
    ("export", export),
    ("import", bring_in),
    ("merge", merge),
    ("prune", prune),
):
    evidence.command(name, cls=PlainCommand, help=help_text(command), epilog=epilog(annotates=False))(
        failing_cleanly(command)
    )
