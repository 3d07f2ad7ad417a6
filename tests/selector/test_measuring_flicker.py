from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

import moderngl
import pytest

from renderers.clock import StageClock
from renderers.context import Gpu
from renderers.map_shadow import MapShadowPass
from renderers.registry import TECHNIQUES
from renderers.technique import Outcome
from scenes.scene import Light, LightKind
from selector.candidate import Candidate
from selector.measurement import LightMeasurement, Measurement, Status
from selector.measurement_record import measurement_record
from selector.measuring import Bench, Plan
from tests.selector.measurements import SV
from tests.small_level import CAMERA, POINT, SPOT, SUN, small_scene

STEPS = 4
PLAN = Plan(96, 64, rounds=0, flicker_steps=STEPS)
LOST = Light("Lost", LightKind.POINT, position=(0.0, 500.0, 0.0), range_m=1.0)


def shadow_map(size: int, focus: str = "light") -> Candidate:
    return Candidate("shadow_map", (("map_size", size), ("filter", "2x2"), ("focus", focus)))


FIXED, FITTED = shadow_map(256), shadow_map(256, "view")


@pytest.fixture
def measure(gpu: Gpu) -> Callable[..., dict[Candidate, Measurement]]:
    def run(
        *chosen: Candidate,
        light: Light = SPOT,
        plan: Plan = PLAN,
        whole: list[LightMeasurement] | None = None,
    ) -> dict[Candidate, Measurement]:
        with Bench(gpu, small_scene(), plan) as bench:
            measurement = bench.measure(light, [CAMERA], chosen)
        if whole is not None:
            whole.append(measurement)
        return {one.candidate: one for one in measurement.measurements}

    return run


@pytest.mark.parametrize("light", [SPOT, POINT, SUN], ids=lambda light: str(light.kind))
def test_what_depends_on_the_camera_flickers_and_nothing_else(
    gpu: Gpu, measure: Callable[..., dict[Candidate, Measurement]], light: Light
) -> None:
    others = [
        Candidate.of(known, settings | ({"fall_back": "never"} if "fall_back" in known.options else {}))
        for known in TECHNIQUES
        if known.name not in ("shadow_map", "shadow_volume")
        for settings in (dict(known.candidates(light.kind, gpu.device.limits)[0]),)
    ]
    found = measure(SV, FIXED, FITTED, *others, light=light)
    flicker = {one: found[one].figure("flicker") for one in found}
    assert flicker[SV] == 0.0
    assert flicker[FIXED] == 0.0
    assert flicker[FITTED] is not None
    assert 0.0 < flicker[FITTED] < 0.05
    for one in others:
        if found[one].status is not Status.OK:
            assert found[one].reason
            continue
        assert flicker[one] is not None
        assert 0.0 <= flicker[one] <= 1.0
        if one.technique == "perspective_shadow_map":
            assert flicker[one] > flicker[FIXED]


def test_nothing_is_filmed_unless_asked_and_figures_stay_as_they_are(
    measure: Callable[..., dict[Candidate, Measurement]],
) -> None:
    without, filmed = measure(FITTED, plan=Plan(96, 64, rounds=1)), measure(FITTED)
    (still,), (moving,) = without[FITTED].views, filmed[FITTED].views
    assert still.flicker is None
    assert moving.flicker is not None
    assert (still.figures, still.flip, still.counters) == (moving.figures, moving.flip, moving.counters)


def test_views_do_not_mix_and_the_worst_one_counts(gpu: Gpu) -> None:
    cameras = [CAMERA, replace(CAMERA, name="Aside", position=(2.0, 4.95, 5.6))]
    with Bench(gpu, small_scene(), PLAN) as bench:
        apart = [bench.measure(SPOT, [camera], [FITTED]).measurements[0] for camera in cameras]
        (together,) = bench.measure(SPOT, cameras, [FITTED]).measurements
    alone = [one.views[0].flicker for one in apart]
    assert alone[0] != alone[1]
    assert [view.flicker for view in together.views] == alone
    assert together.figure("flicker") == max(alone)


def test_a_light_that_strikes_nothing_has_no_flicker(
    measure: Callable[..., dict[Candidate, Measurement]],
) -> None:
    assert measure(FIXED, SV, light=LOST)[FIXED].views[0].flicker is None


def test_every_record_has_it(measure: Callable[..., dict[Candidate, Measurement]]) -> None:
    whole: list[LightMeasurement] = []
    found = measure(FITTED, whole=whole)
    (candidate,) = measurement_record(whole[0])["candidates"]
    assert candidate["views"][0]["flicker"] == found[FITTED].figure("flicker")
    json.dumps(candidate, allow_nan=False)


def test_steps_are_as_many_as_the_plan_says(gpu: Gpu) -> None:
    steps: list[str] = []
    plan = Plan(96, 64, rounds=2, flicker_steps=STEPS)
    # A point light's map of 4096 is refused; where the light strikes nothing the camera moves all the same.
    chosen = [FIXED, shadow_map(4096), SV]
    for light in (POINT, LOST):
        with Bench(gpu, small_scene(), plan) as bench:
            bench.measure(light, [CAMERA], chosen, on_step=steps.append)
        assert len(steps) == plan.steps(1, 3) == 3 * (1 + 2 + STEPS)
        assert steps[-1] == f"{light.name}: SV, Eye, frame {STEPS + 1}"
        steps.clear()


@pytest.mark.parametrize("frame", [1, 2, 3, 8])
def test_a_failure_in_motion_is_a_failure(
    measure: Callable[..., dict[Candidate, Measurement]], monkeypatch: pytest.MonkeyPatch, frame: int
) -> None:
    draw, calls = MapShadowPass.render, []

    def fails_late(self: MapShadowPass, clock: StageClock, *, rebuild: bool) -> Outcome:
        if self._side == 256:
            calls.append(rebuild)
            if len(calls) == 1 + frame:
                raise moderngl.Error("GL_INVALID_VALUE")
        return draw(self, clock, rebuild=rebuild)

    monkeypatch.setattr(MapShadowPass, "render", fails_late)
    found = measure(FITTED, SV)
    assert found[FITTED].status is Status.GL_ERROR
    assert found[FITTED].views[0].flicker is None
    assert found[FITTED].views[0].figures is not None
    assert len(calls) == 1 + frame
    assert found[SV].figure("flicker") == 0.0


def test_what_falls_back_in_motion_is_not_counted_as_itself(
    measure: Callable[..., dict[Candidate, Measurement]], monkeypatch: pytest.MonkeyPatch
) -> None:
    draw, calls = MapShadowPass.render, []

    def gives_up(self: MapShadowPass, clock: StageClock, *, rebuild: bool) -> Outcome:
        outcome = draw(self, clock, rebuild=rebuild)
        calls.append(self._side)
        gone = calls.count(256) > 3
        return Outcome("shadow_volume", note="the light came into view") if gone else outcome

    monkeypatch.setattr(MapShadowPass, "render", gives_up)
    found = measure(FITTED)
    assert found[FITTED].status is Status.REFUSED
    assert found[FITTED].reason == "SV was drawn in view Eye, frame 3, because the light came into view"
    assert found[FITTED].views[0].flicker is None
