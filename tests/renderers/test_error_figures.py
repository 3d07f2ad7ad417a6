from __future__ import annotations

from dataclasses import astuple, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from renderers.error_figures import (
    FLIP_PIXELS_PER_DEGREE,
    ErrorFigures,
    continuity,
    error_figures,
    mean_flip,
    over_views,
)
from scenes.ray_caster import RayCaster
from scenes.scene import Mesh, Scene
from tests import tolerances

Bools = npt.NDArray[np.bool_]

HEIGHT, WIDTH = 128, 160


def compare(
    mask: npt.NDArray[Any],
    truth: Bools,
    domain: Bools | None = None,
    joined: tuple[Bools, Bools] | None = None,
) -> ErrorFigures:
    height, width = truth.shape
    everywhere = np.ones((height, width), np.bool_)
    right, down = joined or (everywhere[:, 1:], everywhere[1:])
    domain = everywhere if domain is None else domain
    return error_figures(mask.astype(np.float32), truth, domain, right, down)


def half_plane(angle: float, shift: float = 0.0, height: int = HEIGHT, width: int = WIDTH) -> Bools:
    """Lit on the side towards `angle`; the edge passes `shift` from the middle."""
    y, x = np.mgrid[:height, :width]
    across = (x - (width - 1) / 2) * np.cos(angle) + (y - (height - 1) / 2) * np.sin(angle)
    return across > shift + 1e-9


def disc(radius: float, size: int = 256) -> Bools:
    y, x = np.mgrid[:size, :size] - (size - 1) / 2
    return np.hypot(x + 0.3, y - 0.2) > radius


def vertical(column: int) -> Bools:
    return np.broadcast_to(np.arange(WIDTH) < column, (HEIGHT, WIDTH))


@pytest.mark.parametrize("shift", [0, 1, 2, 7, 15])
def test_a_vertical_edge_that_is_shifted_is_off_by_its_shift(shift: int) -> None:
    for sign in (-1, 1):
        figures = compare(vertical(80 + sign * shift), vertical(80))
        assert figures.boundary_px == HEIGHT
        assert figures.edge_error_px == shift
        assert figures.edge_error_p95_px == shift
        assert figures.wrong_share == shift / WIDTH
        assert (figures.false_lit, figures.false_shadow) == (
            (shift / WIDTH, 0.0) if sign > 0 else (0.0, shift / WIDTH)
        )
        assert figures.acne_share == figures.leak_share == 0


def test_far_edges_are_cut_at_sixteen_pixels() -> None:
    figures = compare(vertical(110), vertical(80))
    assert figures.edge_error_px == 30
    assert figures.edge_error_p95_px == 16
    assert figures.leak_share == 14 / WIDTH


@pytest.mark.parametrize("shift", [1, 3, 6])
def test_a_diagonal_edge_is_off_by_its_distance(shift: int) -> None:
    truth = half_plane(np.pi / 4)
    moved = np.roll(truth, shift, axis=1)
    moved[:, :shift] = truth[:, :1]
    figures = compare(moved, truth)
    expected = shift / np.sqrt(2)
    assert figures.edge_error_px == pytest.approx(expected, rel=tolerances.EDGE_ENDS)
    assert figures.edge_error_p95_px == pytest.approx(expected, abs=np.sqrt(0.5))


@given(angle=st.floats(0, 2 * np.pi), shift=st.floats(-20, 20))
def test_a_straight_edge_has_its_length_at_any_angle(angle: float, shift: float) -> None:
    size = 256
    truth = half_plane(angle, shift, size, size)
    y, x = np.mgrid[:size, :size]
    keep = np.hypot(x - (size - 1) / 2, y - (size - 1) / 2) < 120
    length = 2 * np.sqrt(120**2 - shift**2)
    boundary = compare(truth, truth, keep).boundary_px
    assert boundary >= length * (1 - tolerances.EDGE_ENDS)
    assert boundary <= length * np.sqrt(4 - 2 * np.sqrt(2)) * (1 + tolerances.EDGE_ENDS)


@pytest.mark.parametrize("radius", [20, 50, 110])
def test_a_disc_has_the_perimeter_of_its_octagon_of_steps(radius: float) -> None:
    # The staircase is 8 (sqrt 2 - 1) / pi = 1.055 times too long on average over all angles.
    figures = compare(disc(radius), disc(radius))
    expected = 16 * (np.sqrt(2) - 1) * radius
    assert figures.boundary_px == pytest.approx(expected, rel=tolerances.DISC_STEPS)


