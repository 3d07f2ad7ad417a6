"""Shadow maps (Williams 1978), for spot, point and directional lights."""

from __future__ import annotations

from collections.abc import Sequence

from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.map_settings import MAP_OPTIONS, fits, guard_share, map_refusal
from renderers.map_shadow import Fitted, MapShadowPass
from renderers.settings import Option, Options, Settings, completed
from scenes.frusta import reach
from scenes.map_frusta import MapFit, fit_map
from scenes.receivers import receiver_body
from scenes.scene import Light, LightKind, Scene


class ShadowMap:
    """Depth from the light decides: fast, as sharp as its texels are small."""

    name = "shadow_map"
    label = "SM"
    title = "Shadow map"
    options: Options = MAP_OPTIONS | {
        "focus": Option(
            "light", "cover all that the light lights, or only what the camera sees of it", ("light", "view")
        ),
        "frusta": Option(
            "fitted",
            "fit the receivers, or take the whole cone and the whole scene's depth as the thesis does",
            ("fitted", "thesis"),
            replay=True,
        ),
        "transfer": Option(
            "texture",
            "draw into the texture that is read, or elsewhere and copy, a stage of its own",
            ("texture", "copy"),
            replay=True,
        ),
        "stored_depth": Option(
            "hyperbolic",
            "depth as projected, or linear in the distance along the axis, with a bias of its own",
            ("hyperbolic", "linear"),
            replay=True,
        ),
    }

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """The settings worth measuring: sizes at 2x2, and 1x1 where it saves taps."""
        focus = "view" if kind is LightKind.DIRECTIONAL else "light"
        sides = (128, 256, 512, 1024, 2048) if kind is LightKind.POINT else (256, 512, 1024, 2048, 4096)
        chosen = [(side, "2x2") for side in sides] + [(sides[2], "1x1"), (sides[3], "1x1")]
        return [
            {"map_size": side, "filter": kernel, "focus": focus}
            for side, kernel in sorted(chosen)
            if fits(side, kind, limits)
        ]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why not: the map is larger than the device allows."""
        return map_refusal(light, scene, limits, completed(self.options, settings, self.label))

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> MapShadowPass:
        """A map of the size that `settings` ask for."""
        chosen = completed(self.options, settings, self.label)
        shrink = guard_share(int(chosen["map_size"]), str(chosen["filter"]))
        focused, thesis = chosen["focus"] == "view", chosen["frusta"] == "thesis"

        def fitting(frame: Frame) -> Fitted:
            return Fitted(ordinary_map(frame, shrink, focused=focused, thesis=thesis), self.name)

        return MapShadowPass(frame, light, chosen, fitting, follows_view=focused)


def ordinary_map(frame: Frame, shrink: float, *, focused: bool, thesis: bool = False) -> MapFit:
    """The map of the frame's light without any warp.

    Args:
        frame: Aimed at light and camera.
        shrink: Share of a side that is left between its guard texels.
        focused: Whether it covers only what the camera sees.
        thesis: Whether it covers the whole cone, and the depth of the whole scene.
    """
    world, light = frame.world, frame.light
    within = reach(light, world.origin)
    low, high = world.surfaces.low, world.surfaces.high
    if thesis and len(low):
        low, high = low.min(axis=0, keepdims=True), high.max(axis=0, keepdims=True)
    body = receiver_body(low, high, within, frame.view_planes if focused else None)
    return fit_map(light, within.centre, body, shrink, whole=thesis)
