"""How long a glTF level of 1,000,000 triangles takes to read, beside trimesh, and how much memory it takes.

    .venv/bin/python tests/bench/reading.py [LEVEL...]

Without levels it writes its own: one mesh, a thousand meshes, one mesh that ten thousand nodes draw, and
quantised positions with short indices. Ours and trimesh's readings alternate, so that what else the machine
does hits both; each figure is a median. Memory is the most that a fresh process holds while it reads, less
what it held before, over the bytes of the arrays that are drawn; kept are fewer where nodes share them. Needs
Linux.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import trimesh
from rich.console import Console
from rich.table import Table

from scenes.formats.registry import read_level
from scenes.gltf.json_chunk import BINARY_CHUNK, CHUNK, HEADER, JSON_CHUNK, MAGIC

ROUNDS = 7
TIME_LIMIT, MEMORY_LIMIT = 2.0, 4.0
COMPONENTS = {"f4": 5126, "u4": 5125, "u2": 5123, "i2": 5122}

HEADINGS = ("level", "triangles", "ours s", "trimesh s", "ratio", "kept MB", "drawn MB", "peak MB", "ratio")

MEASURE = """
import sys
from pathlib import Path
from scenes.formats.registry import level_formats, read_level
level_formats()
def resident(name):
    # The rusage of a process starts with the peak of the one that started it; this does not.
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith(name)) * 1024
before = resident("VmRSS")
scene = read_level(Path(sys.argv[1])).scene
after = resident("VmHWM")
arrays = {id(a): a.nbytes for m in scene.meshes for a in (m.positions, m.triangles, m.placements)}
drawn = sum((m.positions.nbytes + m.triangles.nbytes + 128) * len(m.placements) for m in scene.meshes)
print(after - before, sum(arrays.values()), drawn)
"""


@dataclass(frozen=True)
class Reading:
    """What reading one level took: medians in seconds, and bytes."""

    ours_s: float
    trimesh_s: float
    peak_bytes: int
    array_bytes: int
    drawn_bytes: int
    triangles: int


class Draft:
    """A GLB as it grows."""

    def __init__(self) -> None:
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            **{name: [] for name in ("accessors", "bufferViews", "meshes", "nodes")},
        }
        self.binary = bytearray()

    def accessor(self, array: np.ndarray, *, pitch: int = 0) -> int:
        """Index of a new accessor; `pitch` is the stride where rows are padded to it."""
        width = 1 if array.ndim == 1 else array.shape[1]
        view = {"buffer": 0, "byteOffset": len(self.binary)}
        if pitch:
            rows = np.zeros((len(array), pitch), np.uint8)
            rows[:, : array.itemsize * width] = array.view(np.uint8)
            view["byteStride"] = pitch
            self.binary += rows.tobytes()
        else:
            self.binary += array.tobytes()
        view["byteLength"] = len(self.binary) - view["byteOffset"]
        self.binary += bytes(-len(self.binary) % 4)
        self.document["bufferViews"].append(view)
        entry = {
            "bufferView": len(self.document["bufferViews"]) - 1,
            "componentType": COMPONENTS[array.dtype.str[1:]],
            "count": len(array),
            "type": "SCALAR" if array.ndim == 1 else f"VEC{width}",
        }
        self.document["accessors"].append(entry)
        return len(self.document["accessors"]) - 1

    def write(self, path: Path) -> Path:
        self.document["scenes"] = [{"nodes": list(range(len(self.document["nodes"])))}]
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        chunks = ((JSON_CHUNK, text), (BINARY_CHUNK, bytes(self.binary)))
        body = b"".join(CHUNK.pack(len(content), kind) + content for kind, content in chunks)
        path.write_bytes(HEADER.pack(MAGIC, 2, HEADER.size + len(body)) + body)
        return path


def grid(side: int) -> tuple[np.ndarray, np.ndarray]:
    """A bumpy field of 2 side^2 triangles: positions (v, 3) float32, corners (6 side^2,) uint32."""
    x, z = np.meshgrid(np.arange(side + 1), np.arange(side + 1), indexing="ij")
    positions = np.stack([x, np.sin(x * 0.3) * np.cos(z * 0.2), z], axis=-1).reshape(-1, 3).astype("<f4")
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    corners = np.stack([first, first + 1, first + side + 1, first + 1, first + side + 2, first + side + 1])
    return positions, corners.T.ravel().astype("<u4")


def add_field(draft: Draft, side: int) -> int:
    """Index of a new mesh with positions, normals and texture coordinates, as exporters write them."""
    positions, order = grid(side)
    attributes = {
        "POSITION": draft.accessor(positions),
        "NORMAL": draft.accessor(np.tile(np.array([[0, 1, 0]], "<f4"), (len(positions), 1))),
        "TEXCOORD_0": draft.accessor(positions[:, ::2].copy()),
    }
    short = order.astype("<u2") if len(positions) < 65536 else order
    primitive = {"attributes": attributes, "indices": draft.accessor(short)}
    draft.document["meshes"].append({"primitives": [primitive]})
    return len(draft.document["meshes"]) - 1


def one_mesh(path: Path) -> Path:
    """1,002,528 triangles in one mesh."""
    draft = Draft()
    draft.document["nodes"] = [{"mesh": add_field(draft, 708)}]
    return draft.write(path)


def many_meshes(path: Path) -> Path:
    """A thousand meshes of 1,012 triangles each."""
    draft = Draft()
    meshes = [add_field(draft, 22 + number % 2) for number in range(1000)]
    draft.document["nodes"] = [
        {"mesh": mesh, "translation": [30.0 * (mesh % 32), 0, 30.0 * (mesh // 32)]} for mesh in meshes
    ]
    return draft.write(path)


def many_nodes(path: Path) -> Path:
    """One mesh of 98 triangles that ten thousand nodes draw."""
    draft = Draft()
    mesh = add_field(draft, 7)
    draft.document["nodes"] = [
        {"mesh": mesh, "translation": [9.0 * (n % 100), 0, 9.0 * (n // 100)], "rotation": [0, 0.6, 0, 0.8]}
        for n in range(10_000)
    ]
    return draft.write(path)


def quantised(path: Path) -> Path:
    """Sixteen meshes of 62,658 triangles with 16-bit positions."""
    draft = Draft()
    positions, order = grid(177)
    stored = np.round(positions * 100).astype("<i2")
    for number in range(16):
        attributes = {"POSITION": draft.accessor(stored, pitch=8)}
        primitive = {"attributes": attributes, "indices": draft.accessor(order.astype("<u2"))}
        draft.document["meshes"].append({"primitives": [primitive]})
        draft.document["nodes"].append({"mesh": number, "scale": [0.01] * 3})
    draft.document["extensionsUsed"] = draft.document["extensionsRequired"] = ["KHR_mesh_quantization"]
    return draft.write(path)


def seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def measured(path: Path, rounds: int) -> Reading:
    """Time and memory of reading one level."""
    scene = read_level(path).scene
    trimesh.load_scene(path, process=False)
    ours, theirs = [], []
    for _ in range(rounds):
        ours.append(seconds(lambda: read_level(path)))
        theirs.append(seconds(lambda: trimesh.load_scene(path, process=False)))
    done = subprocess.run(  # a fresh process: what earlier readings held counts for nothing
        [sys.executable, "-c", MEASURE, str(path)], check=True, capture_output=True, text=True
    )
    peak, arrays, drawn = map(int, done.stdout.split())
    return Reading(median(ours), median(theirs), peak, arrays, drawn, scene.triangle_count)


def main() -> int:
    """Prints a table; the exit code says whether all levels keep both limits."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("levels", nargs="*", type=Path, metavar="LEVEL")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    chosen = parser.parse_args()
    table = Table(*HEADINGS)
    kept = True
    with tempfile.TemporaryDirectory() as folder:
        makers = (one_mesh, many_meshes, many_nodes, quantised)
        levels = chosen.levels or [maker(Path(folder) / f"{maker.__name__}.glb") for maker in makers]
        for path in levels:
            found = measured(path, chosen.rounds)
            time_ratio, memory_ratio = found.ours_s / found.trimesh_s, found.peak_bytes / found.drawn_bytes
            kept &= time_ratio <= TIME_LIMIT and memory_ratio <= MEMORY_LIMIT
            table.add_row(
                path.name,
                f"{found.triangles:,}",
                f"{found.ours_s:.3f}",
                f"{found.trimesh_s:.3f}",
                f"{time_ratio:.2f}",
                f"{found.array_bytes / 1e6:.1f}",
                f"{found.drawn_bytes / 1e6:.1f}",
                f"{found.peak_bytes / 1e6:.1f}",
                f"{memory_ratio:.2f}",
            )
    console = Console()
    console.width = max(console.width, len(" ".join(HEADINGS)) + 50)
    console.print(table)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
