"""`gnomon thesis`: which of the thesis' orderings hold on this device."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import options

RESOLUTION = options.Resolution(640, 512)


def thesis(
    only: Annotated[
        str | None,
        typer.Option(
            "--only", metavar="IDS", help="Only these orderings, such as O8,O9.", show_default="all"
        ),
    ] = None,
    resolution: options.Size = RESOLUTION,
    rounds: Annotated[
        int,
        typer.Option(
            "--rounds",
            metavar="N",
            parser=options.whole_number(1, 1000),
            help="How often every candidate is timed.",
        ),
    ] = 5,
    device: options.Device = None,
    export: Annotated[
        Path | None,
        typer.Option(
            "--export",
            metavar="FOLDER",
            help="Write the scenes of the thesis there as .glb files, and measure nothing.",
        ),
    ] = None,
    *,
    no_times: Annotated[
        bool,
        typer.Option(
            "--no-times",
            help="Errors and counters only, which a busy machine does not disturb.",
        ),
    ] = False,
    as_json: options.AsJson = False,
) -> None:
    """Check which orderings of the thesis hold on this device: who is faster, who is more exact.

    The thesis is J. Sindholt, A comparison of Shadow Algorithms (DTU 2005). Its five scenes and the set-ups
    of its figures are rendered with shadow maps, perspective shadow maps, shadow volumes, and Chan and
    Durand's hybrid. For each of twelve orderings the table says whether it holds, by which figures, and
    where it does not, why. A second table shows the thesis' grades beside what is measured.
    """
    from api.cli.failures import UsageError  # noqa: PLC0415
    from api.cli.thesis_run import run_export, run_thesis  # noqa: PLC0415

    if export is not None:
        if only is not None or no_times:
            raise UsageError("--export measures nothing: it goes without --only and --no-times.")
        run_export(export, as_json=as_json)
        return
    # OpenGL is loaded by the commands that need it, so that --help is there at once.
    from api.thesis import Order  # noqa: PLC0415
    from selector.ordering_measuring import Thoroughness  # noqa: PLC0415
    from selector.thesis_orderings import orderings_named  # noqa: PLC0415

    chosen = orderings_named(options.parse_names(only))
    thoroughness = Thoroughness(resolution.width, resolution.height, 0 if no_times else rounds)
    run_thesis(Order(chosen, thoroughness, device), as_json=as_json)
