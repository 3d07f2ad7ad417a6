"""Light-space perspective shadow maps (Wimmer, Scherzer and Purgathofer 2004)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.map_settings import MAP_OPTIONS, fits, map_refusal
from renderers.map_shadow import Fitted, MapShadowPass
from renderers.settings import Option, Options, Settings, completed
from renderers.warped_fit import fit_warped
from scenes.convex import Body
from scenes.light_space_warp import light_space_warps
from scenes.perspective_warp import ahead_of, universal_depth, with_depth
from scenes.scene import Array, Light, LightKind, Scene
from scenes.warped_map import STEEPEST, Maps, Sight

PARAMETERS = np.array([0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2])


class LightSpacePerspectiveShadowMap:
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
        "fall_back": Option(
            "auto",
            "an ordinary map where the warp promises nothing, or only where it cannot be",
            ("auto", "never"),
            replay=True,
        ),
    }

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """The settings worth measuring: sizes."""
        sides = (256, 512) if kind is LightKind.POINT else (512, 1024, 2048)
        return [{"map_size": side, "filter": "2x2"} for side in sides if fits(side, kind, limits)]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why not: the map is larger than the device allows."""
        return map_refusal(light, scene, limits, completed(self.options, settings, self.label))

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> MapShadowPass:
        """A map of the size that `settings` ask for."""
        chosen = completed(self.options, settings, self.label)

        def fitting(frame: Frame) -> Fitted:
            return fit_warped(frame, chosen, self.name, partial(light_space_maps, chosen))

        return MapShadowPass(frame, light, chosen, fitting, follows_view=True)


def light_space_maps(settings: Settings, light: Array, shrink: float, sight: Sight, body: Body) -> Maps:
    """The maps to choose from: one for each place of the warp's centre.

    Args:
        settings: Those of the technique.
        light: (4,) float64 homogeneous, scene space.
        shrink: Share of a side that is left between its guard texels.
        sight: The view.
        body: The receivers.
    """
    corners = ahead_of(light, body.corners)
    wanted = settings["warp"]
    parameters = PARAMETERS if wanted == "auto" else np.array([float(wanted)])
    rows = light_space_warps(light, corners, -sight.eye_from_scene[2, :3], parameters, shrink)
    w = corners @ np.swapaxes(rows[:, 2:, :3], 1, 2)[..., 0].T + rows[:, 2, 3]
    usable = w.min(axis=0) > STEEPEST * w.max(axis=0)

    def finish(index: int) -> Array:
        return with_depth(rows[index], universal_depth(light, corners), light, corners)

    return Maps(rows, usable, finish)
