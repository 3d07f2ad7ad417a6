"""`gnomon compare`: one page that shows a level's lights under every candidate, side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import measuring_options as measuring
from api.cli import options


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
    light: Annotated[list[str] | None, measuring.lights("the first 8")] = None,
    camera: measuring.Cameras = None,
    technique: measuring.Techniques = None,
    policy: measuring.PolicyName = measuring.DEFAULT_POLICY,
    max_edge_error_px: measuring.MaxEdgeError = None,
    resolution: measuring.Size = options.DEFAULT_RESOLUTION,
    rounds: measuring.Rounds = measuring.DEFAULT_ROUNDS,
    mobility: measuring.Mobility = None,
    add_light: options.AddedLights = None,
    scene: options.SceneName = None,
    device: options.Device = None,
    *,
    flicker: measuring.Flicker = False,
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
    from selector.policy import policy as named_policy  # noqa: PLC0415

    order = Order(
        level=level,
        scene=scene,
        target=target_of(level, output),
        lights=light or (),
        cameras=camera or (),
        request=Request(
            max_edge_error_px=named_policy(policy, max_edge_error_px).max_edge_error_px,
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
