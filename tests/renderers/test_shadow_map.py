from __future__ import annotations

from dataclasses import replace
from itertools import cycle, pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from renderers.context import DeviceLimits, Gpu
from renderers.map_settings import LARGEST_CUBE_SIDE, MAP_OPTIONS, TAPS
from renderers.registry import technique
from renderers.settings import Settings
from scenes.scene import Array, Camera, Light, LightKind, Scene
from tests import tolerances
from tests.oracle import judge
from tests.random_scenes import look_at, random_camera, random_light, random_scene
from tests.rendering import Bools, framed, prepared, render_mask
from tests.solids import axes_beside, box, floor, moved, placed, plane

KINDS = list(LightKind)
FILTERS = tuple(TAPS)
FOCUSES = ("light", "view")
assert MAP_OPTIONS["map_size"].bounds is not None
LARGEST_MAP_SIDE = int(MAP_OPTIONS["map_size"].bounds[1])
SMALL, MEDIUM = (96, 72), (160, 120)


def settings_of(side: int, kernel: str = "2x2", focus: str = "light") -> Settings:
    return {"map_size": side, "filter": kernel, "focus": focus}


def light_at(kind: LightKind, position: Array, target: Array, outer: float = 0.6) -> Light:
    direction = (target - position) / np.linalg.norm(target - position)
    return Light("light", kind, tuple(position), tuple(direction), outer / 2, outer)


def shadowed(gpu: Gpu, scene: Scene, light: Light, camera: Camera, settings: Settings) -> tuple[int, int]:
    """Pixels with any shadow at all, and pixels judged."""
    mask, _, domain = render_mask(gpu, scene, light, camera, SMALL, "shadow_map", settings)
    return int((mask[domain] < 1).sum()), int(domain.sum())


