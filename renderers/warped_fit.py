"""Fits a warped map to a frame, or falls back to an ordinary one that fits the view.

What all techniques with warped maps share: each of them brings its warps, and its own settings for them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial

from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.map_settings import guard_share, map_refusal
from renderers.map_shadow import Fitted, MapShadowPass
from renderers.settings import Option, Options, Settings, completed
from renderers.shadow_map import ShadowMap
from scenes.convex import Body
from scenes.frusta import reach
from scenes.map_frusta import MapFit, face_bodies, fit_faces
from scenes.receivers import receiver_body
from scenes.scene import Array, Light, Scene
from scenes.warped_map import Maps, Sight, choose_faces

# Of what the camera sees of the light: with less of it on warped faces, the map is an ordinary one.
MOSTLY = 0.5

FALL_BACK = Option(
    "auto",
    "an ordinary map where the warp promises nothing, or only where it cannot be",
    ("auto", "never"),
    replay=True,
)

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


class WarpedShadowMap(ABC):
    """A technique that compares with a warped map."""

    name: str
    label: str
    title: str
    options: Options

    @abstractmethod
    def maps(self, settings: Settings, light: Array, shrink: float, sight: Sight, body: Body) -> Maps:
        """The warped maps to choose from.

        Args:
            settings: All of the technique's.
            light: (4,) float64 homogeneous, scene space.
            shrink: Share of a side that is left between its guard texels.
            sight: The view.
            body: The receivers.
        """

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why not: the map is larger than the device allows, or takes other meshes."""
        return map_refusal(light, scene, limits, completed(self.options, settings, self.label))

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> MapShadowPass:
        """A map of the size that `settings` ask for."""
        chosen = completed(self.options, settings, self.label)

        def fitting(frame: Frame) -> Fitted:
            return fit_warped(frame, chosen, self.name, partial(self.maps, chosen))

        return MapShadowPass(frame, light, chosen, fitting, follows_view=True)