def test_corners_are_cut_and_saddles_twice() -> None:
    truth = np.ones((40, 40), np.bool_)
    truth[10:30, 10:30] = False
    assert compare(truth, truth).boundary_px == pytest.approx(4 * 19 + 4 * np.sqrt(0.5))
    truth[30:40, 30:40] = False
    # The second square has two free sides, and shares a corner with the first.
    assert compare(truth, truth).boundary_px == pytest.approx(6 * 19 / 2 + 39 + 5 * np.sqrt(0.5), abs=2)
    saddle = np.array([[True, False], [False, True]])
    assert compare(saddle, saddle).boundary_px == pytest.approx(2 * np.sqrt(0.5) + 4 / 2)


def test_fractions_count_for_the_edge_but_not_for_the_share() -> None:
    truth = vertical(80)
    mask = truth.astype(np.float32)
    mask[:, 80] = 0.25
    mask[:, 79] = 0.75
    figures = compare(mask, truth)
    assert figures.edge_error_px == 0.5
    assert figures.wrong_share == 0
    assert figures.edge_error_p95_px == 0


def test_an_empty_domain_says_nothing() -> None:
    truth = vertical(80)
    figures = compare(~truth, truth, np.zeros_like(truth))
    assert figures == ErrorFigures(0, None, None, None, 0.0, None, None, None, None)


def test_without_enough_edge_only_shares_are_given() -> None:
    lit = np.ones((HEIGHT, WIDTH), np.bool_)
    nowhere = compare(vertical(80), lit)
    assert nowhere.boundary_px == 0
    assert nowhere.wrong_share == nowhere.false_shadow == nowhere.acne_share == 0.5
    assert nowhere.edge_error_px is nowhere.edge_error_p95_px is None
    domain = np.zeros_like(lit)
    domain[:63] = True
    short = compare(vertical(83), vertical(80), domain)
    assert short.boundary_px == 63
    assert short.wrong_share == 3 / WIDTH
    assert short.edge_error_px is short.edge_error_p95_px is None
    domain[63] = True
    assert compare(vertical(83), vertical(80), domain).edge_error_px == 3


def test_a_mask_without_any_edge_is_as_far_off_as_can_be() -> None:
    truth = disc(60)
    figures = compare(np.ones_like(truth), truth)
    assert figures.edge_error_p95_px == 16
    area, expected = np.pi * 60**2, 16 * (np.sqrt(2) - 1) * 60
    assert figures.edge_error_px == pytest.approx(area / expected, rel=tolerances.DISC_STEPS)
    assert figures.leak_share == pytest.approx(np.pi * (60 - 16) ** 2 / truth.size, rel=tolerances.DISC_STEPS)


def test_speckles_are_acne_and_an_edge_in_the_wrong_place_is_not() -> None:
    truth = vertical(80)
    mask = vertical(77).copy()
    speckles = np.zeros_like(truth)
    speckles[5::8, 5:70:8] = True
    figures = compare(mask & ~speckles, truth)
    assert figures.acne_share == speckles[:, :70].sum() / truth.size
    assert figures.leak_share == 0
    assert figures.false_shadow == 3 / WIDTH + figures.acne_share


def test_an_island_of_light_is_a_leak_until_it_touches_the_edge() -> None:
    truth = vertical(80)
    mask = truth.copy()
    mask[50:60, 90:95] = True
    assert compare(mask, truth).leak_share == 50 / truth.size
    assert compare(mask, truth).acne_share == 0
    mask[55, 80:90] = True
    assert compare(mask, truth).leak_share == 0
    mask[55, 95:150] = True
    # Columns 80 to 95 lie within 16 pixels of the edge, the rest of the streak beyond.
    assert compare(mask, truth).leak_share == (150 - 96) / truth.size


