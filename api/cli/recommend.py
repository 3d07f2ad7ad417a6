"""`gnomon recommend`: which technique each light should use, without rendering it."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli import learning_options as learning
from api.cli import measuring_options as measuring
from api.cli import options

MODES = ("predict",)


def recommend(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    level: options.Level,
    light: Annotated[list[str] | None, measuring.lights("all")] = None,
    camera: measuring.Cameras = None,
    policy: measuring.PolicyName = measuring.DEFAULT_POLICY,
    max_edge_error_px: measuring.MaxEdgeError = None,
    technique: measuring.Techniques = None,
    model: learning.Model = None,
    resolution: options.Size = options.DEFAULT_RESOLUTION,
    mobility: measuring.Mobility = None,
    mode: Annotated[
        str,
        typer.Option(
            "--mode",
            metavar="predict",
            parser=options.one_of(*MODES),
            autocompletion=options.completing(*MODES),
            help="How answers are found: predict asks a model and renders nothing.",
            rich_help_panel=measuring.PANEL,
        ),
    ] = "predict",
    add_light: options.AddedLights = None,
    scene: options.SceneName = None,
    *,
    as_json: options.AsJson = False,
) -> None:
    """Recommend a shadow technique for each light of a level, from features and a model. Needs no GPU.

    The level is not changed. `gnomon annotate --mode predict` writes the same answers into it; without
    --mode it measures every candidate first.
    """
    from api.cli.predict_run import Asked, run_recommend  # noqa: PLC0415
    from api.predicting import Wish  # noqa: PLC0415
    from scenes.scene import Mobility  # noqa: PLC0415
    from selector.policy import policy as named_policy  # noqa: PLC0415

    del mode
    wish = Wish(
        policy=named_policy(policy, max_edge_error_px),
        mobility=Mobility(mobility) if mobility else None,
        techniques=tuple(technique or ()),
        lights=light or (),
        cameras=camera or (),
        size=(resolution.width, resolution.height),
    )
    run_recommend(Asked(level, scene, add_light or (), model, wish), as_json=as_json)
