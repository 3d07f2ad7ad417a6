from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scenes.convex import NOTHING, Body, clip_planes
from scenes.frusta import camera_view, reach, reversed_infinite
from scenes.receivers import PADDING, receiver_body
from scenes.scene import Array, Light, LightKind
from tests import tolerances
from tests.random_scenes import look_at

ORIGIN = np.zeros(3)
SEEDS = st.integers(0, 10**6)
KINDS = st.sampled_from(list(LightKind))
FOCUSES = st.sampled_from(["light", "view"])
SCALES = st.sampled_from([1e-3, 1.0, 1e3])
DOWN = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -1, 0))


def any_light(kind: LightKind, random: np.random.Generator, scale: float) -> Light:
    direction = random.normal(size=3)
    return Light(
        "any",
        kind,
        position=tuple(scale * random.uniform(-2, 2, 3)),
        direction=tuple(direction / np.linalg.norm(direction)),
        outer_cone_rad=float(random.uniform(0.05, 1.5)),
        range_m=float(random.choice([np.inf, scale * random.uniform(0.3, 5)])),
    )


def any_boxes(random: np.random.Generator, scale: float) -> tuple[Array, Array]:
    """(n, 3), (n, 3) corners of small boxes, some of them flat."""
    middle = scale * random.uniform(-2, 2, (20, 3))
    half = scale * random.uniform(0, 0.4, (20, 3)) * (random.random((20, 3)) < 0.8)
    return middle - half, middle + half


def any_view(random: np.random.Generator, scale: float) -> Array:
    camera = look_at(scale * random.uniform(-3, 3, 3), scale * random.uniform(-1, 1, 3))
    return clip_planes(reversed_infinite(camera.yfov_rad, 4 / 3, 0.1 * scale) @ camera_view(camera))


def points_in(low: Array, high: Array, random: np.random.Generator) -> Array:
    share = random.random((200, len(low), 3))
    points: Array = (low + share * (high - low)).reshape(-1, 3)
    return points


def lit(light: Light, points: Array) -> Array:
    """Those of the points that are within range and cone."""
    if light.kind is LightKind.DIRECTIONAL:
        return points
    offsets = points - light.position
    distances = np.linalg.norm(offsets, axis=1)
    inside = distances <= light.range_m
    if light.kind is LightKind.SPOT:
        inside &= offsets @ np.asarray(light.direction) >= np.cos(light.outer_cone_rad) * distances
    return points[inside]


def heights(body: Body, points: Array) -> Array:
    """(n, p) signed distances of points from the planes of the body, inwards."""
    unit = body.planes / np.linalg.norm(body.planes[:, :3], axis=1, keepdims=True)
    found: Array = points @ unit[:, :3].T + unit[:, 3]
    return found


@given(KINDS, SCALES, SEEDS, FOCUSES)
def test_the_body_holds_every_receiver(kind: LightKind, scale: float, seed: int, focus: str) -> None:
    random = np.random.default_rng(seed)
    light, (low, high) = any_light(kind, random, scale), any_boxes(random, scale)
    view = any_view(random, scale) if focus == "view" else None
    body = receiver_body(low, high, reach(light, ORIGIN), view)
    points = lit(light, points_in(low, high, random))
    if view is not None:
        points = points[(points @ view[:, :3].T + view[:, 3] >= 0).all(axis=1)]
    if not len(body.planes):
        # A box of no size, a single point in reach, has no surface to receive anything.
        assert not len(points) or not np.ptp(points, axis=0).any()
        return
    assert (heights(body, points) >= -tolerances.MAP_PLACE * scale).all()


@given(KINDS, SCALES, SEEDS, FOCUSES)
def test_the_body_is_bounded_and_no_larger_than_what_it_may_hold(
    kind: LightKind, scale: float, seed: int, focus: str
) -> None:
    random = np.random.default_rng(seed)
    light, (low, high) = any_light(kind, random, scale), any_boxes(random, scale)
    view = any_view(random, scale) if focus == "view" else None
    within = reach(light, ORIGIN)
    corners = receiver_body(low, high, within, view).corners
    extent = high.max(axis=0) - low.min(axis=0)
    margin = 2 * PADDING * extent.max()
    assert (corners >= low.min(axis=0) - margin).all()
    assert (corners <= high.max(axis=0) + margin).all()
    for planes in (within.planes, np.zeros((0, 4)) if view is None else view):
        unit = planes / np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
        assert (corners @ unit[:, :3].T + unit[:, 3] >= -tolerances.MAP_PLACE * 10 * scale).all()


def test_along_the_view_the_body_ends_at_the_farthest_box_that_is_seen() -> None:
    # Looking along a row of posts, narrowly: a tower beside the row is not seen and does not count.
    low = np.array([[x - 0.1, 0.0, -0.1] for x in (2.0, 4.0, 6.0)] + [[100.0, 0, 60.0]])
    high = np.array([[x + 0.1, 1.0, 0.1] for x in (2.0, 4.0, 6.0)] + [[101.0, 9, 61.0]])
    camera = look_at((0, 0.5, 0), (1, 0.5, 0), yfov_rad=0.4)
    view = clip_planes(reversed_infinite(camera.yfov_rad, 1.0, 0.1) @ camera_view(camera))
    corners = receiver_body(low, high, reach(DOWN, ORIGIN), view).corners
    assert 1.5 < corners[:, 0].min() < 1.9
    assert 6.1 < corners[:, 0].max() < 6.3


def test_where_nothing_is_in_reach_or_in_sight_there_is_no_body() -> None:
    low, high = np.array([[-1.0, 0, -1]]), np.array([[1.0, 1, 1]])
    away = look_at((0, 5, 0), (0, 9, 0.1))
    view = clip_planes(reversed_infinite(1.0, 1.0, 0.1) @ camera_view(away))
    assert receiver_body(low, high, reach(DOWN, ORIGIN), view) is NOTHING
    lamp = Light("lamp", LightKind.POINT, (0.0, 5, 0), range_m=1.0)
    assert receiver_body(low, high, reach(lamp, ORIGIN)) is NOTHING
    assert receiver_body(low, low, reach(DOWN, ORIGIN)) is NOTHING
    assert receiver_body(np.zeros((0, 3)), np.zeros((0, 3)), reach(DOWN, ORIGIN)) is NOTHING
    assert not len(NOTHING.corners)
    assert NOTHING.cut(view) is NOTHING
