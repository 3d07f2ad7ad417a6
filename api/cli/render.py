"""`gnomon render`: one light by one technique, into a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import options


def render(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    level: options.Level,
    technique: Annotated[
        str,
        typer.Option(
            "--technique",
            "-t",
            metavar="NAME",
            autocompletion=options.known_techniques,
            help="{techniques}, or its id, such as shadow_map.",
        ),
    ] = "SM",
    light: Annotated[
        str | None,
        typer.Option(
            "--light",
            metavar="NAME|INDEX",
            help="Which light: its name, its number or node:NUMBER.",
            show_default="the first",
        ),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            "--camera",
            metavar="NAME|INDEX",
            help="Which camera: its name, its number or node:NUMBER.",
            show_default="the first that shows what the light lights, else the first viewpoint made for it",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="IMAGE.png",
            help="The picture.",
            show_default="LEVEL.LIGHT.TECHNIQUE.png in this folder",
        ),
    ] = None,
    resolution: options.Size = options.DEFAULT_RESOLUTION,
    show: Annotated[
        str | None,
        typer.Option(
            "--show",
            metavar="VIEW",
            autocompletion=options.known_views,
            help="What the picture shows in place of the shaded scene: {views}.",
        ),
    ] = None,
    map_size: Annotated[
        str | None,
        typer.Option(
            "--map-size",
            metavar="N",
            help="Side of a shadow map, or of one face of a cube, in texels.",
            show_default="1024",
        ),
    ] = None,
    filter_: Annotated[
        str | None,
        typer.Option(
            "--filter",
            metavar="NxN",
            autocompletion=options.known_choices("filter"),
            help="Filter of a shadow map: {filter}.",
            show_default="2x2",
        ),
    ] = None,
    focus: Annotated[
        str | None,
        typer.Option(
            "--focus",
            metavar="light|view",
            autocompletion=options.known_choices("focus"),
            help="What a shadow map covers: all that the light reaches, or only what the camera sees.",
            show_default="view for a sun, else light",
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            autocompletion=options.known_settings,
            help="Any setting of the technique; an unknown name or value lists those there are. "
            "May be given again.",
        ),
    ] = None,
    add_light: options.AddedLights = None,
    scene: options.SceneName = None,
    device: options.Device = None,
    *,
    as_json: options.AsJson = False,
) -> None:
    """Render one light by one technique into a PNG, and say what it cost and how wrong it is."""
    # OpenGL and images are loaded by the commands that need them, so that --help is there at once.
    from api.cli.level_warnings import print_warnings  # noqa: PLC0415
    from api.cli.render_report import print_rendering  # noqa: PLC0415
    from api.cli.terminal import errors, print_json, results  # noqa: PLC0415
    from api.rendering import Order, rendered  # noqa: PLC0415

    shorthands = {"map_size": map_size, "filter": filter_, "focus": focus}
    order = Order(
        level=level,
        scene=scene,
        technique=technique,
        settings=options.parse_settings(shorthands, settings or ()),
        view=show,
        light=light,
        camera=camera,
        output=output,
        width=resolution.width,
        height=resolution.height,
        device=device,
        added_lights=add_light or (),
    )
    with errors().status("rendering"):
        rendering = rendered(order)
    print_warnings(errors(), rendering.level)
    if as_json:
        print_json(rendering.record())
    else:
        print_rendering(results(), rendering)
