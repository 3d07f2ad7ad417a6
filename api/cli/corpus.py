"""`gnomon corpus`: the scenes that the selector learns from, and what they cover."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import options

CORPORA = ("quick", "standard", "further", "thesis")


def corpus(
    name: Annotated[
        str,
        typer.Option(
            "--corpus",
            metavar="NAME",
            parser=options.one_of(*CORPORA),
            autocompletion=options.completing(*CORPORA),
            help="Which corpus --stats looks at: quick, standard, further or thesis.",
        ),
    ] = "quick",
    levels: Annotated[
        Path | None,
        typer.Option(
            "--levels",
            metavar="FOLDER",
            help="With --stats: say where the levels in this folder lie outside the corpus.",
        ),
    ] = None,
    export: Annotated[
        Path | None,
        typer.Option("--export", metavar="FOLDER", help="Write one scene of each family there as .glb."),
    ] = None,
    family: Annotated[
        str | None,
        typer.Option("--family", metavar="NAME", help="With --export: only this family.", show_default="all"),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="N",
            parser=options.whole_number(0, 999_999_999),
            help="With --export: another scene of the same family.",
            show_default="0",
        ),
    ] = None,
    *,
    stats: Annotated[
        bool, typer.Option("--stats", help="Measure what the corpus covers, axis by axis.")
    ] = False,
    as_json: options.AsJson = False,
) -> None:
    """List the families of generated scenes, say what they cover, or write some as level files.

    Needs no GPU. The same spec gives the same scene on every machine.
    """
    from api.cli.corpus_run import run_export, run_list, run_stats  # noqa: PLC0415
    from api.cli.failures import UsageError  # noqa: PLC0415

    if stats and export is not None:
        raise UsageError("--stats and --export are two things: ask for one at a time.")
    if levels is not None and not stats:
        raise UsageError("--levels goes with --stats.")
    if export is None and (family is not None or seed is not None):
        raise UsageError("--family and --seed go with --export.")
    if stats:
        run_stats(name, levels, as_json=as_json)
    elif export is not None:
        run_export(export, (family,) if family else (), seed or 0, as_json=as_json)
    else:
        run_list(as_json=as_json)
