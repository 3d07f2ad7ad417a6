"""Light-space perspective shadow maps (Wimmer, Scherzer and Purgathofer 2004)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from renderers.context import DeviceLimits
from renderers.map_settings import MAP_OPTIONS, fits
from renderers.settings import Option, Options, Settings
from renderers.warped_fit import FALL_BACK, WarpedShadowMap
from scenes.convex import Body
from scenes.light_space_warp import light_space_warps
from scenes.perspective_warp import ahead_of, universal_depth, with_depth
from scenes.scene import Array, LightKind
from scenes.warped_map import STEEPEST, Maps, Sight

PARAMETERS = np.array([0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2])


class LightSpacePerspectiveShadowMap(WarpedShadowMap):
    """A shadow map warped along the view within the light's own space."""

    name = "light_space_perspective_shadow_map"
    label = "LiSPSM"
    title = "Light-space perspective shadow map"
    options: Options = MAP_OPTIONS | {
        "warp": Option(
            "auto",
            "distance of the warp's centre before the receivers, in their extent along the view",
            ("auto",),
            (1e-3, 1e7),
        ),
        "fall_back": FALL_BACK,
    }

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """The settings worth measuring: sizes."""
        sides = (256, 512) if kind is LightKind.POINT else (512, 1024, 2048)
        return [{"map_size": side, "filter": "2x2"} for side in sides if fits(side, kind, limits)]

    def maps(self, settings: Settings, light: Array, shrink: float, sight: Sight, body: Body) -> Maps:
        """The maps to choose from: one for each place of the warp's centre."""
        corners = ahead_of(light, body.corners)
        wanted = settings["warp"]
        parameters = PARAMETERS if wanted == "auto" else np.array([float(wanted)])
        rows = light_space_warps(light, corners, -sight.eye_from_scene[2, :3], parameters, shrink)
        w = corners @ np.swapaxes(rows[:, 2:, :3], 1, 2)[..., 0].T + rows[:, 2, 3]
        usable = w.min(axis=0) > STEEPEST * w.max(axis=0)

        def finish(index: int) -> Array:
            return with_depth(rows[index], universal_depth(light, corners), light, corners)

        return Maps(rows, usable, finish)
