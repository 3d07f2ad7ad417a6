"""What is in a level, and what to expect when its lights are measured. No GPU."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from api.wording import counted, path_words
from scenes.level import Level
from scenes.scene import Array, Camera, Light, LightKind, Mesh, Scene
from scenes.shells import Shells

HUGE_M, TINY_M = 20_000.0, 0.05
"""A level whose diagonal is beyond these was hardly modelled in metres."""

Json = dict[str, Any]


@dataclass(frozen=True)
class Inspection:
    """What a level holds.

    Attributes:
        level: The level.
        shells: What its casters are like.
        remarks: One sentence each: what to expect when it is measured.
    """

    level: Level
    shells: Shells
    remarks: tuple[str, ...]

    @classmethod
    def of(cls, level: Level) -> Inspection:
        """Looks through the level."""
        shells = Shells.of(_grouped(level.scene))
        return cls(level, shells, tuple(_remarks(level.scene, shells)))

    def record(self) -> Json:
        """Everything as JSON values. Metres and radians; a light without range has none."""
        scene, shells = self.level.scene, self.shells
        low, high = scene.bounds.tolist()
        return {
            "level": path_words(self.level.path),
            "format": self.level.format,
            "scene": scene.name,
            "digest": scene.digest,
            "triangles": scene.triangle_count,
            "casting_triangles": shells.triangles,
            "meshes": mesh_count(scene),
            "bounds_m": [low, high],
            "casters": {"closed": shells.closed, "balanced": shells.balanced, "open": shells.open},
            "lights": [_light_record(index, light) for index, light in enumerate(scene.lights)],
            "cameras": [camera_record(index, camera) for index, camera in enumerate(scene.cameras)],
            "notes": [
                {"severity": str(note.severity), "where": note.where, "text": note.text}
                for note in self.level.notes
            ],
            "remarks": list(self.remarks),
        }


def mesh_count(scene: Scene) -> int:
    """Meshes as drawn, over all placements."""
    return sum(len(mesh.placements) for mesh in scene.meshes)


def _light_record(index: int, light: Light) -> Json:
    record: Json = {"index": index, "node": light.node, "name": light.name, "kind": str(light.kind)}
    if light.kind is not LightKind.DIRECTIONAL:
        record["position_m"] = list(light.position)
        record["range_m"] = light.range_m if math.isfinite(light.range_m) else None
    if light.kind is not LightKind.POINT:
        record["direction"] = list(light.direction)
    if light.kind is LightKind.SPOT:
        record |= {"inner_cone_rad": light.inner_cone_rad, "outer_cone_rad": light.outer_cone_rad}
    return {**record, "intensity": light.intensity, "mobility": str(light.mobility)}


def camera_record(index: int, camera: Camera) -> Json:
    """A camera, and its place in a list, as JSON values."""
    return {
        "index": index,
        "node": camera.node,
        "name": camera.name,
        "position_m": list(camera.position),
        "forward": list(camera.forward),
        "yfov_rad": camera.yfov_rad,
        "near_m": camera.near_m,
    }


def _remarks(scene: Scene, shells: Shells) -> Iterator[str]:
    yield from _about_geometry(scene, shells)
    yield from _about_lights(scene)
    if scene.lights and not scene.cameras:
        yield (
            "No camera: each light is judged from four viewpoints made for it: over the shoulder, facing the "
            "light, from the side, and an overview."
        )


def _about_geometry(scene: Scene, shells: Shells) -> Iterator[str]:
    if not scene.triangle_count:
        yield "No triangles: there is nothing to render, and annotate refuses."
        return
    extent = _extent(scene.bounds)
    if not TINY_M < extent < HUGE_M:
        yield f"The level measures {extent:,.4g} m from corner to corner: is it modelled in metres?"
    if not shells.triangles:
        yield "Nothing casts a shadow, so every technique will be exact."
    elif shells.open:
        yield (
            f"{_share(shells.open, shells.triangles)} of the casting triangles are in open shells. Gnomon's "
            "shadow volumes are exact on them; engines that count front and back faces only are not."
        )
    broken = _open_in_promises(scene)
    if broken:
        yield (
            f"{counted(broken, 'triangle')} in open shells, of meshes that the file promises to be closed "
            "(EXT_mesh_manifold): the promise is not believed. Close them, or export them without it."
        )
    see_through = sum(mesh.triangle_count for mesh in scene.meshes if not mesh.casts)
    if see_through and shells.triangles:
        yield f"{counted(see_through, 'triangle')} that cast no shadow."
    flat = sum(map(_without_area, scene.meshes))
    if flat:
        yield f"{counted(flat, 'triangle')} with two corners in one place: never drawn."


def _about_lights(scene: Scene) -> Iterator[str]:
    if not scene.lights:
        yield "No lights: annotate has nothing to do, and refuses."
        return
    names = Counter(light.name for light in scene.lights)
    shared = sum(count for count in names.values() if count > 1)
    if shared:
        yield (
            f"Of {counted(shared, 'light')} the name is another's too: address such a light by its number or "
            "node:NUMBER."
        )
    dark = [light.name for light in scene.lights if light.intensity <= 0 or not any(light.color)]
    if dark:
        yield f"{counted(len(dark), 'light')} without intensity or with a black color, first {dark[0]!r}."
    reaching = [light for light in scene.lights if light.kind is not LightKind.DIRECTIONAL]
    endless = [light for light in reaching if math.isinf(light.range_m)]
    if endless:
        yield (
            f"{counted(len(endless), 'light')} of {len(scene.lights)} without a range: each reaches, and "
            "costs, the whole level. A range makes every technique cheaper."
        )


def _grouped(scene: Scene) -> Scene:
    """The scene with one mesh for all that share their arrays: a thousand trees are looked through once."""
    groups: dict[tuple[int, int, bool, int], list[Mesh]] = {}
    for mesh in scene.meshes:
        # Those of a node that are promised to be closed are looked at together, so they stay as they are.
        apart = len(groups) if mesh.promised_closed else -1
        groups.setdefault((id(mesh.positions), id(mesh.triangles), mesh.casts, apart), []).append(mesh)
    meshes = tuple(
        group[0]
        if len(group) == 1
        else replace(group[0], placements=np.concatenate([mesh.placements for mesh in group]))
        for group in groups.values()
    )
    return replace(scene, meshes=meshes)


def _open_in_promises(scene: Scene) -> int:
    promised = tuple(mesh for mesh in scene.meshes if mesh.promised_closed)
    return Shells.of(replace(scene, meshes=promised)).open if promised else 0


def _without_area(mesh: Mesh) -> int:
    first, second, third = mesh.triangles.T
    collapsed = (first == second) | (second == third) | (third == first)
    return int(collapsed.sum()) * len(mesh.placements)


def _share(part: int, whole: int) -> str:
    percent = 100 * part / whole
    return "All" if part == whole else f"{percent:.0f} %" if percent >= 1 else "Under 1 %"


def _extent(bounds: Array) -> float:
    low, high = bounds
    return math.dist(low, high)
