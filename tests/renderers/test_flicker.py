from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from renderers.context import Gpu
from renderers.flicker import (
    FALSE_LIT,
    FALSE_SHADOW,
    RIGHT,
    Flicker,
    Sight,
    State,
    co_visible,
    error_state,
)
from scenes.camera_path import camera_path
from scenes.frusta import camera_view, reversed_infinite
from scenes.scene import Camera, Light
from tests.rendering import framed, prepared, untimed
from tests.small_level import CAMERA, POINT, SPOT, SUN, small_scene

WIDTH, HEIGHT = 64, 48
WALL_M, POST_M = 10.0, 2.0
EYE = Camera("Eye", (0.0, 0.0, 0.0), yfov_rad=1.0)
# Metres across one pixel, at a metre's distance.
PIXEL = 2 * np.tan(EYE.yfov_rad / 2) / HEIGHT
# Edges of a post before the wall, between pixels 19 and 20, and 29 and 30, as the eye sees it.
POST = (np.array([20.0, 30.0]) - WIDTH / 2) * PIXEL * POST_M


def sight(camera: Camera, *, post: bool = True) -> Sight:
    """A wall across the line of sight, and a post before it: where rays strike, computed in closed form."""
    view = camera_view(camera)
    x = (np.arange(WIDTH) + 0.5 - WIDTH / 2) * PIXEL
    y = (HEIGHT / 2 - np.arange(HEIGHT) - 0.5) * PIXEL
    local = np.stack([*np.meshgrid(x, y), np.full((HEIGHT, WIDTH), -1.0)], axis=-1)
    rays = local @ view[:3, :3]
    eye = np.asarray(camera.position)
    on_post, on_wall = (eye + rays * ((-depth - eye[2]) / rays[..., 2:]) for depth in (POST_M, WALL_M))
    hit = post & (on_post[..., 0] >= POST[0]) & (on_post[..., 0] < POST[1])
    normals = np.broadcast_to([0.0, 0.0, 1.0], rays.shape)
    clip = reversed_infinite(camera.yfov_rad, WIDTH / HEIGHT, camera.near_m) @ view
    return Sight(np.where(hit[..., None], on_post, on_wall), normals, np.ones(hit.shape, bool), clip)


def aside(wall_px: float) -> Camera:
    """The eye, moved to the right until the wall stands that many pixels farther left."""
    return replace(EYE, position=(wall_px * PIXEL * WALL_M, 0.0, 0.0))


def band(top: int, rows: int, state: int = FALSE_LIT) -> State:
    states = np.full((HEIGHT, WIDTH), RIGHT, np.int8)
    states[top : top + rows] = state
    return states


def test_states_tell_both_kinds_of_error_within_the_domain() -> None:
    mask = np.array([[0.0, 0.49, 0.5, 1.0], [0.0, 0.49, 0.5, 1.0]], np.float32)
    truth = np.array([[True] * 4, [False] * 4])
    domain = np.array([[True] * 4, [True, True, True, False]])
    wrong = [[FALSE_SHADOW, FALSE_SHADOW, RIGHT, RIGHT], [RIGHT, RIGHT, FALSE_LIT, RIGHT]]
    assert error_state(mask, truth, domain).tolist() == wrong


@given(st.integers(1, 12), st.integers(0, 20))
def test_a_wrong_band_that_jumps_flickers_where_it_was_and_where_it_is(rows: int, jump: int) -> None:
    flicker = Flicker()
    everywhere = np.ones((HEIGHT, WIDTH), bool)
    for frame in range(3):
        flicker.add(band(5 + jump * (frame % 2), rows), band(5 + jump * ((frame + 1) % 2), rows), everywhere)
    assert flicker.share == 2 * min(jump, rows) / HEIGHT


def test_an_error_that_stays_does_not_flicker_and_one_that_turns_over_does() -> None:
    everywhere = np.ones((HEIGHT, WIDTH), bool)
    still, turned = Flicker(), Flicker()
    still.add(band(5, 10), band(5, 10), everywhere)
    turned.add(band(5, 10), band(5, 10, FALSE_SHADOW), everywhere)
    assert still.share == 0.0
    assert turned.share == 10 / HEIGHT


