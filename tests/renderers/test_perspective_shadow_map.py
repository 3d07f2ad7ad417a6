"""Perspective shadow maps against rays: lights anywhere around the camera, maps of any size, both depths."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderers.context import Gpu
from renderers.registry import technique
from renderers.settings import Settings
from scenes.ray_caster import RayCaster
from scenes.scene import Camera, Light, LightKind, Scene
from tests import tolerances
from tests.oracle import judge
from tests.random_scenes import closed_boxes, look_at, random_scene
from tests.rendering import framed, prepared, render_mask, untimed
from tests.solids import box, floor

NAME = "perspective_shadow_map"
SIZE = (240, 180)
WARPED: Settings = {"fall_back": "never"}
CAMERA = look_at((0, 3, 7), (0, 0.5, 0))


def scene() -> Scene:
    return Scene("boxes", (floor(8.0), *closed_boxes(np.random.default_rng(5))))


def aimed(kind: LightKind, position: tuple[float, float, float], outer: float = 0.8) -> Light:
    towards = np.array([0.0, 0.3, 0.0]) - position
    direction = towards / np.linalg.norm(towards)
    return Light("light", kind, position, tuple(direction), 0.3, outer)


EYE_PLANE = tuple(np.asarray(CAMERA.position) + 4 * np.asarray(CAMERA.up) + np.array([3.0, 0, 0]))
LIGHTS = {
    "beside": aimed(LightKind.SPOT, (7.0, 6, 1)),
    "behind": aimed(LightKind.SPOT, (1.0, 8, 11)),
    "on the eye's plane": aimed(LightKind.SPOT, EYE_PLANE, 0.7),
    "facing the viewer": aimed(LightKind.SPOT, (0.5, 6, -9)),
    "in view": aimed(LightKind.SPOT, (0.0, 4.0, -1), 1.0),
    "lamp amid the boxes": Light("lamp", LightKind.POINT, (0.3, 3.2, 0.4)),
    "sun beside": aimed(LightKind.DIRECTIONAL, (7.0, 8, 0)),
    "sun behind": aimed(LightKind.DIRECTIONAL, (1.0, 8, 9)),
    "sun facing": aimed(LightKind.DIRECTIONAL, (0.5, 5, -9)),
}
every_place = pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS)


def error(gpu: Gpu, light: Light, settings: Settings, name: str = NAME, camera: Camera = CAMERA) -> float:
    """The share of wrong pixels, after making sure that the technique was not another."""
    with (
        framed(gpu, scene(), light, camera, SIZE) as frame,
        technique(name).prepare(frame, light, settings) as shadow_pass,
    ):
        outcome = shadow_pass.render(untimed(gpu), rebuild=True)
        assert outcome.technique == name, outcome.note
        return judge(
            scene(), frame.read_mask(), frame.read_surfaces(), frame.read_domain(), light, camera
        ).wrong_share


@pytest.mark.parametrize("depth", ["universal", "kozlov"])
@every_place
def test_error_falls_as_the_map_grows_wherever_the_light_is(gpu: Gpu, light: Light, depth: str) -> None:
    """P4: nowhere above 1.3 C / N, with the median C of the sizes, but for what shadow volumes get wrong."""
    sides = (256, 512, 1024, 2048) if light.kind is LightKind.POINT else (256, 512, 1024, 2048, 4096, 8192)
    found = [error(gpu, light, WARPED | {"map_size": side, "depth": depth}) for side in sides]
    constant = np.median([wrong * side for wrong, side in zip(found, sides, strict=True)])
    for wrong, side in zip(found, sides, strict=True):
        bound = tolerances.CONVERGENCE * constant / side
        assert wrong <= bound + tolerances.CONVERGENCE_FLOOR, (dict(zip(sides, found, strict=True)), constant)


@every_place
def test_both_depths_agree(gpu: Gpu, light: Light) -> None:
    settings = WARPED | {"map_size": 512}
    universal, kozlov = (error(gpu, light, settings | {"depth": depth}) for depth in ("universal", "kozlov"))
    assert kozlov == pytest.approx(universal, rel=tolerances.DEPTH_MODES, abs=tolerances.CONVERGENCE_FLOOR)


@pytest.mark.parametrize("kind", [LightKind.SPOT, LightKind.DIRECTIONAL])
def test_nothing_jumps_as_the_light_crosses_the_eyes_plane(gpu: Gpu, kind: LightKind) -> None:
    """P5: from before the eye to behind it, through the plane itself."""
    forward = np.asarray(CAMERA.forward)
    found = []
    for step in (-1e-2, -1e-6, -1e-12, 0.0, 1e-12, 1e-6, 1e-2):
        if kind is LightKind.SPOT:
            light = aimed(kind, tuple(np.asarray(EYE_PLANE) - step * forward), 0.7)
        else:
            across = np.asarray(CAMERA.up) + np.array([0.5, 0, 0]) + step * forward
            light = replace(aimed(kind, (0.0, 1, 0)), direction=tuple(-across / np.linalg.norm(across)))
        # One size alone is as random as where the edges fall between its texels.
        sides = (96, 128, 160, 200, 256, 320)
        found.append(
            np.mean([error(gpu, light, WARPED | {"map_size": side, "slide_back": 1.0}) for side in sides])
        )
    assert max(found) - min(found) <= tolerances.EYE_PLANE * max(found)


@pytest.mark.parametrize("depth", ["universal", "kozlov"])
@pytest.mark.parametrize("kind", [LightKind.SPOT, LightKind.DIRECTIONAL])
def test_what_stands_behind_the_eye_casts_its_shadow_before_it(gpu: Gpu, kind: LightKind, depth: str) -> None:
    """P6."""
    behind = Scene("behind", (floor(20.0), box((0, 4.0, 12.0), (1.0, 1.0, 1.0))))
    light = aimed(kind, (0.0, 9.0, 27.0), 0.7)
    camera = look_at((0, 2.0, 8.0), (0, 0, 0))
    settings = WARPED | {"map_size": 1024, "depth": depth}
    mask, seen, domain = render_mask(gpu, behind, light, camera, SIZE, NAME, settings)
    shadow = domain & (mask < 0.5)
    assert shadow.sum() > 500
    verdict = judge(behind, mask, seen, domain, light, camera)
    assert verdict.wrong_share <= tolerances.SAMPLED_WRONG / 1024


@pytest.mark.parametrize("place", ["beside", "behind", "facing the viewer", "sun beside", "sun behind"])
def test_far_back_the_error_is_that_of_a_map_fitted_to_the_view(gpu: Gpu, place: str) -> None:
    """P7."""
    light = LIGHTS[place]
    warped = [error(gpu, light, WARPED | {"map_size": side, "slide_back": 1e6}) for side in (256, 512, 1024)]
    ordinary = [
        error(gpu, light, {"map_size": side, "focus": "view"}, "shadow_map") for side in (256, 512, 1024)
    ]
    assert np.mean(np.log(warped)) == pytest.approx(np.mean(np.log(ordinary)), abs=tolerances.FAR_BACK_ERROR)


def test_a_warp_that_promises_nothing_falls_back_and_says_so(gpu: Gpu) -> None:
    """A lamp at the eye sees what the eye sees: every texel is as large as a pixel already."""
    lamp = Light("lamp", LightKind.SPOT, CAMERA.position, CAMERA.forward, 0.3, 0.7)
    with (
        framed(gpu, scene(), lamp, CAMERA, SIZE) as frame,
        technique(NAME).prepare(frame, lamp, {"map_size": 512}) as shadow_pass,
    ):
        outcome = shadow_pass.render(untimed(gpu), rebuild=True)
        mask = frame.read_mask()
        with prepared(frame, "shadow_map", {"map_size": 512, "focus": "view"}):
            assert np.array_equal(frame.read_mask(), mask)
    assert outcome.technique == "shadow_map"
    assert "would not help" in outcome.note


def test_auto_never_promises_less_than_the_ordinary_map(gpu: Gpu) -> None:
    """Where it warps, the warp is worth it: over many views error is lower than with the fitted map."""
    ratios = []
    for seed in range(12):
        one = random_scene("closed boxes", seed)
        camera = look_at((4 * np.cos(seed), 1.2, 4 * np.sin(seed)), (0, 0.5, 0))
        light = aimed(LightKind.DIRECTIONAL, (6 * np.sin(2 * seed), 7, 6 * np.cos(2 * seed)))
        with framed(gpu, one, light, camera, SIZE) as frame:
            rays = RayCaster(one)
            surfaces, domain = frame.read_surfaces(), frame.read_domain()
            lit = np.zeros(domain.shape, bool)
            lit[domain] = rays.lit(surfaces.positions[domain], surfaces.normals[domain], light)
            shares = []
            for name, settings in (
                (NAME, {"map_size": 256}),
                ("shadow_map", {"map_size": 256, "focus": "view"}),
            ):
                with technique(name).prepare(frame, light, settings) as shadow_pass:
                    outcome = shadow_pass.render(untimed(gpu), rebuild=True)
                    shares.append(np.count_nonzero(((frame.read_mask() > 0.5) != lit) & domain))
                    if name == NAME and outcome.technique != NAME:
                        break
            if len(shares) == 2:
                ratios.append(shares[0] / max(shares[1], 1))
    assert len(ratios) >= 4
    assert np.exp(np.mean(np.log(ratios))) < 1
