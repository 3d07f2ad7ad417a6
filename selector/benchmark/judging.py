"""Errors and counters of one instance: one candidate after the other, each told before the next begins."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import asdict, replace

from renderers.clock import ClockKind, StageClock
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.world import World
from selector.benchmark.messages import Begins, Job, Judged, Part, Word
from selector.benchmark.questions import Posed
from selector.benchmark.stopwatch import Stopwatch
from selector.candidate import Candidate
from selector.evidence.rows import CandidateRow
from selector.measurement import Status
from selector.runner import Runner
from selector.truth import Oracle, Reference

Say = Callable[[Word], None]


def candidate_rows(candidates: Sequence[Candidate]) -> tuple[CandidateRow, ...]:
    """Candidates as the store keeps them."""
    return tuple(CandidateRow(one.technique, dict(one.settings)) for one in candidates)


class Judge:
    """Judges candidates, one instance after the other.

    Args:
        gpu: Where.
        job: How.
        say: Hears of each part before it begins, and of each candidate as soon as it is judged.
    """

    def __init__(self, gpu: Gpu, job: Job, say: Say) -> None:
        self._gpu, self._job, self._say = gpu, job, say
        self._clock = StageClock(gpu, ClockKind.WALL, staged=False)

    def answer(
        self, posed: Posed, wanted: Sequence[Candidate], watch: Stopwatch, *, rays: bool = False
    ) -> None:
        """Judges the wanted candidates.

        Args:
            posed: The instance.
            wanted: The candidates.
            watch: Where the seconds go.
            rays: Whether rays tell the truth, whatever shadow volumes could say.

        Raises:
            GlError: The device cannot hold the scene, or not even its surfaces can be drawn.
        """
        with ExitStack() as alive:
            with watch.part("upload"), self._gpu.guard(posed.scene.name):
                world = World.of(self._gpu, posed.scene)
                alive.callback(world.release)
                frame = alive.enter_context(Frame(world, self._job.width, self._job.height))
            reference = self._reference(posed, frame, watch, rays=rays)
            for candidate, row in zip(wanted, candidate_rows(wanted), strict=True):
                self._say(Begins(Part.CANDIDATE, row.key))
                with watch.part("candidates"):
                    judged = self._judged(posed, frame, candidate, reference)
                self._say(judged)

    def _reference(self, posed: Posed, frame: Frame, watch: Stopwatch, *, rays: bool) -> Reference:
        self._say(Begins(Part.TRUTH))
        oracle = Oracle(frame, self._clock, self._job.timeout_s)
        with watch.part("truth"), ExitStack() as alive:
            frame.shine(posed.light)
            if not rays:
                oracle.prepare(posed.light, alive)
            return oracle.reference(posed.light, posed.camera)

    def _judged(self, posed: Posed, frame: Frame, candidate: Candidate, reference: Reference) -> Judged:
        runner = Runner(candidate, frame)
        with ExitStack() as alive:
            runner.prepare(posed.light, posed.scene, alive)
            if runner.status is Status.OK:
                runner.judge(
                    posed.light,
                    posed.camera,
                    reference,
                    self._clock,
                    self._job.timeout_s,
                    flip=self._job.flip,
                )
        return judged(runner, reference)


def judged(runner: Runner, reference: Reference) -> Judged:
    """What came out for a candidate."""
    (key,) = (row.key for row in candidate_rows([runner.candidate]))
    bare = Judged(key, runner.status, runner.reason, runner.memory_bytes, reference.source)
    if not runner.views:
        return bare
    (view,) = runner.views
    figures = dict[str, float | None](asdict(view.figures)) if view.figures else {}
    if view.flip is not None:
        figures["flip"] = view.flip
    return replace(bare, fallback=view.fallback, figures=figures, counters=dict(view.counters))
