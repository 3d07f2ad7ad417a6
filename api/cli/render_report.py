"""What `gnomon render` says."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable
from api.rendering import Rendering
from renderers.error_figures import ErrorFigures
from scenes.scene import Mobility
from selector.measurement import Status

NO_ERROR_FIGURES = "the view shows nothing that the light reaches"


def print_rendering(console: Console, rendering: Rendering) -> None:
    """Technique, times, memory, counters, error figures, and where the picture is."""
    measurement, run = rendering.measurement, rendering.run
    view = run.views[0]
    light, method = measurement.light, run.candidate.method
    console.print(
        Text.assemble((run.candidate.label, "bold"), f"  {method.title} ({method.name})"), soft_wrap=True
    )
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    others = f", the first of {rendering.others + 1} of this name" if rendering.others else ""
    table.add_row("light", printable(f"{light.name} ({light.kind}, node {light.node}{others})"))
    table.add_row("view", printable(f"{rendering.camera.name}, {measurement.width}x{measurement.height}"))
    table.add_row("device", printable(f"{measurement.device.renderer}, time by {measurement.clock} clock"))
    if run.status is not Status.OK or view.note:
        table.add_row("status", printable(f"{run.status} {run.reason} {view.note}".strip()))
    for mobility in (Mobility.DYNAMIC, Mobility.STATIC):
        shadow_ms, frame_ms = run.shadow_ms(mobility), run.frame_ms(mobility)
        if shadow_ms is not None and frame_ms is not None:
            stages = ", ".join(f"{name} {ms:.2f}" for name, ms in run.stages_ms(mobility).items())
            table.add_row(
                f"{mobility} light", f"shadow {shadow_ms:.2f} ms, frame {frame_ms:.2f} ms ({stages})"
            )
    table.add_row("memory", f"{run.memory_bytes / 1e6:.2f} MB")
    table.add_row("work", ", ".join(f"{name.replace('_', ' ')} {n:,}" for name, n in view.counters.items()))
    table.add_row(f"error (against {view.truth})", _error(view.figures, view.flip))
    shown = f", which shows the view {rendering.view}" if rendering.view else ""
    table.add_row("picture", printable(f"{rendering.output}{shown}"))
    console.print(table)


def _error(figures: ErrorFigures | None, flip: float | None) -> str:
    if figures is None or figures.wrong_share is None:
        return NO_ERROR_FIGURES
    assert figures.false_lit is not None
    assert figures.false_shadow is not None
    edge = (
        f"edge off by {figures.edge_error_px:.2f} px over {figures.boundary_px:.0f} px"
        if figures.edge_error_px is not None
        else f"too little edge to judge ({figures.boundary_px:.0f} px)"
    )
    wrong = (
        f"wrong {100 * figures.wrong_share:.3f} % (false light {100 * figures.false_lit:.3f} %, "
        f"false shadow {100 * figures.false_shadow:.3f} %)"
    )
    parts = [edge, wrong]
    if flip is not None:
        parts.append(f"FLIP {flip:.4f}")
    return "; ".join(parts)
