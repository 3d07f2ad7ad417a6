"""Writes our own scenes as GLB: the same scene gives the same bytes.

Source: glTF 2.0 specification (Khronos), section 4 (GLB); KHR_lights_punctual (Khronos).
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from scenes.atomic_file import write_atomically
from scenes.gltf.asset import LIGHTS
from scenes.gltf.json_chunk import BINARY_CHUNK, CHUNK, HEADER, JSON_CHUNK, MAGIC
from scenes.gltf.transforms import IDENTITY
from scenes.light_annotation import MOBILITY_KEY
from scenes.scene import Array, Camera, Light, LightKind, Mesh, Mobility, Scene
from scenes.vectors import Vector, unit, upright

Json = dict[str, Any]

FLOAT, UNSIGNED_INT = 5126, 5125
VERTEX_DATA, INDEX_DATA = 34962, 34963
GENERATOR = "Gnomon"


def write_glb(scene: Scene, path: Path) -> None:
    """Writes a scene as GLB.

    Raises:
        OutputError: The file cannot be written.
    """
    write_atomically(path, glb_bytes(scene))


def glb_bytes(scene: Scene) -> bytes:
    """A scene as the bytes of a GLB.

    One node per placement, light and camera, in this order, each with a world matrix and no children.
    Meshes that share arrays share accessors. Meshes without triangles or placements draw nothing and are
    left out. All floats survive exactly.
    """
    draft = _Draft()
    for mesh in scene.meshes:
        draft.add_mesh(mesh)
    for light in scene.lights:
        draft.add_light(light)
    for camera in scene.cameras:
        draft.add_camera(camera)
    return _packed(draft.document(scene.name), b"".join(draft.chunks))


class _Draft:
    """The tables of the file as they fill."""

    def __init__(self) -> None:
        self.tables: dict[str, list[Json]] = {
            name: [] for name in ("accessors", "bufferViews", "cameras", "materials", "meshes", "nodes")
        }
        self.lights: list[Json] = []
        self.chunks: list[bytes] = []
        self._accessors: dict[tuple[int, ...], int] = {}
        # Keeps the arrays alive by whose address accessors are shared.
        self._kept: list[npt.NDArray[Any]] = []

    def _add(self, table: str, entry: Json) -> int:
        self.tables[table].append(entry)
        return len(self.tables[table]) - 1

    def add_mesh(self, mesh: Mesh) -> None:
        if not mesh.triangle_count:
            return
        primitive = {
            "attributes": {"POSITION": self._accessor(mesh.positions, FLOAT, VERTEX_DATA)},
            "indices": self._accessor(mesh.triangles, UNSIGNED_INT, INDEX_DATA),
            "material": self._material(mesh),
        }
        index = self._add("meshes", {"name": mesh.name, "primitives": [primitive]})
        for placement in mesh.placements:
            self._add("nodes", {"name": mesh.name, "mesh": index, **_matrix(placement)})

    def _accessor(self, array: npt.NDArray[Any], component: int, target: int) -> int:
        # The address, not the object: meshes hold their own views of the arrays that they share.
        key = (array.__array_interface__["data"][0], *array.shape, target)
        if key not in self._accessors:
            vertices = target == VERTEX_DATA
            content = array.astype("<f4" if vertices else "<u4").tobytes()
            offset = sum(map(len, self.chunks))
            self.chunks.append(content)
            view = {"buffer": 0, "byteOffset": offset, "byteLength": len(content), "target": target}
            accessor: Json = {"bufferView": self._add("bufferViews", view), "componentType": component}
            if vertices:
                lowest, highest = array.min(axis=0).tolist(), array.max(axis=0).tolist()
                accessor |= {"type": "VEC3", "count": len(array), "min": lowest, "max": highest}
            else:
                accessor |= {"type": "SCALAR", "count": array.size}
            self._accessors[key] = self._add("accessors", accessor)
            self._kept.append(array)
        return self._accessors[key]

    def _material(self, mesh: Mesh) -> int:
        material: Json = {"pbrMetallicRoughness": {"baseColorFactor": [*mesh.base_color, 1.0]}}
        if not mesh.casts:
            material["alphaMode"] = "BLEND"
        if material in self.tables["materials"]:
            return self.tables["materials"].index(material)
        return self._add("materials", material)

    def add_light(self, light: Light) -> None:
        entry: Json = {
            "name": light.name,
            "type": light.kind.value,
            "color": list(light.color),
            "intensity": light.intensity,
        }
        if math.isfinite(light.range_m):
            entry["range"] = light.range_m
        if light.kind is LightKind.SPOT:
            entry["spot"] = {
                "innerConeAngle": light.inner_cone_rad,
                "outerConeAngle": light.outer_cone_rad,
            }
        self.lights.append(entry)
        node: Json = {"name": light.name, "extensions": {LIGHTS: {"light": len(self.lights) - 1}}}
        if light.mobility is not Mobility.DYNAMIC:
            node["extras"] = {MOBILITY_KEY: light.mobility.value}
        self._add("nodes", node | _matrix(_pose(light.position, light.direction)))

    def add_camera(self, camera: Camera) -> None:
        lens = {"yfov": camera.yfov_rad, "znear": camera.near_m}
        index = self._add("cameras", {"name": camera.name, "type": "perspective", "perspective": lens})
        pose = _pose(camera.position, camera.forward, camera.up)
        self._add("nodes", {"name": camera.name, "camera": index, **_matrix(pose)})

    def document(self, name: str) -> Json:
        scene: Json = {"name": name}
        if self.tables["nodes"]:
            scene["nodes"] = list(range(len(self.tables["nodes"])))
        document: Json = {"asset": {"version": "2.0", "generator": GENERATOR}, "scene": 0, "scenes": [scene]}
        document |= {table: entries for table, entries in self.tables.items() if entries}
        if self.chunks:
            document["buffers"] = [{"byteLength": sum(map(len, self.chunks))}]
        if self.lights:
            document |= {"extensions": {LIGHTS: {"lights": self.lights}}, "extensionsUsed": [LIGHTS]}
        return document


def _matrix(world: Array) -> Json:
    columns = [float(value) + 0.0 for value in world.T.flat]
    return {} if columns == list(IDENTITY) else {"matrix": columns}


def _pose(position: Vector, forward: Vector, up: Vector | None = None) -> Array:
    """(4, 4) float64 world from local of what looks along -Z with +Y up."""
    if up is None:
        # Any up does; the axis that the direction is least along is never parallel to it.
        axis = min(range(3), key=lambda axis: abs(forward[axis]))
        up = upright((float(axis == 0), float(axis == 1), float(axis == 2)), unit(forward) or forward)
    assert up is not None, f"{forward} is no direction"
    right = (
        forward[1] * up[2] - forward[2] * up[1],
        forward[2] * up[0] - forward[0] * up[2],
        forward[0] * up[1] - forward[1] * up[0],
    )
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, up, np.negative(forward), position
    return pose


def _packed(document: Json, binary: bytes) -> bytes:
    text = json.dumps(document, separators=(",", ":"), sort_keys=True, allow_nan=False).encode()
    chunks = [(JSON_CHUNK, text + b" " * (-len(text) % 4))]
    if binary:
        chunks.append((BINARY_CHUNK, binary + b"\0" * (-len(binary) % 4)))
    packed = b"".join(CHUNK.pack(len(content), kind) + content for kind, content in chunks)
    return HEADER.pack(MAGIC, 2, HEADER.size + len(packed)) + packed
