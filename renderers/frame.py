"""One view of a world: the G-buffer, the light mask that techniques write, and the shared shading pass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt
from OpenGL import GL

from renderers import shader
from renderers.owner import Owner
from renderers.run_drawer import RunDrawer
from renderers.world import World
from scenes.convex import clip_planes
from scenes.frusta import boxes_inside, camera_view, reach, reversed_infinite
from scenes.receivers import receiver_body
from scenes.scene import Array, Camera, Light, LightKind

Window = tuple[int, int, int, int]
Mask = npt.NDArray[np.float32]
Picture = npt.NDArray[np.uint8]


# Of the largest coordinates: twice the least move that leaves no plane in its own shadow on a map, seen from
# 0.2 to 300 scene sizes.
FLOAT32_STEPS = 4.8e-7
NOTHING_SEEN = np.zeros(4, np.uint32)
INFINITELY_FAR = np.zeros(1, np.float32)
# Of pictures where there is no surface, display-referred.
SKY = (0.55, 0.58, 0.63)


class Frame(Owner):
    """Targets and uniform blocks for one resolution; `look` aims it at a camera, `shine` at a light.

    A context manager that gives its GPU memory back.
    """

    def __init__(self, world: World, width: int, height: int) -> None:
        self.world, self.gpu = world, world.gpu
        self.width, self.height = width, height
        ctx = self.gpu.ctx
        self.depth = self.gpu.depth_texture(width, height)
        self.surface = ctx.texture((width, height), 2, dtype="u4")
        self.albedo = ctx.texture((width, height), 4)
        self.mask = ctx.texture((width, height), 1)
        self.domain = ctx.texture((width, height), 1)
        self.shaded = ctx.texture((width, height), 4)
        for texture in (self.depth, self.surface, self.albedo, self.mask, self.domain, self.shaded):
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._surface_target = ctx.framebuffer([self.surface, self.albedo], self.depth)
        self._mask_target = ctx.framebuffer([self.mask], self.depth)
        self._domain_target = ctx.framebuffer([self.domain], self.depth)
        self._shaded_target = ctx.framebuffer([self.shaded], self.depth)
        for target in (self._mask_target, self._domain_target, self._shaded_target):
            target.depth_mask = False
        self.camera = Camera("nowhere", (0.0, 0.0, 0.0))
        self.light = Light("none", LightKind.POINT)
        self._window: Window | None = None
        self._domain_drawn = False
        self._frame_block = ctx.buffer(reserve=128)
        self._light_block = ctx.buffer(reserve=64)
        surface = shader.program(
            self.gpu,
            shader.source("geometry_buffer.glsl", "surface_vertex"),
            shader.source("geometry_buffer.glsl", "surface_fragment"),
        )
        self._surface = RunDrawer(self.gpu, world.vertex_array(surface), len(world.surfaces.low))
        self._visible = np.zeros((0, 2), np.int64)
        self._domain = shader.full_screen(self.gpu, shader.source("shading.glsl", "domain"))
        self._shade = shader.full_screen(self.gpu, shader.source("shading.glsl", "shade"))

    def release(self) -> None:
        """Give the GPU memory back."""
        self.gpu.release(
            self._surface_target,
            self._mask_target,
            self._domain_target,
            self._shaded_target,
            self.depth,
            self.surface,
            self.albedo,
            self.mask,
            self.domain,
            self.shaded,
            self._frame_block,
            self._light_block,
            self._surface,
            self._domain,
            self._shade,
        )

    def look(self, camera: Camera) -> None:
        """Aim at what `camera` sees."""
        self._stand_at(camera)
        self._window = None
        surfaces = self.world.surfaces
        seen = boxes_inside(self.view_planes, surfaces.low, surfaces.high)
        self._visible = surfaces.runs(seen)
        largest = np.abs(self.world.scene.bounds - self.world.origin).max()
        rounding = FLOAT32_STEPS * (largest + np.linalg.norm(self.eye))
        rows = [[*self.eye, rounding], *([*ray, 0.0] for ray in self.rays)]
        self._frame_block.write(_columns(self.clip_from_scene) + np.array(rows, "f4").tobytes())

    def fit_to(self, camera: Camera) -> None:
        """Let passes fit what they make to `camera`, while the picture stays that of the camera looked at.

        So the maps of two cameras can be compared in the same pixels. Draw and read surfaces and domain
        before; the next `look` ends it.
        """
        window = self.window
        self._stand_at(camera)
        self._window = window

    def _stand_at(self, camera: Camera) -> None:
        eye = np.asarray(camera.position) - self.world.origin
        view = camera_view(camera)
        view[:3, 3] = -view[:3, :3] @ eye
        aspect = self.width / self.height
        half_height = np.tan(camera.yfov_rad / 2)
        self.camera, self.eye = camera, eye
        self.clip_from_scene = reversed_infinite(camera.yfov_rad, aspect, camera.near_m) @ view
        self.rays = np.stack([view[0, :3] * half_height * aspect, view[1, :3] * half_height, -view[2, :3]])
        self.eye_from_scene = view
        self.view_planes = clip_planes(self.clip_from_scene)
        # Nothing nearer than the near plane is seen.
        self.view_planes[-1, 3] -= camera.near_m

    def shine(self, light: Light) -> None:
        """Aim the light block at `light`."""
        self.light, self._window = light, None
        self._domain_drawn = False
        homogeneous = light.homogeneous
        homogeneous[:3] -= homogeneous[3] * self.world.origin
        spot = light.kind is LightKind.SPOT
        range_m = light.range_m if np.isfinite(light.range_m) else 0.0
        block = [
            homogeneous,
            [*light.direction, np.cos(light.outer_cone_rad)] if spot else [0, 0, 0, -2],
            [np.cos(light.inner_cone_rad), range_m, 0, 0],
            [*light.color, 0],
        ]
        self._light_block.write(np.array(block, "f4").tobytes())

    @property
    def window(self) -> Window:
        """x, y, width, height in pixels that hold every visible surface in the light's reach; may be empty.

        Passes that scissor to it do no work where the mask is 0 for everybody.
        """
        if self._window is None:
            self._window = self._find_window()
        return self._window

    def fill_mask(self, visibility: moderngl.VertexArray) -> None:
        """Run a full-screen pass that writes visibility where the mask can be anything but 0."""
        self._cover(self._mask_target, visibility, self.window)

    def _cover(
        self,
        target: moderngl.Framebuffer,
        full_screen: moderngl.VertexArray,
        window: Window,
        background: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Clear, then run a full-screen pass on pixels that show a surface.

        The pass lies at infinity and is kept where the scene is nearer, so the depth test spares the sky: a
        third less time on the bench's street.
        """
        ctx = self.gpu.ctx
        target.use()
        target.scissor = (0, 0, self.width, self.height)
        target.clear(*background, 1.0)
        target.scissor = window
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.depth_func = "<"
        full_screen.render(moderngl.TRIANGLES, vertices=3)
        ctx.enable_only(moderngl.NOTHING)

    def _find_window(self) -> Window:
        surfaces, within = self.world.surfaces, reach(self.light, self.world.origin)
        lit = receiver_body(surfaces.low, surfaces.high, within, self.view_planes).corners
        clip = np.hstack([lit, np.ones((len(lit), 1))]) @ self.clip_from_scene.T
        ahead = clip[clip[:, 3] > 0]
        if not len(ahead):
            return 0, 0, 0, 0
        size = np.array([self.width, self.height])
        pixels = (ahead[:, :2] / ahead[:, 3:] + 1) / 2 * size
        first = np.clip(np.floor(pixels.min(axis=0)) - 1, 0, size).astype(int)
        last = np.clip(np.ceil(pixels.max(axis=0)) + 1, 0, size).astype(int)
        return int(first[0]), int(first[1]), int(last[0] - first[0]), int(last[1] - first[1])

    def draw_surfaces(self) -> None:
        """Fill the G-buffer."""
        self._domain_drawn = False
        self._surface_target.use()
        # glClear is undefined for integer targets; albedo is read only where a surface was drawn.
        GL.glClearBufferuiv(GL.GL_COLOR, 0, NOTHING_SEEN)
        GL.glClearBufferfv(GL.GL_DEPTH, 0, INFINITELY_FAR)
        self.world.bind_faces(4)
        ctx = self.gpu.ctx
        self._frame_block.bind_to_uniform_block(0)
        self._light_block.bind_to_uniform_block(1)
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.depth_func = ">"
        self._surface.draw(self._visible)
        ctx.enable_only(moderngl.NOTHING)
        self.surface.use(0)

    def draw_domain(self) -> None:
        """Mark where a technique's answer counts for the light."""
        self._cover(self._domain_target, self._domain, self.window)
        self._domain_drawn = True

    def shade(self) -> None:
        """Light the surfaces through the mask."""
        self.albedo.use(2)
        self.mask.use(3)
        self._cover(self._shaded_target, self._shade, (0, 0, self.width, self.height), SKY)

    def write_mask(self, lit: npt.NDArray[np.bool_]) -> None:
        """Fill the mask from (h, w) bool, top row first, instead of by a technique."""
        self.mask.write(np.ascontiguousarray(lit[::-1] * np.uint8(255)), alignment=1)

    def read_mask(self) -> Mask:
        """(h, w) float32 in [0, 1], top row first: 1 lit, 0 shadowed, and 0 outside the domain."""
        mask = _rows(self.mask, np.uint8, self.height).astype(np.float32) / np.float32(255)
        return mask * self.read_domain()

    def read_domain(self) -> npt.NDArray[np.bool_]:
        """(h, w) bool, top row first: where a technique's answer counts."""
        if not self._domain_drawn:
            self.draw_domain()
        return _rows(self.domain, np.uint8, self.height) > 0

    def read_picture(self) -> Picture:
        """(h, w, 3) uint8 sRGB, top row first."""
        return _rows(self.shaded, np.uint8, self.height).reshape(self.height, self.width, 4)[:, :, :3]

    def read_surfaces(self) -> Surfaces:
        """What the camera sees, rebuilt from the G-buffer exactly as the shaders do."""
        halves = _rows(self.surface, np.uint32, self.height).reshape(self.height, self.width, 2)
        distance = np.ascontiguousarray(halves[..., 0]).view(np.float32).astype(np.float64)
        x = 2 * (np.arange(self.width) + 0.5) / self.width - 1
        y = 1 - 2 * (np.arange(self.height) + 0.5) / self.height
        rays = self.rays[2] + x[None, :, None] * self.rays[0] + y[:, None, None] * self.rays[1]
        covered = distance > 0
        normals = decode_octahedral(halves[..., 1])
        away = np.einsum("ijk,ijk->ij", normals, rays) > 0
        positions = self.world.origin + self.eye + rays * distance[..., None]
        return Surfaces(positions, np.where(away[..., None], -normals, normals), covered)


