"""The table of `gnomon devices`."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table

from api.cli.terminal import printable
from api.device_list import ListedDevice
from api.wording import amount
from renderers.clock import ClockKind

CLOCKS = {
    ClockKind.QUERY: "timer queries",
    ClockKind.WALL: "wall clock with glFinish",
}


def print_devices(console: Console, found: Sequence[ListedDevice]) -> None:
    """One row a device."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("#", justify="right", no_wrap=True)
    for column in ("renderer", "OpenGL", "kind"):
        table.add_column(column, overflow="fold")
    table.add_column("textures", justify="right", no_wrap=True)
    table.add_column("buffers", justify="right", no_wrap=True)
    table.add_column("time by", overflow="fold")
    for one in found:
        device, limits = one.device, one.device.limits
        table.add_row(
            str(device.index),
            printable(device.renderer),
            printable(device.gl_version),
            "software" if device.software else "hardware",
            f"{limits.max_texture_side}",
            amount(limits.max_buffer_bytes),
            CLOCKS[one.clock],
        )
    console.print(table)
