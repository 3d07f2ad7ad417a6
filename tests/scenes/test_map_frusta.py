from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.convex import clip_planes
from scenes.frusta import camera_view, reach, reversed_infinite
from scenes.map_frusta import GUARD_TEXELS, WIDEST_SINGLE_RAD, MapFit, faces_of, fit_map
from scenes.scene import Array, Camera, Light, LightKind
from tests import tolerances
from tests.random_scenes import look_at

ORIGIN = np.zeros(3)
SEEDS = st.integers(0, 10**6)
KINDS = st.sampled_from(list(LightKind))
SIDES = st.sampled_from([128, 1024, 8192])
SCALES = st.sampled_from([1e-3, 1.0, 1e3])


def any_light(kind: LightKind, random: np.random.Generator, scale: float) -> Light:
    direction = random.normal(size=3)
    return Light(
        "any",
        kind,
        position=tuple(scale * random.uniform(-2, 2, 3)),
        direction=tuple(direction / np.linalg.norm(direction)),
        outer_cone_rad=float(random.uniform(0.02, np.pi / 2)),
        range_m=float(random.choice([np.inf, scale * random.uniform(0.3, 5)])),
    )


def any_bounds(random: np.random.Generator, scale: float) -> Array:
    """A box around zero; now and then flat."""
    half = scale * random.uniform(0.2, 2, 3) * np.maximum(random.random(3) < 0.85, [0, 0, 1])
    return np.stack([-half, half])


def receivers(light: Light, bounds: Array, planes: Array, random: np.random.Generator) -> Array:
    """Points that the light lights, inside `bounds` and `planes`."""
    points = random.uniform(bounds[0], bounds[1], (4000, 3))
    inside = (points @ planes[:, :3].T + planes[:, 3] >= 0).all(axis=1)
    if light.kind is not LightKind.DIRECTIONAL:
        offsets = points - light.position
        distances = np.linalg.norm(offsets, axis=1)
        inside &= distances <= light.range_m
        if light.kind is LightKind.SPOT:
            inside &= offsets @ np.asarray(light.direction) >= np.cos(light.outer_cone_rad) * distances
    return points[inside]


def face_of(from_light: Array) -> Array:
    axis = np.abs(from_light).argmax(axis=1)
    return 2 * axis + (np.take_along_axis(from_light, axis[:, None], 1)[:, 0] < 0)


def ndc(fit: MapFit, light: Light, points: Array) -> tuple[Array, Array]:
    """Normalised map coordinates (n, 3) and w (n,) of points, each on the face that it belongs to."""
    face = face_of(points - light.position) if len(fit.faces) == 6 else np.zeros(len(points), int)
    q = np.einsum("nij,nj->ni", fit.faces[face], np.hstack([points, np.ones((len(points), 1))]))
    return q[:, :3] / q[:, 3:], q[:, 3]


@settings(deadline=None)
@given(KINDS, SIDES, SCALES, SEEDS, st.sampled_from(["light", "view"]))
def test_a_map_covers_every_receiver_with_guard_texels_to_spare(
    kind: LightKind, side: int, scale: float, seed: int, focus: str
) -> None:
    random = np.random.default_rng(seed)
    light, bounds = any_light(kind, random, scale), any_bounds(random, scale)
    camera = look_at(scale * random.uniform(-3, 3, 3), scale * random.uniform(-1, 1, 3))
    view = clip_planes(reversed_infinite(camera.yfov_rad, 4 / 3, 0.1 * scale) @ camera_view(camera))
    planes = view if focus == "view" else np.zeros((0, 4))
    fit = fit_map(light, reach(light, ORIGIN), bounds, side, view if focus == "view" else None)
    points = receivers(light, bounds, planes, random)
    if not len(fit.faces):
        assert not len(points)
        return
    assert len(fit.faces) == faces_of(light)
    # Beside a spot or point light the depth is that of the near plane: clamped, and lit.
    near_enough = np.ones(len(points), bool)
    if kind is not LightKind.DIRECTIONAL:
        near_enough = np.linalg.norm(points - light.position, axis=1) > 1e-2 * scale
    place, w = ndc(fit, light, points[near_enough])
    guarded = 1 - 2 * GUARD_TEXELS / side
    assert (w > 0).all()
    assert (np.abs(place[:, :2]) <= guarded + tolerances.MAP_PLACE).all()
    assert (place[:, 2] >= -tolerances.MAP_PLACE).all()
    assert (place[:, 2] <= 1 + tolerances.MAP_PLACE).all()


