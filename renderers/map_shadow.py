"""The pass of every technique that compares with a map; how the map looks at the scene tells them apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import moderngl
import numpy as np

from renderers import shader
from renderers.clock import StageClock
from renderers.frame import Frame
from renderers.internals import DrawnMap, Internals
from renderers.map_pass import MapPass
from renderers.map_settings import TAPS, Bias
from renderers.map_transfer import CopiedMap
from renderers.settings import Settings
from renderers.technique import Counters, Outcome, ShadowPass
from scenes.frusta import reach
from scenes.map_frusta import MapFit, faces_of
from scenes.scene import Light, LightKind

FILE = "map_comparison.glsl"


@dataclass(frozen=True)
class Fitted:
    """How a map looks at the scene in one frame.

    Attributes:
        fit: Its faces.
        technique: The technique that this is; another than asked for where it fell back.
        note: Why, where it did.
    """

    fit: MapFit
    technique: str
    note: str = ""


Fitting = Callable[[Frame], Fitted]


class MapShadowPass(ShadowPass):
    """A map and its comparison, for one frame.

    Args:
        frame: Where it renders.
        light: A light of the kind that it is for.
        settings: All of `map_settings.MAP_OPTIONS`.
        fitting: Finds the map's faces for the frame's light and camera.
        follows_view: Whether they depend on the camera, so that the map is always made anew.
    """

    def __init__(
        self, frame: Frame, light: Light, settings: Settings, fitting: Fitting, *, follows_view: bool
    ) -> None:
        self._frame, self._fitting, self._follows_view = frame, fitting, follows_view
        self._side, kernel = int(settings["map_size"]), str(settings["filter"])
        self._bias = Bias.of(settings)
        self._taps = TAPS[kernel]
        faces = faces_of(light)
        # A directional light's depth is linear anyhow.
        linear = settings.get("stored_depth") == "linear" and light.kind is not LightKind.DIRECTIONAL
        self._linear = linear
        self._map = MapPass(
            frame.world,
            self._side,
            faces,
            (self._bias.slope, self._bias.units),
            back_faces=settings["map_faces"] == "back",
            linear=linear,
        )
        self._copied = CopiedMap(frame, self._map) if settings.get("transfer") == "copy" else None
        self._fitted = Fitted(MapFit(np.zeros((0, 4, 4))), "")
        self.memory_bytes = self._map.memory_bytes * (1 if self._copied is None else 2)
        gpu = frame.gpu
        texels = moderngl.LINEAR if self._taps else moderngl.NEAREST
        self._sampler = gpu.ctx.sampler(
            filter=(texels, texels), compare_func=">=", repeat_x=False, repeat_y=False
        )
        self._visibility = shader.full_screen(
            gpu,
            shader.source(FILE, ("one_face" if faces == 1 else "six_faces") + ("_linear" if linear else "")),
        )
        self._block = gpu.ctx.buffer(reserve=6 * 64 + 16)
        self._built = False

    def release(self) -> None:
        """Give the GPU memory back."""
        self._map.release()
        if self._copied is not None:
            self._copied.release()
        self._frame.gpu.release(self._sampler, self._visibility, self._block)

    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:
        """Draw the map if it has to be drawn, and compare every pixel with it."""
        rebuild = rebuild or not self._built or self._follows_view
        if rebuild:
            with clock.stage("map"):
                self._draw_map()
            if self._copied is not None:
                self._copied.copy(clock)
        with clock.stage("visibility"):
            self._compare()
        return Outcome(self._fitted.technique, rebuilt=rebuild, note=self._fitted.note)

    def count(self) -> Counters:
        """Triangles of the map, and texels cleared and written, overdraw included."""
        within = reach(self._frame.light, self._frame.world.origin)
        return {
            "map_triangles": self._map.triangles(self._fitted.fit, within),
            "map_texels_cleared": self._map.memory_bytes // 4,
            "map_texels_written": self._map.texels(self._fitted.fit, within),
        }

    def internals(self) -> Internals:
        """The map."""
        return Internals(map=DrawnMap(self._map, self._fitted.fit, self._linear))

    def _draw_map(self) -> None:
        self._fitted = self._fitting(self._frame)
        fit = self._fitted.fit
        self._block.write(self._map.block(fit, self._bias.normal_texels, self._taps))
        self._map.draw(fit, reach(self._frame.light, self._frame.world.origin))
        self._built = True

    def _compare(self) -> None:
        self._block.bind_to_uniform_block(2)
        (self._copied or self._map).texture.use(2)
        self._sampler.use(2)
        self._frame.fill_mask(self._visibility)
        self._sampler.clear(2)
