"""Cameras where a map's players begin and where its intermission looks from.

Source: QuakeC of the game (client.qc, 1996): a player's eyes are 22 units above his origin, he looks along
`angle`, and an intermission looks along `mangle`, which is pitch (downwards), yaw and roll there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scenes.level import NoteBook
from scenes.quake.map_text import Entity
from scenes.quake.units import heading, place
from scenes.quake.values import number, numbers
from scenes.scene import Camera
from scenes.vectors import Vector, upright

EYE_HEIGHT_UNITS = 22.0
MOST_CAMERAS = 4
# Quake's 90 degrees across a screen of 4 to 3: 2 atan(3/4).
YFOV_RAD = 1.2870022175865687

_INTERMISSION = "info_intermission"
_STARTS = (
    "info_player_start",
    "info_player_start2",
    "info_player_coop",
    "info_player_deathmatch",
    _INTERMISSION,
)


def read_cameras(entities: Sequence[Entity], notes: NoteBook) -> tuple[Camera, ...]:
    """Four of the places where the map lets someone look, far from each other; all where there are fewer.

    The first is the start of the single player, or what the file has first; each further one is the one
    farthest from all that are chosen. They come in the order of the file.

    Raises:
        LevelError: A key holds something else than the numbers that it should.
    """
    found = [
        _camera(entity, origin, notes)
        for entity in entities
        if entity.kind in _STARTS and (origin := numbers(entity, (3,), "origin")) is not None
    ]
    chosen = _spread(found)
    if len(found) > len(chosen):
        notes.info(
            "player starts",
            f"{len(chosen)} of {len(found)} are cameras, those farthest from each other:"
            f" {', '.join(camera.name for camera in chosen)}.",
        )
    return chosen


def _camera(entity: Entity, origin: tuple[float, ...], notes: NoteBook) -> Camera:
    x, y, z = origin
    angles = numbers(entity, (3,), "mangle", "angles")
    yaw, pitch = (angles[1], -angles[0]) if angles else (number(entity, 0.0, "angle"), 0.0)
    forward = heading(yaw, pitch)
    if entity.kind != _INTERMISSION:
        z += EYE_HEIGHT_UNITS
    up = upright((0.0, 1.0, 0.0), forward)
    if up is None:
        notes.info(
            f"line {entity.line}, {entity.where}", "It looks straight up or down: north is up in its view."
        )
    north: Vector = (0.0, 0.0, -1.0)
    return Camera(
        name=f"{entity.kind} {entity.index}",
        position=place(x, y, z),
        forward=forward,
        up=up or north,
        yfov_rad=YFOV_RAD,
        node=entity.index,
    )


def _spread(cameras: list[Camera]) -> tuple[Camera, ...]:
    if len(cameras) <= MOST_CAMERAS:
        return tuple(cameras)
    places = np.array([camera.position for camera in cameras])
    first = next((i for i, one in enumerate(cameras) if one.name.startswith(f"{_STARTS[0]} ")), 0)
    chosen = [first]
    distances = np.full(len(cameras), np.inf)
    while len(chosen) < MOST_CAMERAS:
        steps = places - places[chosen[-1]]
        distances = np.minimum(distances, (steps * steps).sum(axis=1))
        if distances.max() == 0.0:
            break
        chosen.append(int(np.argmax(distances)))
    return tuple(cameras[index] for index in sorted(chosen))
