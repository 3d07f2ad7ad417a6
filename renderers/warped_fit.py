"""Fits a warped map to a frame, or falls back to an ordinary one that fits the view."""

from __future__ import annotations

from collections.abc import Callable

from renderers.frame import Frame
from renderers.map_settings import guard_share
from renderers.map_shadow import Fitted
from renderers.settings import Settings
from renderers.shadow_map import ShadowMap
from scenes.convex import Body
from scenes.frusta import reach
from scenes.map_frusta import MapFit, face_bodies, fit_faces
from scenes.receivers import receiver_body
from scenes.scene import Array
from scenes.warped_map import Maps, Sight, choose_faces

# Of what the camera sees of the light: with less of it on warped faces, the map is an ordinary one.
MOSTLY = 0.5

MapsOf = Callable[[Array, float, Sight, Body], Maps]
"""The maps to choose from, for a homogeneous light, a share between guard texels, a view and receivers."""


def fit_warped(frame: Frame, settings: Settings, name: str, maps_of: MapsOf) -> Fitted:
    """The faces of a warped map; an ordinary map where no face is worth warping, which the outcome says.

    Args:
        frame: Aimed at light and camera.
        settings: `map_size`, `filter` and `fall_back` count here.
        name: The technique's id.
        maps_of: The technique's maps.
    """
    side = int(settings["map_size"])
    shrink = guard_share(side, str(settings["filter"]))
    world, light = frame.world, frame.light
    within = reach(light, world.origin)
    homogeneous = light.homogeneous
    homogeneous[:3] -= homogeneous[3] * world.origin
    sight = Sight(
        frame.eye,
        homogeneous,
        frame.eye_from_scene,
        frame.clip_from_scene,
        (frame.width, frame.height),
        *world.probes.seen(within, frame.view_planes, frame.eye, homogeneous),
    )
    body = receiver_body(world.surfaces.low, world.surfaces.high, within, frame.view_planes)
    bodies = face_bodies(light, within.centre, body)
    ordinary = fit_faces(light, within.centre, bodies, shrink)
    choice = choose_faces(
        ordinary.faces,
        bodies,
        sight,
        side,
        lambda part: maps_of(homogeneous, shrink, sight, part),
        always=settings["fall_back"] == "never",
    )
    if choice.share >= MOSTLY or not choice.shown:
        return Fitted(MapFit(choice.faces), name, choice.note)
    return Fitted(ordinary, ShadowMap.name, choice.note)
