from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import moderngl
import numpy as np
import pytest

from renderers.clock import StageClock
from renderers.context import Gpu
from renderers.map_shadow import MapShadowPass
from renderers.shadow_volume import ShadowVolumePass
from renderers.technique import Outcome
from scenes.scene import Light, Mobility
from selector.candidate import Candidate
from selector.measurement import LightMeasurement, Measurement, Status, Truth
from selector.measurement_record import measurement_record
from selector.measuring import Bench, OnPicture, Plan
from selector.truth import Shown
from tests.selector.measurements import SV
from tests.small_level import CAMERA, POINT, SPOT, SUN, small_scene

PLAN = Plan(96, 64, rounds=2)


def shadow_map(size: int, kernel: str = "2x2") -> Candidate:
    return Candidate("shadow_map", (("map_size", size), ("filter", kernel), ("focus", "light")))


SMALL, LARGE = shadow_map(128), shadow_map(512)


@pytest.fixture
def measure(gpu: Gpu) -> Callable[..., LightMeasurement]:
    def run(
        *candidates: Candidate,
        light: Light = SPOT,
        plan: Plan = PLAN,
        steps: list[str] | None = None,
        on_picture: OnPicture | None = None,
    ) -> LightMeasurement:
        log = [] if steps is None else steps
        with Bench(gpu, small_scene(), plan) as bench:
            return bench.measure(light, [CAMERA], candidates, on_step=log.append, on_picture=on_picture)

    return run


def by_candidate(measurement: LightMeasurement) -> dict[Candidate, Measurement]:
    return {one.candidate: one for one in measurement.measurements}


@pytest.mark.parametrize("light", [SPOT, POINT, SUN], ids=lambda light: str(light.kind))
def test_the_truth_is_exact_and_larger_maps_are_nearer(
    measure: Callable[..., LightMeasurement], light: Light
) -> None:
    found = by_candidate(measure(SMALL, LARGE, SV, light=light))
    errors = [found[one].figure("edge_error_px") for one in (SMALL, LARGE, SV)]
    assert errors[2] == 0.0
    assert errors[0] is not None
    assert errors[1] is not None
    assert errors[0] > errors[1] > 0
    assert all(one.status is Status.OK for one in found.values())


def test_every_sample_is_kept_for_both_mobilities_in_every_round(
    measure: Callable[..., LightMeasurement],
) -> None:
    measurement = measure(SMALL, SV)
    for one in measurement.measurements:
        (view,) = one.views
        assert [(sample.round, sample.mobility) for sample in view.samples] == [
            (index, mobility) for index in range(2) for mobility in (Mobility.DYNAMIC, Mobility.STATIC)
        ]
        assert all(0 < sample.shadow_ms < sample.frame_ms for sample in view.samples)
    assert [len(times) for times in measurement.canary_ms] == [2]
    json.dumps(measurement_record(measurement), allow_nan=False)


def test_counters_and_figures_repeat_exactly(measure: Callable[..., LightMeasurement]) -> None:
    first, second = measure(SMALL, SV), measure(SMALL, SV)
    for one, other in zip(first.measurements, second.measurements, strict=True):
        assert one.views[0].counters == other.views[0].counters
        assert one.views[0].counters
        assert one.views[0].figures == other.views[0].figures
        assert one.views[0].flip == other.views[0].flip
        assert one.memory_bytes == other.memory_bytes > 0


@pytest.mark.parametrize("memory", [1, 1 << 30], ids=["one at a time", "all together"])
def test_steps_are_as_many_as_the_plan_says(
    measure: Callable[..., LightMeasurement], monkeypatch: pytest.MonkeyPatch, memory: int
) -> None:
    monkeypatch.setattr("selector.measuring.PASSES_ALIVE_BYTES", memory)
    steps: list[str] = []
    # A point light's map of 4096 is refused.
    measure(SMALL, shadow_map(4096), SV, light=POINT, steps=steps)
    assert len(steps) == PLAN.steps(1, 3)
    assert steps[0] == "Torch: SM 128 2x2, Eye"
    assert steps[-1] == "Torch: round 2 of 2, Eye"


