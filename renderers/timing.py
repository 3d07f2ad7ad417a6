"""Times one frame of one technique, by stages and as a whole."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from renderers.clock import ClockKind, StageClock
from renderers.frame import Frame
from renderers.technique import Outcome, ShadowPass

SURFACES, SHADOW, SHADING = "surfaces", "shadow", "shading"


@dataclass(frozen=True)
class TimedFrame:
    """One frame's times in milliseconds.

    Attributes:
        shadow_ms: The technique's own passes.
        frame_ms: Surfaces, shadow and shading.
        stages_ms: By stage; with timer queries from a second frame, since queries serialise stages.
        outcome: What the technique did.
    """

    shadow_ms: float
    frame_ms: float
    stages_ms: Mapping[str, float]
    outcome: Outcome


def timed_frame(frame: Frame, technique: ShadowPass, kind: ClockKind, *, rebuild: bool) -> TimedFrame:
    """Draw everything once and time it."""
    if kind is ClockKind.WALL:
        return _wall(frame, technique, rebuild=rebuild)
    return _queried(frame, technique, rebuild=rebuild)


def _wall(frame: Frame, technique: ShadowPass, *, rebuild: bool) -> TimedFrame:
    # Each stage ends with glFinish, so the stages sum to the whole.
    clock = StageClock(frame.gpu, ClockKind.WALL)
    frame.gpu.ctx.finish()
    start = time.perf_counter()
    with clock.stage(SURFACES):
        frame.draw_surfaces()
    outcome = technique.render(clock, rebuild=rebuild)
    with clock.stage(SHADING):
        frame.shade()
    frame_ms = (time.perf_counter() - start) * 1e3
    stages = clock.stages()
    shadow_ms = sum(ms for stage, ms in stages.items() if stage not in (SURFACES, SHADING))
    return TimedFrame(shadow_ms, frame_ms, stages, outcome)


def _queried(frame: Frame, technique: ShadowPass, *, rebuild: bool) -> TimedFrame:
    whole = StageClock(frame.gpu, ClockKind.QUERY)
    silent = StageClock(frame.gpu, ClockKind.QUERY, staged=False)
    with whole.stage(SURFACES):
        frame.draw_surfaces()
    with whole.stage(SHADOW):
        outcome = technique.render(silent, rebuild=rebuild)
    with whole.stage(SHADING):
        frame.shade()
    totals = whole.stages()
    staged = StageClock(frame.gpu, ClockKind.QUERY)
    technique.render(staged, rebuild=rebuild)
    stages = {SURFACES: totals[SURFACES], **staged.stages(), SHADING: totals[SHADING]}
    return TimedFrame(totals[SHADOW], sum(totals.values()), stages, outcome)