def test_a_patch_belongs_to_the_edge_from_two_pixels_away_also_across_corners() -> None:
    truth = vertical(80)
    mask = truth.copy()
    mask[50:60, 82:85] = True  # its nearest pixel centre lies 2.5 pixels from the edge
    assert compare(mask, truth).leak_share == 30 / truth.size
    mask = truth.copy()
    mask[50:60, 81:85] = True
    assert compare(mask, truth).leak_share == 0
    diagonal = truth.copy()
    diagonal[50 + np.arange(9), 81 + np.arange(9)] = True
    assert compare(diagonal, truth).leak_share == 0


def test_where_another_object_begins_no_edge_is_seen() -> None:
    truth = vertical(80)
    joined_right = np.ones((HEIGHT, WIDTH - 1), np.bool_)
    joined_right[:, 79] = False
    joined = joined_right, np.ones((HEIGHT - 1, WIDTH), np.bool_)
    figures = compare(truth, truth, joined=joined)
    assert figures.boundary_px == 0
    assert figures.edge_error_px is None
    assert compare(vertical(83), truth, joined=joined).wrong_share == 3 / WIDTH


def test_nothing_outside_the_domain_counts() -> None:
    truth, mask = vertical(80), vertical(82)
    domain = np.zeros_like(truth)
    domain[:100, 40:120] = True
    scribbled = np.where(domain, mask, np.random.default_rng(1).random(mask.shape) < 0.5)
    figures = compare(scribbled, truth, domain)
    assert figures == compare(mask, truth, domain)
    assert figures.pixels == 100 * 80
    assert (figures.boundary_px, figures.edge_error_px) == (100, 2)


@pytest.mark.parametrize("bad", [np.nan, -0.1, 1.1, np.inf])
def test_masks_that_hold_no_shares_are_refused(bad: float) -> None:
    mask = vertical(80).astype(np.float32)
    mask[3, 4] = bad
    with pytest.raises(AssertionError):
        compare(mask, vertical(80))