def test_rounds_shuffle_the_candidates_and_repeat_by_seed(
    measure: Callable[..., LightMeasurement], monkeypatch: pytest.MonkeyPatch
) -> None:
    order: list[int] = []
    draw = MapShadowPass.render

    def watched(self: MapShadowPass, clock: StageClock, *, rebuild: bool) -> Outcome:
        order.append(self._side)
        return draw(self, clock, rebuild=rebuild)

    monkeypatch.setattr(MapShadowPass, "render", watched)
    candidates = [shadow_map(size) for size in (128, 160, 192, 224, 256)]
    plan = Plan(96, 64, rounds=6)

    def rounds() -> list[list[int]]:
        order.clear()
        measure(*candidates, plan=plan)
        timed = [side for side in order if side != 512][5:]  # 512: the canary's own map
        assert len(timed) == 6 * 5 * 2
        return [timed[index : index + 10 : 2] for index in range(0, len(timed), 10)]

    first, second = rounds(), rounds()
    assert all(sorted(one) == [128, 160, 192, 224, 256] for one in first)
    assert len({tuple(one) for one in first}) > 1
    assert first == second


def test_a_refusal_has_its_reason(measure: Callable[..., LightMeasurement]) -> None:
    found = by_candidate(measure(shadow_map(4096), SV, light=POINT))
    refused = found[shadow_map(4096)]
    assert refused.status is Status.REFUSED
    assert "2048" in refused.reason
    assert refused.views == ()
    assert found[SV].status is Status.OK


@pytest.mark.parametrize(
    ("raised", "status"),
    [
        (moderngl.Error("GL_INVALID_OPERATION"), Status.GL_ERROR),
        (moderngl.Error("GL_OUT_OF_MEMORY"), Status.OUT_OF_MEMORY),
        (ZeroDivisionError("a bug"), Status.CRASHED),
    ],
    ids=["gl_error", "out_of_memory", "crashed"],
)
@pytest.mark.parametrize("place", ["__init__", "render", "count"])
def test_one_candidate_fails_alone(
    measure: Callable[..., LightMeasurement],
    monkeypatch: pytest.MonkeyPatch,
    raised: Exception,
    status: Status,
    place: str,
) -> None:
    whole = getattr(MapShadowPass, place)

    def fails(self: MapShadowPass, *args: object, **options: object) -> object:
        failing = args[2]["map_size"] == 128 if place == "__init__" else self._side == 128  # type: ignore[index]
        if failing:
            raise raised
        return whole(self, *args, **options)

    monkeypatch.setattr(MapShadowPass, place, fails)
    found = by_candidate(measure(SMALL, LARGE, SV))
    assert found[SMALL].status is status
    assert str(raised) in found[SMALL].reason
    assert found[LARGE].status is Status.OK
    assert len(found[LARGE].views[0].samples) == 4


def test_a_failure_while_timing_is_a_failure(
    measure: Callable[..., LightMeasurement], monkeypatch: pytest.MonkeyPatch
) -> None:
    draw, calls = MapShadowPass.render, []

    def fails_late(self: MapShadowPass, clock: StageClock, *, rebuild: bool) -> Outcome:
        if self._side == 128:
            calls.append(rebuild)
            if len(calls) == 3:
                raise moderngl.Error("GL_INVALID_VALUE")
        return draw(self, clock, rebuild=rebuild)

    monkeypatch.setattr(MapShadowPass, "render", fails_late)
    found = by_candidate(measure(SMALL, SV))
    assert found[SMALL].status is Status.GL_ERROR
    assert len(found[SMALL].views[0].samples) == 1
    assert len(calls) == 3


def test_a_slow_candidate_is_not_repeated(
    measure: Callable[..., LightMeasurement], monkeypatch: pytest.MonkeyPatch
) -> None:
    draw, calls = MapShadowPass.render, []

    def slow(self: MapShadowPass, clock: StageClock, *, rebuild: bool) -> Outcome:
        if self._side == 128:
            calls.append(rebuild)
            time.sleep(0.3)
        return draw(self, clock, rebuild=rebuild)

    monkeypatch.setattr(MapShadowPass, "render", slow)
    found = by_candidate(measure(SMALL, SV, plan=Plan(96, 64, rounds=2, timeout_s=0.25)))
    assert found[SMALL].status is Status.TIMEOUT
    assert "view Eye" in found[SMALL].reason
    assert len(calls) == 1
    assert found[SMALL].views[0].samples == ()


