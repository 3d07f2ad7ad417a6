"""Options of the commands that measure many instances; they mean the same in each."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli import options

DEFAULT_CORPUS = "quick"

Rounds = Annotated[
    int,
    typer.Option(
        "--rounds",
        metavar="N",
        parser=options.whole_number(1, 1000),
        help="How often a candidate is timed at most; less where its rank is clear.",
    ),
]
TimeLimit = Annotated[
    float | None,
    typer.Option(
        "--time-limit",
        metavar="TIME",
        parser=options.parse_time,
        help="Begin no further instance after this, such as 20min or 2h; the next run goes on.",
        show_default="none",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        metavar="N",
        parser=options.whole_number(1, 256),
        help="Processes that judge errors side by side; times are always taken alone.",
        show_default="one a core",
    ),
]