@dataclass(frozen=True)
class Surfaces:
    """The visible surface in each pixel, top row first.

    Attributes:
        positions: (h, w, 3) float64, world metres.
        normals: (h, w, 3) float64, unit, geometric, towards the eye.
        covered: (h, w) bool: whether there is a surface.
    """

    positions: Array
    normals: Array
    covered: npt.NDArray[np.bool_]


def decode_octahedral(packed: npt.NDArray[np.uint32]) -> Array:
    """(..., 3) float64 unit normals; the inverse of `world.encode_octahedral`."""
    halves = np.stack([packed & 0xFFFF, packed >> 16], axis=-1).astype(np.uint16).view(np.int16)
    square = np.maximum(halves / 32767, -1)
    height = 1 - np.abs(square).sum(axis=-1)
    fold = np.maximum(-height, 0)[..., None]
    flat = square - fold * np.where(square >= 0, 1.0, -1.0)
    normals = np.concatenate([flat, height[..., None]], axis=-1)
    unit: Array = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    return unit


def _columns(matrix: Array) -> bytes:
    return matrix.T.astype("f4").tobytes()


def _rows(texture: moderngl.Texture, dtype: npt.DTypeLike, height: int) -> npt.NDArray[Any]:
    return np.frombuffer(texture.read(alignment=1), dtype).reshape(height, -1)[::-1]
