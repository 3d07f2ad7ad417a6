"""A candidate on its way through the views of one light: whatever happens to it, the others go on."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace

from renderers.clock import ClockKind, StageClock
from renderers.context import OutOfVideoMemoryError
from renderers.error_figures import Bools, error_figures, mean_flip
from renderers.flicker import Flicker, State, error_state
from renderers.frame import Frame
from renderers.registry import technique
from renderers.technique import Outcome, ShadowPass
from renderers.timing import timed_frame
from scenes.errors import DeviceError
from scenes.scene import Camera, Light, Mobility, Scene
from selector.candidate import Candidate
from selector.measurement import Measurement, Sample, Status, ViewRun
from selector.truth import Reference, Shown


@dataclass
class Runner:
    """One candidate for one light in one frame.

    Attributes:
        candidate: What is measured.
        frame: Where it renders.
        status: How it has fared so far; no more work is given to one that is not ok.
        reason: Why it is not ok.
        memory_bytes: What its pass holds on the device.
        views: What was measured so far.
    """

    candidate: Candidate
    frame: Frame
    status: Status = Status.OK
    reason: str = ""
    memory_bytes: int = 0
    views: list[ViewRun] = field(default_factory=list)
    _pass: ShadowPass | None = None
    _samples: list[Sample] = field(default_factory=list)
    _flicker: Flicker = field(default_factory=Flicker)

    def prepare(self, light: Light, scene: Scene, alive: ExitStack) -> None:
        """Make its pass, which lives as long as `alive`; or find out why there is none."""
        method, settings = self.candidate.method, dict(self.candidate.settings)
        with self._surviving(light):
            refusal = method.refuses(light, scene, self.frame.gpu.device.limits, settings)
            if refusal:
                self.status, self.reason = Status.REFUSED, refusal
                return
            self._pass = alive.enter_context(method.prepare(self.frame, light, settings))
            self.memory_bytes = self._pass.memory_bytes

    def judge(
        self,
        light: Light,
        camera: Camera,
        truth: Reference,
        clock: StageClock,
        timeout_s: float,
        *,
        flip: bool = True,
    ) -> Shown | None:
        """Render once, untimed: figures and counters are kept, what is seen is given.

        None on failure, and without `flip`: then no picture is made, which spares a third of the time.
        """
        assert self.status is Status.OK
        assert self._pass is not None
        frame, picture = self.frame, None
        with self._surviving(light):
            outcome, seconds = self._render(clock)
            if flip:
                frame.shade()
                picture = frame.read_picture()
            mask = frame.read_mask()
            counters = {name: int(count) for name, count in self._pass.count().items()}
        if self.status is not Status.OK:
            return None
        run = ViewRun(
            camera.name,
            figures=error_figures(mask, truth.lit, truth.domain, *truth.joined),
            flip=None if picture is None else mean_flip(picture, truth.picture),
            counters=counters,
            truth=truth.source,
        )
        self._keep(run, outcome, seconds, timeout_s)
        return None if picture is None else Shown(picture, mask, truth)

    def warm_up(self, light: Light, camera: Camera, clock: StageClock, timeout_s: float) -> None:
        """Render once, untimed and unjudged, in place of `judge`: only the status is found out."""
        assert self.status is Status.OK
        with self._surviving(light):
            outcome, seconds = self._render(clock)
        if self.status is Status.OK:
            self._keep(ViewRun(camera.name), outcome, seconds, timeout_s)

    @property
    def samples(self) -> Sequence[Sample]:
        """Frames timed in the view that is not closed yet."""
        return self._samples

    def time(self, light: Light, index: int, kind: ClockKind) -> None:
        """Time one frame as a dynamic and one as a static light, in round `index`."""
        assert self._pass is not None
        for mobility in (Mobility.DYNAMIC, Mobility.STATIC):
            with self._surviving(light):
                timed = timed_frame(self.frame, self._pass, kind, rebuild=mobility is Mobility.DYNAMIC)
                self._samples.append(
                    Sample(index, mobility, timed.shadow_ms, timed.frame_ms, timed.stages_ms)
                )
            if self.status is not Status.OK:
                return

    def film(
        self, light: Light, cameras: tuple[Camera, Camera], truth: Reference, seen: Bools, clock: StageClock
    ) -> None:
        """Render a frame of a camera move, untimed, as fitted to its own camera and to the one before."""
        assert self._pass is not None
        states: list[State] = []
        for camera in cameras:
            with self._surviving(light):
                self.frame.fit_to(camera)
                outcome = self._pass.render(clock, rebuild=True)
                states.append(error_state(self.frame.read_mask(), truth.lit, truth.domain))
                self._count_only_as_itself(outcome, camera)
            if self.status is not Status.OK:
                return
        self._flicker.add(states[0], states[1], seen)

    def close_film(self) -> None:
        """Keep with the last view how much the frames filmed since flicker, if none of them failed."""
        if self.status is Status.OK:
            self.views[-1] = replace(self.views[-1], flicker=self._flicker.share)
        self._flicker = Flicker()

    def close_view(self) -> None:
        """Keep the samples taken since the last view with that view."""
        if self._samples:
            self.views[-1] = replace(self.views[-1], samples=tuple(self._samples))
        self._samples = []

    def release(self) -> None:
        """Forget the pass, whose memory has been given back."""
        self._pass = None

    def result(self) -> Measurement:
        """What was measured."""
        return Measurement(self.candidate, self.status, self.reason, self.memory_bytes, tuple(self.views))

    def _render(self, clock: StageClock) -> tuple[Outcome, float]:
        """What was done, and in how many seconds."""
        assert self._pass is not None
        start = time.perf_counter()
        outcome = self._pass.render(clock, rebuild=True)
        self.frame.gpu.ctx.finish()
        return outcome, time.perf_counter() - start

    def _keep(self, run: ViewRun, outcome: Outcome, seconds: float, timeout_s: float) -> None:
        fallback = "" if outcome.technique == self.candidate.technique else outcome.technique
        self.views.append(replace(run, note="" if fallback else outcome.note, fallback=fallback))
        self._count_only_as_itself(outcome, self.frame.camera)
        if self.status is Status.OK and seconds > timeout_s:
            self.status = Status.TIMEOUT
            self.reason = f"a frame took {seconds:.1f} s in view {run.camera}"

    def _count_only_as_itself(self, outcome: Outcome, camera: Camera) -> None:
        if outcome.technique != self.candidate.technique:
            self.status = Status.REFUSED
            other = technique(outcome.technique).label
            why = outcome.note or f"{self.candidate.method.label} gave up"
            self.reason = f"{other} was drawn in view {camera.name}, because {why}"

    @contextmanager
    def _surviving(self, light: Light) -> Iterator[None]:
        """Whatever goes wrong in the block is this candidate's status, and nobody else's."""
        try:
            with self.frame.gpu.guard(f"{self.candidate.label} for {light.name}"):
                yield
        except OutOfVideoMemoryError as error:
            self.status, self.reason = Status.OUT_OF_MEMORY, str(error)
        except DeviceError as error:
            self.status, self.reason = Status.GL_ERROR, str(error)
        except MemoryError as error:
            self.status, self.reason = Status.OUT_OF_MEMORY, str(error) or "there is no memory left"
        except Exception as error:  # noqa: BLE001  a bug in one technique must not cost the others' results
            self.frame.gpu.ctx.clear_errors()
            self.status, self.reason = Status.CRASHED, f"{type(error).__name__}: {error}"
