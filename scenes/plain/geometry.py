"""The triangles of an OBJ, PLY or STL file, read by trimesh; binary PLY and STL are read as they lie."""

from __future__ import annotations

import io
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.magnitudes import LARGEST, MOST_TRIANGLES
from scenes.plain.binary_ply import read_binary_ply
from scenes.plain.binary_stl import read_binary_stl, triangle_count
from scenes.plain.lights_file import is_lights_file
from scenes.scene import Array, Mesh, Positions, Triangles

_OBJ_VERTEX = re.compile(rb"^[ \t]*v[ \t]", re.MULTILINE)
# Possessive, so that each byte is looked at once.
_OBJ_RELATIVE = re.compile(rb"^[ \t]*f(?:[ \t]++[1-9][\d/]*+)*+[ \t]++-", re.MULTILINE)
_OBJ_ZERO = re.compile(rb"^[ \t]*f(?:[ \t]++-?[1-9][\d/-]*+)*+[ \t]++-?0", re.MULTILINE)
# trimesh steps over such lines without a word.
_OBJ_ODD = (b"\n ", b"\n\t", b"\nv\t", b"\nf\t", b"\no\t", b"\ng\t")
_OBJ_WORD = re.compile(rb"^[ \t]*([vfog])[ \t]+", re.MULTILINE)
_OBJ_MATERIAL = re.compile(rb"^[ \t]*mtllib[ \t]+([^\r\n]+)", re.MULTILINE)
_PLY_COUNT = re.compile(rb"^element[ \t]+\S+[ \t]+(\d+)", re.MULTILINE)
_UTF8_MARK = b"\xef\xbb\xbf"
_PLY_END = b"end_header"
_EXPORT = "Export it again, as triangles."


def require_geometry(source: bytes, suffix: str) -> None:
    """Checks that a file may be what its suffix says, without reading it.

    Raises:
        LevelError: It is not, or its header promises more than the file can hold.
    """
    if suffix == ".obj" and not is_lights_file(source) and _OBJ_VERTEX.search(source):
        return
    if suffix == ".ply" and source.startswith(b"ply"):
        header = source[: source.find(_PLY_END)]
        if _PLY_END in source and all(int(count) <= len(source) for count in _counts(header)):
            return
    if suffix == ".stl" and (source[:80].lstrip().startswith(b"solid") or triangle_count(source) is not None):
        return
    raise LevelError(f"This is no {suffix[1:].upper()} file, or it was cut short.", remedy=_EXPORT)


def read_geometry(
    source: bytes, path: Path, unit_m: float, notes: NoteBook, *, z_up: bool
) -> tuple[Mesh, ...]:
    """All triangles of the file, in metres with Y up.

    Args:
        source: The file.
        path: Its name.
        unit_m: Length of its unit.
        notes: What is left out is noted here.
        z_up: Whether its Z axis points up.

    Raises:
        LevelError: The file is broken, has no triangles or too many, or numbers beyond what the GPU knows.
    """
    suffix = path.suffix.lower()
    if suffix == ".obj":
        source = _plain_text(source)
    require_geometry(source, suffix)
    if suffix == ".obj":
        _judge_obj(source, notes)
    meshes = [
        _mesh(name, points, faces, unit_m, z_up=z_up)
        for name, points, faces in _loaded(source, suffix, path.stem, notes)
        if len(faces)
    ]
    count = sum(mesh.triangle_count for mesh in meshes)
    if count > MOST_TRIANGLES:
        raise LevelError(
            f"This level has {count:,} triangles.",
            known=f"At most {MOST_TRIANGLES:,} are drawn.",
            remedy="Split it, or simplify it.",
        )
    if not count:
        raise LevelError("This file holds no triangles.", remedy=_EXPORT)
    return tuple(meshes)


def _mesh(name: str, points: Array | Positions, faces: Triangles, unit_m: float, *, z_up: bool) -> Mesh:
    # Corners that no triangle has may be anything, and large levels are not copied more often than needed.
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = points if unit_m == 1.0 else np.multiply(points, unit_m, dtype=np.float64)
        _require_sound(name, scaled, faces)
        turned = np.stack([scaled[:, 0], scaled[:, 2], -scaled[:, 1]], axis=1) if z_up else scaled
        positions, triangles = turned.astype(np.float32, copy=False), faces.astype(np.int32, copy=False)
    positions.flags.writeable = triangles.flags.writeable = False
    return Mesh(name, positions, triangles)


