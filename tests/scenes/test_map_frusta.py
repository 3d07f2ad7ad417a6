from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.convex import clip_planes
from scenes.frusta import camera_view, reach, reversed_infinite
from scenes.map_frusta import WIDEST_SINGLE_RAD, MapFit, faces_of, fit_map
from scenes.receivers import receiver_body
from scenes.scene import Array, Camera, Light, LightKind
from tests import tolerances
from tests.random_scenes import look_at

ORIGIN = np.zeros(3)
SEEDS = st.integers(0, 10**6)
KINDS = st.sampled_from(list(LightKind))
SHRINKS = st.sampled_from([1.0, 1 - 1 / 1024, 0.9])
FOCUSES = st.sampled_from(["light", "view"])
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


def fitted(
    light: Light, bounds: Array, shrink: float, view: Array | None = None, *, whole: bool = False
) -> MapFit:
    """The map of a light for all geometry in one box, or for what `view` shows of it."""
    within = reach(light, ORIGIN)
    return fit_map(
        light,
        within.centre,
        receiver_body(bounds[:1], bounds[1:], within, view),
        shrink,
        whole=whole,
    )


def any_view(random: np.random.Generator, scale: float) -> Array:
    """(5, 4) planes of a camera in or around the scene."""
    camera = look_at(scale * random.uniform(-3, 3, 3), scale * random.uniform(-1, 1, 3))
    return clip_planes(reversed_infinite(camera.yfov_rad, 4 / 3, 0.1 * scale) @ camera_view(camera))


def face_of(from_light: Array) -> Array:
    axis = np.abs(from_light).argmax(axis=1)
    return 2 * axis + (np.take_along_axis(from_light, axis[:, None], 1)[:, 0] < 0)


def ndc(fit: MapFit, light: Light, points: Array) -> tuple[Array, Array]:
    """Normalised map coordinates (n, 3) and w (n,) of points, each on the face that it belongs to."""
    face = face_of(points - light.position) if len(fit.faces) == 6 else np.zeros(len(points), int)
    q = np.einsum("nij,nj->ni", fit.faces[face], np.hstack([points, np.ones((len(points), 1))]))
    return q[:, :3] / q[:, 3:], q[:, 3]


@given(KINDS, SHRINKS, SCALES, SEEDS, FOCUSES, st.sampled_from(["fitted", "thesis"]))
def test_a_map_covers_every_receiver_with_guard_texels_to_spare(
    kind: LightKind, shrink: float, scale: float, seed: int, focus: str, frusta: str
) -> None:
    random = np.random.default_rng(seed)
    light, bounds = any_light(kind, random, scale), any_bounds(random, scale)
    seen = any_view(random, scale) if focus == "view" else None
    fit = fitted(light, bounds, shrink, seen, whole=frusta == "thesis")
    points = receivers(light, bounds, np.zeros((0, 4)) if seen is None else seen, random)
    if not len(fit.faces):
        assert not len(points)
        return
    assert len(fit.faces) == faces_of(light)
    # Beside a spot or point light the depth is that of the near plane: clamped, and lit.
    near_enough = np.ones(len(points), bool)
    if kind is not LightKind.DIRECTIONAL:
        near_enough = np.linalg.norm(points - light.position, axis=1) > 1e-2 * scale
    place, w = ndc(fit, light, points[near_enough])
    assert (w > 0).all()
    assert (np.abs(place[:, :2]) <= shrink + tolerances.MAP_PLACE).all()
    assert (place[:, 2] >= -tolerances.MAP_PLACE).all()
    assert (place[:, 2] <= 1 + tolerances.MAP_PLACE).all()


def texels_per_metre(fit: MapFit, light: Light, points: Array) -> Array:
    """(n, 2): how fast both map coordinates change at points, each on the face that it belongs to."""
    face = face_of(points - light.position) if len(fit.faces) == 6 else np.zeros(len(points), int)
    place, w = ndc(fit, light, points)
    rows = fit.faces[face]
    gradients = rows[:, :2, :3] - place[:, :2, None] * rows[:, 3:, :3]
    found: Array = np.linalg.norm(gradients, axis=2) / w[:, None]
    return found


