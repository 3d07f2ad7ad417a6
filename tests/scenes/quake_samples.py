"""Small Quake maps as text, and how tests read them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from scenes.formats.registry import read_level
from scenes.level import Level
from scenes.scene import Array, Scene

Point = tuple[float, float, float]

STANDARD = "0 0 0 1.000000 1.000000"
VALVE = "[ 1 0 0 -16 ] [ 0 -1 0 8 ] 0 1 1"


def face(points: Iterable[Sequence[float]], texture: str = "wall", placement: str = STANDARD) -> str:
    corners = " ".join("( " + " ".join(f"{value:.17g}" for value in point) + " )" for point in points)
    return f"{corners} {texture} {placement}\n"


def plane(normal: Sequence[float], distance: float) -> list[list[float]]:
    """Three points of a plane, in the order that makes `normal` its outward one."""
    unit = np.asarray(normal, float) / np.linalg.norm(normal)
    along = np.cross(unit, np.eye(3)[np.argmin(np.abs(unit))])
    across = np.cross(unit, along)
    middle = unit * distance
    return [(middle + 32 * along).tolist(), middle.tolist(), (middle + 32 * across).tolist()]


def brush(
    planes: Iterable[tuple[Sequence[float], float]], texture: str = "wall", placement: str = STANDARD
) -> str:
    faces = (face(plane(normal, distance), texture, placement) for normal, distance in planes)
    return "{\n" + "".join(faces) + "}\n"


def box(low: Point, high: Point, texture: str = "wall", placement: str = STANDARD) -> str:
    sides = [([-float(i == axis) for i in range(3)], -low[axis]) for axis in range(3)]
    sides += [([float(i == axis) for i in range(3)], high[axis]) for axis in range(3)]
    return brush(sides, texture, placement)


def entity(brushes: str = "", **keys: str) -> str:
    pairs = "".join(f'"{key}" "{value}"\n' for key, value in keys.items())
    return "{\n" + pairs + brushes + "}\n"


CUBE = box((0, 0, 0), (32, 32, 32))
WORLD = entity(CUBE, classname="worldspawn")


def read(tmp_path: Path, text: str | bytes) -> Level:
    path = tmp_path / "level.map"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_level(path)


def corners(scene: Scene) -> Array:
    """(t, 3, 3) world corners of all triangles."""
    found = [mesh.world_positions()[0][mesh.triangles] for mesh in scene.meshes]
    return np.concatenate([np.zeros((0, 3, 3)), *found])


def volume(scene: Scene) -> float:
    """Cubic metres inside all meshes, by the divergence theorem."""
    a, b, c = np.moveaxis(corners(scene), 1, 0)
    return float(np.einsum("td,td->", a, np.cross(b, c)) / 6)
