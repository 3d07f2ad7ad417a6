"""`make bench`: frame times of shadow maps and shadow volumes beside what the device can do at most.

Needs `../shared/bench` (box grid and street, on which OGRE was measured). Boxes cast, floors do not.
"""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from statistics import median

import numpy as np
from limits import measure_limits
from rich.console import Console
from rich.table import Table

from renderers.clock import truthful_clock
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.registry import technique
from renderers.technique import Settings, ShadowPass
from renderers.timing import TimedFrame, timed_frame
from renderers.world import World
from scenes.formats.registry import read_level
from scenes.scene import Camera, Light, LightKind, Scene

ROOT = Path(__file__).parents[2]
BENCH = ROOT.parent / "shared" / "bench"
ROUNDS = 15
# OGRE 14.6 on the same kind of machine when quiet, milliseconds: whole frame without shadows, with texture
# shadows, with stencil shadows (the better of its two modes each); see docs/benchmarks.md.
OGRE = {"scene": (24.2, 38.0, 257.0), "street": (9.6, 20.4, 14.2)}
CASES: dict[str, tuple[str, Settings]] = {
    "SM 1024": ("SM", {"map_size": 1024, "filter": "2x2", "focus": "light"}),
    "SV": ("SV", {}),
}


@dataclass
class Row:
    """One technique on one scene, medians over the rounds, milliseconds."""

    scene: str
    technique: str
    frame_ms: float
    shadow_ms: float
    stages_ms: dict[str, float]
    counters: dict[str, int]
    ogre_frame_ms: float
    ogre_shadow_ms: float
    raw_frame_ms: list[float] = field(default_factory=list)


def bench_scene(name: str) -> tuple[Scene, int, int]:
    """The scene `name` with the light and camera of its JSON, and the resolution."""
    setup = json.loads((BENCH / f"{name}.json").read_text())
    scene = read_level(BENCH / f"{name}.glb").scene
    position = np.array(setup["light"])
    light = Light(
        "light",
        LightKind.SPOT,
        tuple(position),
        _unit(np.array(setup["target"]) - position),
        float(np.radians(setup["inner"])),
        float(np.radians(setup["cutoff"])),
    )
    eye = np.array(setup["eye"])
    forward = _unit(np.array(setup["look"]) - eye)
    right = _unit(np.cross(forward, [0.0, 1.0, 0.0]))
    camera = Camera(
        "camera",
        tuple(eye),
        forward,
        _unit(np.cross(right, forward)),
        float(np.radians(setup["fovy"])),
        setup["near"],
    )
    meshes = tuple(replace(mesh, casts="floor" not in mesh.name.lower()) for mesh in scene.meshes)
    return Scene(name, meshes, (light,), (camera,)), setup["W"], setup["H"]


def _unit(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = vector / np.linalg.norm(vector)
    return float(x), float(y), float(z)


def measure(gpu: Gpu, name: str, rounds: int) -> list[Row]:
    """Every case on one scene, interleaved."""
    scene, width, height = bench_scene(name)
    light, kind = scene.lights[0], truthful_clock(gpu)
    samples: dict[str, list[TimedFrame]] = {case: [] for case in CASES}
    with ExitStack() as alive, Frame(World.of(gpu, scene), width, height) as frame:
        frame.look(scene.cameras[0])
        frame.shine(light)
        passes: dict[str, ShadowPass] = {
            case: alive.enter_context(technique(label).prepare(frame, light, settings))
            for case, (label, settings) in CASES.items()
        }
        for round_index in range(-1, rounds):
            for case, one in passes.items():
                timed = timed_frame(frame, one, kind, rebuild=True)
                if round_index >= 0:
                    samples[case].append(timed)
        counters = {case: dict(one.count()) for case, one in passes.items()}
    rows = []
    for index, (case, timed) in enumerate(samples.items()):
        none, *theirs = OGRE[name]
        stages = {stage: median(one.stages_ms[stage] for one in timed) for stage in timed[0].stages_ms}
        rows.append(
            Row(
                name,
                case,
                median(one.frame_ms for one in timed),
                median(one.shadow_ms for one in timed),
                stages,
                counters[case],
                theirs[index],
                theirs[index] - none,
                [one.frame_ms for one in timed],
            )
        )
    return rows


def main() -> None:
    """Measure, print a table, and with --json the raw samples."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--device")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    if not BENCH.is_dir():
        sys.exit(f"{BENCH.name}: the bench scenes are not here; nothing was measured.")
    console = Console(stderr=True)
    with Gpu(arguments.device) as gpu, console.status("measuring"):
        limits = measure_limits(gpu)
        rows = [row for name in OGRE for row in measure(gpu, name, arguments.rounds)]
        device = gpu.device
    if arguments.json:
        rows_json = [asdict(row) for row in rows]
        json.dump({"device": device.as_dict(), "limits": asdict(limits), "rows": rows_json}, sys.stdout)
        return
    table = Table(title=f"{device.renderer}, 1280x1024, median of {arguments.rounds} rounds, milliseconds")
    for heading in ("scene", "technique", "frame", "OGRE", "shadows alone", "OGRE", "stages", "counters"):
        table.add_column(heading)
    for row in rows:
        stages = ", ".join(f"{stage} {ms:.1f}" for stage, ms in row.stages_ms.items())
        counters = ", ".join(f"{key} {value:,}" for key, value in row.counters.items())
        table.add_row(
            row.scene,
            row.technique,
            f"{row.frame_ms:.1f}",
            f"{row.ogre_frame_ms:.1f}",
            f"{row.shadow_ms:.1f}",
            f"{row.ogre_shadow_ms:.1f}",
            stages,
            counters,
        )
    console = Console(width=200)
    console.print(table)
    console.print(
        f"Limits: {limits.blended_fragments / 1e6:,.0f} M blended fragments/s, "
        f"{limits.depth_fragments / 1e6:,.0f} M depth fragments/s, "
        f"{limits.triangles / 1e6:,.1f} M triangles/s."
    )
    for row in rows:
        if row.technique == "SV":
            rate = row.counters["volume_fragments"] / row.stages_ms["volumes"] * 1e3
            console.print(
                f"SV on {row.scene}: {rate / 1e6:,.0f} M fragments/s, "
                f"{rate / limits.blended_fragments:.0%} of the fill limit."
            )


if __name__ == "__main__":
    main()
