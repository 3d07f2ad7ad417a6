from __future__ import annotations

import numpy as np
import pytest

from renderers.context import Gpu
from renderers.map_settings import TAPS, Bias, auto_bias, filter_radius
from renderers.registry import technique
from renderers.settings import Settings, completed
from scenes.scene import Light, LightKind, Scene
from tests.random_scenes import look_at
from tests.rendering import render_mask
from tests.solids import axes_beside, plane

KINDS = list(LightKind)
PLANES = 12


def bias_of(**settings: str | float) -> Bias:
    return Bias.of(completed(technique("SM").options, settings, "SM"))


def acne(gpu: Gpu, kind: LightKind, settings: Settings) -> list[float]:
    """Share of shadowed pixels on each of a few planes of all slopes, each alone in its scene."""
    random = np.random.default_rng(11)
    shares = []
    for slope in np.radians(np.linspace(5, 85, PLANES)):
        normal = random.normal(size=3)
        normal /= np.linalg.norm(normal)
        across, along = axes_beside(normal)
        turn = random.uniform(0, 2 * np.pi)
        sideways = np.cos(turn) * across + np.sin(turn) * along
        to_light = np.cos(slope) * normal + np.sin(slope) * sideways
        light = Light("light", kind, tuple(5 * to_light), tuple(-to_light), 0.3, 0.6)
        camera = look_at(6 * (np.cos(0.6) * normal + np.sin(0.6) * across), (0, 0, 0))
        scene = Scene("plane", (plane(normal, 4.0),))
        mask, _, domain = render_mask(gpu, scene, light, camera, (96, 72), "shadow_map", settings)
        shares.append(float((mask[domain] < 1).mean()))
    return shares


@pytest.mark.parametrize("kernel", TAPS)
def test_auto_fits_the_filter(kernel: str) -> None:
    assert bias_of(filter=kernel) == auto_bias(filter_radius(kernel))
    assert bias_of(filter=kernel).slope == 2 * filter_radius(kernel) + 0.1


@pytest.mark.parametrize("kernel", TAPS)
def test_the_thesis_has_one_bias_for_all_filters(kernel: str) -> None:
    assert bias_of(bias="thesis", filter=kernel) == Bias(1.1, 4.0, 0.0)


def test_numbers_come_before_presets() -> None:
    assert bias_of(bias="thesis", bias_slope=3.5) == Bias(3.5, 4.0, 0.0)
    assert bias_of(bias="thesis", bias_units=0, bias_normal=0.25) == Bias(1.1, 0.0, 0.25)
    assert bias_of(bias_slope=0, bias_units=0, bias_normal=0) == Bias(0.0, 0.0, 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_the_thesis_bias_is_enough_for_one_texel_and_not_for_its_own_filter(
    gpu: Gpu, kind: LightKind
) -> None:
    assert max(acne(gpu, kind, {"map_size": 256, "filter": "1x1", "bias": "thesis"})) == 0
    assert max(acne(gpu, kind, {"map_size": 256, "filter": "2x2", "bias": "thesis"})) > 0.1
    assert max(acne(gpu, kind, {"map_size": 256, "filter": "2x2", "bias": "auto"})) == 0


@pytest.mark.parametrize("kernel", TAPS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_slope_factor_of_the_whole_footprint_is_enough_and_of_its_half_is_not(
    gpu: Gpu, kind: LightKind, kernel: str
) -> None:
    radius = filter_radius(kernel)
    alone: dict[str, str | float] = {"map_size": 256, "filter": kernel, "bias_normal": 0}
    assert max(acne(gpu, kind, alone | {"bias_slope": 2 * radius + 0.1})) == 0
    # Where light falls in along a texel's side the depth moves by only half as much.
    assert max(acne(gpu, kind, alone | {"bias_slope": radius})) > 0.01


@pytest.mark.parametrize("kind", KINDS)
def test_without_a_slope_factor_half_of_every_slanted_plane_shadows_itself(gpu: Gpu, kind: LightKind) -> None:
    shares = acne(gpu, kind, {"map_size": 256, "filter": "1x1", "bias_slope": 0, "bias_normal": 0})
    assert min(shares[1:]) > 0.3


@pytest.mark.parametrize("kind", KINDS)
def test_an_offset_along_the_normal_helps_but_does_not_replace_the_slope_factor(
    gpu: Gpu, kind: LightKind
) -> None:
    alone: dict[str, str | float] = {"map_size": 256, "filter": "2x2", "bias_slope": 0}
    narrow = acne(gpu, kind, alone | {"bias_normal": 0.5})
    wide = acne(gpu, kind, alone | {"bias_normal": 2})
    assert max(narrow) > 0.3
    assert sum(wide) < sum(narrow) / 4
