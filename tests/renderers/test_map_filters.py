from __future__ import annotations

import numpy as np
import pytest

from renderers.context import Gpu
from renderers.error_figures import continuity, error_figures
from renderers.map_settings import TAPS, filter_radius, guard_share
from scenes.receivers import PADDING
from scenes.scene import Array, Light, LightKind, Scene
from tests import tolerances
from tests.random_scenes import look_at, random_camera, random_light, random_scene
from tests.rendering import framed, prepared, render_mask
from tests.solids import box, floor

SUN = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1.0, 0.0))
HALF = 6.0
SIDE = 64
BLURRED = [kernel for kernel, taps in TAPS.items() if taps]
EDGES = [0.0, 0.05, 0.11, -0.03]


def beside_an_edge(gpu: Gpu, edge: float, kernel: str) -> tuple[Array, Array]:
    """Fraction of light on a floor, and how far beyond the edge of a roof, in texels of the sun's map."""
    roof = box(((edge - HALF) / 2, 3, 0), ((edge + HALF) / 2, 0.1, HALF))
    camera = look_at((edge, 2.5, 0), (edge, 0, 0), yfov_rad=0.62)
    settings = {"map_size": SIDE, "filter": kernel}
    scene = Scene("roof", (floor(HALF), roof))
    mask, seen, domain = render_mask(gpu, scene, SUN, camera, (160, 160), "shadow_map", settings)
    assert domain.all()
    texel = 2 * HALF * (1 + 2 * PADDING) / (SIDE * guard_share(SIDE, kernel))
    return mask.astype(float).ravel(), (seen.positions[..., 0].ravel() - edge) / texel


@pytest.mark.parametrize("kernel", TAPS)
@pytest.mark.parametrize("edge", EDGES)
def test_a_straight_edge_is_blurred_over_the_filters_radius_and_no_further(
    gpu: Gpu, edge: float, kernel: str
) -> None:
    lit, beyond = beside_an_edge(gpu, edge, kernel)
    radius = filter_radius(kernel)
    assert np.abs(beyond).max() > radius + 1
    assert (lit[beyond < -radius] == 0).all()
    assert (lit[beyond > radius] == 1).all()


@pytest.mark.parametrize("kernel", BLURRED)
@pytest.mark.parametrize("edge", EDGES)
def test_light_grows_evenly_across_as_many_texels_as_there_are_comparisons(
    gpu: Gpu, edge: float, kernel: str
) -> None:
    lit, beyond = beside_an_edge(gpu, edge, kernel)
    taps = TAPS[kernel]
    # A map knows the edge to half a texel.
    middle = beyond[np.abs(lit - 0.5).argmin()]
    assert abs(middle) <= 0.5 + tolerances.FILTER_FRACTION
    expected = np.clip((beyond - middle) / taps + 0.5, 0, 1)
    assert np.abs(lit - expected).max() <= tolerances.FILTER_FRACTION


def test_the_nearest_texel_alone_is_lit_or_not(gpu: Gpu) -> None:
    for edge in EDGES:
        lit, _ = beside_an_edge(gpu, edge, "1x1")
        assert set(np.unique(lit)) == {0.0, 1.0}


@pytest.mark.parametrize("kind", LightKind)
def test_a_wider_filter_errs_by_its_blur_and_no_more(gpu: Gpu, kind: LightKind) -> None:
    # Blur counts as error: against a sharp edge its area is in proportion to the radius.
    errors = dict.fromkeys(BLURRED, 0.0)
    for seed in range(6):
        scene, light, camera = (
            random_scene("closed boxes", seed),
            random_light(kind, seed),
            random_camera(seed),
        )
        with framed(gpu, scene, light, camera, (160, 120)) as frame:
            with prepared(frame, "shadow_volume", {}):
                truth, domain, seen = frame.read_mask() > 0.5, frame.read_domain(), frame.read_surfaces()
            joined = continuity(seen.positions, seen.normals, seen.covered)
            for kernel in BLURRED:
                settings = {"map_size": 512, "filter": kernel, "focus": "view"}
                with prepared(frame, "shadow_map", settings):
                    found = error_figures(frame.read_mask(), truth, domain, *joined)
                # None where the view shows no edge to speak of.
                errors[kernel] += found.edge_error_px or 0.0
    assert errors["2x2"] > 0
    for kernel in BLURRED:
        wider = filter_radius(kernel) / filter_radius("2x2")
        assert errors[kernel] <= wider * errors["2x2"] * tolerances.FILTER_ERROR_RATIO, errors