@pytest.mark.parametrize("kernel", FILTERS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_plane_alone_has_no_shadow_at_any_slope_and_scale(gpu: Gpu, kind: LightKind, kernel: str) -> None:
    random = np.random.default_rng(7)
    scales, focuses = cycle([1e-3, 1.0, 1e3, 30.0]), cycle(FOCUSES)
    # Six faces of 2048 take a second each to clear.
    sides = cycle([128, 512, 1024 if kind is LightKind.POINT else 2048])
    for slope in [*range(90), *[0] * 6]:
        scale, settings = next(scales), settings_of(next(sides), kernel, next(focuses))
        normal = random.normal(size=3) if slope % 2 else np.eye(3)[slope // 2 % 3]
        normal = normal / np.linalg.norm(normal)
        across, along = axes_beside(normal)
        turn, angle = random.uniform(0, 2 * np.pi), np.radians(slope)
        sideways = np.cos(turn) * across + np.sin(turn) * along
        to_light = np.cos(angle) * normal + np.sin(angle) * sideways
        scene = Scene("plane", (plane(normal, 4 * scale, cells=1 + slope % 3),))
        light = light_at(kind, 5 * scale * to_light, np.zeros(3))
        eye = 6 * scale * (np.cos(0.6) * normal + np.sin(0.6) * across)
        camera = look_at(eye, (0, 0, 0), near_m=0.05 * scale)
        count, judged = shadowed(gpu, scene, light, camera, settings)
        assert judged > 200, (slope, scale, settings)
        assert count == 0, (slope, scale, settings)


@pytest.mark.parametrize("half", [10.0, 64.0, 640.0, 1e4])
@pytest.mark.parametrize("kind", [LightKind.POINT, LightKind.SPOT])
def test_a_lamp_close_above_a_huge_floor_leaves_it_lit(gpu: Gpu, kind: LightKind, half: float) -> None:
    # Two triangles, of which all but a speck is clipped away: what their new corners round must not show.
    scene = Scene("floor", (plane(np.array([0.0, 1, 0]), half, cells=1),))
    light = replace(light_at(kind, np.array([0.0, 0.1, 0]), np.array([0.02, 0, 0.01])), range_m=0.55)
    camera = look_at((0.3, 1.5, 0.2), (0, 0, 0), near_m=0.005)
    for settings in (settings_of(1024, "1x1", "light"), settings_of(2048, "2x2", "light")):
        count, judged = shadowed(gpu, scene, light, camera, settings)
        assert judged > 20
        assert count == 0, settings


@pytest.mark.parametrize("distance", [0.3, 3.0, 30.0, 300.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_plane_that_faces_the_light_has_no_shadow_from_near_or_far(
    gpu: Gpu, kind: LightKind, distance: float
) -> None:
    # Where nothing slopes, polygon offset is a few depth units, and a flat map's units are tiny.
    for normal, away in (
        (np.array([0.0, 1, 0]), 0.0),
        (np.array([1.0, 0, 0]), 60.0),
        (np.ones(3) / 3**0.5, 1e4),
    ):
        middle = away * np.array([1.0, -1, 0.5])
        # Something far off moves the middle of the scene away from the plane.
        far_off = box(middle - 40 * normal, (0.1, 0.1, 0.1))
        scene = Scene("plane", (moved(plane(normal, 4.0), placed(offset=middle)), far_off))
        across = axes_beside(normal)[0]
        eye = middle + distance * (np.cos(0.5) * normal + np.sin(0.5) * across)
        camera = look_at(eye, middle, yfov_rad=min(1.0, 6 / distance), near_m=0.05)
        light = light_at(kind, middle + 5 * normal, middle)
        for focus in FOCUSES:
            for kernel in ("1x1", "2x2"):
                assert shadowed(gpu, scene, light, camera, settings_of(2048, kernel, focus))[0] == 0


SIZES = (256, 512, 1024, 2048, 4096)


def exponent(shares: dict[int, float]) -> float:
    """Slope of log error over log size."""
    sizes = np.log([float(size) for size in shares])
    return float(np.polyfit(sizes, np.log(list(shares.values())), 1)[0])


@pytest.mark.parametrize("kind", KINDS)
def test_error_falls_as_the_map_grows(gpu: Gpu, kind: LightKind) -> None:
    focus = "view" if kind is LightKind.DIRECTIONAL else "light"
    sizes = [size for size in SIZES if kind is not LightKind.POINT or size <= LARGEST_CUBE_SIDE]
    shares = {}
    views = [
        (random_scene("closed boxes", seed), random_light(kind, seed), random_camera(seed))
        for seed in range(9)
    ]
    views.append(
        (box_over_floor(), light_at(kind, np.array([1.0, 5, 1]), np.zeros(3)), look_at((0, 5, 5), (0, 0, 0)))
    )
    for size in sizes:
        wrong, judged = 0, 0
        for scene, light, camera in views:
            mask, seen, domain = render_mask(
                gpu, scene, light, camera, (240, 180), "shadow_map", settings_of(size, focus=focus)
            )
            found = judge(scene, mask, seen, domain, light, camera)
            wrong, judged = wrong + int(found.wrong.sum()), judged + found.domain_px
        shares[size] = wrong / judged
    assert abs(exponent(shares) + 1) <= tolerances.MAP_EXPONENT, shares
    assert all(shares[small] > shares[large] for small, large in pairwise(sizes)), shares


def box_over_floor() -> Scene:
    return Scene("box over floor", (floor(6.0), box((0, 1, 0), (0.5, 0.25, 0.5))))


@pytest.mark.parametrize("outer", [0.5, 1.2, 1.5, float(np.pi / 2)])
def test_nothing_behind_a_spot_casts(gpu: Gpu, outer: float) -> None:
    scene, camera = Scene("floor", (floor(6.0),)), look_at((0, 5, 5), (0, 0, 0))
    light = light_at(LightKind.SPOT, np.array([0.0, 2, 0]), np.zeros(3), outer)
    # Behind the lamp, around it from behind, and mirrored through it.
    behind = [
        box((0, 3, 0), (1, 0.3, 1)),
        box((0.5, 2.5, 0.2), (0.1, 0.4, 0.1)),
        box((-0.4, 4, 0.3), (0.4, 0.4, 0.4)),
    ]
    alone, _, domain = render_mask(gpu, scene, light, camera, MEDIUM, "shadow_map", settings_of(512))
    mask, seen, judged = render_mask(
        gpu, Scene("behind", (*scene.meshes, *behind)), light, camera, MEDIUM, "shadow_map", settings_of(512)
    )
    on_floor = domain & judged & (np.abs(seen.positions[..., 1]) < 1e-3)
    assert on_floor.sum() > 500
    assert (alone[domain] == 1).all()
    assert (mask[on_floor] == 1).all()


def test_nothing_is_projected_backwards(gpu: Gpu) -> None:
    # A lamp that looks up casts no shadow of what is above it onto what is below.
    scene = Scene("two", (floor(6.0), box((0, 3, 0), (0.5, 0.1, 0.5)), floor(6.0, height=4.0)))
    light = light_at(LightKind.SPOT, np.array([0.0, 2, 0]), np.array([0.0, 4, 0]), 0.8)
    mask, seen, domain = render_mask(
        gpu, scene, light, look_at((0, 1.9, 5), (0, 1, 0)), MEDIUM, "shadow_map", settings_of(512)
    )
    below = seen.covered & (seen.positions[..., 1] < 1)
    assert below.sum() > 500
    assert not domain[below].any()
    assert (mask[below] == 0).all()


@pytest.mark.parametrize("kind", [LightKind.DIRECTIONAL, LightKind.SPOT])
def test_a_caster_before_the_near_plane_still_casts(gpu: Gpu, kind: LightKind) -> None:
    # The camera sees the floor alone, so a map focused on the view has its near plane far below the box.
    scene = Scene("high", (floor(6.0), box((0, 7, 0), (0.6, 0.1, 0.6))))
    light = light_at(kind, np.array([0.0, 9, 0]), np.zeros(3), 1.0)
    camera = look_at((0, 2, 0.01), (0, 0, 0), yfov_rad=1.2)
    for focus in FOCUSES:
        mask, seen, domain = render_mask(
            gpu, scene, light, camera, MEDIUM, "shadow_map", settings_of(1024, focus=focus)
        )
        assert domain.all()
        half = 0.6 if kind is LightKind.DIRECTIONAL else 0.6 * 9 / 1.9
        across = np.abs(seen.positions[..., [0, 2]]).max(axis=-1)
        assert (mask[across < half - 0.05] == 0).all()
        assert (across < half - 0.05).sum() > 1000
        assert (mask[across > half + 0.05] == 1).all()


def room(half: Array, turn: Rotation | None) -> Scene:
    return Scene("room", (box((0, 0, 0), half, turn),))


@pytest.mark.parametrize("side", [16, 128, 1024])
@pytest.mark.parametrize("kernel", FILTERS)
def test_the_faces_of_a_cube_meet_without_a_seam(gpu: Gpu, kernel: str, side: int) -> None:
    # From inside a bare room every shadow is an error, and all twelve seams are seen, some at grazing angles.
    random = np.random.default_rng(5)
    for i in range(24):
        half = np.array([[4.0, 3, 5], [8, 1, 8], [2, 6, 1]][i % 3])
        turn = Rotation.from_quat(random.normal(size=4)) if i % 2 else None
        place, eye = random.uniform(-0.6, 0.6, 3) * half, random.uniform(-0.8, 0.8, 3) * half
        if turn is not None:
            place, eye = turn.apply(place), turn.apply(eye)
        kind, outer = (LightKind.SPOT, 1.55) if i % 4 == 0 else (LightKind.POINT, 0.8)
        light = light_at(kind, place, place + random.normal(size=3), outer)
        camera = look_at(eye, place + random.normal(size=3), yfov_rad=1.8, near_m=0.02)
        mask, _, domain = render_mask(
            gpu, room(half, turn), light, camera, MEDIUM, "shadow_map", settings_of(side, kernel)
        )
        assert domain.any()
        assert (mask[domain] == 1).all(), i


def test_a_ball_of_boxes_round_a_lamp_is_right_across_all_faces(gpu: Gpu) -> None:
    random = np.random.default_rng(3)
    directions = random.normal(size=(40, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    boxes = [
        box(2 * d, random.uniform(0.05, 0.3, 3), Rotation.from_quat(random.normal(size=4)))
        for d in directions
    ]
    scene = Scene("ball", (*room(np.full(3, 5.0), None).meshes, *boxes))
    light = light_at(LightKind.POINT, np.array([0.05, 0.1, -0.02]), np.zeros(3))
    near_seam, wrong_near, judged, wrong = 0, 0, 0, 0
    for eye, target in (
        ((4, 4, 4), (0, -1, 0)),
        ((-4, 2, 4), (1, 0, -2)),
        ((0, 0.2, 0.3), (3, 3, 3)),
        ((0, -4, 0), (1, 4, 1)),
    ):
        camera = look_at(eye, target, yfov_rad=1.5)
        mask, seen, domain = render_mask(
            gpu, scene, light, camera, (240, 180), "shadow_map", settings_of(128)
        )
        found = judge(scene, mask, seen, domain, light, camera)
        seam = domain & at_a_seam(seen.positions - np.asarray(light.position))
        near_seam, wrong_near = near_seam + int(seam.sum()), wrong_near + int((found.wrong & seam).sum())
        judged, wrong = judged + int(domain.sum()), wrong + int(found.wrong.sum())
    assert near_seam > 1000
    # No worse beside a seam than elsewhere.
    assert wrong_near / near_seam <= wrong / judged * tolerances.SEAM_RATIO


def at_a_seam(from_light: Array) -> Bools:
    """Whether a direction lies within a hundredth of where two faces meet."""
    sizes = np.sort(np.abs(from_light), axis=-1)
    near: Bools = sizes[..., 1] > 0.98 * sizes[..., 2]
    return near


@pytest.mark.parametrize("kind", KINDS)
def test_the_largest_map_works_where_the_device_holds_it(gpu: Gpu, kind: LightKind) -> None:
    side = LARGEST_CUBE_SIDE if kind is LightKind.POINT else LARGEST_MAP_SIDE
    light, settings = light_at(kind, np.array([1.0, 5, 1]), np.zeros(3)), settings_of(side)
    reason = technique("SM").refuses(light, box_over_floor(), gpu.device.limits, settings)
    if reason is not None:
        pytest.skip(reason)
    camera = look_at((0, 5, 5), (0, 0, 0))
    mask, seen, domain = render_mask(gpu, box_over_floor(), light, camera, MEDIUM, "shadow_map", settings)
    found = judge(box_over_floor(), mask, seen, domain, light, camera)
    assert found.wrong_share <= tolerances.SAMPLED_WRONG / side
    assert (mask[domain] < 0.5).any()


@pytest.mark.parametrize("kind", KINDS)
def test_sizes_beyond_the_device_are_refused(kind: LightKind) -> None:
    limits = DeviceLimits(max_texture_side=2048, max_buffer_bytes=2**27)
    light, scene = light_at(kind, np.ones(3), np.zeros(3)), box_over_floor()
    fits = 512 if kind is LightKind.POINT else 2048
    assert technique("SM").refuses(light, scene, limits, settings_of(fits)) is None
    reason = technique("SM").refuses(light, scene, limits, settings_of(2 * fits))
    assert reason is not None
    assert str(2 * fits) in reason


@pytest.mark.parametrize("kind", KINDS)
def test_a_map_focused_on_the_view_shows_the_same_shadows(gpu: Gpu, kind: LightKind) -> None:
    side, differing, judged, wrong = 1024, 0, 0, dict.fromkeys(FOCUSES, 0)
    for seed in range(6):
        scene, light, camera = (
            random_scene("closed boxes", seed),
            random_light(kind, seed),
            random_camera(seed),
        )
        masks = {}
        for focus in FOCUSES:
            masks[focus], seen, domain = render_mask(
                gpu, scene, light, camera, MEDIUM, "shadow_map", settings_of(side, focus=focus)
            )
            wrong[focus] += int(judge(scene, masks[focus], seen, domain, light, camera).wrong.sum())
        differing += int((np.abs(masks["light"] - masks["view"])[domain] > 0.5).sum())
        judged += int(domain.sum())
    assert differing <= tolerances.SAMPLED_WRONG / side * judged
    # Fewer texels are spent where nobody looks.
    assert wrong["view"] <= wrong["light"] * tolerances.FOCUS_RATIO


def test_a_caster_out_of_range_or_cone_is_not_drawn(gpu: Gpu) -> None:
    crowd = [box((x, 0.5, 30.0), (0.3, 0.3, 0.3)) for x in range(-40, 40)]
    scene = Scene("crowd", (floor(60.0, cells=1), *crowd))
    light = replace(light_at(LightKind.POINT, np.array([0.0, 3, 0]), np.zeros(3)), range_m=6.0)
    with (
        framed(gpu, scene, light, look_at((0, 5, 5), (0, 0, 0)), SMALL) as frame,
        prepared(frame, "shadow_map", settings_of(256)) as shadow_pass,
    ):
        assert 0 < shadow_pass.count()["map_triangles"] < 6 * len(crowd) * 12
