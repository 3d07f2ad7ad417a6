"""`gnomon benchmark`: measures many instances, and keeps what it finds in a store."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli import benchmarking_options as benchmarking
from api.cli import measuring_options as measuring
from api.cli import options

RESOLUTION = options.Resolution(640, 512)
PURPOSES = ("errors", "times", "both")


def benchmark(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    corpus: Annotated[
        list[str] | None,
        typer.Option(
            "--corpus",
            metavar="NAME|PATH",
            help="quick, standard, further or thesis; a level file, or a folder of them. May be given again.",
            show_default=benchmarking.DEFAULT_CORPUS,
        ),
    ] = None,
    purpose: Annotated[
        str,
        typer.Option(
            "--purpose",
            metavar="WHAT",
            parser=options.one_of(*PURPOSES),
            autocompletion=options.completing(*PURPOSES),
            help="errors (and counters), times, or both, errors first.",
        ),
    ] = "both",
    technique: measuring.Techniques = None,
    rounds: benchmarking.Rounds = 10,
    resolution: options.Size = RESOLUTION,
    time_limit: benchmarking.TimeLimit = None,
    workers: benchmarking.Workers = None,
    lights: Annotated[
        int | None,
        typer.Option(
            "--lights",
            metavar="N",
            parser=options.whole_number(1, 100_000),
            help="Of a level at most so many lights, spread evenly.",
            show_default="all",
        ),
    ] = None,
    views: Annotated[
        int | None,
        typer.Option(
            "--views",
            metavar="N",
            parser=options.whole_number(1, 1000),
            help="Of a level's light at most so many views.",
            show_default="all",
        ),
    ] = None,
    store: options.StoreUrl = options.DEFAULT_STORE,
    seed: Annotated[
        int,
        typer.Option(
            "--seed",
            metavar="N",
            parser=options.whole_number(0, 999_999_999),
            help="Another order of the candidates in timed rounds.",
        ),
    ] = 1,
    device: options.Device = None,
    *,
    test: Annotated[
        bool, typer.Option("--test", help="Keep levels apart as test data: no model may learn from them.")
    ] = False,
    flip: Annotated[
        bool, typer.Option("--flip", help="Compare pictures by FLIP too, for half as much time again.")
    ] = False,
    resume: Annotated[
        bool, typer.Option("--resume/--no-resume", help="Leave out what is fresh in the store.")
    ] = True,
    as_json: options.AsJson = False,
) -> None:
    """Measure many lights with every candidate, and keep all of it in a store of evidence.

    Errors and counters are exact: they are judged by several processes side by side, on any machine at any
    time. Times are taken one instance after the other, on a machine that should do nothing else. What is in
    the store already is left out, so the command goes on where it was stopped.
    """
    # OpenGL is loaded by the commands that need it, so that --help is there at once.
    from api.benchmarking import Request  # noqa: PLC0415
    from api.cli.benchmark_run import run_benchmark  # noqa: PLC0415
    from selector.evidence.rows import Purpose, Role  # noqa: PLC0415

    request = Request(
        sources=corpus or (benchmarking.DEFAULT_CORPUS,),
        purposes=tuple(Purpose) if purpose == "both" else (Purpose(purpose),),
        store=store,
        width=resolution.width,
        height=resolution.height,
        techniques=tuple(technique or ()),
        rounds=rounds,
        time_limit_s=time_limit,
        workers=workers,
        device=device,
        role=Role.TEST if test else Role.TRAINING,
        lights=lights,
        views=views,
        seed=seed,
        resume=resume,
        flip=flip,
    )
    run_benchmark(request, as_json=as_json)
