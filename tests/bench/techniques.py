"""`make bench`, second part: every technique beside the others, and how each grows.

Scenes: the box grid and the street of `../shared/bench`, a grid of 250,000 triangles and the thesis' water
tower. Growth: with triangles, pixels, map size and overlapping volumes, from a base in the middle. All
techniques take turns in every round, so that what else the machine does hits all alike.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median

import numpy as np
from frames import BENCH, bench_scene
from rich.console import Console
from rich.progress import track
from rich.table import Table

from renderers.clock import ClockKind, truthful_clock
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.registry import TECHNIQUES, technique
from renderers.settings import Settings
from renderers.timing import TimedFrame, timed_frame
from renderers.world import World
from scenes.scene import Camera, Light, Mesh, Scene
from scenes.thesis.box_grid import box_grid
from scenes.thesis.water_tower import water_tower

ROUNDS = 7
FULL, HALF = (1280, 1024), (640, 512)
LARGE_GRID_BOXES = 20_833
MOBILITIES = {"dynamic": True, "static": False}
# What a warped map does where it is not worth it is no longer that technique.
ALWAYS = {"perspective_shadow_map", "light_space_perspective_shadow_map"}
USUAL_SIDE = 1024
HYBRID_SIDE = 512


@dataclass(frozen=True)
class Stage:
    """A scene with its first light and camera, at a resolution."""

    name: str
    scene: Scene
    size: tuple[int, int]

    @property
    def light(self) -> Light:
        return self.scene.lights[0]

    @property
    def camera(self) -> Camera:
        return self.scene.cameras[0]


@dataclass(frozen=True)
class Row:
    """One technique on one stage: medians in milliseconds, and what it did."""

    stage: str
    technique: str
    value: float
    shadow_ms: dict[str, float]
    frame_ms: dict[str, float]
    stages_ms: dict[str, float]
    counters: dict[str, int]
    raw_shadow_ms: dict[str, list[float]]


def usual_settings(name: str, side: int = USUAL_SIDE) -> Settings:
    """Settings that stand for a technique: a map of `side`, half of that for the hybrid."""
    options = technique(name).options
    settings: dict[str, str | int | float | bool] = {}
    if "map_size" in options:
        settings["map_size"] = side * HYBRID_SIDE // USUAL_SIDE if name == "chan_hybrid" else side
    if name in ALWAYS:
        settings["fall_back"] = "never"
    return settings


def stages() -> Iterator[Stage]:
    """The scenes on which techniques are compared."""
    for name, title in (("scene", "box grid"), ("street", "street")):
        scene, width, height = bench_scene(name)
        yield Stage(title, scene, (width, height))
    yield Stage("box grid, 250,000 triangles", box_grid(LARGE_GRID_BOXES), FULL)
    yield Stage("water tower", water_tower(), FULL)


def sheets(count: int) -> Scene:
    """`count` sheets above each other between the light and the floor of the box grid."""
    grid = box_grid(1)
    side = np.array([[-4.0, 0, -4], [-4, 0, 4], [4, 0, 4], [4, 0, -4]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    heights = np.linspace(1.0, 6.0, count)
    stack = [Mesh(f"sheet {i}", side + np.array([0, y, 0], np.float32), faces) for i, y in enumerate(heights)]
    floors = tuple(mesh for mesh in grid.meshes if "floor" in mesh.name)
    return replace(grid, meshes=(*floors, *stack))


GROWTHS: dict[str, tuple[tuple[int, ...], Callable[[int], tuple[Stage, int]]]] = {
    "triangles": (
        (1_500, 12_000, 96_000, 384_000),
        lambda n: (Stage("grid", box_grid(n // 12), HALF), USUAL_SIDE),
    ),
    "pixels": (
        (320 * 256, 640 * 512, 1280 * 1024, 2560 * 2048),
        lambda n: (
            Stage("grid", box_grid(), (round((n * 1.25) ** 0.5), round((n / 1.25) ** 0.5))),
            USUAL_SIDE,
        ),
    ),
    "map size": ((256, 512, 1024, 2048, 4096), lambda n: (Stage("grid", box_grid(), HALF), n)),
    "overlapping volumes": ((1, 4, 16, 64, 256), lambda n: (Stage("sheets", sheets(n), HALF), USUAL_SIDE)),
}


def measure(gpu: Gpu, stage: Stage, rounds: int, side: int, value: float = 0.0) -> list[Row]:
    """Every technique on one stage, by turns, dynamic and static."""
    kind: ClockKind = truthful_clock(gpu)
    timed: dict[tuple[str, str], list[TimedFrame]] = {}
    world = World.of(gpu, stage.scene)
    with ExitStack() as alive:
        alive.callback(world.release)
        frame = alive.enter_context(Frame(world, *stage.size))
        frame.look(stage.camera)
        frame.shine(stage.light)
        passes = {
            known.label: alive.enter_context(
                known.prepare(frame, stage.light, usual_settings(known.name, side))
            )
            for known in TECHNIQUES
        }
        for round_index in range(-1, rounds):
            for label, one in passes.items():
                for mobility, rebuild in MOBILITIES.items():
                    found = timed_frame(frame, one, kind, rebuild=rebuild)
                    if round_index >= 0:
                        timed.setdefault((label, mobility), []).append(found)
        counters = {label: dict(one.count()) for label, one in passes.items()}
    return [_row(stage.name, label, value, timed, counters[label]) for label in passes]


def _row(
    stage: str,
    label: str,
    value: float,
    timed: dict[tuple[str, str], list[TimedFrame]],
    counters: dict[str, int],
) -> Row:
    frames = {mobility: timed[label, mobility] for mobility in MOBILITIES}
    dynamic = frames["dynamic"]
    return Row(
        stage,
        label,
        value,
        {mobility: median(one.shadow_ms for one in found) for mobility, found in frames.items()},
        {mobility: median(one.frame_ms for one in found) for mobility, found in frames.items()},
        {name: median(one.stages_ms[name] for one in dynamic) for name in dynamic[0].stages_ms},
        counters,
        {mobility: [one.shadow_ms for one in found] for mobility, found in frames.items()},
    )


def exponent(rows: list[Row]) -> float:
    """Slope of log time over log value: 1 grows in proportion, 0 not at all."""
    slope, _ = np.polyfit(
        np.log([row.value for row in rows]), np.log([row.shadow_ms["dynamic"] for row in rows]), 1
    )
    return float(slope)


def print_stages(console: Console, rows: list[Row], title: str) -> None:
    """A table of techniques on scenes, and the share of volume fragments that the hybrid saves."""
    table = Table(title=title)
    for heading in ("scene", "technique", "shadow ms", "static", "frame ms", "over SM", "stages", "counters"):
        table.add_column(heading)
    for row in rows:
        base = next(one for one in rows if one.stage == row.stage and one.technique == "SM")
        table.add_row(
            row.stage,
            row.technique,
            f"{row.shadow_ms['dynamic']:.1f}",
            f"{row.shadow_ms['static']:.1f}",
            f"{row.frame_ms['dynamic']:.1f}",
            f"{row.shadow_ms['dynamic'] / base.shadow_ms['dynamic']:.2f}",
            ", ".join(f"{name} {ms:.1f}" for name, ms in row.stages_ms.items()),
            ", ".join(f"{name} {count:,}" for name, count in row.counters.items()),
        )
    console.print(table)
    for stage in dict.fromkeys(row.stage for row in rows):
        volumes, hybrid = (
            next(
                row.counters["volume_fragments"]
                for row in rows
                if (row.stage, row.technique) == (stage, label)
            )
            for label in ("SV", "Chan")
        )
        console.print(
            f"{stage}: Chan rasterises {hybrid:,} volume fragments where SV rasterises {volumes:,}: "
            f"{1 - hybrid / volumes:.1%} saved."
        )


def print_growth(console: Console, what: str, rows: list[Row]) -> None:
    """A table of milliseconds over the growing value, and the exponent with which they grow."""
    values = sorted({row.value for row in rows})
    table = Table(title=f"shadow ms of dynamic lights as {what} grow")
    table.add_column("technique")
    for value in values:
        table.add_column(f"{value:,.0f}", justify="right")
    table.add_column("exponent", justify="right")
    for label in dict.fromkeys(row.technique for row in rows):
        own = [row for row in rows if row.technique == label]
        table.add_row(label, *(f"{row.shadow_ms['dynamic']:.1f}" for row in own), f"{exponent(own):.2f}")
    console.print(table)


def main() -> None:
    """Measure, print tables, and with --json keep the raw samples."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--device")
    parser.add_argument("--json", type=Path, metavar="FILE", help="where to write the raw samples")
    arguments = parser.parse_args()
    if not BENCH.is_dir():
        sys.exit(f"{BENCH.name}: the bench scenes are not here; nothing was measured.")
    progress = Console(stderr=True)
    growth: dict[str, list[Row]] = {}
    with Gpu(arguments.device) as gpu:
        rows = [
            row
            for stage in track(list(stages()), "scenes", console=progress)
            for row in measure(gpu, stage, arguments.rounds, USUAL_SIDE)
        ]
        for what, (values, make) in GROWTHS.items():
            growth[what] = [
                row
                for value in track(values, what, console=progress)
                for stage, side in [make(value)]
                for row in measure(gpu, stage, arguments.rounds, side, value)
            ]
        device = gpu.device
    if arguments.json:
        record = {
            "device": device.as_dict(),
            "rows": [asdict(row) for row in rows],
            "growth": {what: [asdict(row) for row in found] for what, found in growth.items()},
        }
        arguments.json.write_text(json.dumps(record))
    console = Console(width=220)
    print_stages(console, rows, f"{device.renderer}, median of {arguments.rounds} rounds, milliseconds")
    for what, found in growth.items():
        print_growth(console, what, found)


if __name__ == "__main__":
    main()
