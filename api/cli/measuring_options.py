"""Options of the commands that measure lights; they mean the same in each."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli import options

PANEL = "What is measured"
MOBILITIES = "static", "dynamic"
POLICIES = "speed", "balanced", "quality"
DEFAULT_POLICY = "balanced"


def lights(default: str) -> typer.models.OptionInfo:
    """`--light`, where `default` says which are taken without it."""
    info: typer.models.OptionInfo = typer.Option(
        "--light",
        metavar="NAME|INDEX",
        help="Only this light: its name, its number or node:NUMBER. May be given again.",
        show_default=default,
        rich_help_panel=PANEL,
    )
    return info


Cameras = Annotated[
    list[str] | None,
    typer.Option(
        "--camera",
        metavar="NAME|INDEX",
        help="Judge only by this camera. May be given again.",
        show_default="those that show what the light lights, else four viewpoints made for it",
        rich_help_panel=PANEL,
    ),
]
Techniques = Annotated[
    list[str] | None,
    typer.Option(
        "-t",
        "--technique",
        metavar="NAME",
        help="Only this technique, by label or id. May be given again.",
        show_default="all",
        autocompletion=options.known_techniques,
        rich_help_panel=PANEL,
    ),
]
PolicyName = Annotated[
    str,
    typer.Option(
        "--policy",
        metavar="NAME",
        parser=options.one_of(*POLICIES),
        autocompletion=options.completing(*POLICIES),
        help="How far the edge of a shadow may be off: speed 4, balanced 1.5, quality 0.5 pixels. The "
        "cheapest candidate within it wins.",
        rich_help_panel=PANEL,
    ),
]
MaxEdgeError = Annotated[
    float | None,
    typer.Option(
        "--max-edge-error-px",
        metavar="PX",
        parser=options.parse_pixels,
        help="Another limit than the policy's, in pixels.",
        show_default=False,
        rich_help_panel=PANEL,
    ),
]
Size = Annotated[
    options.Resolution,
    typer.Option(
        "--resolution",
        metavar="WxH",
        parser=options.parse_resolution,
        help="Pixels across and down of each view.",
        rich_help_panel=PANEL,
    ),
]
Rounds = Annotated[
    int,
    typer.Option(
        "--rounds",
        metavar="N",
        parser=options.whole_number(1, 1000),
        help="How often every candidate is timed.",
        rich_help_panel=PANEL,
    ),
]
Mobility = Annotated[
    str | None,
    typer.Option(
        "--mobility",
        metavar="static|dynamic",
        parser=options.one_of(*MOBILITIES),
        autocompletion=options.completing(*MOBILITIES),
        help="Whether lights stand still, so that their maps are kept.",
        show_default="what the level says of each light, else dynamic",
        rich_help_panel=PANEL,
    ),
]
Flicker = Annotated[
    bool,
    typer.Option(
        "--flicker",
        help="Move each camera a little and measure how much errors flicker.",
        rich_help_panel=PANEL,
    ),
]
DEFAULT_ROUNDS = 3
