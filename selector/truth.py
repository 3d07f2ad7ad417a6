"""What is true in one view of one light: by shadow volumes, or by rays where those cannot answer."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from renderers.clock import StageClock
from renderers.context import GlError
from renderers.error_figures import continuity
from renderers.frame import Frame, Mask, Picture, Surfaces
from renderers.registry import GROUND_TRUTH, GROUND_TRUTH_SETTINGS, technique
from renderers.technique import ShadowPass
from scenes.ray_caster import RayCaster
from scenes.scene import Camera, Light
from selector.measurement import Truth

Bools = npt.NDArray[np.bool_]


# Positions rebuilt from the G-buffer are off by up to 1.5e-7 of their distance from the eye.
POSITION_ERROR = 2e-7


@dataclass(frozen=True)
class Reference:
    """One view as it should look; pictures have their top row first.

    Attributes:
        surfaces: What the camera sees.
        domain: (h, w), where a mask has to answer.
        lit: (h, w), whether the light reaches the surface.
        picture: (h, w, 3) uint8 sRGB.
        joined: What `error_figures` calls `joined_right` and `joined_down`.
        source: Who says so.
    """

    surfaces: Surfaces
    domain: Bools
    lit: Bools
    picture: Picture
    joined: tuple[Bools, Bools]
    source: Truth

    def shown(self) -> Shown:
        """The truth itself, as if a candidate had drawn it."""
        return Shown(self.picture, self.lit.astype(np.float32), self)


@dataclass(frozen=True)
class Shown:
    """One view as a candidate draws it, or as it should look; the top row comes first.

    Attributes:
        picture: (h, w, 3) uint8 sRGB.
        mask: (h, w) float32 in [0, 1]: 1 lit, 0 shadowed.
        truth: What it is compared with.
    """

    picture: Picture
    mask: Mask
    truth: Reference


class Oracle:
    """Knows the truth about the light that its frame is aimed at.

    Args:
        frame: Where it renders.
        clock: One that times nothing.
        timeout_s: After one frame that takes longer, rays answer in place of shadow volumes.
    """

    def __init__(self, frame: Frame, clock: StageClock, timeout_s: float) -> None:
        self._frame, self._clock, self._timeout_s = frame, clock, timeout_s
        self._volumes: ShadowPass | None = None
        self._caster: RayCaster | None = None

    def prepare(self, light: Light, alive: ExitStack) -> None:
        """Make ready for `light`; what is made lives as long as `alive`."""
        gpu, scene = self._frame.gpu, self._frame.world.scene
        truth = technique(GROUND_TRUTH)
        settings = GROUND_TRUTH_SETTINGS
        self._volumes = None
        if truth.refuses(light, scene, gpu.device.limits, settings):
            return
        try:
            with gpu.guard(f"{truth.label} as truth for {light.name}"):
                self._volumes = alive.enter_context(truth.prepare(self._frame, light, settings))
        except GlError:
            # Rays need no device memory, and every row says who told the truth.
            self._volumes = None

    def reference(self, light: Light, camera: Camera) -> Reference:
        """The truth about `light` as `camera` sees it; aims the frame and leaves its surfaces drawn.

        Raises:
            GlError: Not even the surfaces could be drawn.
        """
        frame = self._frame
        with frame.gpu.guard(f"surfaces for {light.name}"):
            frame.look(camera)
            frame.draw_surfaces()
            frame.draw_domain()
            surfaces, domain = frame.read_surfaces(), frame.read_domain()
        source = Truth.SHADOW_VOLUME if self._count_volumes() else Truth.EMBREE
        with frame.gpu.guard(f"truth for {light.name}"):
            if source is Truth.EMBREE:
                frame.write_mask(self.traced(light, surfaces, domain))
            frame.shade()
            lit = frame.read_mask() > 0.5
            picture = frame.read_picture()
        joined = continuity(surfaces.positions - frame.world.origin, surfaces.normals, surfaces.covered)
        return Reference(surfaces, domain, lit, picture, joined, source)

    def traced(self, light: Light, surfaces: Surfaces, domain: Bools) -> Bools:
        """(h, w): whether rays from the surfaces in the domain reach the light; False elsewhere."""
        if self._caster is None:
            self._caster = RayCaster(self._frame.world.scene)
        lit = np.zeros(domain.shape, bool)
        seen = surfaces.positions[domain]
        distance = np.linalg.norm(seen - np.asarray(self._frame.camera.position), axis=1)
        lit[domain] = self._caster.lit(
            seen, surfaces.normals[domain], light, position_error=POSITION_ERROR * distance
        )
        return lit

    def disagreement(self, light: Light, reference: Reference) -> float:
        """Share of the domain in which rays see it otherwise than the reference."""
        if not reference.domain.any():
            return 0.0
        traced = self.traced(light, reference.surfaces, reference.domain)
        return float((traced != reference.lit)[reference.domain].mean())

    def _count_volumes(self) -> bool:
        if self._volumes is None:
            return False
        start = time.perf_counter()
        try:
            with self._frame.gpu.guard("shadow volumes as truth"):
                self._volumes.render(self._clock, rebuild=True)
                self._frame.gpu.ctx.finish()
        except GlError:
            self._volumes = None
            return False
        if time.perf_counter() - start > self._timeout_s:
            # The other views of this light would take as long again.
            self._volumes = None
            return False
        return True
