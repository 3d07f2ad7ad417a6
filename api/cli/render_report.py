"""What `gnomon render` says."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cli.terminal import printable
from api.rendering import Rendering
from api.verdicts import EXACT, is_exact_by_definition
from api.wording import amount
from renderers.registry import technique
from scenes.scene import Mobility
from selector.candidate import Candidate
from selector.measurement import Measurement, Status

NO_ERROR_FIGURES = "the view shows nothing that the light reaches"
FORCED = "fall_back=never"
COUNTERS = {"map_texels_written": "map fragments"}
"""Overdraw is counted, so that more may be written than there are texels."""


def print_rendering(console: Console, rendering: Rendering) -> None:
    """Technique, times, memory, counters, error figures, and where the picture is."""
    measurement, run = rendering.measurement, rendering.run
    view = run.views[0]
    light, method = measurement.light, run.candidate.method
    drawn = technique(view.fallback).label if view.fallback else ""
    instead = f"; {drawn} was drawn" if drawn else ""
    console.print(
        Text.assemble((run.candidate.label, "bold"), f"  {method.title} ({method.name}){instead}"),
        soft_wrap=True,
    )
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    others = f", the first of {rendering.others + 1} of this name" if rendering.others else ""
    node = "" if light.node is None else f", node {light.node}"
    table.add_row("light", printable(f"{light.name} ({light.kind}{node}{others})"))
    table.add_row("view", printable(f"{rendering.camera.name}, {measurement.width}x{measurement.height}"))
    table.add_row("device", printable(f"{measurement.device.renderer}, time by {measurement.clock} clock"))
    if drawn:
        table.add_row("fell back", printable(run.reason))
        if can_be_forced(run.candidate):
            table.add_row("", f"--set {FORCED} draws the warp all the same")
    elif run.status is not Status.OK:
        table.add_row("status", printable(f"{run.status}: {run.reason}"))
    if view.note:
        table.add_row("note", printable(view.note))
    for mobility in (Mobility.DYNAMIC, Mobility.STATIC):
        shadow_ms, frame_ms = run.shadow_ms(mobility), run.frame_ms(mobility)
        if shadow_ms is not None and frame_ms is not None:
            stages = ", ".join(f"{name} {ms:.2f}" for name, ms in run.stages_ms(mobility).items())
            table.add_row(
                f"{mobility} light", f"shadow {shadow_ms:.2f} ms, frame {frame_ms:.2f} ms ({stages})"
            )
    table.add_row("memory", amount(run.memory_bytes))
    table.add_row("work", ", ".join(f"{counter_words(name)} {n:,}" for name, n in view.counters.items()))
    of_drawn = f"error of the {drawn}" if drawn else "error"
    table.add_row(f"{of_drawn} (against {view.truth})", _error(run))
    shown = f", which shows the view {rendering.view}" if rendering.view else ""
    table.add_row("picture", printable(f"{rendering.output}{shown}"))
    console.print(table)


def counter_words(name: str) -> str:
    """A work counter's name for readers."""
    return COUNTERS.get(name, name.replace("_", " "))


def can_be_forced(candidate: Candidate) -> bool:
    """Whether a setting keeps the technique from falling back, and is not in use."""
    name, _, value = FORCED.partition("=")
    option = candidate.method.options.get(name)
    return option is not None and value in option.choices and dict(candidate.settings).get(name) != value


def _error(run: Measurement) -> str:
    view = run.views[0]
    figures, flip = view.figures, view.flip
    if figures is None or figures.wrong_share is None:
        return NO_ERROR_FIGURES
    if is_exact_by_definition(run) and not figures.wrong_share:
        return EXACT
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
