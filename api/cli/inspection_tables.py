"""The tables of `gnomon inspect`."""

from __future__ import annotations

import math

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable
from api.inspection import Inspection, mesh_count
from api.shells import Shells
from api.wording import counted
from scenes.level import Severity
from scenes.scene import Camera, Light, LightKind

NOTHING = "-"


def print_inspection(console: Console, inspection: Inspection) -> None:
    """Summary, lights, cameras, what the reader noticed, what to expect."""
    level, scene = inspection.level, inspection.level.scene
    low, high = scene.bounds
    meshes = "1 mesh" if mesh_count(scene) == 1 else f"{mesh_count(scene):,} meshes"
    console.print(Text(printable(str(level.path)), style="bold"))
    summary = Table.grid(padding=(0, 2))
    summary.add_column(style="dim")
    summary.add_column(overflow="fold")
    summary.add_row("format", level.format)
    summary.add_row("scene", printable(scene.name))
    summary.add_row("digest", scene.digest)
    summary.add_row("triangles", f"{scene.triangle_count:,} in {meshes}")
    summary.add_row("casters", _shells(inspection.shells))
    summary.add_row(
        "size",
        " x ".join(f"{side:,.4g}" for side in high - low) + f" m, from {_place(low)} to {_place(high)}",
    )
    console.print(summary)
    if scene.lights:
        console.print(_light_table(scene.lights))
    if scene.cameras:
        console.print(_camera_table(scene.cameras))
    _print_notes(console, inspection)


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


def _light_table(lights: tuple[Light, ...]) -> Table:
    table = _titled(counted(len(lights), "light"))
    for column in ("#", "node"):
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("name", overflow="fold")
    table.add_column("kind", no_wrap=True)
    table.add_column("position", no_wrap=True)
    for column in ("range m", "cone", "mobility"):
        table.add_column(column, justify="right", no_wrap=True)
    for index, light in enumerate(lights):
        sun = light.kind is LightKind.DIRECTIONAL
        table.add_row(
            str(index),
            _number(light.node),
            printable(light.name),
            str(light.kind),
            f"towards {_place(light.direction)}" if sun else _place(light.position),
            NOTHING if sun else f"{light.range_m:,.4g}" if math.isfinite(light.range_m) else "no end",
            _degrees(2 * light.outer_cone_rad) if light.kind is LightKind.SPOT else NOTHING,
            str(light.mobility),
        )
    return table


def _camera_table(cameras: tuple[Camera, ...]) -> Table:
    table = _titled(counted(len(cameras), "camera"))
    for column in ("#", "node"):
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("name", overflow="fold")
    table.add_column("position", no_wrap=True)
    table.add_column("height", justify="right", no_wrap=True)
    for index, camera in enumerate(cameras):
        table.add_row(
            str(index),
            _number(camera.node),
            printable(camera.name),
            _place(camera.position),
            _degrees(camera.yfov_rad),
        )
    return table


def _titled(title: str) -> Table:
    return Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1))


def _number(node: int | None) -> str:
    return NOTHING if node is None else str(node)


def _degrees(radians: float) -> str:
    return f"{math.degrees(radians):.0f}°"


def _place(position: object) -> str:
    assert hasattr(position, "__iter__")
    return "(" + ", ".join(f"{component + 0.0:.4g}" for component in position) + ")"
