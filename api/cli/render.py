"""`gnomon render`: one light by one technique, into a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import options

FILTERS, FOCI = ("1x1", "2x2"), ("light", "view")


def render(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    level: options.Level,
    technique: Annotated[
        str,
        typer.Option("--technique", "-t", metavar="NAME", help="SM or SV, or its id, such as shadow_map."),
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
            show_default="the first, or in a level without cameras the first viewpoint made for the light",
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
    map_size: Annotated[
        int | None,
        typer.Option(
            "--map-size",
            metavar="N",
            parser=options.whole_number(128, 8192),
            help="Side of a shadow map, or of one face of a cube, in texels.",
            show_default="1024",
        ),
    ] = None,
    filter_: Annotated[
        str | None,
        typer.Option(
            "--filter",
            metavar="1x1|2x2",
            parser=options.one_of(*FILTERS),
            autocompletion=options.completing(*FILTERS),
            help="Filter of a shadow map.",
            show_default="2x2",
        ),
    ] = None,
    focus: Annotated[
        str | None,
        typer.Option(
            "--focus",
            metavar="light|view",
            parser=options.one_of(*FOCI),
            autocompletion=options.completing(*FOCI),
            help="What a shadow map covers: all that the light reaches, or only what the camera sees.",
            show_default="view for a sun, else light",
        ),
    ] = None,
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

    wanted = {"map_size": map_size, "filter": filter_, "focus": focus}
    order = Order(
        level=level,
        scene=scene,
        technique=technique,
        settings={name: value for name, value in wanted.items() if value is not None},
        light=light,
        camera=camera,
        output=output,
        width=resolution.width,
        height=resolution.height,
        device=device,
    )
    with errors().status("rendering"):
        rendering = rendered(order)
    print_warnings(errors(), rendering.level)
    if as_json:
        print_json(rendering.record())
    else:
        print_rendering(results(), rendering)
