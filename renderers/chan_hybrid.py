"""Chan and Durand's hybrid (2004): a small shadow map where it is certain, shadow volumes at its edges."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from renderers.clock import StageClock
from renderers.context import DeviceLimits
from renderers.covering_map import CoveringMapPass
from renderers.frame import Frame
from renderers.internals import DrawnMap, Internals
from renderers.map_pass import MapPass
from renderers.map_settings import MAP_OPTIONS, TAPS, Bias, fits, guard_share, map_refusal
from renderers.settings import Option, Options, Settings, completed
from renderers.shadow_map import ShadowMap, ordinary_map
from renderers.shadow_volume import ShadowVolume
from renderers.silhouette_pixels import SilhouettePixels
from renderers.technique import Counters, Outcome, ShadowPass
from renderers.volume_pass import BEHIND, VolumePass
from renderers.volume_pieces import EDGES_PER_FACE
from renderers.volume_silhouettes import VolumeForm
from renderers.volume_tiles import BYTES_PER_TRIANGLE, TiledVolumePass
from scenes.frusta import reach
from scenes.map_frusta import MapFit, faces_of
from scenes.scene import Light, LightKind, Scene

DEPTH_FUNC_ALWAYS = "1"

OPTIONS: Options = {
    "map_size": MAP_OPTIONS["map_size"],
    "kernel": Option("2x2", "texels that must agree for the map to answer", ("2x2", "4x4")),
    "focus": ShadowMap.options["focus"],
    "casters": Option(
        "sampled",
        "casters as texels sample them, or a second map that even thin ones cover",
        ("sampled", "covering"),
    ),
    "grazing": Option(
        0.0, "cosine of incidence up to which volumes decide, whatever the map says", (), (0, 1)
    ),
    "tiles": Option(
        64, "pixels along a tile; volumes are drawn in tiles where they can count", ("off",), (16, 1024)
    ),
    **{name: option for name, option in MAP_OPTIONS.items() if name.startswith("bias")},
}


class ChanHybrid:
    """Exact where no caster and no gap is thinner than a texel; volumes fill less than the screen."""

    name = "chan_hybrid"
    label = "Chan"
    title = "Hybrid of shadow map and shadow volumes"
    options: Options = OPTIONS

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """The settings worth measuring: sizes."""
        focus = "view" if kind is LightKind.DIRECTIONAL else "light"
        sides = (128, 256, 512) if kind is LightKind.POINT else (256, 512, 1024)
        return [
            {"map_size": side, "kernel": "2x2", "focus": focus} for side in sides if fits(side, kind, limits)
        ]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why not: the map is larger than the device allows, or the volumes' buffers are."""
        chosen = completed(self.options, settings, self.label)
        # First what no setting of tiles mends.
        reason = map_refusal(light, scene, limits, chosen) or ShadowVolume().refuses(light, scene, limits, {})
        faces = sum(mesh.triangle_count for mesh in scene.meshes if mesh.casts)
        most_bytes = 2 * faces * (1 + EDGES_PER_FACE) * BYTES_PER_TRIANGLE
        if reason is None and chosen["tiles"] != "off" and most_bytes > limits.max_buffer_bytes:
            return f"{faces:,} casting triangles need larger lists than the device's buffers; try tiles=off"
        return reason

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ChanHybridPass:
        """A map of the size that `settings` ask for, and the volumes of the frame's world."""
        return ChanHybridPass(frame, light, completed(self.options, settings, self.label))


