"""Times of one instance: interleaved rounds with a canary, until the ranking is known."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field

from renderers.canary import Canary
from renderers.clock import StageClock, truthful_clock
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.world import World
from scenes.scene import Mobility
from selector.benchmark.judging import Say, candidate_rows
from selector.benchmark.messages import Begins, Job, Part, Timed
from selector.benchmark.questions import Posed
from selector.benchmark.ranking import settled
from selector.benchmark.stopwatch import Stopwatch
from selector.candidate import Candidate
from selector.evidence.rows import SampleRow
from selector.measurement import Status
from selector.measuring import PASSES_ALIVE_BYTES
from selector.runner import Runner

SLOW_FRAME_S = 0.4
SLOW_ROUNDS = 2
"""A frame that takes longer is sampled twice: it is far from its neighbours, and more would take minutes."""


@dataclass
class _Entrant:
    """A candidate with what has been timed of it."""

    key: str
    runner: Runner
    samples: list[SampleRow] = field(default_factory=list)
    done: bool = False

    def ratios(self, mobility: Mobility) -> list[float]:
        return [one.shadow_ms / one.canary_ms for one in self.samples if one.mobility is mobility]

    def timed(self) -> Timed:
        return Timed(self.key, self.runner.status, self.runner.reason, tuple(self.samples))


class Timekeeper:
    """Times candidates, one instance after the other.

    Args:
        gpu: Where.
        job: How.
        say: Hears of each candidate before its frames, and of the results.
    """

    def __init__(self, gpu: Gpu, job: Job, say: Say) -> None:
        self._gpu, self._job, self._say = gpu, job, say
        self._kind = truthful_clock(gpu)
        self._silent = StageClock(gpu, self._kind, staged=False)
        with gpu.guard("canary"):
            self._canary = Canary(gpu, self._kind)

    def answer(self, posed: Posed, wanted: Sequence[Candidate], watch: Stopwatch) -> None:
        """Times the wanted candidates; all results are told at the end, for they are measured side by side.

        Args:
            posed: The instance.
            wanted: The candidates.
            watch: Where the seconds go.

        Raises:
            GlError: The device cannot hold the scene, or its surfaces cannot be drawn.
        """
        with ExitStack() as alive:
            with watch.part("upload"), self._gpu.guard(posed.scene.name):
                world = World.of(self._gpu, posed.scene)
                alive.callback(world.release)
                frame = alive.enter_context(Frame(world, self._job.width, self._job.height))
                frame.shine(posed.light)
                frame.look(posed.camera)
                frame.draw_surfaces()
            rows = candidate_rows(wanted)
            entrants = [_Entrant(row.key, Runner(one, frame)) for one, row in zip(wanted, rows, strict=True)]
            for batch in self._batches(entrants, posed, watch):
                self._rounds(batch, posed, watch)
        for entrant in entrants:
            self._say(entrant.timed())

    def release(self) -> None:
        """Give the GPU memory back."""
        self._canary.release()

    def _batches(
        self, entrants: Sequence[_Entrant], posed: Posed, watch: Stopwatch
    ) -> Iterator[list[_Entrant]]:
        """Those whose passes fit into memory together, warmed up; each batch is freed before the next."""
        waiting = list(entrants)
        while waiting:
            with ExitStack() as alive:
                batch: list[_Entrant] = []
                while waiting and sum(one.runner.memory_bytes for one in batch) < PASSES_ALIVE_BYTES:
                    batch.append(waiting.pop(0))
                    with watch.part("warm-up"):
                        self._warm_up(batch[-1], posed, alive)
                yield batch
                for entrant in batch:
                    entrant.runner.release()

    def _warm_up(self, entrant: _Entrant, posed: Posed, alive: ExitStack) -> None:
        runner = entrant.runner
        self._say(Begins(Part.CANDIDATE, entrant.key))
        runner.prepare(posed.light, posed.scene, alive)
        if runner.status is Status.OK:
            runner.warm_up(posed.light, posed.camera, self._silent, self._job.timeout_s)

    def _rounds(self, batch: Sequence[_Entrant], posed: Posed, watch: Stopwatch) -> None:
        # Each instance has an order of its own, the same in every run with the same seed.
        order = random.Random(f"{self._job.seed} {posed.row.key}")  # noqa: S311  no secrecy needed
        for index in range(self._job.rounds):
            running = [one for one in batch if one.runner.status is Status.OK and not one.done]
            if not running:
                return
            with watch.part("canary"):
                canary_ms = self._canary.sing()
            order.shuffle(running)
            with watch.part("rounds"):
                for entrant in running:
                    self._say(Begins(Part.CANDIDATE, entrant.key))
                    self._sample(entrant, posed, index, canary_ms)
            _settle(batch)

    def _sample(self, entrant: _Entrant, posed: Posed, index: int, canary_ms: float) -> None:
        runner = entrant.runner
        runner.time(posed.light, index, self._kind)
        for one in runner.samples[len(entrant.samples) :]:
            entrant.samples.append(
                SampleRow(index, one.mobility, one.shadow_ms, one.frame_ms, canary_ms, one.stages_ms)
            )
        slowest_s = max((one.frame_ms for one in entrant.samples), default=0.0) / 1e3
        if runner.status is Status.OK and slowest_s > self._job.timeout_s:
            runner.status, runner.reason = Status.TIMEOUT, f"a frame took {slowest_s:.1f} s"
        entrant.done |= index + 1 >= SLOW_ROUNDS and slowest_s > SLOW_FRAME_S


def _settle(batch: Sequence[_Entrant]) -> None:
    """Whoever is ranked among those that could be timed needs no more rounds."""
    ranked = [one for one in batch if one.runner.status is Status.OK]
    known = [settled([one.ratios(mobility) for one in ranked]) for mobility in Mobility]
    for entrant, *by_mobility in zip(ranked, *known, strict=True):
        entrant.done |= all(by_mobility)
