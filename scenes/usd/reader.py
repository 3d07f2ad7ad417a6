"""A USD stage as a scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import UsdGeom, UsdLux

from scenes.errors import LevelError
from scenes.level import Note, NoteBook
from scenes.scene import Array, Camera, Light, Scene
from scenes.usd.cameras import read_camera
from scenes.usd.diagnostics import quiet
from scenes.usd.lamps import Lamp, lamps, note_unread_lamps
from scenes.usd.lights import read_light
from scenes.usd.parcel import Parcel, packed, unpacked
from scenes.usd.placement import place_geometry
from scenes.usd.stage import judge_composition, layers_outside, open_file, world_from_stage
from scenes.usd.templates import note_templates
from scenes.usd.transforms import product
from scenes.usd.values import path_of
from scenes.usd.walk import Edge, Forest, Kind, walk


def read_scene(path: Path, scene_name: str | None) -> tuple[Scene, tuple[Note, ...]]:
    """The scene of a USD file, and what there is to say about it.

    Raises:
        LevelError: The file or a layer of it cannot be read, or holds what no scene can.
    """
    return unpacked(read_parcel(path, scene_name))


def read_parcel(path: Path, scene_name: str | None) -> Parcel:
    """The same, packed for its way into another process.

    Raises:
        LevelError: As `read_scene`.
    """
    notes = NoteBook()
    with quiet():
        if scene_name is not None:
            raise _no_scene(scene_name)
        stage = open_file(path)
        judge_composition(stage, notes)
        for name in layers_outside(stage, path.parent):
            notes.info("stage", f"It is composed of a layer outside its folder: {name}.")
        world = world_from_stage(stage, notes)
        forest = walk(stage, notes)
        meshes = place_geometry(forest, world, notes)
        lights = tuple(_lights(forest, world, notes))
        cameras = tuple(_cameras(forest, world, float(UsdGeom.GetStageMetersPerUnit(stage)), notes))
        _judge(forest, notes)
        note_templates(stage, forest, notes)
        if not meshes:
            notes.warning("stage", "This level has no triangles: nothing casts a shadow.")
        if not lights:
            notes.lightless("stage", "This level has no lights that cast shadows (UsdLux).")
        return packed(path.stem, meshes, lights, cameras, tuple(notes.notes))


def _no_scene(name: str) -> LevelError:
    return LevelError(
        f'There is no scene "{name}".',
        where="stage",
        known="A USD file is one scene, without a name.",
        remedy="Leave --scene out.",
    )


def _lights(forest: Forest, world: Array, notes: NoteBook) -> list[Light]:
    note_unread_lamps(forest, notes)
    found = []
    for index, lamp in enumerate(lamps(forest, Kind.LIGHT)):
        if not lamp.visible:
            notes.info(path_of(lamp.prim), "An invisible light: left out.")
            continue
        light = read_light(lamp.prim, _placed(world, lamp), lamp.name, index, notes)
        found += [light] if light is not None else []
    return found


def _cameras(forest: Forest, world: Array, unit_m: float, notes: NoteBook) -> list[Camera]:
    found = []
    for index, lamp in enumerate(lamps(forest, Kind.CAMERA)):
        camera = read_camera(lamp.prim, _placed(world, lamp), lamp.name, unit_m, index, notes)
        found += [camera] if camera is not None else []
    return found


def _placed(world: Array, lamp: Lamp) -> Array:
    placed = product(world, lamp.matrix)
    if not np.isfinite(placed).all():
        raise LevelError(
            "The transform of this prim is not finite in the world.",
            where=path_of(lamp.prim),
            remedy="Check the scales and translations of the prim and of those above it.",
        )
    return placed


def _judge(forest: Forest, notes: NoteBook) -> None:
    for reason, count in sorted(forest.skipped.items()):
        notes.info("stage", f"{count:,} meshes and shapes are {reason}: left out.")
    for tree in forest.trees.values():
        shapes = (one.prim for one in tree.entries if isinstance(one, Edge) or one.kind is Kind.GEOMETRY)
        for prim in shapes:
            if prim.HasAPI(UsdLux.LightAPI) and prim.IsA(UsdGeom.Gprim):
                notes.warning(
                    path_of(prim), "It shines in its own shape: it is read as a mesh, not as a light."
                )