def test_only_what_both_frames_see_counts() -> None:
    seen = np.zeros((HEIGHT, WIDTH), bool)
    flicker = Flicker()
    flicker.add(band(0, 10), band(0, 0), seen)
    assert flicker.share is None
    seen[5:20] = True
    flicker.add(band(0, 10), band(0, 0), seen)
    assert flicker.share == 5 / 15


def test_a_camera_that_stands_still_sees_everything_again() -> None:
    now = sight(EYE)
    assert co_visible(now, now).all()


def test_what_a_post_has_hidden_and_what_comes_into_the_picture_was_not_seen() -> None:
    # The wall moves by 2 pixels, the post by 10: from columns 20..29 to 10..19.
    seen = co_visible(sight(aside(2)), sight(EYE))
    assert (seen == seen[0]).all()
    assert np.flatnonzero(~seen[0]).tolist() == [*range(20, 28), 62, 63]
    # Without the post, the wall behind it has always been there.
    alone = co_visible(sight(aside(2), post=False), sight(EYE, post=False))
    assert np.flatnonzero(~alone[0]).tolist() == [62, 63]


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-0.01, 0.01))
def test_places_are_followed_by_fractions_of_a_pixel(right: float, up: float, turn: float) -> None:
    metres = PIXEL * WALL_M
    forward = (float(np.sin(turn)), 0.0, -float(np.cos(turn)))
    moved = replace(EYE, position=(right * metres, up * metres, 0.0), forward=forward)
    seen = co_visible(sight(moved, post=False), sight(EYE, post=False))
    margin = 1 + int(np.ceil(1 + np.tan(abs(turn)) / PIXEL * 1.6))
    assert seen[margin:-margin, margin:-margin].all()


def test_other_surfaces_domains_and_directions_are_not_the_same_place() -> None:
    now, before = sight(aside(0.5)), sight(EYE)
    assert co_visible(now, before).any()
    nothing = np.zeros((HEIGHT, WIDTH), bool)
    assert not co_visible(now, replace(before, domain=nothing)).any()
    assert not co_visible(replace(now, domain=nothing), before).any()
    assert not co_visible(now, replace(before, normals=-before.normals)).any()
    behind = replace(EYE, forward=(0.0, 0.0, 1.0))
    clip = sight(behind).clip_from_position
    assert not co_visible(now, replace(before, clip_from_position=clip)).any()
    # A tenth of a pixel is far more than depth is rounded by.
    nearer = before.positions + np.array([0.0, 0.0, 0.1 * PIXEL * WALL_M])
    assert not co_visible(now, replace(before, positions=nearer))[:, 35:].any()


@pytest.mark.parametrize("light", [SPOT, POINT, SUN], ids=lambda light: str(light.kind))
def test_a_fit_to_another_camera_changes_the_fitted_map_and_nothing_else(gpu: Gpu, light: Light) -> None:
    moved = camera_path(CAMERA, 7.0, HEIGHT, 1)[1]
    view = {"map_size": 256, "filter": "2x2", "focus": "view"}
    fixed = {**view, "focus": "light"}
    with framed(gpu, small_scene(), light, CAMERA, (WIDTH, HEIGHT)) as frame:
        window = frame.window
        changed = []
        for name, settings in (("shadow_map", fixed), ("shadow_volume", {}), ("shadow_map", view)):
            with prepared(frame, name, settings) as shadow_pass:
                own = frame.read_mask()
                frame.fit_to(moved)
                assert frame.window == window
                shadow_pass.render(untimed(gpu), rebuild=True)
                changed.append(bool((frame.read_mask() != own).any()))
                frame.look(CAMERA)
                frame.draw_surfaces()
                shadow_pass.render(untimed(gpu), rebuild=True)
                assert np.array_equal(frame.read_mask(), own)
    assert changed == [False, False, True]
