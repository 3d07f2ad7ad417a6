"""Measurements made up for tests: candidates with times by round and an error by view."""

from __future__ import annotations

from collections.abc import Sequence

from renderers.clock import ClockKind
from renderers.context import Device, DeviceLimits
from renderers.error_figures import ErrorFigures
from scenes.scene import Light, LightKind, Mobility
from selector.candidate import Candidate
from selector.measurement import LightMeasurement, Measurement, Sample, Status, ViewRun

LIGHT = Light("Lamp", LightKind.POINT, node=7)
DEVICE = Device(0, "made up", "nobody", "4.6", "4.60", software=False, limits=DeviceLimits(16384, 1 << 27))
SV = Candidate("shadow_volume")


def shadow_map(size: int) -> Candidate:
    return Candidate("shadow_map", (("map_size", size), ("filter", "2x2"), ("focus", "light")))


def figures(
    edge_error_px: float | None, *, wrong_share: float = 0.0, pixels: int = 1000, boundary_px: float = 100.0
) -> ErrorFigures:
    if pixels == 0:
        return ErrorFigures(0, None, None, None, 0.0, None, None, None, None)
    return ErrorFigures(
        pixels, wrong_share, wrong_share, 0.0, boundary_px, edge_error_px, edge_error_px, 0.0, 0.0
    )


def view(
    times: Sequence[float], errors: ErrorFigures, *, static: Sequence[float] = (), camera: str = "Eye"
) -> ViewRun:
    samples = [
        Sample(index, mobility, ms, ms + 1, {"map": ms})
        for mobility, some in ((Mobility.DYNAMIC, times), (Mobility.STATIC, static or times))
        for index, ms in enumerate(some)
    ]
    return ViewRun(camera, tuple(samples), errors, 0.001, {"texels": 1})


def measured(
    candidate: Candidate, *views: ViewRun, status: Status = Status.OK, reason: str = ""
) -> Measurement:
    return Measurement(candidate, status, reason, 1024, views)


def light_measurement(*measurements: Measurement) -> LightMeasurement:
    rounds = ((1.0, 1.0, 1.0),)
    return LightMeasurement(LIGHT, ("Eye",), 96, 64, measurements, rounds, DEVICE, ClockKind.WALL)
