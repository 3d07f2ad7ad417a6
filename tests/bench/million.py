"""Levels of about a million triangles in every format, for `reading.py`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from scenes.gltf.json_chunk import BINARY_CHUNK, CHUNK, HEADER, JSON_CHUNK, MAGIC

COMPONENTS = {"f4": 5126, "u4": 5125, "u2": 5123, "i2": 5122}
SIDE, MANY = 708, 1000


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


def one_mesh(path: Path, side: int = SIDE) -> Path:
    """1,002,528 triangles in one mesh, or another field."""
    draft = Draft()
    draft.document["nodes"] = [{"mesh": add_field(draft, side)}]
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


def usd(path: Path, sides: list[int]) -> Path:
    """Fields side by side, each a mesh with normals and texture coordinates, as exporters write them."""
    from pxr import Usd, UsdGeom, Vt  # noqa: PLC0415  an extra

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.Xform.Define(stage, "/world")
    for number, side in enumerate(sides):
        positions, order = grid(side)
        mesh = UsdGeom.Mesh.Define(stage, f"/world/field_{number}")
        mesh.AddTranslateOp().Set((30.0 * (number % 32), 0.0, 30.0 * (number // 32)))
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(positions))
        mesh.CreateNormalsAttr(
            Vt.Vec3fArray.FromNumpy(np.tile(np.array([[0, 1, 0]], np.float32), (len(positions), 1)))
        )
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(order.astype(np.int32)))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(order) // 3, 3, np.int32)))
    stage.GetRootLayer().Save()
    return path


def plain(path: Path, sides: list[int]) -> Path:
    """The same as OBJ (an object each), STL or PLY (both know one mesh only)."""
    fields = [trimesh.Trimesh(*shaped(side), process=False) for side in sides]
    if path.suffix == ".obj":
        objects, first = [], 1
        for number, field in enumerate(fields):
            vertices = "\n".join(f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in field.vertices.tolist())
            faces = "\n".join(f"f {a} {b} {c}" for a, b, c in (field.faces + first).tolist())
            objects.append(f"o field_{number}\n{vertices}\n{faces}\n")
            first += len(field.vertices)
        path.write_text("".join(objects))
    else:
        trimesh.util.concatenate(fields).export(path)
    return path


def shaped(side: int) -> tuple[np.ndarray, np.ndarray]:
    """A field's positions and (t, 3) triangles."""
    positions, order = grid(side)
    return positions, order.reshape(-1, 3)


def levels(folder: Path) -> list[Path]:
    """All of them, written there."""
    makers: dict[str, Callable[[Path], Path]] = {
        "one_mesh.glb": one_mesh,
        "many_meshes.glb": many_meshes,
        "many_nodes.glb": many_nodes,
        "quantised.glb": quantised,
        "one_mesh.usdc": lambda path: usd(path, [SIDE]),
        "many_meshes.usdc": lambda path: usd(path, [22 + n % 2 for n in range(MANY)]),
        "one_mesh.usda": lambda path: usd(path, [SIDE]),
        "one_object.obj": lambda path: plain(path, [SIDE]),
        "many_objects.obj": lambda path: plain(path, [22 + n % 2 for n in range(MANY)]),
        "one_mesh.ply": lambda path: plain(path, [SIDE]),
        "one_mesh.stl": lambda path: plain(path, [SIDE]),
    }
    return [make(folder / name) for name, make in makers.items()]


def small(folder: Path, suffix: str) -> Path:
    """A level of eight triangles in the same format."""
    path = folder / f"small{suffix}"
    if suffix.startswith(".gl"):
        return one_mesh(path.with_suffix(".glb"), 2)
    return usd(path, [2]) if suffix.startswith(".usd") else plain(path, [2])