@given(KINDS, SCALES, SEEDS, FOCUSES)
def test_a_cropped_map_is_never_coarser_than_a_whole_one(
    kind: LightKind, scale: float, seed: int, focus: str
) -> None:
    random = np.random.default_rng(seed)
    light, bounds = any_light(kind, random, scale), any_bounds(random, scale)
    seen = any_view(random, scale) if focus == "view" else None
    points = receivers(light, bounds, np.zeros((0, 4)) if seen is None else seen, random)[:200]
    if not len(points):
        return
    whole = fitted(light, bounds, 0.99, whole=True)
    cropped = fitted(light, bounds, 0.99, seen)
    finer = texels_per_metre(cropped, light, points) / texels_per_metre(whole, light, points)
    assert finer.min() >= 1 - tolerances.MAP_PLACE


def test_a_cone_over_a_small_table_is_cropped_to_it() -> None:
    spot = Light("spot", LightKind.SPOT, (0.0, 4, 0), (0.0, -1, 0), outer_cone_rad=float(np.radians(60)))
    table = np.array([[0.0, 0, -1], [2, 0.1, 1]])
    corners = np.array([[x, 0.1, z] for x in (0.0, 2.0) for z in (-1.0, 1.0)])
    place = ndc(fitted(spot, table, 1.0), spot, corners)[0][:, :2]
    # All but the padding of a thousandth, in both directions, off the axis though it lies.
    assert np.allclose(place.min(axis=0), -1, atol=0.01)
    assert np.allclose(place.max(axis=0), 1, atol=0.01)


def test_faces_of_a_cube_without_receivers_show_nothing() -> None:
    lamp = Light("lamp", LightKind.POINT, (0.0, 4, 0))
    under = np.array([[-1.0, 0, -1], [1, 0.1, 1]])
    shown = [bool(face.any()) for face in fitted(lamp, under, 1.0).faces]
    # -Y alone; a whole map shows the same faces, for all of their width.
    assert shown == [False, False, False, True, False, False]
    assert [bool(face.any()) for face in fitted(lamp, under, 1.0, whole=True).faces] == shown


@given(KINDS, SCALES, SEEDS)
def test_depth_falls_along_every_ray_and_the_place_stays(kind: LightKind, scale: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    light, bounds = any_light(kind, random, scale), any_bounds(random, scale)
    fit = fitted(light, bounds, 0.99)
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
    fit = fitted(sun, np.array([[-4.0, 0, -2], [4, 1, 2]]), 0.95)
    corners = np.array([[x, 0.5, z, 1] for x in (-4, 4) for z in (-2, 2)])
    place = np.abs(corners @ fit.faces[0].T)[:, :2]
    # The box is padded by a thousandth of its length, 8 m, on every side.
    assert np.allclose(place.max(axis=0).max(), 0.95 * 4 / 4.008, rtol=tolerances.PROJECTION * 10)


@pytest.mark.parametrize("frusta", ["fitted", "thesis"])
def test_a_spot_alone_fits_its_cone_to_its_map(frusta: str) -> None:
    spot = Light("spot", LightKind.SPOT, position=(0.0, 5, 0), direction=(0.0, -1, 0), outer_cone_rad=0.6)
    fit = fitted(spot, np.array([[-50.0, 0, -50], [50, 0, 50]]), 0.9, whole=frusta == "thesis")
    q = fit.faces[0] @ [5 * np.tan(0.6), 0, 0, 1]
    assert np.allclose(np.abs(q[:2]).max() / q[3], 0.9, rtol=tolerances.MAP_PLACE)


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
    assert fitted(away, bounds, 1.0).faces.shape == (0, 4, 4)
    dim = replace(away, kind=LightKind.POINT, range_m=1.0)
    assert fitted(dim, bounds, 1.0).faces.shape == (0, 4, 4)


def test_a_focused_map_shows_less_ground_than_one_for_the_whole_light() -> None:
    sun = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1, 0))
    bounds = np.array([[-100.0, 0, -100], [100, 1, 100]])
    camera: Camera = look_at((0, 3, 0), (2, 0, 0))
    view = clip_planes(reversed_infinite(camera.yfov_rad, 1.0, 0.1) @ camera_view(camera))
    whole = fitted(sun, bounds, 1.0).faces[0]
    focused = fitted(sun, bounds, 1.0, view).faces[0]
    assert (np.linalg.norm(focused[:2, :3], axis=1) > 5 * np.linalg.norm(whole[:2, :3], axis=1)).all()
