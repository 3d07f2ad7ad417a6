"""`gnomon rebenchmark`: finds out whether the answers of before still hold, once or every day."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import benchmarking_options as benchmarking
from api.cli import measuring_options as measuring
from api.cli import options

BASELINE_RESOLUTION = options.Resolution(640, 512)
MAX_AGE_S = 90 * 86_400.0


def rebenchmark(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    store: options.StoreUrl = options.DEFAULT_STORE,
    model: Annotated[
        Path,
        typer.Option("--model", metavar="FILE", help="The model in force, which a better one replaces."),
    ] = Path("gnomon.model"),
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="PAGE.html", help="The report; its JSON lies beside it."),
    ] = Path("gnomon-rebenchmark.html"),
    levels: Annotated[
        list[Path] | None,
        typer.Option(
            "--levels",
            metavar="FOLDER|FILE",
            help="Levels whose lights are watched, and from which evidence may come. May be given again.",
            show_default="none",
        ),
    ] = None,
    policy: measuring.PolicyName = measuring.DEFAULT_POLICY,
    sample: Annotated[
        int,
        typer.Option(
            "--sample",
            metavar="N",
            parser=options.whole_number(1, 100_000),
            help="Instances that are measured again to find drift; a test needs 10 of each technique.",
        ),
    ] = 24,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="N",
            parser=options.whole_number(0, 999_999_999),
            help="Another sample.",
            show_default="the date, such as 20300131",
        ),
    ] = None,
    max_age: Annotated[
        float | None,
        typer.Option(
            "--max-age",
            metavar="TIME",
            parser=options.parse_time,
            help="Times that are older are stale, such as 30d.",
            show_default="90d",
        ),
    ] = None,
    rounds: benchmarking.Rounds = 10,
    time_limit: benchmarking.TimeLimit = None,
    technique: measuring.Techniques = None,
    corpus: Annotated[
        list[str] | None,
        typer.Option(
            "--corpus",
            metavar="NAME|PATH",
            help="What a first run measures, as in `gnomon benchmark`. May be given again.",
            show_default=benchmarking.DEFAULT_CORPUS,
        ),
    ] = None,
    resolution: Annotated[
        options.Resolution,
        typer.Option(
            "--resolution",
            metavar="WxH",
            parser=options.parse_resolution,
            help="Of the views of a first run; later ones keep what they find.",
        ),
    ] = BASELINE_RESOLUTION,
    workers: benchmarking.Workers = None,
    device: options.Device = None,
    every: Annotated[
        float | None,
        typer.Option(
            "--every",
            metavar="TIME",
            parser=options.parse_time,
            help="Stay, and begin a job so often, such as 24h; Ctrl-C or SIGTERM ends it.",
            show_default="once",
        ),
    ] = None,
    *,
    train: Annotated[
        bool, typer.Option("--train/--no-train", help="Learn a new model where evidence has changed.")
    ] = True,
    as_json: options.AsJson = False,
) -> None:
    """Find out whether the answers of before still hold: after changes of code or driver, and without any.

    Measures a sample again, tests it for drift, measures again what is affected, learns a new model, keeps
    whichever is better, and leaves a report that names the lights of watched levels whose answer has moved.
    A first run makes the baseline. Made for cron and systemd timers: a lock keeps two jobs apart, and
    whatever ends a job leaves store, model and report whole.
    """
    from datetime import timedelta  # noqa: PLC0415

    # OpenGL is loaded by the commands that need it, so that --help is there at once.
    from api.cli.rebenchmark_run import run_rebenchmark  # noqa: PLC0415
    from api.rebenchmarking import Request  # noqa: PLC0415
    from selector.policy import policy as policy_named  # noqa: PLC0415

    request = Request(
        store=store,
        model=model,
        report=output,
        levels=tuple(levels or ()),
        policy=policy_named(policy),
        size=(options.DEFAULT_RESOLUTION.width, options.DEFAULT_RESOLUTION.height),
        sample=sample,
        seed=seed,
        max_age=timedelta(seconds=max_age or MAX_AGE_S),
        rounds=rounds,
        time_limit_s=time_limit,
        workers=workers,
        device=device,
        techniques=tuple(technique or ()),
        corpus=tuple(corpus or (benchmarking.DEFAULT_CORPUS,)),
        resolution=(resolution.width, resolution.height),
        learn=train,
    )
    run_rebenchmark(request, every, as_json=as_json)
