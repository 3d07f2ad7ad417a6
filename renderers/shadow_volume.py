"""Shadow volumes (Crow 1977) by z-fail, right for any set of triangles: the truth of all error figures."""

from __future__ import annotations

from collections.abc import Sequence

from renderers import shader
from renderers.clock import StageClock
from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.technique import Counters, Outcome, Settings, ShadowPass
from renderers.volume_pass import BYTES_PER_PIECE, VolumePass
from scenes.scene import Light, LightKind, Scene

DEPTH_FUNC_ALWAYS = "1"
EDGES_PER_FACE = 3


class ShadowVolume:
    """Pixel-exact shadows: counts the triangles between each visible point and the light."""

    name = "shadow_volume"
    label = "SV"
    title = "Shadow volume"

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """One: it has nothing to tune."""
        del kind, limits
        return [{}]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why not: the edge lists do not fit the device's buffers."""
        del light, settings
        faces = sum(mesh.triangle_count for mesh in scene.meshes if mesh.casts)
        if EDGES_PER_FACE * faces * BYTES_PER_PIECE > limits.max_buffer_bytes:
            return f"{faces:,} casting triangles need larger buffers than the device's"
        return None

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ShadowVolumePass:
        """The volumes of the frame's world."""
        del light, settings
        return ShadowVolumePass(frame)


class ShadowVolumePass(ShadowPass):
    """The volumes of one light in one frame."""

    def __init__(self, frame: Frame) -> None:
        self._frame = frame
        self._volumes = VolumePass(frame)
        self._visibility = shader.full_screen(
            frame.gpu, shader.source("volume_visibility.glsl", "visibility")
        )
        self.memory_bytes = self._volumes.memory_bytes
        self._built = False

    def release(self) -> None:
        """Give the GPU memory back."""
        self._volumes.release()
        self._frame.gpu.release(self._visibility)

    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:
        """Find silhouettes if they have to be found, add up the volumes, and write the mask."""
        rebuild = rebuild or not self._built
        if rebuild:
            with clock.stage("edges"):
                self._volumes.find_silhouettes()
            self._built = True
        with clock.stage("volumes"):
            self._volumes.draw()
        with clock.stage("visibility"):
            self._volumes.counts.use(2)
            self._frame.fill_mask(self._visibility)
        return Outcome("shadow_volume", rebuilt=rebuild)

    def count(self) -> Counters:
        """Caps, silhouette edges and volume fragments."""
        caps, sides = self._volumes.pieces()
        return {
            "cap_triangles": 2 * caps,
            "silhouette_edges": sides,
            "volume_fragments": self._volumes.fragments(DEPTH_FUNC_ALWAYS),
            "volume_fragments_counted": self._volumes.fragments("<="),
        }
