"""`gnomon annotate`: measures the lights of a level and writes the answers into it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import measuring_options as measuring
from api.cli import options

OUTPUTS, EXTRAS = "Where the result goes", "More to look at"


def annotate(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    level: options.Level,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="The annotated level.",
            show_default="NAME.annotated.EXT beside the level",
            rich_help_panel=OUTPUTS,
        ),
    ] = None,
    light: Annotated[list[str] | None, measuring.lights("all")] = None,
    camera: measuring.Cameras = None,
    technique: measuring.Techniques = None,
    max_edge_error_px: measuring.MaxEdgeError = measuring.DEFAULT_MAX_EDGE_ERROR_PX,
    resolution: measuring.Size = options.DEFAULT_RESOLUTION,
    rounds: measuring.Rounds = measuring.DEFAULT_ROUNDS,
    mobility: measuring.Mobility = None,
    mode: Annotated[
        str,
        typer.Option(
            "--mode",
            metavar="measure",
            parser=options.one_of("measure"),
            autocompletion=options.completing("measure"),
            help="How answers are found: measure renders every candidate.",
            rich_help_panel=measuring.PANEL,
        ),
    ] = "measure",
    pictures: Annotated[
        Path | None,
        typer.Option(
            "--pictures",
            metavar="FOLDER",
            help="Write a picture of each light under each candidate, and a sheet with all of them.",
            show_default=False,
            rich_help_panel=EXTRAS,
        ),
    ] = None,
    measurements: Annotated[
        Path | None,
        typer.Option(
            "--measurements",
            metavar="FILE",
            help="Write every raw sample, counter and error figure, as JSON.",
            show_default=False,
            rich_help_panel=EXTRAS,
        ),
    ] = None,
    add_light: options.AddedLights = None,
    scene: options.SceneName = None,
    device: options.Device = None,
    *,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Overwrite the level itself.", rich_help_panel=OUTPUTS)
    ] = False,
    clear: Annotated[
        bool,
        typer.Option(
            "--clear",
            help="Measure nothing and take Gnomon's annotation out again; needs -o or --in-place.",
            rich_help_panel=OUTPUTS,
        ),
    ] = False,
    verify: Annotated[
        bool,
        typer.Option(
            "--verify",
            help="Check the ground truth itself against ray casting (Embree).",
            rich_help_panel=EXTRAS,
        ),
    ] = False,
    flicker: measuring.Flicker = False,
    as_json: options.AsJson = False,
) -> None:
    """Choose a shadow technique for every light of a level, and write the choices into it.

    Every light is rendered with every candidate technique and setting from every camera that shows it.
    Speed and error are measured, and the cheapest candidate whose shadow's edge is near enough to the truth
    wins.

    The level itself stays untouched unless --in-place is given. Lights added with --add-light are written
    beside plain geometry (OBJ, PLY, STL), as NAME.lights.json; other levels hold their lights themselves.
    """
    # OpenGL and images are loaded by the commands that need them, so that --help is there at once.
    from api.annotating import Order, target_of  # noqa: PLC0415
    from api.cli.annotate_run import run_annotate, run_clear  # noqa: PLC0415
    from api.cli.failures import UsageError  # noqa: PLC0415
    from scenes.scene import Mobility  # noqa: PLC0415
    from selector.level_measuring import Request  # noqa: PLC0415
    from selector.measuring import FLICKER_STEPS, Plan  # noqa: PLC0415

    del mode
    if in_place and output is not None:
        raise UsageError("--in-place and -o contradict each other.", remedy="Give one of them.")
    if clear:
        if not in_place and output is None:
            raise UsageError("--clear needs to know where to write.", remedy="Add --in-place or -o OUT.")
        if light:
            raise UsageError("--clear takes out the annotation of all lights.", remedy="Leave --light out.")
        if add_light:
            raise UsageError("--clear measures nothing.", remedy="Leave --add-light out.")
        run_clear(level, target_of(level, output, in_place=in_place), in_place=in_place, as_json=as_json)
        return
    order = Order(
        level=level,
        scene=scene,
        target=target_of(level, output, in_place=in_place),
        in_place=in_place,
        lights=light or (),
        cameras=camera or (),
        request=Request(
            max_edge_error_px=max_edge_error_px,
            techniques=tuple(technique or ()),
            mobility=Mobility(mobility) if mobility else None,
            plan=Plan(
                resolution.width,
                resolution.height,
                rounds,
                verify=verify,
                flicker_steps=FLICKER_STEPS if flicker else 0,
            ),
        ),
        pictures=pictures,
        measurements=measurements,
        device=device,
        added_lights=add_light or (),
    )
    run_annotate(order, as_json=as_json)
