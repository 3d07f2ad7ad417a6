"""`gnomon annotate`: measures the lights of a level and writes the answers into it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from api.cli import learning_options as learning
from api.cli import measuring_options as measuring
from api.cli import options

MODES = MEASURE, PREDICT = "measure", "predict"
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
    policy: measuring.PolicyName = measuring.DEFAULT_POLICY,
    max_edge_error_px: measuring.MaxEdgeError = None,
    resolution: measuring.Size = options.DEFAULT_RESOLUTION,
    rounds: measuring.Rounds = measuring.DEFAULT_ROUNDS,
    mobility: measuring.Mobility = None,
    mode: Annotated[
        str,
        typer.Option(
            "--mode",
            metavar="measure|predict",
            parser=options.one_of(*MODES),
            autocompletion=options.completing(*MODES),
            help="How answers are found: measure renders every candidate, predict asks a model and renders "
            "nothing.",
            rich_help_panel=measuring.PANEL,
        ),
    ] = MEASURE,
    model: learning.Model = None,
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
    wins. With --mode predict a model that has learnt from such measurements answers at once, without a GPU.

    The level itself stays untouched unless --in-place is given. Lights added with --add-light are written
    beside plain geometry (OBJ, PLY, STL), as NAME.lights.json; other levels hold their lights themselves.
    """
    # OpenGL and images are loaded by the commands that need them, so that --help is there at once.
    from api.annotating import Order, target_of  # noqa: PLC0415
    from api.cli.annotate_run import run_annotate, run_clear  # noqa: PLC0415
    from api.cli.failures import UsageError  # noqa: PLC0415
    from api.cli.predict_run import run_predicted_annotate  # noqa: PLC0415
    from api.predicted_annotating import Order as PredictOrder  # noqa: PLC0415
    from api.predicting import Wish  # noqa: PLC0415
    from scenes.scene import Mobility  # noqa: PLC0415
    from selector.level_measuring import Request  # noqa: PLC0415
    from selector.measuring import FLICKER_STEPS, Plan  # noqa: PLC0415
    from selector.policy import policy as named_policy  # noqa: PLC0415

    if in_place and output is not None:
        raise UsageError("--in-place and -o contradict each other.", remedy="Give one of them.")
    target = target_of(level, output, in_place=in_place)
    if clear:
        _check_clear(has_target=in_place or output is not None, light=light, add_light=add_light)
        run_clear(level, target, in_place=in_place, as_json=as_json)
        return
    wish = Wish(
        policy=named_policy(policy, max_edge_error_px),
        mobility=Mobility(mobility) if mobility else None,
        techniques=tuple(technique or ()),
        lights=light or (),
        cameras=camera or (),
        size=(resolution.width, resolution.height),
    )
    if mode == PREDICT:
        renders: dict[str, object] = {"--pictures": pictures, "--measurements": measurements}
        renders |= {"--device": device}
        renders |= {"--verify": verify, "--flicker": flicker, "--rounds": rounds != measuring.DEFAULT_ROUNDS}
        _check_predict(renders)
        order = PredictOrder(level, scene, target, in_place, wish, add_light or ())
        run_predicted_annotate(order, model, as_json=as_json)
        return
    if model is not None:
        raise UsageError("--model is asked by --mode predict only.", remedy="Add --mode predict.")
    plan = Plan(*wish.size, rounds, verify=verify, flicker_steps=FLICKER_STEPS if flicker else 0)
    to_measure = Order(
        level=level,
        scene=scene,
        target=target,
        in_place=in_place,
        lights=wish.lights,
        cameras=wish.cameras,
        request=Request(wish.policy.max_edge_error_px, wish.techniques, wish.mobility, plan),
        pictures=pictures,
        measurements=measurements,
        device=device,
        added_lights=add_light or (),
    )
    run_annotate(to_measure, as_json=as_json)


def _check_clear(*, has_target: bool, light: object, add_light: object) -> None:
    from api.cli.failures import UsageError  # noqa: PLC0415

    if not has_target:
        raise UsageError("--clear needs to know where to write.", remedy="Add --in-place or -o OUT.")
    if light:
        raise UsageError("--clear takes out the annotation of all lights.", remedy="Leave --light out.")
    if add_light:
        raise UsageError("--clear measures nothing.", remedy="Leave --add-light out.")


def _check_predict(renders: Mapping[str, object]) -> None:
    """Refuse what only measuring can give.

    Args:
        renders: Option -> whether it was given.
    """
    from api.cli.failures import UsageError  # noqa: PLC0415

    for name, given in renders.items():
        if given:
            raise UsageError(
                f"{name} is about rendering, and --mode predict renders nothing.",
                remedy=f"Leave {name} out, or --mode.",
            )
