"""`gnomon features`: the numbers about a light from which its technique is predicted."""

from __future__ import annotations

from typing import Annotated

from api.cli import measuring_options as measuring
from api.cli import options


def features(
    level: options.Level,
    light: Annotated[list[str] | None, measuring.lights("all")] = None,
    camera: measuring.Cameras = None,
    resolution: options.Size = options.DEFAULT_RESOLUTION,
    add_light: options.AddedLights = None,
    scene: options.SceneName = None,
    *,
    as_json: options.AsJson = False,
) -> None:
    """Show the features of each light: numbers by which a technique can be chosen without rendering.

    One column for each view that shows what the light lights. Needs no GPU.
    """
    from api.added_lights import level_with_lights  # noqa: PLC0415
    from api.choosing import require_file  # noqa: PLC0415
    from api.cli.learning_tables import print_features  # noqa: PLC0415
    from api.cli.terminal import print_json, results  # noqa: PLC0415
    from api.learning import feature_records  # noqa: PLC0415

    require_file(level)
    read = level_with_lights(level, scene, add_light or ())
    record = feature_records(read, light or (), camera or (), (resolution.width, resolution.height))
    if as_json:
        print_json(record)
    else:
        print_features(results(), record)
