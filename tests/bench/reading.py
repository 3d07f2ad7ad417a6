"""How long a level of 1,000,000 triangles takes to read, beside trimesh or usd-core, and in how much memory.

    .venv/bin/python -m tests.bench.reading [LEVEL...]

Without levels it writes its own (`million.py`). Ours and the other's readings alternate, so that what else
the machine does hits both; each figure is a median. usd-core opens the stage and hands out every mesh's
arrays; trimesh keeps an OBJ's objects apart, as we do, and leaves its materials out. Memory is the most that
a fresh process and its own processes hold while they read, less what they held before, over the bytes of the
arrays that are drawn; kept are fewer where nodes share them. Needs Linux.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import trimesh
from rich.console import Console
from rich.table import Table

from scenes.formats.registry import read_level
from tests.bench import million

ROUNDS = 7
TIME_LIMIT, MEMORY_LIMIT = 2.0, 4.0
HEADINGS = (
    *("level", "triangles", "ours s", "theirs s", "ratio"),
    *("kept MB", "drawn MB", "peak MB", "ratio", "their peak MB"),
)

MEASURE = """
import sys
from pathlib import Path
from tests.bench.reading import READERS
def resident(name):
    # The rusage of a process starts with the peak of the one that started it; this does not.
    own = list(Path("/proc/self/task").glob("*/children"))
    pids = ["self", *(pid for file in own for pid in file.read_text().split())]
    lines = (line for pid in pids for line in open(f"/proc/{pid}/status") if line.startswith(name))
    return sum(int(line.split()[1]) for line in lines) * 1024
read = READERS[sys.argv[1]]
# What the libraries themselves take counts for nothing.
read(Path(sys.argv[2]))
before = resident("VmRSS")
found = read(Path(sys.argv[3]))
print(resident("VmHWM") - before)
"""


@dataclass(frozen=True)
class Reading:
    """What reading one level took: medians in seconds, and bytes."""

    ours_s: float
    theirs_s: float
    peak_bytes: int
    their_peak_bytes: int
    array_bytes: int
    drawn_bytes: int
    triangles: int


def seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def by_trimesh(path: Path) -> object:
    """What trimesh makes of a level."""
    apart = {"split_objects": True, "group_material": False, "skip_materials": True}
    return trimesh.load_scene(path, process=False, **(apart if path.suffix == ".obj" else {}))


def by_usd(path: Path) -> object:
    """What usd-core says of every mesh of a stage: its arrays, its place, and whether it is drawn at all."""
    from pxr import Usd, UsdGeom  # noqa: PLC0415  an extra

    stage = Usd.Stage.Open(str(path))
    places = UsdGeom.XformCache()
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    return [
        (
            np.array(one.GetPointsAttr().Get()),
            np.array(one.GetFaceVertexIndicesAttr().Get()),
            np.array(one.GetFaceVertexCountsAttr().Get()),
            places.GetLocalToWorldTransform(one.GetPrim()),
            one.ComputeVisibility(),
            one.ComputePurpose(),
        )
        for one in meshes
    ]


READERS: dict[str, Callable[[Path], object]] = {
    "ours": read_level,
    "by_trimesh": by_trimesh,
    "by_usd": by_usd,
}


def measured(path: Path, small: Path, rounds: int) -> Reading:
    """Time and memory of reading one level; `small` is one of the same format."""
    theirs = by_usd if path.suffix.startswith(".usd") else by_trimesh
    scene = read_level(path).scene
    theirs(path)
    our_s, their_s = [], []
    for _ in range(rounds):
        our_s.append(seconds(lambda: read_level(path)))
        their_s.append(seconds(lambda: theirs(path)))
    peaks = [peak(name, path, small) for name in ("ours", theirs.__name__)]
    arrays = {id(a): a.nbytes for m in scene.meshes for a in (m.positions, m.triangles, m.placements)}
    drawn = sum((m.positions.nbytes + m.triangles.nbytes + 128) * len(m.placements) for m in scene.meshes)
    return Reading(median(our_s), median(their_s), *peaks, sum(arrays.values()), drawn, scene.triangle_count)


def peak(reader: str, path: Path, small: Path) -> int:
    """Bytes that a fresh process holds at most while it reads a level, beyond those after a small one."""
    done = subprocess.run(
        [sys.executable, "-c", MEASURE, reader, str(small), str(path)],
        check=True,
        capture_output=True,
        text=True,
    )
    return int(done.stdout)


def row(path: Path, found: Reading) -> dict[str, Any]:
    """The figures of one level, and whether it keeps both limits; what their reader holds is not ours."""
    times, memory = found.ours_s / found.theirs_s, found.peak_bytes / found.drawn_bytes
    ours_alone = (found.peak_bytes - found.their_peak_bytes) / found.drawn_bytes
    kept = times <= TIME_LIMIT and min(memory, ours_alone) <= MEMORY_LIMIT
    return {"level": path.name, **asdict(found), "time_ratio": times, "memory_ratio": memory, "kept": kept}


def shown(figures: dict[str, Any]) -> list[str]:
    """A row of the table."""
    kept, drawn, ours, theirs = (
        f"{figures[name] / 1e6:.1f}"
        for name in ("array_bytes", "drawn_bytes", "peak_bytes", "their_peak_bytes")
    )
    our_s, their_s = (f"{figures[name]:.3f}" for name in ("ours_s", "theirs_s"))
    times, memory = (f"{figures[name]:.2f}" for name in ("time_ratio", "memory_ratio"))
    counted = figures["level"], f"{figures['triangles']:,}"
    return [*counted, our_s, their_s, times, kept, drawn, ours, memory, theirs]


def main() -> int:
    """Prints a table; the exit code says whether all levels keep both limits."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("levels", nargs="*", type=Path, metavar="LEVEL")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder, few = Path(name), Path(name) / "few"
        few.mkdir()
        for path in chosen.levels or million.levels(folder):
            rows.append(row(path, measured(path, million.small(few, path.suffix), chosen.rounds)))
            sys.stderr.write(" ".join(shown(rows[-1])) + "\n")
    table = Table(*HEADINGS)
    for figures in rows:
        table.add_row(*shown(figures))
    console = Console()
    console.width = max(console.width, len(" ".join(HEADINGS)) + 50)
    console.print(table)
    if chosen.json:
        chosen.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0 if all(figures["kept"] for figures in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
