from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from unittest.mock import Mock

import pytest

from renderers.context import Gpu
from renderers.shadow_map import ShadowMap
from scenes.errors import DeviceError
from scenes.ray_caster import RayCaster
from scenes.scene import Camera, Light, LightKind, Mobility, Scene
from scenes.viewpoints import viewpoints
from selector.level_measuring import Answer, Request, answers, seen_lights
from selector.measurement_record import answer_record
from selector.measuring import Bench, Plan
from tests.small_level import CAMERA, POINT, SPOT, SUN, named, small_scene

PLAN = Plan(64, 48, rounds=1)
OTHER = Camera("Other", (4.0, 7.5, 9.0), (0.0, -0.6, -0.8), (0.0, 0.8, -0.6))
NOWHERE = Light("Nowhere", LightKind.POINT, position=(0.0, 500.0, 0.0), range_m=1.0)


@pytest.fixture
def ask(gpu: Gpu) -> Callable[..., list[Answer]]:
    def run(scene: Scene, request: Request) -> list[Answer]:
        seen = seen_lights(scene, scene.lights)
        with Bench(gpu, scene, request.plan) as bench:
            return list(answers(bench, gpu.device.limits, seen, request, [].append))

    return run


def test_a_light_is_seen_by_the_level_s_cameras_or_those_that_are_chosen() -> None:
    scene = small_scene(cameras=(CAMERA, OTHER))
    assert [one.cameras for one in seen_lights(scene, scene.lights)] == [(CAMERA, OTHER)] * 3
    assert [one.cameras for one in seen_lights(scene, [SPOT], [OTHER])] == [(OTHER,)]


def test_a_level_without_cameras_gets_viewpoints_for_each_light() -> None:
    scene = small_scene(cameras=())
    seen = seen_lights(scene, scene.lights)
    assert [one.cameras for one in seen] == [viewpoints(scene, light) for light in scene.lights]
    assert all(len(one.cameras) == 4 for one in seen)
    assert seen[0].cameras != seen[1].cameras


def test_mobility_is_the_light_s_own_unless_all_are_given_one(ask: Callable[..., list[Answer]]) -> None:
    scene = small_scene((SPOT, SUN))
    own = ask(scene, Request(techniques=("SV",), plan=PLAN))
    given = ask(scene, Request(techniques=("SV",), mobility=Mobility.DYNAMIC, plan=PLAN))
    assert [one.recommendation and one.recommendation.mobility for one in own] == ["static", "dynamic"]
    assert [one.recommendation and one.recommendation.mobility for one in given] == ["dynamic", "dynamic"]


def test_a_light_that_strikes_nothing_is_a_problem_of_its_own(ask: Callable[..., list[Answer]]) -> None:
    found = ask(small_scene((NOWHERE, SPOT), cameras=()), Request(techniques=("SV",), plan=PLAN))
    assert found[0].recommendation is None
    assert "strikes no surface" in found[0].problem
    assert found[1].recommendation is not None


@pytest.mark.parametrize(
    ("raised", "words"),
    [(DeviceError("The device is gone."), "The device is gone."), (KeyError("x"), "inside Gnomon: KeyError")],
)
def test_what_goes_wrong_with_one_light_stays_with_it(
    ask: Callable[..., list[Answer]], monkeypatch: pytest.MonkeyPatch, raised: Exception, words: str
) -> None:
    measure = Bench.measure

    def failing(self: Bench, light: Light, *args: object, **options: object) -> object:
        if light.name == "Bad":
            raise raised
        return measure(self, light, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Bench, "measure", failing)
    scene = small_scene((SPOT, named(POINT, "Bad"), SUN))
    found = ask(scene, Request(techniques=("SV",), plan=PLAN))
    assert [bool(one.recommendation) for one in found] == [True, False, True]
    assert words in found[1].problem
    assert answer_record(found[1]) == {
        "node": None,
        "name": "Bad",
        "kind": "point",
        "problem": found[1].problem,
    }


def test_an_interrupt_is_no_light_s_problem(
    ask: Callable[..., list[Answer]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Bench, "measure", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        ask(small_scene(), Request(techniques=("SV",), plan=PLAN))


def test_where_all_candidates_fail_the_reasons_are_named(
    ask: Callable[..., list[Answer]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ShadowMap, "refuses", lambda *_: "no room")
    found = ask(small_scene((SPOT,)), Request(techniques=("SM",), plan=PLAN))
    assert found[0].recommendation is None
    assert found[0].measurement is not None
    assert "SM 256 2x2: refused (no room)" in found[0].problem


def test_steps_of_a_request_follow_views_and_kind(gpu: Gpu) -> None:
    scene = small_scene(cameras=(CAMERA, OTHER))
    request = Request(techniques=("sv", "shadow_map"), plan=replace(PLAN, rounds=3))
    limits = gpu.device.limits
    spot, point, _ = (request.steps(one, limits) for one in seen_lights(scene, scene.lights))
    assert spot == 2 * (len(ShadowMap().candidates(LightKind.SPOT, limits)) + 1) * (1 + 3)
    assert point == 2 * (len(ShadowMap().candidates(LightKind.POINT, limits)) + 1) * (1 + 3)


def test_a_light_for_which_no_viewpoint_can_be_made_costs_no_other(
    ask: Callable[..., list[Answer]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(scene: Scene, light: Light, caster: RayCaster) -> tuple[Camera, ...]:
        if light.name == "Bad":
            raise ZeroDivisionError("a bug")
        return viewpoints(scene, light, caster)

    monkeypatch.setattr("selector.level_measuring.viewpoints", failing)
    found = ask(small_scene((named(POINT, "Bad"), SPOT), cameras=()), Request(techniques=("SV",), plan=PLAN))
    assert "ZeroDivisionError" in found[0].problem
    assert found[1].recommendation is not None