class ChanHybridPass(ShadowPass):
    """Map, silhouette pixels and volumes of one light in one frame."""

    def __init__(self, frame: Frame, light: Light, settings: Settings) -> None:
        self._frame, kernel = frame, str(settings["kernel"])
        self._focused, self._covers = settings["focus"] == "view", settings["casters"] == "covering"
        side, faces = int(settings["map_size"]), faces_of(light)
        self._taps, self._shrink = TAPS[kernel], guard_share(side, kernel)
        self._bias = _bias(settings)
        offset = self._bias.slope, self._bias.units
        self._map = MapPass(frame.world, side, faces, offset)
        self._maps = [self._map]
        if self._covers:
            self._maps.append(CoveringMapPass(frame.world, side, faces, offset))
        for one in self._maps:
            one.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            one.texture.repeat_x = one.texture.repeat_y = False
        self._fit = MapFit(np.zeros((0, 4, 4)))
        self._block = frame.gpu.ctx.buffer(reserve=6 * 64 + 16)
        simple = kernel == "2x2" and not self._covers
        self._silhouettes = SilhouettePixels(frame, faces, float(settings["grazing"]), simple=simple)
        depth, tiles = self._silhouettes.depth, settings["tiles"]
        form = VolumeForm(variant="mixed")
        self._tiled = None if tiles == "off" else TiledVolumePass(frame, depth, int(tiles), form)
        self._volumes = self._tiled or VolumePass(frame, depth, form)
        self._parts: list[MapPass | SilhouettePixels | VolumePass] = [
            self._volumes,
            self._silhouettes,
            *self._maps,
        ]
        self.memory_bytes = sum(part.memory_bytes for part in self._parts)
        self._built = False

    def release(self) -> None:
        """Give the GPU memory back."""
        for part in self._parts:
            part.release()
        self._frame.gpu.release(self._block)

    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:
        """Draw the map, let it answer where it is certain, and count volumes elsewhere."""
        rebuild = rebuild or not self._built
        if rebuild or self._focused:
            with clock.stage("map"):
                self._draw_maps()
        with clock.stage("silhouette_pixels"):
            self._silhouettes.find(self._block, self._map, self._maps[-1])
        if rebuild:
            with clock.stage("edges"):
                self._volumes.find_silhouettes()
        if self._tiled:
            with clock.stage("computation_mask"):
                self._tiled.cull()
        with clock.stage("volumes"):
            self._volumes.draw()
        with clock.stage("visibility"):
            self._silhouettes.fill(self._volumes.counts)
        self._built = True
        return Outcome("chan_hybrid", rebuilt=rebuild or self._focused)

    def count(self) -> Counters:
        """Work of the maps, silhouette pixels, and pieces, triangles and fragments of the volumes."""
        within = reach(self._frame.light, self._frame.world.origin)
        caps, sides = self._volumes.pieces()
        return {
            "map_triangles": sum(one.triangles(self._fit, within) for one in self._maps),
            "map_texels_cleared": sum(one.memory_bytes for one in self._maps) // 4,
            "map_texels_written": sum(one.texels(self._fit, within) for one in self._maps),
            "silhouette_pixels": self._silhouettes.count(self._volumes.counts),
            "cap_triangles": 2 * caps,
            "silhouette_edges": sides,
            "volume_triangles": self._tiled.triangles() if self._tiled else 2 * (caps + sides),
            "volume_fragments": self._volumes.fragments(DEPTH_FUNC_ALWAYS),
            "volume_fragments_counted": self._volumes.fragments(BEHIND),
        }

    def internals(self) -> Internals:
        """The map, the silhouette pixels and the volumes."""
        return Internals(DrawnMap(self._map, self._fit), self._volumes, self._silhouettes.depth)

    def _draw_maps(self) -> None:
        frame = self._frame
        self._fit = ordinary_map(frame, self._shrink, focused=self._focused)
        self._block.write(self._map.block(self._fit, self._bias.normal_texels, self._taps))
        for one in self._maps:
            one.draw(self._fit, reach(frame.light, frame.world.origin))


def _bias(settings: Settings) -> Bias:
    """What `settings` ask for; where they name no number, receivers stay where they are.

    A step along the normal leads to other texels than those around the pixel, and a shadow's edge between
    these may go unseen: 1,313 wrong pixels instead of 686 on the bench's box grid, 512 texels. The slope
    alone keeps a plane out of its own shadow.
    """
    normal = settings["bias_normal"]
    return Bias.of(
        {**settings, "filter": settings["kernel"], "bias_normal": 0.0 if normal == "auto" else normal}
    )
