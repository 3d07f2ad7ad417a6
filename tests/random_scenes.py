"""Random scenes over a floor, by class of geometry, with a light of each kind and a camera; all by seed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from scenes.scene import Array, Camera, Light, LightKind, Mesh, Scene
from tests.solids import axes_beside, box, fan, floor, sheet, soup

Random = np.random.Generator
FLOOR_HALF = 6.0


def _turn(random: Random) -> Rotation:
    return Rotation.from_quat(random.normal(size=4))


def _place(random: Random) -> Array:
    return np.array([random.uniform(-3, 3), random.uniform(0.4, 3), random.uniform(-3, 3)])


def closed_boxes(random: Random) -> list[Mesh]:
    """Boxes turned at random; some meet, some stand in the floor."""
    return [box(_place(random), random.uniform(0.1, 0.9, 3), _turn(random)) for _ in range(12)]


def open_sheets(random: Random) -> list[Mesh]:
    """Wavy open grids."""

    def wavy() -> Mesh:
        centre, frame, size = _place(random), _turn(random).as_matrix(), random.uniform(0.4, 1.2)
        waves, height = random.uniform(1, 4, 2), random.uniform(0, 0.4)

        def shape(u: Array, v: Array) -> Array:
            local = np.stack([u, v, height * np.sin(waves[0] * u) * np.cos(waves[1] * v)], axis=-1)
            return centre + size * local @ frame.T

        return sheet(shape, 8)

    return [wavy() for _ in range(5)]


def triangle_soup(random: Random) -> list[Mesh]:
    """Loose triangles in any winding."""
    centres = np.array([_place(random) for _ in range(60)])
    return [soup(centres[:, None] + random.normal(scale=0.6, size=(60, 3, 3)))]


def fans(random: Random) -> list[Mesh]:
    """Up to nine triangles around one edge."""

    def one() -> Mesh:
        start = _place(random)
        end = start + random.normal(scale=0.7, size=3)
        tips = start + random.normal(scale=1.0, size=(int(random.integers(3, 10)), 3))
        mesh = fan(start, end, tips)
        triangles = mesh.triangles.copy()
        flipped = random.random(len(triangles)) < 0.5
        triangles[flipped] = triangles[flipped][:, [1, 0, 2]]
        return Mesh(mesh.name, mesh.positions, triangles)

    return [one() for _ in range(8)]


def duplicates_and_degenerates(random: Random) -> list[Mesh]:
    """Boxes and loose triangles with faces given twice, turned over, rotated, or without area."""
    meshes = [*closed_boxes(random)[:5], *triangle_soup(random)]
    broken = []
    for mesh in meshes:
        some = mesh.triangles[random.random(len(mesh.triangles)) < 0.4]
        extra = [
            some,
            some[::2, ::-1],
            np.roll(some[1::2], 1, axis=1),
            some[:, [0, 1, 1]],
            some[:, [2, 2, 2]],
        ]
        broken.append(Mesh(mesh.name, mesh.positions, np.vstack([mesh.triangles, *extra])))
    return broken


CLASSES: dict[str, Callable[[Random], list[Mesh]]] = {
    "closed boxes": closed_boxes,
    "open sheets": open_sheets,
    "triangle soup": triangle_soup,
    "fans": fans,
    "duplicates and degenerates": duplicates_and_degenerates,
}


def random_scene(geometry: str, seed: int) -> Scene:
    """A scene of the class `geometry`, over a floor."""
    random = np.random.default_rng([seed, *geometry.encode()])
    return Scene(geometry, (floor(FLOOR_HALF), *CLASSES[geometry](random)))


def random_light(kind: LightKind, seed: int) -> Light:
    """A light above the scene that shines at it."""
    random = np.random.default_rng([seed, *kind.encode()])
    position = np.array([random.uniform(-5, 5), random.uniform(4, 8), random.uniform(-5, 5)])
    towards = random.uniform(-1, 1, 3) - position
    direction = towards / np.linalg.norm(towards)
    return Light(
        f"random {kind}",
        kind,
        position=tuple(position),
        direction=tuple(direction),
        inner_cone_rad=0.4,
        outer_cone_rad=float(random.uniform(0.5, 1.0)),
        range_m=float("inf") if seed % 2 else 14.0,
    )


def random_camera(seed: int) -> Camera:
    """A camera beside the scene, or in the midst of it, that looks at its middle."""
    random = np.random.default_rng([seed, 77])
    away = random.uniform(3, 9)
    angle = random.uniform(0, 2 * np.pi)
    eye = np.array([away * np.cos(angle), random.uniform(1, 6), away * np.sin(angle)])
    return look_at(eye, random.uniform((-1, 0, -1), (1, 2, 1)))


def look_at(eye: object, target: object, *, yfov_rad: float = 1.0, near_m: float = 0.05) -> Camera:
    """A camera at `eye` that looks at `target`, with its up vector near Y where it can be."""
    start, end = np.asarray(eye, float), np.asarray(target, float)
    forward = (end - start) / np.linalg.norm(end - start)
    helper = np.array([0.0, 1.0, 0.0]) if abs(forward[1]) < 0.999 else axes_beside(forward)[0]
    right = np.cross(forward, helper)
    up = np.cross(right / np.linalg.norm(right), forward)
    return Camera("test", tuple(start), tuple(forward), tuple(up), yfov_rad, near_m)
