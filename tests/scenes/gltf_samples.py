"""Small glTF files for the tests, built from plain dictionaries."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from scenes.formats.registry import read_level
from scenes.level import Level

Json = dict[str, Any]

CORNERS = np.array([[0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 5]], np.float32)
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint16)
COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


def data_uri(content: bytes) -> str:
    return "data:application/octet-stream;base64," + base64.b64encode(content).decode()


def document(*arrays: np.ndarray, **tables: Any) -> Json:
    """A document with one buffer, view and accessor per array; tables given by name are added."""
    made: Json = {"asset": {"version": "2.0"}, "buffers": [], "bufferViews": [], "accessors": []}
    for index, array in enumerate(arrays):
        content = array.tobytes()
        made["buffers"].append({"byteLength": len(content), "uri": data_uri(content)})
        made["bufferViews"].append({"buffer": index, "byteLength": len(content)})
        made["accessors"].append(
            {
                "bufferView": index,
                "componentType": COMPONENTS[array.dtype.str[1:]],
                "count": len(array),
                "type": "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}",
            }
        )
    return made | tables


def tetrahedron(**tables: Any) -> Json:
    """A tetrahedron on one node in one scene, and what is given besides."""
    defaults: Json = {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    }
    return document(CORNERS, TETRAHEDRON.ravel()) | defaults | tables


def lit(*lights: Json, nodes: list[Json] | None = None, **tables: Any) -> Json:
    """Nodes that carry the lights, one each unless `nodes` says otherwise."""
    if nodes is None:
        nodes = [{"extensions": {"KHR_lights_punctual": {"light": i}}} for i in range(len(lights))]
    made = document(nodes=nodes, scenes=[{"nodes": list(range(len(nodes)))}], scene=0, **tables)
    made["extensions"] = {"KHR_lights_punctual": {"lights": list(lights)}}
    made["extensionsUsed"] = ["KHR_lights_punctual"]
    return made


def carrying(light: int, **node: Any) -> Json:
    return {"extensions": {"KHR_lights_punctual": {"light": light}}, **node}


def chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack("<I", len(content)) + kind + content


def glb_of(*chunks: bytes, version: int = 2, length: int | None = None) -> bytes:
    body = b"".join(chunks)
    return b"glTF" + struct.pack("<II", version, 12 + len(body) if length is None else length) + body


def glb(values: Json, binary: bytes | None = None) -> bytes:
    text = json.dumps(values).encode()
    chunks = [chunk(b"JSON", text + b" " * (-len(text) % 4))]
    if binary is not None:
        chunks.append(chunk(b"BIN\0", binary + b"\0" * (-len(binary) % 4)))
    return glb_of(*chunks)


def read(folder: Path, source: Json | bytes, name: str | None = None, scene: str | None = None) -> Level:
    """Writes the file into the folder and reads it."""
    if isinstance(source, dict):
        path, content = folder / (name or "level.gltf"), json.dumps(source).encode()
    else:
        path, content = folder / (name or "level.glb"), source
    path.write_bytes(content)
    return read_level(path, scene)


def notes_of(level: Level) -> str:
    return "\n".join(f"{note.severity} {note.where}: {note.text}" for note in level.notes)
