"""Shadow volumes (Crow 1977) by z-fail, right for any set of triangles: the truth of all error figures."""

from __future__ import annotations

from collections.abc import Sequence

from renderers import shader
from renderers.clock import StageClock
from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.internals import Internals
from renderers.settings import Option, Options, Settings, completed
from renderers.stencil_volumes import StencilVolumePass
from renderers.technique import Counters, Outcome, ShadowPass
from renderers.volume_closure import lit_faces_fall_short
from renderers.volume_eye import near_rectangle_is_lit
from renderers.volume_pass import BEHIND, IN_FRONT, VolumePass
from renderers.volume_pieces import BYTES_PER_PIECE, EDGES_PER_FACE
from renderers.volume_silhouettes import VolumeForm
from scenes.scene import Light, LightKind, Scene

DEPTH_FUNC_ALWAYS = "1"
EYE_IN_SHADOW = "z-pass may be wrong here: a caster may stand between the near plane and the light"

OPTIONS: Options = {
    "variant": Option(
        "mixed", "volumes of all faces, or of lit ones where that is enough", ("mixed", "general", "crow")
    ),
    "unchecked": Option(
        default=False, meaning="crow where it is wrong, too", choices=(False, True), replay=True
    ),
    "volumes": Option(
        "silhouette", "sides at silhouettes, or around each face", ("silhouette", "triangle"), replay=True
    ),
    "counting": Option(
        "zfail", "count what lies behind surfaces, or in front", ("zfail", "zpass"), replay=True
    ),
    "counter": Option(
        "blend", "a float target, or 8 bits of stencil", ("blend", "two_sided", "one_sided"), replay=True
    ),
    "extrusion": Option("receivers", "where volumes end", ("receivers", "infinite", "finite"), replay=True),
    "silhouettes": Option("gpu", "what finds silhouettes", ("gpu", "cpu"), replay=True),
}


class ShadowVolume:
    """Pixel-exact shadows: counts the triangles between each visible point and the light."""

    name = "shadow_volume"
    label = "SV"
    title = "Shadow volume"
    options = OPTIONS

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """One: what can be set changes what is drawn, never what is seen, and the default draws any level."""
        del kind, limits
        return [{}]

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why not: the edge lists do not fit the device's buffers, or a variant would be wrong."""
        chosen = completed(self.options, settings, self.label)
        faces = sum(mesh.triangle_count for mesh in scene.meshes if mesh.casts)
        if EDGES_PER_FACE * faces * BYTES_PER_PIECE > limits.max_buffer_bytes:
            return f"{faces:,} casting triangles need larger buffers than the device's"
        if chosen["counter"] != "blend" and chosen["variant"] != "crow":
            return f"counter={chosen['counter']} adds only ones, as variant=crow does; others subtract, too"
        if chosen["variant"] == "crow" and not chosen["unchecked"]:
            return lit_faces_fall_short(light, scene)
        return None

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ShadowVolumePass:
        """The volumes of the frame's world."""
        del light
        return ShadowVolumePass(frame, completed(self.options, settings, self.label))


class ShadowVolumePass(ShadowPass):
    """The volumes of one light in one frame."""

    def __init__(self, frame: Frame, settings: Settings) -> None:
        self._frame = frame
        self._lit_faces_only = settings["variant"] == "crow"
        self._checked: Light | None = None
        self._shortfall = ""
        self._depth_func = IN_FRONT if settings["counting"] == "zpass" else BEHIND
        self._volumes = _volumes(frame, settings)
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
            self._volumes.draw(self._depth_func)
        with clock.stage("visibility"):
            self._volumes.counts.use(2)
            self._frame.fill_mask(self._visibility)
        return Outcome("shadow_volume", rebuilt=rebuild, note=self._warning())

    def count(self) -> Counters:
        """Caps, silhouette edges and volume fragments."""
        caps, sides = self._volumes.pieces()
        return {
            "cap_triangles": 2 * caps,
            "silhouette_edges": sides,
            "volume_fragments": self._volumes.fragments(DEPTH_FUNC_ALWAYS),
            "volume_fragments_counted": self._volumes.fragments(self._depth_func),
        }

    def internals(self) -> Internals:
        """The volumes."""
        return Internals(volumes=self._volumes)

    def _warning(self) -> str:
        """Where this frame may be wrong, and why; empty for what is always right."""
        light = self._frame.light
        if self._lit_faces_only and light is not self._checked:
            self._checked = light
            self._shortfall = lit_faces_fall_short(light, self._frame.world.scene) or ""
        if self._shortfall:
            return self._shortfall
        if self._depth_func == IN_FRONT and not near_rectangle_is_lit(self._frame):
            return EYE_IN_SHADOW
        return ""


def _volumes(frame: Frame, settings: Settings) -> VolumePass:
    counter, finite = settings["counter"], settings["extrusion"] == "finite"
    form = VolumeForm(
        # In front of a surface there are no near caps, and no far ones that lie beyond all receivers.
        caps=settings["counting"] == "zfail" or finite,
        variant=str(settings["variant"]),
        per_triangle=settings["volumes"] == "triangle",
        unit_weights=counter != "blend",
        on_cpu=settings["silhouettes"] == "cpu",
        extrusion=str(settings["extrusion"]),
    )
    if counter == "blend":
        return VolumePass(frame, form=form)
    return StencilVolumePass(frame, form, one_sided=counter == "one_sided")