@settings(deadline=None)
@given(KINDS, SCALES, SEEDS)
def test_depth_falls_along_every_ray_and_the_place_stays(kind: LightKind, scale: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    light, bounds = any_light(kind, random, scale), any_bounds(random, scale)
    fit = fit_map(light, reach(light, ORIGIN), bounds, 512)
    points = receivers(light, bounds, np.zeros((0, 4)), random)[:20]
    if not len(points):
        return
    start = np.asarray(light.position) if kind is not LightKind.DIRECTIONAL else points - light.direction
    steps = np.array([0.3, 0.6, 0.9, 1.0])
    rays = start + steps[:, None, None] * (points - start)
    places = np.stack([ndc(fit, light, ray)[0] for ray in rays])
    assert np.abs(places[..., :2] - places[-1, :, :2]).max() <= tolerances.MAP_PLACE * 100
    assert (np.diff(places[..., 2], axis=0) < 0).all()


def test_a_sun_from_above_fits_the_floor_to_its_map() -> None:
    sun = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1, 0))
    bounds = np.array([[-4.0, 0, -2], [4, 1, 2]])
    fit = fit_map(sun, reach(sun, ORIGIN), bounds, 128)
    corners = np.array([[x, 0.5, z, 1] for x in (-4, 4) for z in (-2, 2)])
    place = np.abs(corners @ fit.faces[0].T)[:, :2]
    # The box is padded by a thousandth of its length, 8 m, on every side.
    assert np.allclose(
        place.max(axis=0).max(), (1 - 2 * GUARD_TEXELS / 128) * 4 / 4.008, rtol=tolerances.PROJECTION * 10
    )


def test_a_spot_alone_fits_its_cone_to_its_map() -> None:
    spot = Light("spot", LightKind.SPOT, position=(0.0, 5, 0), direction=(0.0, -1, 0), outer_cone_rad=0.6)
    fit = fit_map(spot, reach(spot, ORIGIN), np.array([[-50.0, 0, -50], [50, 0, 50]]), 256)
    rim = 5 * np.tan(0.6)
    q = fit.faces[0] @ [rim, 0, 0, 1]
    assert np.allclose(
        np.abs(q[:2]).max() / q[3], 1 - 2 * GUARD_TEXELS / 256, rtol=tolerances.PROJECTION * 10
    )


@pytest.mark.parametrize(
    ("kind", "outer", "faces"),
    [
        (LightKind.POINT, 0.1, 6),
        (LightKind.DIRECTIONAL, 1.5, 1),
        (LightKind.SPOT, float(WIDEST_SINGLE_RAD), 1),
        (LightKind.SPOT, float(WIDEST_SINGLE_RAD) + 1e-6, 6),
        (LightKind.SPOT, float(np.pi / 2), 6),
    ],
)
def test_only_light_that_one_perspective_cannot_hold_takes_six_faces(
    kind: LightKind, outer: float, faces: int
) -> None:
    assert faces_of(Light("light", kind, outer_cone_rad=outer)) == faces


def test_a_light_that_reaches_nothing_has_no_face() -> None:
    away = Light("spot", LightKind.SPOT, position=(0.0, 5, 0), direction=(0.0, 1, 0))
    bounds = np.array([[-1.0, 0, -1], [1, 1, 1]])
    assert fit_map(away, reach(away, ORIGIN), bounds, 256).faces.shape == (0, 4, 4)
    dim = replace(away, kind=LightKind.POINT, range_m=1.0)
    assert fit_map(dim, reach(dim, ORIGIN), bounds, 256).faces.shape == (0, 4, 4)


def test_a_focused_map_shows_less_ground_than_one_for_the_whole_light() -> None:
    sun = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1, 0))
    bounds = np.array([[-100.0, 0, -100], [100, 1, 100]])
    camera: Camera = look_at((0, 3, 0), (2, 0, 0))
    view = clip_planes(reversed_infinite(camera.yfov_rad, 1.0, 0.1) @ camera_view(camera))
    whole = fit_map(sun, reach(sun, ORIGIN), bounds, 512).faces[0]
    focused = fit_map(sun, reach(sun, ORIGIN), bounds, 512, view).faces[0]
    assert (np.linalg.norm(focused[:2, :3], axis=1) > 5 * np.linalg.norm(whole[:2, :3], axis=1)).all()
