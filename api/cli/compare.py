"""`gnomon compare`: one page that shows a level's lights under every candidate, side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import options

MOBILITIES = "static", "dynamic"


def compare(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    level: options.Level,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="PAGE.html",
            help="The page.",
            show_default="NAME.compare.html beside the level",
        ),
    ] = None,
    light: Annotated[
        list[str] | None,
        typer.Option(
            "--light",
            metavar="NAME|INDEX",
            help="Only this light: its name, its number or node:NUMBER. May be given again.",
            show_default="the first 8",
        ),
    ] = None,
    camera: Annotated[
        list[str] | None,
        typer.Option(
            "--camera",
            metavar="NAME|INDEX",
            help="Only this camera. May be given again.",
            show_default="those that show what the light lights, else four viewpoints made for it",
        ),
    ] = None,
    technique: Annotated[
        list[str] | None,
        typer.Option(
            "-t",
            "--technique",
            metavar="NAME",
            help="Only this technique, by label or id. May be given again.",
            show_default="all",
        ),
    ] = None,
    max_edge_error_px: Annotated[
        float,
        typer.Option(
            "--max-edge-error-px",
            metavar="PX",
            parser=options.parse_pixels,
            help="How far the edge of a shadow may be off, in pixels. The cheapest candidate within it wins.",
        ),
    ] = 1.5,
    resolution: options.Size = options.DEFAULT_RESOLUTION,
    rounds: Annotated[
        int,
        typer.Option(
            "--rounds",
            metavar="N",
            parser=options.whole_number(1, 1000),
            help="How often every candidate is timed.",
        ),
    ] = 3,
    mobility: Annotated[
        str | None,
        typer.Option(
            "--mobility",
            metavar="static|dynamic",
            parser=options.one_of(*MOBILITIES),
            autocompletion=options.completing(*MOBILITIES),
            help="Whether lights stand still, so that their maps are kept.",
            show_default="what the level says of each light, else dynamic",
        ),
    ] = None,
    add_light: options.AddedLights = None,
    scene: options.SceneName = None,
    device: options.Device = None,
    *,
    flicker: Annotated[
        bool,
        typer.Option("--flicker", help="Move each camera a little, and measure how much errors flicker."),
    ] = False,
    as_json: options.AsJson = False,
) -> None:
    """Show how every technique draws the lights of a level, on one page for the browser.

    For each light and view the page shows the picture of each candidate, a map of its errors, its time by
    stages, and time against error; the candidate that `annotate` would choose is marked. The page is one
    file, which needs no network.
    """
    # OpenGL and images are loaded by the commands that need them, so that --help is there at once.
    from api.cli.compare_run import run_compare  # noqa: PLC0415
    from api.comparing import Order, target_of  # noqa: PLC0415
    from scenes.scene import Mobility  # noqa: PLC0415
    from selector.level_measuring import Request  # noqa: PLC0415
    from selector.measuring import FLICKER_STEPS, Plan  # noqa: PLC0415

    order = Order(
        level=level,
        scene=scene,
        target=target_of(level, output),
        lights=light or (),
        cameras=camera or (),
        request=Request(
            max_edge_error_px=max_edge_error_px,
            techniques=tuple(technique or ()),
            mobility=Mobility(mobility) if mobility else None,
            plan=Plan(
                resolution.width, resolution.height, rounds, flicker_steps=FLICKER_STEPS if flicker else 0
            ),
        ),
        device=device,
        added_lights=add_light or (),
    )
    run_compare(order, as_json=as_json)
