"""One view of a world: the G-buffer, the light mask that techniques write, and the shared shading pass."""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

import moderngl
import numpy as np
import numpy.typing as npt

from renderers import shader
from renderers.world import World
from scenes.frusta import camera_view, reversed_infinite
from scenes.scene import Array, Camera, Light, LightKind

Mask = npt.NDArray[np.float32]
Picture = npt.NDArray[np.uint8]


class Frame:
    """Targets and uniform blocks for one resolution; `look` aims it at a camera, `shine` at a light.

    A context manager that gives its GPU memory back.
    """

    def __init__(self, world: World, width: int, height: int) -> None:
        self.world, self.gpu = world, world.gpu
        self.width, self.height = width, height
        ctx = self.gpu.ctx
        self.depth = self.gpu.depth_texture(width, height, bits=32)
        self.normal = ctx.texture((width, height), 1, dtype="u4")
        self.albedo = ctx.texture((width, height), 4)
        self.mask = ctx.texture((width, height), 1)
        self.domain = ctx.texture((width, height), 1)
        self.shaded = ctx.texture((width, height), 4)
        for texture in (self.depth, self.normal, self.albedo, self.mask, self.domain, self.shaded):
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._surface_target = ctx.framebuffer([self.normal, self.albedo], self.depth)
        self.mask_target = ctx.framebuffer([self.mask])
        self._domain_target = ctx.framebuffer([self.domain])
        self._shaded_target = ctx.framebuffer([self.shaded])
        self.camera = Camera("nowhere", (0.0, 0.0, 0.0))
        self.light = Light("none", LightKind.POINT)
        self._frame_block = ctx.buffer(reserve=128)
        self._light_block = ctx.buffer(reserve=64)
        surface = shader.program(
            self.gpu,
            shader.source("geometry_buffer.glsl", "surface_vertex"),
            shader.source("geometry_buffer.glsl", "surface_fragment"),
        )
        self._surface = world.vertex_array(surface)
        self._domain = shader.full_screen(self.gpu, shader.source("shading.glsl", "domain"))
        self._shade = shader.full_screen(self.gpu, shader.source("shading.glsl", "shade"))

    def __enter__(self) -> Self:
        """The frame itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the GPU memory back."""
        self.gpu.release(
            self._surface_target,
            self.mask_target,
            self._domain_target,
            self._shaded_target,
            self.depth,
            self.normal,
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
        eye = np.asarray(camera.position) - self.world.origin
        view = camera_view(camera)
        view[:3, 3] = -view[:3, :3] @ eye
        aspect = self.width / self.height
        half_height = np.tan(camera.yfov_rad / 2)
        self.camera, self.eye = camera, eye
        self.clip_from_scene = reversed_infinite(camera.yfov_rad, aspect, camera.near_m) @ view
        self.rays = np.stack([view[0, :3] * half_height * aspect, view[1, :3] * half_height, -view[2, :3]])
        rows = [[*eye, camera.near_m], *([*ray, 0.0] for ray in self.rays)]
        self._frame_block.write(_columns(self.clip_from_scene) + np.array(rows, "f4").tobytes())

    def shine(self, light: Light) -> None:
        """Aim the light block at `light`."""
        self.light = light
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

    def draw_surfaces(self) -> None:
        """Fill the G-buffer."""
        self._surface_target.use()
        self._surface_target.clear(depth=0.0)
        self.world.face_buffer.bind_to_storage_buffer(0)
        ctx = self.gpu.ctx
        self._frame_block.bind_to_uniform_block(0)
        self._light_block.bind_to_uniform_block(1)
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.depth_func = ">"
        self._surface.render(moderngl.TRIANGLES, vertices=3 * len(self.world.triangles))
        ctx.enable_only(moderngl.NOTHING)
        self.depth.use(0)
        self.normal.use(1)

    def draw_domain(self) -> None:
        """Mark where a technique has to answer for the light."""
        self._domain_target.use()
        self._domain.render(moderngl.TRIANGLES, vertices=3)

    def shade(self) -> None:
        """Light the surfaces through the mask."""
        self._shaded_target.use()
        self.albedo.use(2)
        self.mask.use(3)
        self._shade.render(moderngl.TRIANGLES, vertices=3)

    def read_mask(self) -> Mask:
        """(h, w) float32 in [0, 1], top row first: 1 lit, 0 shadowed."""
        return _rows(self.mask, np.uint8, self.height).astype(np.float32) / np.float32(255)

    def read_domain(self) -> npt.NDArray[np.bool_]:
        """(h, w) bool, top row first: where a technique has to answer."""
        return _rows(self.domain, np.uint8, self.height) > 0

    def read_picture(self) -> Picture:
        """(h, w, 3) uint8 sRGB, top row first."""
        return _rows(self.shaded, np.uint8, self.height).reshape(self.height, self.width, 4)[:, :, :3]

    def read_surfaces(self) -> Surfaces:
        """What the camera sees, rebuilt from the G-buffer exactly as the shaders do."""
        depth = _rows(self.depth, np.float32, self.height).astype(np.float64)
        packed = _rows(self.normal, np.uint32, self.height)
        x = 2 * (np.arange(self.width) + 0.5) / self.width - 1
        y = 1 - 2 * (np.arange(self.height) + 0.5) / self.height
        rays = self.rays[2] + x[None, :, None] * self.rays[0] + y[:, None, None] * self.rays[1]
        covered = depth > 0
        distance = self.camera.near_m / np.where(covered, depth, 1)
        normals = decode_octahedral(packed)
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
