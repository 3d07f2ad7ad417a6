"""`gnomon inspect`: what is in a level, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from api.cli import options

if TYPE_CHECKING:
    from scenes.level import Level


def inspect(
    level: options.Level,
    views: Annotated[
        Path | None,
        typer.Option(
            "--views",
            metavar="IMAGE.png",
            help="Also draw the views that the lights are judged over, at most 24 evenly spread lights.",
        ),
    ] = None,
    light: Annotated[
        list[str] | None,
        typer.Option(
            "--light",
            metavar="NAME|INDEX",
            help="With --views: only this light; may be given again.",
            show_default="all",
        ),
    ] = None,
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
    from api.cli.failures import UsageError  # noqa: PLC0415
    from api.cli.inspection_tables import print_inspection  # noqa: PLC0415
    from api.cli.terminal import print_json, results  # noqa: PLC0415
    from api.inspection import Inspection  # noqa: PLC0415

    if light and views is None:
        raise UsageError("--light chooses the lights of a picture.", remedy="Add --views IMAGE.png.")
    require_file(level)
    inspection = Inspection.of(level_with_lights(level, scene, add_light or ()))
    drawn = {} if views is None else _drawn(inspection.level, views, light or ())
    if as_json:
        print_json(inspection.record() | drawn)
    else:
        print_inspection(results(), inspection, views)


def _drawn(level: Level, path: Path, wanted: Sequence[str]) -> dict[str, Any]:
    """Draws the views, and gives them as JSON values."""
    from api.cli.terminal import errors  # noqa: PLC0415
    from api.viewpoint_sheet import views_record, write_views  # noqa: PLC0415

    with errors().status("drawing views"):
        return views_record(path, write_views(level, path, wanted))
