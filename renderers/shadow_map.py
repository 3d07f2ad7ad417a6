"""Shadow maps (Williams 1978), for spot, point and directional lights."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from renderers import shader
from renderers.clock import StageClock
from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.map_pass import MapPass, atlas_shape
from renderers.technique import Counters, Outcome, Settings, ShadowPass
from scenes.convex import clip_planes
from scenes.frusta import reach
from scenes.map_frusta import MapFit, faces_of, fit_map
from scenes.scene import Light, LightKind, Scene

SIDES = (128, 256, 512, 1024, 2048, 4096, 8192)
LARGEST_CUBE_SIDE = 2048
# Half-width of the comparison footprint in texels: 2x2 reads the hardware's bilinear comparison.
FILTERS = {"1x1": 0.5, "2x2": 1.0}
FOCUSES = ("light", "view")
OFFSET_UNITS = 4.0
"""Depth units: covers the rounding of the depth buffer itself."""


def auto_bias(radius_texels: float) -> tuple[float, float]:
    """Slope factor of the polygon offset, and normal offset in texels, for a footprint of this radius.

    Over a footprint of radius r a plane's depth moves by at most 2 r m, with m the larger of its two
    slopes as GL takes it; 0.1 covers rounding. Free of any scene scale.
    """
    return 2 * radius_texels + 0.1, 0.5 * radius_texels


class ShadowMap:
    """Depth from the light decides: fast, as sharp as its texels are small."""

    name = "shadow_map"
    label = "SM"
    title = "Shadow map"

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """The settings worth measuring: sizes at 2x2, and 1x1 where it saves taps."""
        focus = "view" if kind is LightKind.DIRECTIONAL else "light"
        sides = (128, 256, 512, 1024, 2048) if kind is LightKind.POINT else (256, 512, 1024, 2048, 4096)
        chosen = [(side, "2x2") for side in sides] + [(sides[2], "1x1"), (sides[3], "1x1")]
        columns = atlas_shape(6 if kind is LightKind.POINT else 1)[0]
        return [
            {"map_size": side, "filter": kernel, "focus": focus}
            for side, kernel in sorted(chosen)
            if side * columns <= limits.max_texture_side
        ]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why not: the map is larger than the device allows."""
        del scene
        side, faces = int(settings["map_size"]), faces_of(light)
        if faces == 6 and side > LARGEST_CUBE_SIDE:
            return f"cube maps are at most {LARGEST_CUBE_SIDE} a face, not {side}"
        if side * atlas_shape(faces)[0] > limits.max_texture_side:
            return f"a map of {side} does not fit the device's textures of {limits.max_texture_side}"
        return None

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ShadowMapPass:
        """A map of the size that `settings` ask for."""
        return ShadowMapPass(frame, light, settings)


class ShadowMapPass(ShadowPass):
    """One map with its settings, for one frame."""

    def __init__(self, frame: Frame, light: Light, settings: Settings) -> None:
        self._frame = frame
        self._side = int(settings["map_size"])
        self._focused = settings["focus"] == "view"
        slope, self._normal_offset = auto_bias(FILTERS[str(settings["filter"])])
        faces = faces_of(light)
        self._map = MapPass(frame.world, self._side, faces, (slope, OFFSET_UNITS))
        self._fit = MapFit(np.zeros((0, 4, 4)))
        self.memory_bytes = self._map.memory_bytes
        gpu = frame.gpu
        kernel = moderngl.LINEAR if settings["filter"] == "2x2" else moderngl.NEAREST
        self._sampler = gpu.ctx.sampler(
            filter=(kernel, kernel), compare_func=">=", repeat_x=False, repeat_y=False
        )
        self._visibility = shader.full_screen(
            gpu, shader.source("shadow_map.glsl", "one_face" if faces == 1 else "six_faces")
        )
        self._block = gpu.ctx.buffer(reserve=6 * 64 + 16)
        self._built = False

    def release(self) -> None:
        """Give the GPU memory back."""
        self._map.release()
        self._frame.gpu.release(self._sampler, self._visibility, self._block)

    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:
        """Draw the map if it has to be drawn, and compare every pixel with it."""
        rebuild = rebuild or not self._built or self._focused
        if rebuild:
            with clock.stage("map"):
                self._draw_map()
        with clock.stage("visibility"):
            self._compare()
        return Outcome("shadow_map", rebuilt=rebuild)

    def count(self) -> Counters:
        """Triangles of the map, and texels cleared and written, overdraw included."""
        within = reach(self._frame.light, self._frame.world.origin)
        return {
            "map_triangles": self._map.triangles(self._fit, within),
            "map_texels_cleared": self._map.memory_bytes // 4,
            "map_texels_written": self._map.texels(self._fit, within),
        }

    def _draw_map(self) -> None:
        frame = self._frame
        world = frame.world
        within = reach(frame.light, world.origin)
        view = clip_planes(frame.clip_from_scene) if self._focused else None
        self._fit = fit_map(frame.light, within, world.scene.bounds - world.origin, self._side, view)
        self._block.write(self._atlas_block())
        self._map.draw(self._fit, within)
        self._built = True

    def _atlas_block(self) -> bytes:
        matrices = np.zeros((6, 4, 4), "f4")
        for index, face in enumerate(self._fit.faces):
            matrices[index] = (self._map.atlas_from_clip(index) @ face).T
        texels = np.array([self._map.columns, self._map.rows], float) * self._side
        return matrices.tobytes() + np.array([*(1 / texels), self._normal_offset, 0], "f4").tobytes()

    def _compare(self) -> None:
        self._block.bind_to_uniform_block(2)
        self._map.texture.use(2)
        self._sampler.use(2)
        self._frame.fill_mask(self._visibility)
        self._sampler.clear(2)