def random_pictures(seed: int) -> tuple[npt.NDArray[np.float32], Bools, Bools, Bools, Bools]:
    """A wavy truth, a mask that is shifted, blurred, speckled, and gaps in the domain and between pixels."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:120, :150]
    wave = 7 * np.sin(x / rng.uniform(5, 20)) + 7 * np.cos(y / rng.uniform(5, 20))
    truth = wave > 0
    mask = np.clip(wave * 0.3 + rng.uniform(-1, 1) + 0.01, 0, 1).astype(np.float32)
    mask = np.where(rng.random(mask.shape) < 0.01, 1 - mask, mask)
    mask[mask == 0.5] = 0.4
    domain = rng.random(truth.shape) < 0.97
    return mask, truth, domain, rng.random((120, 149)) < 0.97, rng.random((119, 150)) < 0.97


def agree(first: ErrorFigures, second: ErrorFigures) -> None:
    assert astuple(first) == pytest.approx(astuple(second), rel=tolerances.NEGATIVE_MASK, abs=0)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**31 - 1))
def test_flips_transposition_and_negatives_change_nothing_but_names(seed: int) -> None:
    mask, truth, domain, right, down = random_pictures(seed)
    figures = error_figures(mask, truth, domain, right, down)
    assert figures.edge_error_px is not None
    agree(error_figures(mask[::-1], truth[::-1], domain[::-1], right[::-1], down[::-1]), figures)
    mirrored = (picture[:, ::-1] for picture in (mask, truth, domain, right, down))
    agree(error_figures(*mirrored), figures)
    agree(error_figures(mask.T, truth.T, domain.T, down.T, right.T), figures)
    negative = error_figures(1 - mask, ~truth, domain, right, down)
    swapped = replace(
        negative,
        false_lit=negative.false_shadow,
        false_shadow=negative.false_lit,
        acne_share=negative.leak_share,
        leak_share=negative.acne_share,
    )
    agree(swapped, figures)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**31 - 1))
def test_the_parts_fit_the_whole(seed: int) -> None:
    mask, truth, domain, right, down = random_pictures(seed)
    figures = error_figures(mask, truth, domain, right, down)
    assert figures.pixels == domain.sum()
    assert figures.wrong_share == ((mask >= 0.5) != truth)[domain].mean()
    assert figures.false_lit is not None
    assert figures.false_shadow is not None
    assert figures.false_lit + figures.false_shadow == pytest.approx(figures.wrong_share)
    assert figures.acne_share is not None
    assert figures.leak_share is not None
    assert 0 <= figures.acne_share <= figures.false_shadow
    assert 0 <= figures.leak_share <= figures.false_lit
    perfect = error_figures(truth.astype(np.float32), truth, domain, right, down)
    assert perfect.wrong_share == perfect.edge_error_px == perfect.edge_error_p95_px == 0


def test_views_are_combined_by_the_worst_below_twenty_and_the_95th_percentile_from_there() -> None:
    assert over_views([]) is None
    assert over_views([None, None]) is None
    assert over_views([None, 2.0, 5.0, None, 1.0]) == 5.0
    assert over_views([*range(19), None]) == 18
    assert over_views([*range(21), None]) == 19


def picture(mask: Bools) -> npt.NDArray[np.uint8]:
    return np.where(mask[..., None], np.uint8(200), np.uint8(40)) + np.zeros(3, np.uint8)


def test_flip_of_equal_pictures_is_zero_and_of_black_and_white_about_one() -> None:
    black, white = np.zeros((48, 64, 3), np.uint8), np.full((48, 64, 3), 255, np.uint8)
    assert mean_flip(white, white) == 0
    assert mean_flip(black, white) == mean_flip(white, black)
    # Black and white are 100 apart in lightness; the scale ends at green and blue.
    assert 0.9 < mean_flip(black, white) < 1
    green, blue = black.copy(), black.copy()
    green[..., 1] = blue[..., 2] = 255
    assert mean_flip(green, blue) == pytest.approx(1, rel=tolerances.FLOAT32_PICTURE)


def test_flip_grows_with_the_shift_of_an_edge_and_fine_noise_fades_with_the_viewers_distance() -> None:
    truth = picture(vertical(80))
    values = [mean_flip(picture(vertical(80 + shift)), truth) for shift in (1, 2, 4)]
    assert 0 < values[0] < values[1] < values[2]
    noise = np.random.default_rng(2).uniform(0.2, 0.8, (64, 64, 3)).astype(np.float32)
    grey = np.full_like(noise, 0.5)
    far, near = mean_flip(noise, grey, pixels_per_degree=134), mean_flip(noise, grey, pixels_per_degree=30)
    assert far < mean_flip(noise, grey) < near


@given(st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_flip_of_the_changed_part_is_that_of_the_whole_picture(seed: int) -> None:
    random = np.random.default_rng(seed)
    reference = ndimage.gaussian_filter(random.random((120, 160, 3)), (2, 2, 0)).astype(np.float32)
    image = reference.copy()
    top, left = random.integers(0, 110), random.integers(0, 150)
    image[top : top + random.integers(1, 60), left : left + random.integers(1, 60)] *= random.random()
    whole = OpenImageIO.ImageBufAlgo.FLIP_diff(
        *(OpenImageIO.ImageBuf(np.ascontiguousarray(picture)) for picture in (reference, image)),
        hdr=0,
        ppd=FLIP_PIXELS_PER_DEGREE,
    )
    expected = whole.get_pixels(OpenImageIO.FLOAT).mean(dtype=np.float64)
    assert mean_flip(image, reference) == pytest.approx(expected, rel=tolerances.FLOAT32_PICTURE)


def test_flip_takes_uint8_for_srgb_and_floats_for_linear() -> None:
    first, second = picture(vertical(80)), picture(vertical(84))

    def linear(encoded: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
        return (((encoded / 255 + 0.055) / 1.055) ** 2.4).astype(np.float32)

    encoded = mean_flip(first, second)
    assert encoded == pytest.approx(mean_flip(linear(first), linear(second)), rel=tolerances.FLOAT32_PICTURE)
    as_if_linear = mean_flip((first / 255).astype(np.float32), (second / 255).astype(np.float32))
    assert as_if_linear != pytest.approx(encoded, rel=0.02)


def seen(
    meshes: dict[str, tuple[list[list[float]], list[list[int]]]],
    eye: tuple[float, float, float],
    look_down: float,
    *,
    scale: float = 1.0,
    size: tuple[int, int] = (90, 120),
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], Bools, npt.NDArray[np.int64]]:
    """Positions from the eye, normals, validity and triangle, as a camera that looks along -z sees them."""
    placed = np.diag([scale, scale, scale, 1.0])[None]
    scene = Scene("seen", tuple(Mesh(name, *mesh, placed) for name, mesh in meshes.items()))
    caster = RayCaster(scene)
    height, width = size
    y, x = np.mgrid[:height, :width]
    rays = np.stack([(x + 0.5) / width - 0.5, (0.5 - (y + 0.5) / height) * 0.75, -np.ones(size)], -1)
    turn = np.array(
        [[1, 0, 0], [0, np.cos(look_down), -np.sin(look_down)], [0, np.sin(look_down), np.cos(look_down)]]
    )
    rays = (rays @ turn).reshape(-1, 3) / np.linalg.norm(rays.reshape(-1, 3), axis=1)[:, None]
    distance, triangle = caster.hits(np.broadcast_to(scale * np.array(eye), rays.shape), rays)
    valid = triangle >= 0
    corners = caster.corners(np.maximum(triangle, 0))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    normals *= -np.sign(np.einsum("ij,ij->i", normals, rays))[:, None]
    positions = rays * np.where(valid, distance, 0)[:, None]
    shape = (height, width, 3)
    return (
        positions.reshape(shape).astype(np.float32),
        normals.reshape(shape).astype(np.float32),
        valid.reshape(size),
        triangle.reshape(size),
    )


def slab(low: list[float], high: list[float]) -> tuple[list[list[float]], list[list[int]]]:
    """A box: each side is two triangles in a row, in the order -x, +x, -y, +y, -z, +z."""
    pick = [low, high]
    corners = [[pick[i][0], pick[j][1], pick[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, [side for a, b, c, d in sides for side in ([a, b, c], [a, c, d])]


FLOOR = ([[-900.0, 0, -900], [900, 0, -900], [900, 0, 900], [-900, 0, 900]], [[0, 2, 1], [0, 3, 2]])
SCALES = [1e-3, 1.0, 1e3]


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("look_down", [0.0, 0.2, 0.6, np.pi / 2])
def test_a_floor_is_one_surface_up_to_the_horizon(scale: float, look_down: float) -> None:
    positions, normals, valid, _ = seen({"floor": FLOOR}, (0, 1.7, 0), look_down, scale=scale)
    right, down = continuity(positions, normals, valid)
    assert valid.mean() > 0.4
    assert (right == (valid[:, :-1] & valid[:, 1:])).all()
    assert (down == (valid[:-1] & valid[1:])).all()


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("height", [0.0, 0.05, 0.5])
def test_a_box_is_joined_to_the_floor_only_where_it_stands_on_it(scale: float, height: float) -> None:
    meshes = {"floor": FLOOR, "box": slab([-1, height, -6], [1, height + 1, -4])}
    positions, normals, valid, triangle = seen(meshes, (0, 1.9, 0), 0.3, scale=scale)
    right, down = continuity(positions, normals, valid)
    side = np.where(triangle >= 2, (triangle - 2) // 2, -1)  # of the box; -1 on the floor
    top, front, floor = 3, 5, -1
    crease = (side[:-1] == top) & (side[1:] == front)
    assert crease.sum() > 20
    assert down[crease].all()
    middle = np.arange(120) // 24 == 2  # away from the corners, where the pixel below shows what is behind
    foot = middle & (side[:-1] == front) & (side[1:] == floor)
    assert foot.sum() > 20
    assert (down[foot] == (height == 0)).all()
    behind = (side[:-1] == floor) & (side[1:] == top)
    assert behind.sum() > 20
    assert not down[behind].any()
    beside = (side[:, :-1] == floor) != (side[:, 1:] == floor)
    assert beside.sum() > 20
    assert not right[beside].any()
    same = (side[:, :-1] == side[:, 1:]) & valid[:, :-1] & valid[:, 1:]
    assert right[same].all()


def test_a_ledge_is_told_from_the_floor_below_it() -> None:
    # 2 cm thick, seen from a man's height at 6 m: 16 degrees.
    meshes = {"floor": FLOOR, "ledge": slab([-3, 0.0, -5.9], [3, 0.02, 5])}
    positions, normals, valid, triangle = seen(meshes, (0, 1.7, 0), 0.28, size=(60, 200))
    _, down = continuity(positions, normals, valid)
    on_floor = triangle < 2
    rim = (on_floor[:-1] & ~on_floor[1:])[:, 40:160]
    assert rim.any(axis=0).all()
    assert not down[:, 40:160][rim].any()