def test_what_falls_back_is_not_counted_as_itself(
    measure: Callable[..., LightMeasurement], monkeypatch: pytest.MonkeyPatch
) -> None:
    draw = MapShadowPass.render

    def fallen(self: MapShadowPass, clock: StageClock, *, rebuild: bool) -> Outcome:
        draw(self, clock, rebuild=rebuild)
        return Outcome("shadow_volume", note="the light is behind the camera")

    monkeypatch.setattr(MapShadowPass, "render", fallen)
    # The canary draws a shadow map too, and asks for nothing but its time.
    found = by_candidate(measure(SMALL))
    assert found[SMALL].status is Status.REFUSED
    assert found[SMALL].reason == "SV was drawn in view Eye, because the light is behind the camera"
    (view,) = found[SMALL].views
    assert (view.fallback, view.note) == ("shadow_volume", "")


@contextmanager
def volumes_that(monkeypatch: pytest.MonkeyPatch, act: Callable[[], None]) -> Iterator[None]:
    draw = ShadowVolumePass.render

    def acting(self: ShadowVolumePass, clock: StageClock, *, rebuild: bool) -> Outcome:
        act()
        return draw(self, clock, rebuild=rebuild)

    with monkeypatch.context() as patched:
        patched.setattr(ShadowVolumePass, "render", acting)
        yield


def fail() -> None:
    raise moderngl.Error("GL_OUT_OF_MEMORY")


@pytest.mark.parametrize("act", [lambda: time.sleep(0.3), fail], ids=["slow", "failing"])
def test_rays_tell_the_truth_where_volumes_cannot(
    measure: Callable[..., LightMeasurement], monkeypatch: pytest.MonkeyPatch, act: Callable[[], None]
) -> None:
    by_volumes = measure(LARGE)
    with volumes_that(monkeypatch, act):
        by_rays = measure(LARGE, plan=Plan(96, 64, rounds=1, timeout_s=0.25))
    assert by_volumes.measurements[0].views[0].truth is Truth.SHADOW_VOLUME
    assert by_rays.measurements[0].views[0].truth is Truth.EMBREE
    for figure in ("edge_error_px", "wrong_share"):
        # Both truths are pixel-exact here: the figures are the same numbers.
        assert by_rays.measurements[0].figure(figure) == by_volumes.measurements[0].figure(figure)


def test_the_truth_itself_is_verified_on_request(measure: Callable[..., LightMeasurement]) -> None:
    assert measure(SV).verified_wrong_share is None
    assert measure(SV, plan=Plan(96, 64, rounds=1, verify=True)).verified_wrong_share == 0.0


def test_pictures_come_of_the_truth_and_of_every_candidate(measure: Callable[..., LightMeasurement]) -> None:
    shown: dict[Candidate | None, Shown] = {}

    def keep(light: Light, camera: object, candidate: Candidate | None, what: Shown) -> None:
        assert (light, camera) == (SPOT, CAMERA)
        shown[candidate] = what

    measure(SMALL, SV, on_picture=keep)
    assert list(shown) == [None, SMALL, SV]
    pictures = {candidate: what.picture for candidate, what in shown.items()}
    assert all(picture.shape == (64, 96, 3) for picture in pictures.values())
    assert np.array_equal(pictures[None], pictures[SV])
    assert not np.array_equal(pictures[None], pictures[SMALL])
    for what in shown.values():
        assert what.mask.shape == what.truth.lit.shape == what.truth.domain.shape == (64, 96)
    assert np.array_equal(shown[None].mask > 0.5, shown[None].truth.lit)
    assert np.array_equal(shown[SV].mask, shown[None].mask)
    wrong = (shown[SMALL].mask >= 0.5) != shown[SMALL].truth.lit
    assert wrong[shown[SMALL].truth.domain].any()


def test_passes_that_do_not_fit_together_are_measured_one_after_the_other(
    measure: Callable[..., LightMeasurement], monkeypatch: pytest.MonkeyPatch
) -> None:
    together = measure(SMALL, LARGE, SV)
    monkeypatch.setattr("selector.measuring.PASSES_ALIVE_BYTES", 1)
    apart = measure(SMALL, LARGE, SV)
    assert len(apart.canary_ms) == 3
    for one, other in zip(together.measurements, apart.measurements, strict=True):
        assert other.status is Status.OK
        assert one.views[0].figures == other.views[0].figures
