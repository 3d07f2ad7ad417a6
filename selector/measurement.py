"""What was measured about one light: raw samples, work counters and error figures, by candidate and view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from statistics import median

from renderers.clock import ClockKind
from renderers.context import Device
from renderers.error_figures import ErrorFigures, over_views
from renderers.technique import Counters
from scenes.scene import Light, Mobility
from selector.candidate import Candidate


class Status(StrEnum):
    """How a run ended."""

    OK = "ok"
    REFUSED = "refused"
    TIMEOUT = "timeout"
    OUT_OF_MEMORY = "out_of_memory"
    GL_ERROR = "gl_error"
    CRASHED = "crashed"


class Truth(StrEnum):
    """What the mask was compared with."""

    SHADOW_VOLUME = "shadow_volume"
    EMBREE = "embree"


@dataclass(frozen=True)
class Sample:
    """One timed frame.

    Attributes:
        round: Which round it belongs to; all samples of a round share one canary.
        mobility: Whether the map or the volumes were made anew.
        shadow_ms: The technique's own stages.
        frame_ms: Everything: surfaces, shadow, shading.
        stages_ms: Milliseconds by stage.
    """

    round: int
    mobility: Mobility
    shadow_ms: float
    frame_ms: float
    stages_ms: Mapping[str, float]


@dataclass(frozen=True)
class ViewRun:
    """One candidate in one view.

    Attributes:
        camera: The camera's name.
        samples: Every timed frame, raw.
        figures: Error figures; None where no mask was made.
        flip: Mean FLIP of the shaded picture against that of the truth; None where there is none.
        counters: Exact work counts.
        truth: What the mask was compared with.
        note: What the technique had to say; why it fell back is its measurement's reason, and not said here.
        flicker: Share of co-visible pixels whose error changes from frame to frame of a camera move; None
            where none was made, or no pixel is co-visible.
        fallback: Id of the technique that was drawn in its place; empty where it was drawn itself. All that
            is measured here is that one's.
    """

    camera: str
    samples: tuple[Sample, ...] = ()
    figures: ErrorFigures | None = None
    flip: float | None = None
    counters: Counters = field(default_factory=dict)
    truth: Truth = Truth.SHADOW_VOLUME
    note: str = ""
    flicker: float | None = None
    fallback: str = ""


@dataclass(frozen=True)
class Measurement:
    """One candidate for one light, over all views."""

    candidate: Candidate
    status: Status
    reason: str = ""
    memory_bytes: int = 0
    views: tuple[ViewRun, ...] = ()

    def shadow_ms(self, mobility: Mobility) -> float | None:
        """Mean over views of the median over rounds."""
        return self._mean_of_medians(mobility, lambda sample: sample.shadow_ms)

    def frame_ms(self, mobility: Mobility) -> float | None:
        """Mean over views of the median over rounds."""
        return self._mean_of_medians(mobility, lambda sample: sample.frame_ms)

    def stages_ms(self, mobility: Mobility) -> dict[str, float]:
        """Stage times, each the mean over views of the median over rounds."""
        samples = [sample for view in self.views for sample in view.samples]
        names = dict.fromkeys(name for sample in samples for name in sample.stages_ms)
        times = {name: self._mean_of_medians(mobility, _Stage(name)) for name in names}
        return {name: time for name, time in times.items() if time}

    def figure(self, name: str) -> float | None:
        """An error figure over all views: the 95th percentile, the worst where there are fewer than 20."""
        if name in ("flip", "flicker"):
            return over_views([getattr(view, name) for view in self.views])
        return over_views([getattr(view.figures, name) for view in self.views if view.figures])

    def _mean_of_medians(self, mobility: Mobility, value: Callable[[Sample], float]) -> float | None:
        medians = [
            median(values)
            for view in self.views
            if (values := [value(sample) for sample in view.samples if sample.mobility is mobility])
        ]
        return sum(medians) / len(medians) if medians else None


@dataclass(frozen=True)
class _Stage:
    name: str

    def __call__(self, sample: Sample) -> float:
        return sample.stages_ms.get(self.name, 0.0)


@dataclass(frozen=True)
class LightMeasurement:
    """All candidates for one light.

    Attributes:
        light: The light.
        cameras: Names of the views it was judged over.
        width: Pixels across a view.
        height: Pixels down a view.
        measurements: One a candidate, in the order in which they were given.
        device: Where it was measured.
        clock: How time was read.
        canary_ms: Time of the fixed canary frame at the start of each round, by view.
        verified_wrong_share: Share of pixels in which shadow volumes and Embree disagree, the worst of all
            views; None where it was not asked for.
    """

    light: Light
    cameras: tuple[str, ...]
    width: int
    height: int
    measurements: tuple[Measurement, ...]
    canary_ms: tuple[tuple[float, ...], ...]
    device: Device
    clock: ClockKind
    verified_wrong_share: float | None = None
