"""`make bench`: frame times of shadow maps and shadow volumes beside what the device can do at most.

Needs `../shared/bench` (box grid and street, on which OGRE was measured). Boxes cast, floors do not. Where
GNOMON_BENCH_OGRE names a Python with ogre-python, trimesh and scipy, OGRE draws between our frames.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from statistics import median

import numpy as np
from limits import measure_limits
from rich.console import Console
from rich.table import Table

from renderers.clock import StageClock, truthful_clock
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.registry import technique
from renderers.settings import Settings
from renderers.technique import Counters, Outcome, ShadowPass
from renderers.timing import TimedFrame, timed_frame
from renderers.world import World
from scenes.formats.registry import read_level
from scenes.scene import Camera, Light, LightKind, Scene

ROOT = Path(__file__).parents[2]
BENCH = ROOT.parent / "shared" / "bench"
ROUNDS = 15
NONE = "none"
CASES: dict[str, tuple[str, Settings]] = {
    "SM 1024": ("SM", {"map_size": 1024, "filter": "2x2", "focus": "light"}),
    "SV": ("SV", {}),
}
# What OGRE does in each case; of several the one with the lower median counts.
OGRE: dict[str, tuple[str, ...]] = {
    "SM 1024": ("texture",),
    "SV": ("stencil additive", "stencil modulative"),
    NONE: (NONE,),
}
# OGRE 14.6 another day on the same kind of machine when quiet, milliseconds a frame; see docs/benchmarks.md.
OGRE_THEN = {
    "scene": {"SM 1024": 38.0, "SV": 257.0, NONE: 24.2},
    "street": {"SM 1024": 20.4, "SV": 14.2, NONE: 9.6},
}


class Unshadowed(ShadowPass):
    """Leaves the mask as it is, for the cost of a frame without shadows."""

    memory_bytes = 0

    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:  # noqa: ARG002  nothing to time
        """Do nothing."""
        return Outcome(NONE, rebuild)

    def count(self) -> Counters:
        """Nothing to count."""
        return {}

    def release(self) -> None:
        """Nothing to give back."""


class Ogre:
    """OGRE beside us, a process for each technique; each draws a frame when asked and sleeps otherwise."""

    def __init__(self, python: str, scene: str, alive: ExitStack) -> None:
        self._processes = {
            technique: alive.enter_context(
                subprocess.Popen(
                    [python, Path(__file__).with_name("ogre.py"), "--scene", scene, "--technique", technique],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    bufsize=0,
                )
            )
            for techniques in OGRE.values()
            for technique in techniques
        }

    def frame_ms(self, technique: str) -> float:
        """Milliseconds of one frame drawn now."""
        process = self._processes[technique]
        try:
            process.stdin.write(b"\n")
            answer = process.stdout.readline()
        except BrokenPipeError:
            answer = b""
        if not answer:
            sys.exit(
                f"OGRE stopped ({technique}); its words are above. Is GNOMON_BENCH_OGRE the right Python?"
            )
        return float(answer)


@dataclass
class Row:
    """One technique on one scene, medians over the rounds, milliseconds.

    Attributes:
        shadow_ms: A frame less one without shadows of the same round.
        frame_ratio: Ours over OGRE's of the same round; None where OGRE was not measured beside us.
        shadow_ratio: The same of `shadow_ms`.
    """

    scene: str
    technique: str
    frame_ms: float
    shadow_ms: float
    stages_ms: dict[str, float]
    counters: dict[str, int]
    ogre_technique: str
    ogre_frame_ms: float
    ogre_shadow_ms: float
    frame_ratio: float | None = None
    shadow_ratio: float | None = None
    raw_frame_ms: dict[str, list[float]] = field(default_factory=dict)


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


def measure(gpu: Gpu, name: str, rounds: int, python: str | None) -> list[Row]:
    """Every case on one scene, ours and OGRE's by turns."""
    scene, width, height = bench_scene(name)
    light, kind = scene.lights[0], truthful_clock(gpu)
    ours: dict[str, list[TimedFrame]] = {case: [] for case in OGRE}
    theirs: dict[str, list[float]] = {
        technique: [] for techniques in OGRE.values() for technique in techniques
    }
    with ExitStack() as alive, Frame(World.of(gpu, scene), width, height) as frame:
        ogre = Ogre(python, name, alive) if python else None
        frame.look(scene.cameras[0])
        frame.shine(light)
        passes: dict[str, ShadowPass] = {
            case: alive.enter_context(technique(label).prepare(frame, light, settings))
            for case, (label, settings) in CASES.items()
        }
        passes[NONE] = Unshadowed()
        for round_index in range(-1, rounds):
            for case, one in passes.items():
                if case == NONE:
                    frame.write_mask(np.ones((height, width), bool))
                timed = timed_frame(frame, one, kind, rebuild=True)
                drawn = {technique: ogre.frame_ms(technique) for technique in OGRE[case]} if ogre else {}
                if round_index >= 0:
                    ours[case].append(timed)
                    for label, frame_ms in drawn.items():
                        theirs[label].append(frame_ms)
        counters = {case: dict(one.count()) for case, one in passes.items()}
    return [_row(name, case, ours, theirs, counters[case]) for case in CASES]


