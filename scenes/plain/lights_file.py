"""A lights file: JSON with the lights and cameras of a file of plain geometry."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.companions import SCHEME
from scenes.json_splice import RawJson
from scenes.level import NoteBook
from scenes.magnitudes import require_divisor
from scenes.plain.entries import read_camera, read_light
from scenes.scene import Camera, Light

GEOMETRY_SUFFIXES = (".obj", ".ply", ".stl")
_ENDINGS = (".lights", ".annotated")
_KEYS = frozenset({"geometry", "unit_m", "up", "lights", "cameras"})
# Blanks before the first brace, at most.
_HEAD = 4096
_DEEPEST = "It is nested deeper, or holds longer numbers, than any lights file."


@dataclass(frozen=True)
class LightsFile:
    """What a lights file says.

    Attributes:
        unit_m: Length of the geometry's unit.
        z_up: Whether the geometry's Z axis points up instead of its Y axis.
        lights: In metres with Y up; `node` is the place in the list.
        cameras: In metres with Y up.
    """

    unit_m: float
    z_up: bool
    lights: tuple[Light, ...]
    cameras: tuple[Camera, ...]


NO_LIGHTS = LightsFile(1.0, z_up=False, lights=(), cameras=())


def root_of(source: bytes, where: str = "") -> Entry:
    """The object of a lights file.

    Raises:
        LevelError: It is not valid JSON, or not an object.
    """
    raw = RawJson(source, where=where)
    try:
        value = raw.value(raw.root)
    except (RecursionError, ValueError) as error:
        raise LevelError("This JSON is no lights file.", where=where, known=_DEEPEST) from error
    return Entry(value, where)


def is_lights_file(source: bytes) -> bool:
    """Whether a file begins as a JSON object does, and no geometry."""
    return source.removeprefix(b"\xef\xbb\xbf")[:_HEAD].lstrip(b" \t\r\n").startswith(b"{")


def read_lights_file(source: bytes, notes: NoteBook) -> LightsFile:
    """Lights and cameras, and how the geometry stands.

    Raises:
        LevelError: It is no such JSON, or a value is missing or not what it should be.
    """
    root = root_of(source)
    unknown = sorted(key for key in root.values if key not in _KEYS)
    if unknown:
        names = ", ".join(unknown)[:80].encode("utf-8", "replace").decode()
        notes.warning("lights file", f"Not known, and ignored: {names}.")
    unit_m = root.number("unit_m", 1.0)
    if unit_m <= 0.0:
        raise root.wrong("unit_m", "above 0 metres")
    require_divisor(root, "unit_m", unit_m, "metres")
    up = root.text("up") or "Y"
    if up not in ("Y", "Z"):
        raise root.wrong("up", '"Y" or "Z"')
    lights = [
        read_light(entry, index, notes) for index, entry in enumerate(_objects(root, "lights", "light"))
    ]
    cameras = [
        read_camera(entry, index, notes) for index, entry in enumerate(_objects(root, "cameras", "camera"))
    ]
    return LightsFile(unit_m, up == "Z", tuple(lights), tuple(cameras))


def geometry_of(root: Mapping[str, object], path: Path) -> Path:
    """The geometry's file, relative to the folder of the lights file at `path`.

    Without `geometry` it is the one that shares the name: `yard.obj` for `yard.lights.json`.

    Raises:
        LevelError: There is none, it has another suffix, or it lies outside the folder.
    """
    named = root.get("geometry")
    if named is None:
        return _namesake(path)
    if not isinstance(named, str) or not named.lower().endswith(GEOMETRY_SUFFIXES):
        raise LevelError(
            '"geometry" must be the name of a file of plain geometry.',
            known=f"Known are {', '.join(GEOMETRY_SUFFIXES)}.",
            remedy="Name the file relative to the lights file.",
        )
    relative = Path(os.path.normpath(named))
    if SCHEME.match(named) or named.startswith(("/", "\\")) or os.pardir in relative.parts:
        raise LevelError(
            f"The geometry {named[:80]} does not lie in the folder of the lights file.",
            remedy="Put it there, and name it relative to the lights file.",
        )
    return relative


def lights_path(geometry: Path) -> Path:
    """Where the lights of a geometry's file are looked for: `yard.lights.json` for `yard.obj`."""
    return geometry.with_name(f"{geometry.stem}{_ENDINGS[0]}.json")


def _namesake(path: Path) -> Path:
    stem = path.stem
    while stem.endswith(_ENDINGS):
        stem = stem[: stem.rindex(".")]
    for suffix in GEOMETRY_SUFFIXES:
        try:
            if stem and path.with_name(stem + suffix).is_file():
                return Path(stem + suffix)
        except (OSError, ValueError):
            break
    raise LevelError(
        "This JSON does not say which geometry its lights belong to.",
        known=f"There is no {stem}.obj, .ply or .stl beside it either.",
        remedy='Add "geometry": "NAME.obj" to it.',
    )


def _objects(root: Entry, key: str, label: str) -> list[Entry]:
    found = []
    for index, value in enumerate(root.items(key)):
        if not isinstance(value, dict):
            raise LevelError("This entry is not a JSON object.", where=f"{label} {index}")
        plain = Entry(value, f"{label} {index}")
        name = plain.text("name")
        found.append(Entry(value, f'{label} {index} "{name}"') if name else plain)
    return found
