"""The tables of `gnomon inspect`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable, printable_name
from api.inspection import Inspection, mesh_count
from api.wording import counted
from scenes.level import Severity
from scenes.scene import Camera, Light, LightKind, Mobility
from scenes.shells import Shells

NOTHING = "-"
LONGEST_PATH = 4096
NAME_WIDTH = 12
"""Columns that a long name keeps on a narrow screen."""
MOST_ROWS = 1000
"""More take a terminal more than a second to lay out, and nobody reads them."""
KEPT_COLUMNS = 4
"""Number, node, name and kind, or of a camera its place, are shown on every screen."""
PADDING = 2


def print_inspection(console: Console, inspection: Inspection, picture: Path | None = None) -> None:
    """Summary, lights, cameras, what the reader noticed, what to expect, and the picture that was written."""
    level, scene = inspection.level, inspection.level.scene
    low, high = scene.bounds
    meshes = "1 mesh" if mesh_count(scene) == 1 else f"{mesh_count(scene):,} meshes"
    console.print(Text(printable(str(level.path)), style="bold"))
    summary = Table.grid(padding=(0, 2))
    summary.add_column(style="dim")
    summary.add_column(overflow="fold")
    summary.add_row("format", level.format)
    summary.add_row("scene", printable_name(scene.name))
    summary.add_row("digest", scene.digest)
    summary.add_row("triangles", f"{scene.triangle_count:,} in {meshes}")
    summary.add_row("casters", _shells(inspection.shells))
    summary.add_row(
        "size",
        " x ".join(f"{side:,.4g}" for side in high - low) + f" m, from {_place(low)} to {_place(high)}",
    )
    console.print(summary)
    if scene.lights:
        console.print(_light_table(scene.lights[:MOST_ROWS], console.width, len(scene.lights)))
        _print_rest(console, len(scene.lights), "light")
    if scene.cameras:
        console.print(_camera_table(scene.cameras[:MOST_ROWS], console.width, len(scene.cameras)))
        _print_rest(console, len(scene.cameras), "camera")
    _print_notes(console, inspection)
    if picture is not None:
        console.print(Text(f"Wrote {printable(str(picture), LONGEST_PATH)}."), soft_wrap=True)


def _print_rest(console: Console, count: int, what: str) -> None:
    if count > MOST_ROWS:
        console.print(Text(f"... and {counted(count - MOST_ROWS, f'more {what}')}: --json tells all."))


def _print_notes(console: Console, inspection: Inspection) -> None:
    for note in inspection.level.notes:
        warning = note.severity is Severity.WARNING
        line = Text("warning: " if warning else "note: ", style="bold yellow" if warning else "bold cyan")
        line.append(printable(f"{note.where}: {note.text}"), style="default")
        console.print(line)
    for remark in inspection.remarks:
        line = Text("expect: ", style="bold cyan")
        line.append(printable(remark), style="default")
        console.print(line)


def _shells(shells: Shells) -> str:
    if not shells.triangles:
        return "none"
    parts = {"closed": shells.closed, "balanced": shells.balanced, "open": shells.open}
    shares = ", ".join(f"{100 * part / shells.triangles:.1f} % {name}" for name, part in parts.items())
    return f"{shells.triangles:,} triangles: {shares}"


@dataclass(frozen=True)
class _Column:
    """A column of a table; one that may be left out is, where all its cells hold what goes without saying."""

    title: str
    cells: list[str]
    right: bool = False
    narrowest: int = 0
    unspoken: str = ""

    @property
    def least(self) -> int:
        """Columns of the screen that it cannot do without."""
        words = [*self.title.split(), *(cell for cell in self.cells if self.right)]
        return max(self.narrowest, *map(len, words))


def _light_table(lights: tuple[Light, ...], width: int, count: int) -> Table:
    return _table(
        counted(count, "light"),
        [
            *_addresses(lights),
            _Column("kind", [str(light.kind) for light in lights], narrowest=len(LightKind.DIRECTIONAL)),
            _Column("position", [_whereabouts(light) for light in lights], narrowest=8),
            _Column("range m", [_range(light) for light in lights], right=True, unspoken=NOTHING),
            _Column("full cone", [_cone(light) for light in lights], right=True, unspoken=NOTHING),
            _Column(
                "mobility", [str(light.mobility) for light in lights], right=True, unspoken=Mobility.DYNAMIC
            ),
        ],
        width,
    )


def _camera_table(cameras: tuple[Camera, ...], width: int, count: int) -> Table:
    return _table(
        counted(count, "camera"),
        [
            *_addresses(cameras),
            _Column("position", [_place(camera.position) for camera in cameras], narrowest=8),
            _Column("vertical fov", [_degrees(camera.yfov_rad) for camera in cameras], right=True),
        ],
        width,
    )


def _addresses(found: Sequence[Light | Camera]) -> list[_Column]:
    """By these the other commands know them: no screen is too narrow for them."""
    names = [printable_name(one.name) for one in found]
    return [
        _Column("#", [str(index) for index in range(len(found))], right=True, narrowest=len(str(len(found)))),
        _Column("node", [_number(one.node) for one in found], right=True, narrowest=4),
        _Column("name", names, narrowest=min(max(map(len, names)), NAME_WIDTH)),
    ]


def _table(title: str, columns: Sequence[_Column], width: int) -> Table:
    """As many of the columns, from the left, as `width` has room for."""
    table = Table(
        title=title, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1), collapse_padding=True
    )
    shown = [column for column in columns if not column.unspoken or set(column.cells) != {column.unspoken}]
    spoken = len(shown)
    while sum(column.least + PADDING for column in shown) + PADDING > width and len(shown) > KEPT_COLUMNS:
        shown.pop()
    if len(shown) < spoken:
        table.title = f"{title}, more on a wider screen"
    for column in shown:
        table.add_column(
            column.title,
            justify="right" if column.right else "left",
            overflow="fold",
            min_width=column.least,
        )
    for cells in zip(*(column.cells for column in shown), strict=True):
        table.add_row(*cells)
    return table


def _whereabouts(light: Light) -> str:
    if light.kind is not LightKind.DIRECTIONAL:
        return _place(light.position)
    return "towards (" + ", ".join(f"{component + 0.0:.2g}" for component in light.direction) + ")"


def _range(light: Light) -> str:
    if light.kind is LightKind.DIRECTIONAL:
        return NOTHING
    return f"{light.range_m:,.4g}" if math.isfinite(light.range_m) else "unlimited"


def _cone(light: Light) -> str:
    return _degrees(2 * light.outer_cone_rad) if light.kind is LightKind.SPOT else NOTHING


def _number(node: int | None) -> str:
    return NOTHING if node is None else str(node)


def _degrees(radians: float) -> str:
    return f"{math.degrees(radians):.0f}°"


def _place(position: object) -> str:
    assert hasattr(position, "__iter__")
    return "(" + ", ".join(f"{component + 0.0:.4g}" for component in position) + ")"
