"""`gnomon inspect`: what is in a level, and what is wrong with it."""

from __future__ import annotations

from api.cli import options


def inspect(
    level: options.Level,
    add_light: options.AddedLights = None,
    scene: options.SceneName = None,
    *,
    as_json: options.AsJson = False,
) -> None:
    """Show what is in a level and what to expect of it. Needs no GPU.

    Lists lights and cameras with the names and numbers by which other commands address them.
    """
    # Arrays are loaded by the commands that need them, so that --help is there at once.
    from api.added_lights import level_with_lights  # noqa: PLC0415
    from api.choosing import require_file  # noqa: PLC0415
    from api.cli.inspection_tables import print_inspection  # noqa: PLC0415
    from api.cli.terminal import print_json, results  # noqa: PLC0415
    from api.inspection import Inspection  # noqa: PLC0415

    require_file(level)
    inspection = Inspection.of(level_with_lights(level, scene, add_light or ()))
    if as_json:
        print_json(inspection.record())
    else:
        print_inspection(results(), inspection)
