"""Stage times by the clock that tells the truth on this device.

On llvmpipe timer queries around deferred rasterisation read about 1 ms for a pass that takes 300 ms, so the
wall clock with `glFinish` stands in; on a GPU that would serialise the stages, so queries are used there.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum

import moderngl
import numpy as np

from renderers.context import Gpu

# Query and wall clock agree when the device is kept busy for milliseconds; a liar is off by an order.
TRUTHFUL_RATIO = 0.5
PROBE_SIDE = 1024
PROBE_LAYERS = 32


class ClockKind(StrEnum):
    """How GPU time is read."""

    QUERY = "query"
    WALL = "wall"


class StageClock:
    """Adds up milliseconds by stage name; one frame at a time.

    Args:
        gpu: The context whose work is timed.
        kind: The clock that `truthful_clock` found.
        staged: Whether to time each stage. Off, stages cost nothing and `stages` stays empty.
    """

    def __init__(self, gpu: Gpu, kind: ClockKind, *, staged: bool = True) -> None:
        self._gpu, self._kind, self._staged = gpu, kind, staged
        self._queries: list[tuple[str, moderngl.Query]] = []
        self._wall_ms: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what the block submits under `name`."""
        if not self._staged:
            yield
        elif self._kind is ClockKind.QUERY:
            query = self._gpu.ctx.query(time=True)
            with query:
                yield
            self._queries.append((name, query))
        else:
            start = time.perf_counter()
            yield
            self._gpu.ctx.finish()
            self._wall_ms[name] = self._wall_ms.get(name, 0.0) + (time.perf_counter() - start) * 1e3

    def stages(self) -> dict[str, float]:
        """Milliseconds by stage since the clock was made; waits for the device."""
        total = dict(self._wall_ms)
        for name, query in self._queries:
            total[name] = total.get(name, 0.0) + query.elapsed / 1e6
        return total


def truthful_clock(gpu: Gpu) -> ClockKind:
    """The clock to use on this device: the timer query if it agrees with the wall clock, else the wall clock.

    Draws layers of full-screen blending until the wall clock shows milliseconds, and compares. The first
    query is thrown away: on llvmpipe it may read 4,294,967,295 ns.
    """

    def probe() -> ClockKind:
        ratios = [_query_over_wall(gpu) for _ in range(4)][1:]
        return ClockKind.QUERY if TRUTHFUL_RATIO < np.median(ratios) < 1 / TRUTHFUL_RATIO else ClockKind.WALL

    return gpu.cached("truthful clock", probe)


def _query_over_wall(gpu: Gpu) -> float:
    ctx = gpu.ctx
    texture = ctx.texture((PROBE_SIDE, PROBE_SIDE), 4, dtype="f2")
    target = ctx.framebuffer([texture])
    target.use()
    ctx.finish()
    query = ctx.query(time=True)
    layers = PROBE_LAYERS
    while True:
        start = time.perf_counter()
        with query:
            for layer in range(layers):
                target.clear(layer / layers, 0, 0, 0)
        ctx.finish()
        wall_ns = (time.perf_counter() - start) * 1e9
        elapsed_ns = query.elapsed
        if wall_ns > 2e6 or layers >= 4096:
            break
        layers *= 4
    gpu.release(target, texture)
    return float(elapsed_ns / wall_ns)