def named_files(source: bytes, path: Path) -> tuple[Path, ...]:
    """The material libraries that an OBJ names in its own folder, and that are there."""
    if path.suffix.lower() != ".obj":
        return ()
    found = set()
    for match in _OBJ_MATERIAL.finditer(source) if b"mtllib" in source else ():
        name = Path(match[1].decode("utf-8", "replace").strip())
        try:
            if len(name.parts) == 1 and path.with_name(name.name).is_file():
                found.add(name)
        except (OSError, ValueError):
            continue
    return tuple(sorted(found))


def _plain_text(source: bytes) -> bytes:
    """Without the mark of some Windows programs, which would cost the first line, and with lines that end."""
    source = source.removeprefix(_UTF8_MARK)
    return source if b"\n" in source else source.replace(b"\r", b"\n")


def _judge_obj(source: bytes, notes: NoteBook) -> None:
    """Refuses what trimesh takes for something else: it counts relative indices from the end of the file."""
    if b"mtllib" in source and _OBJ_MATERIAL.search(source):
        notes.info("materials", "Materials are not read: every surface is opaque.")
    zero, relative = _OBJ_ZERO.search(source), _OBJ_RELATIVE.search(source)
    if zero:
        raise LevelError(
            "A face has a corner 0; corners are counted from 1.",
            where=_line(source, zero.start()),
            remedy=_EXPORT,
        )
    if relative and _OBJ_VERTEX.search(source, relative.end()):
        raise LevelError(
            "Faces that count their corners backwards, between the corners, are not read.",
            where=_line(source, relative.start()),
            remedy="Export it with absolute indices.",
        )


def _line(source: bytes, position: int) -> str:
    line = source.count(b"\n", 0, position) + 1
    return f"line {line}"


def _loaded(
    source: bytes, suffix: str, stem: str, notes: NoteBook
) -> list[tuple[str, Array | Positions, Triangles]]:
    if suffix == ".ply" and (found := read_binary_ply(source)):
        return [(stem, *found)]
    if suffix == ".stl" and (triangles := read_binary_stl(source)):
        return [(stem, *triangles)]
    if suffix == ".obj" and (source[:1].isspace() or any(mark in source for mark in _OBJ_ODD)):
        source = _OBJ_WORD.sub(rb"\1 ", source)
    # Faces belong to objects, whatever they are made of.
    options: dict[str, Any] = {"process": False, "skip_materials": True}
    if suffix == ".obj":
        options |= {"split_objects": True, "group_material": False}
    # It takes a third of a second to import, and most levels do without it.
    import trimesh  # noqa: PLC0415

    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            # What trimesh finds odd, numbers included, is checked afterwards.
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(io.BytesIO(source), file_type=suffix[1:], **options)
    except Exception as error:  # a broken file makes trimesh raise anything
        raise LevelError(
            f"This {suffix[1:].upper()} file cannot be read.",
            known=f"trimesh says: {type(error).__name__}: {str(error)[:120]}.",
            remedy=_EXPORT,
        ) from error
    loaded: list[tuple[str, Array | Positions, Triangles]] = []
    # By name: the order of trimesh is its own.
    for name, geometry in sorted(scene.geometry.items()):
        if isinstance(geometry, trimesh.Trimesh):
            known = stem if name in ("geometry", "geometry_0") else str(name)
            loaded.append((known, np.asarray(geometry.vertices, float), np.asarray(geometry.faces)))
        else:
            notes.info("geometry", "Points and lines cast no shadow: left out.")
    return loaded


def _require_sound(name: str, vertices: Array | Positions, faces: Triangles) -> None:
    if vertices.shape[1:] != (3,):
        raise LevelError(
            "A corner needs three numbers.",
            where=f'mesh "{name}"',
            known=f"Here it has {vertices.shape[-1]}.",
            remedy=_EXPORT,
        )
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise LevelError(
            "A triangle has a corner that is not in the file.",
            where=f'mesh "{name}"',
            known=f"There are {len(vertices):,} corners.",
            remedy=_EXPORT,
        )
    # A NaN is the least and the greatest of its array, and not within any limit.
    if vertices.min() >= -LARGEST and vertices.max() <= LARGEST:
        return
    if not (np.abs(vertices[np.unique(faces)]) <= LARGEST).all():
        raise LevelError(
            "A corner's position is no number, or too great a one.",
            where=f'mesh "{name}"',
            known=f"At most {LARGEST:g} metres are read.",
            remedy=_EXPORT,
        )


def _counts(header: bytes) -> list[bytes]:
    # Longer numbers than any file's length are none, and Python refuses to read them.
    return [count if len(count) < 16 else b"9" * 16 for count in _PLY_COUNT.findall(header)]
