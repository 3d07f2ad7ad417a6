"""Perspective shadow maps (Stamminger and Drettakis 2002, Kozlov 2004), for every kind and place of light."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from renderers.context import DeviceLimits
from renderers.map_settings import MAP_OPTIONS, fits
from renderers.settings import Option, Options, Settings
from renderers.warped_fit import FALL_BACK, WarpedShadowMap
from scenes.convex import Body
from scenes.perspective_warp import ahead_of, universal_depth, warps, with_depth
from scenes.scene import Array, LightKind
from scenes.virtual_camera import virtual_cameras
from scenes.warped_map import STEEPEST, WIDEST_CONE_RAD, Maps, Sight

SLIDES = np.array([0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0])
# The thesis moves the virtual camera back until its plane at infinity stands at 1.5 or beyond, in a depth of
# [0, 1]: f / (f - n) >= 1.5.
THESIS_INFINITY = 1.5


class PerspectiveShadowMap(WarpedShadowMap):
    """A shadow map drawn after the camera's perspective: texels where the eye is near."""

    name = "perspective_shadow_map"
    label = "PSM"
    title = "Perspective shadow map"
    options: Options = MAP_OPTIONS | {
        "depth": Option(
            "universal",
            "depth along the light's rays, or after the camera's perspective with near and far inverted",
            ("universal", "kozlov"),
            replay=True,
        ),
        "slide_back": Option(
            "auto",
            "how far the virtual camera moves back, in depths of the receivers",
            ("auto", "thesis"),
            (0, 1e7),
        ),
        "cube_clipping": Option("on", "fit the map to the receivers", ("on", "off"), replay=True),
        "near_far": Option(
            "fitted",
            "fit the virtual camera to the receivers, or keep the scene's",
            ("fitted", "scene"),
            replay=True,
        ),
        "fall_back": FALL_BACK,
    }

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """The settings worth measuring: sizes."""
        sides = (128, 256, 512, 1024) if kind is LightKind.POINT else (256, 512, 1024, 2048)
        return [{"map_size": side, "filter": "2x2"} for side in sides if fits(side, kind, limits)]

    def maps(self, settings: Settings, light: Array, shrink: float, sight: Sight, body: Body) -> Maps:
        """The maps to choose from: one for each distance that the virtual camera moves back."""
        corners = ahead_of(light, body.corners)
        cameras = virtual_cameras(
            sight.eye_from_scene,
            corners,
            _slides(settings, sight, corners),
            tight=settings["near_far"] == "fitted",
            clipped=settings["cube_clipping"] == "on",
        )
        found = warps(cameras, light, shrink)
        w = np.einsum("kc,knc->kn", found.rows[:, 2, :3], cameras.corners) + found.rows[:, 2, 3:]
        usable = (found.half_angles < WIDEST_CONE_RAD) & (w.min(axis=1) > STEEPEST * w.max(axis=1))

        def finish(index: int) -> Array:
            rows, corners = found.rows[index], cameras.corners[index]
            if settings["depth"] == "universal":
                return with_depth(rows, universal_depth(light, corners), light, corners)
            inverted = bool(found.inverted[index])
            return with_depth(rows, found.camera_depths[index], light, corners, inverted=inverted)

        return Maps(found.rows, usable, finish)


def _slides(settings: Settings, sight: Sight, corners: Array) -> Array:
    wanted = settings["slide_back"]
    if wanted == "auto":
        return SLIDES
    if wanted != "thesis":
        return np.array([float(wanted)])
    depth = -(corners @ sight.eye_from_scene[2, :3] + sight.eye_from_scene[2, 3])
    near, far = float(depth.min()), float(depth.max())
    return np.array([max(0.0, THESIS_INFINITY - far / max(far - near, 1e-12))])
