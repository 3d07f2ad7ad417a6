"""`gnomon devices`: what can be rendered on."""

from __future__ import annotations

from api.cli import options


def devices(*, as_json: options.AsJson = False) -> None:
    """List the devices that Gnomon can render on, and how their time is told."""
    # OpenGL is loaded by the commands that need it, so that --help is there at once.
    from api.cli.device_table import print_devices  # noqa: PLC0415
    from api.cli.terminal import print_json, results  # noqa: PLC0415
    from api.device_list import listed_devices  # noqa: PLC0415

    found = listed_devices()
    if as_json:
        print_json([one.record() for one in found])
    else:
        print_devices(results(), found)