def _row(
    name: str,
    case: str,
    ours: dict[str, list[TimedFrame]],
    theirs: dict[str, list[float]],
    counters: Counters,
) -> Row:
    stages = ours[case][0].stages_ms
    frames, without = (np.array([one.frame_ms for one in ours[key]]) for key in (case, NONE))
    then = OGRE_THEN[name]
    row = Row(
        name,
        case,
        median(frames),
        median(frames - without),
        {stage: median(one.stages_ms[stage] for one in ours[case]) for stage in stages},
        dict(counters),
        OGRE[case][0].split()[0],
        then[case],
        then[case] - then[NONE],
        raw_frame_ms={"ours": list(frames), "ours none": list(without)},
    )
    if theirs[NONE]:
        best = min(OGRE[case], key=lambda label: median(theirs[label]))
        ogre, ogre_without = np.array(theirs[best]), np.array(theirs[NONE])
        row.ogre_technique, row.ogre_frame_ms = best, median(ogre)
        row.ogre_shadow_ms = median(ogre - ogre_without)
        row.frame_ratio = median(frames / ogre)
        row.shadow_ratio = median((frames - without) / (ogre - ogre_without))
        row.raw_frame_ms |= {f"OGRE {label}": theirs[label] for label in (*OGRE[case], NONE)}
    return row


def main() -> None:
    """Measure, print a table, and with --json the raw samples."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--device")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    if not BENCH.is_dir():
        sys.exit(f"{BENCH.name}: the bench scenes are not here; nothing was measured.")
    python = os.environ.get("GNOMON_BENCH_OGRE")
    console = Console(stderr=True)
    with Gpu(arguments.device) as gpu, console.status("measuring"):
        limits = measure_limits(gpu)
        rows = [row for name in OGRE_THEN for row in measure(gpu, name, arguments.rounds, python)]
        device = gpu.device
    if arguments.json:
        rows_json = [asdict(row) for row in rows]
        json.dump({"device": device.as_dict(), "limits": asdict(limits), "rows": rows_json}, sys.stdout)
        return
    table = Table(title=f"{device.renderer}, 1280x1024, median of {arguments.rounds} rounds, milliseconds")
    headings = ("scene", "technique", "frame", "OGRE", "ours/OGRE", "shadows alone", "OGRE", "ours/OGRE")
    for heading in (*headings, "OGRE's way", "stages", "counters"):
        table.add_column(heading)
    for row in rows:
        stages = ", ".join(f"{stage} {ms:.1f}" for stage, ms in row.stages_ms.items())
        counters = ", ".join(f"{key} {value:,}" for key, value in row.counters.items())
        table.add_row(
            row.scene,
            row.technique,
            f"{row.frame_ms:.1f}",
            f"{row.ogre_frame_ms:.1f}",
            "-" if row.frame_ratio is None else f"{row.frame_ratio:.2f}",
            f"{row.shadow_ms:.1f}",
            f"{row.ogre_shadow_ms:.1f}",
            "-" if row.shadow_ratio is None else f"{row.shadow_ratio:.2f}",
            row.ogre_technique,
            stages,
            counters,
        )
    console = Console(width=200)
    console.print(table)
    if not python:
        console.print(
            "OGRE was not measured beside us: GNOMON_BENCH_OGRE names no Python with ogre-python. "
            "Its figures are another day's, on the same kind of machine when quiet."
        )
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
