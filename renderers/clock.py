"""Stage times by the clock that tells the truth on this device.

On a software rasteriser the wall clock with `glFinish` is the truth, and a timer query can at best agree:
on llvmpipe it has read 0.8 ms for a pass of 300 ms and 120 ms for one of 11. On a GPU `glFinish` would
serialise the stages, so queries are used, if they agree with the wall clock.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum

import moderngl

from renderers import shader
from renderers.context import Gpu

# Both clocks agree within a few percent while a device is kept busy.
TRUTHFUL_RATIO = (0.5, 1.5)
PROBE_SIDE = 1024
PROBE_LAYERS = 64
PROBES = 5


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
    """The clock to use on this device: the timer query where it agrees with the wall clock.

    Draws many blended layers on a GPU and compares. One disagreement is enough: a busy machine may make the
    wall clock slow, which costs precision, but a query that lies would cost the truth.
    """

    def probe() -> ClockKind:
        if gpu.device.software:
            return ClockKind.WALL
        # The first query is thrown away: it may hold the start-up of the device.
        ratios = [_query_over_wall(gpu) for _ in range(PROBES + 1)][1:]
        low, high = TRUTHFUL_RATIO
        return ClockKind.QUERY if all(low < ratio < high for ratio in ratios) else ClockKind.WALL

    return gpu.cached("truthful clock", probe)


def _query_over_wall(gpu: Gpu) -> float:
    ctx = gpu.ctx
    texture = ctx.texture((PROBE_SIDE, PROBE_SIDE), 4, dtype="f2")
    target = ctx.framebuffer([texture])
    layers = shader.full_screen(gpu, shader.source("full_screen.glsl", "layer"))
    target.use()
    ctx.enable_only(moderngl.BLEND)
    ctx.blend_func = (moderngl.ONE, moderngl.ONE)
    ctx.finish()
    query = ctx.query(time=True)
    start = time.perf_counter()
    with query:
        layers.render(moderngl.TRIANGLES, vertices=3, instances=PROBE_LAYERS)
    ctx.finish()
    wall_ns = (time.perf_counter() - start) * 1e9
    elapsed_ns = query.elapsed
    ctx.enable_only(moderngl.NOTHING)
    gpu.release(target, texture, layers)
    return float(elapsed_ns / wall_ns)
