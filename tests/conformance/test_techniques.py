"""What every registered technique must answer, by its line in the registry alone."""

from __future__ import annotations

import gc
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

from renderers.context import DeviceLimits, Gpu
from renderers.registry import GROUND_TRUTH, TECHNIQUES, UnknownTechniqueError, technique
from renderers.settings import Settings
from renderers.technique import Technique
from scenes.scene import Array, Camera, Light, LightKind, Mesh, Scene
from tests import tolerances
from tests.gl_state import gl_state, live_objects
from tests.oracle import judge
from tests.random_scenes import look_at, random_camera, random_light, random_scene
from tests.rendering import framed, prepared, render_mask, untimed
from tests.solids import box, floor, moved, placed, soup

SIZE = (160, 120)
ROOMY = DeviceLimits(max_texture_side=16384, max_buffer_bytes=2**30)
CRAMPED = DeviceLimits(max_texture_side=64, max_buffer_bytes=64)
CAMERA = look_at((0.3, 5.5, 4.5), (0.3, 0.4, 0))


@dataclass(frozen=True)
class Case:
    """One candidate of one technique for one kind of light."""

    technique: Technique
    kind: LightKind
    settings: Settings

    @property
    def label(self) -> str:
        values = "-".join(str(value) for value in self.settings.values())
        return "-".join(part for part in (self.technique.label, str(self.kind), values) if part)

    @property
    def texels(self) -> int | None:
        """Texels along the map that it samples; None for techniques that sample none."""
        size = self.settings.get("map_size")
        return None if size is None else int(size)


def as_itself(known: Technique, settings: Settings) -> Settings:
    """`settings`, without leave to draw another technique where this one promises nothing."""
    return settings | {"fall_back": "never"} if "fall_back" in known.options else settings


CASES = [
    Case(known, kind, as_itself(known, settings))
    for known in TECHNIQUES
    for kind in LightKind
    for settings in known.candidates(kind, ROOMY)
]
# One candidate of each kind answers for what does not depend on the settings.
FEW = list({(case.technique.name, case.kind): case for case in reversed(CASES)}.values())
FEW += [
    Case(known, kind, known.candidates(kind, ROOMY)[0])
    for known in TECHNIQUES
    for kind in LightKind
    if "fall_back" in known.options
]
every_case = pytest.mark.parametrize("case", CASES, ids=lambda case: case.label)
every_kind = pytest.mark.parametrize("case", FEW, ids=lambda case: case.label)


def skip_if_refused(gpu: Gpu, case: Case, scene: Scene, light: Light) -> None:
    reason = case.technique.refuses(light, scene, gpu.device.limits, case.settings)
    if reason is not None:
        pytest.skip(reason)


def light_of(kind: LightKind) -> Light:
    """A light right above the middle; a sun stands at 45 degrees."""
    if kind is LightKind.DIRECTIONAL:
        return Light("sun", kind, direction=(float(np.sqrt(0.5)), -float(np.sqrt(0.5)), 0.0))
    return Light("lamp", kind, (0.0, 5.0, 0.0), (0.0, -1, 0), 0.5, 0.8)


def box_over_floor() -> Scene:
    """A box of 1 x 0.5 x 1, its middle a metre above a floor."""
    return Scene("box over floor", (floor(6.0), box((0, 1, 0), (0.5, 0.25, 0.5))))


def depth_in_shadow(kind: LightKind, points: Array) -> Array:
    """Metres from points on the floor to the edge of the box's shadow, positive inside."""
    if kind is LightKind.DIRECTIONAL:
        low, high = np.array([0.25, -0.5]), np.array([1.75, 0.5])
    else:
        low, high = np.full(2, -0.5 * 5 / 3.75), np.full(2, 0.5 * 5 / 3.75)
    place = points[:, [0, 2]]
    return np.minimum(place - low, high - place).min(axis=1)


@every_case
def test_a_box_casts_the_shadow_that_similar_triangles_give(gpu: Gpu, case: Case) -> None:
    scene, light = box_over_floor(), light_of(case.kind)
    skip_if_refused(gpu, case, scene, light)
    mask, seen, domain = render_mask(gpu, scene, light, CAMERA, SIZE, case.technique.name, case.settings)
    ground = domain & (np.abs(seen.positions[..., 1]) < 0.1)
    inside = depth_in_shadow(case.kind, seen.positions[ground])
    extent = float(np.linalg.norm(scene.bounds[1] - scene.bounds[0]))
    hair = (
        tolerances.EXACT_EDGE
        if case.texels is None
        else tolerances.SAMPLED_EDGE_TEXELS * extent / case.texels
    )
    dark, bright = inside > hair, inside < -hair
    assert dark.sum() > 20
    assert bright.sum() > 1000
    assert (mask[ground][dark] == 0).all()
    assert (mask[ground][bright] == 1).all()
    assert (mask[~domain] == 0).all()


@every_case
def test_a_mask_is_what_rays_say(gpu: Gpu, case: Case) -> None:
    for seed, geometry in enumerate(("closed boxes", "triangle soup", "open sheets")):
        scene, light, camera = (
            random_scene(geometry, seed),
            random_light(case.kind, seed),
            random_camera(seed),
        )
        skip_if_refused(gpu, case, scene, light)
        mask, seen, domain = render_mask(gpu, scene, light, camera, SIZE, case.technique.name, case.settings)
        bound = tolerances.VOLUME_WRONG_SHARE
        if case.texels is not None:
            bound += tolerances.SAMPLED_WRONG / case.texels
        # One pixel is more than the share of a small domain.
        assert judge(scene, mask, seen, domain, light, camera).wrong.sum() <= max(1, bound * domain.sum())


@pytest.mark.parametrize("kind", LightKind)
@pytest.mark.parametrize("known", TECHNIQUES, ids=lambda known: known.label)
def test_a_finer_map_is_never_worse(gpu: Gpu, known: Technique, kind: LightKind) -> None:
    """Summed over scenes: in one of them chance may favour the coarser map."""
    candidates = [as_itself(known, settings) for settings in known.candidates(kind, ROOMY)]
    sizes = sorted({int(settings["map_size"]) for settings in candidates if "map_size" in settings})
    if not sizes:
        pytest.skip(f"{known.label} has no map")
    wrong, judged = dict.fromkeys(sizes, 0), 0
    for seed, geometry in enumerate(("closed boxes", "triangle soup", "open sheets", "closed boxes")):
        scene, light, camera = random_scene(geometry, seed), random_light(kind, seed), random_camera(seed)
        for size in sizes:
            settings = next(one for one in candidates if one.get("map_size") == size)
            mask, seen, domain = render_mask(gpu, scene, light, camera, SIZE, known.name, settings)
            wrong[size] += int(judge(scene, mask, seen, domain, light, camera).wrong.sum())
            judged += int(domain.sum())
    noise = tolerances.VOLUME_WRONG_SHARE * judged
    for coarse, fine in pairwise(sizes):
        assert wrong[fine] <= tolerances.FINER * wrong[coarse] + noise, wrong


@every_kind
def test_moving_everything_together_changes_nothing(gpu: Gpu, case: Case) -> None:
    scene, light, camera = random_scene("closed boxes", 3), random_light(case.kind, 3), random_camera(3)
    skip_if_refused(gpu, case, scene, light)
    name = case.technique.name
    mask, _, domain = render_mask(gpu, scene, light, camera, SIZE, name, case.settings)
    for away in (np.array([1024.0, -256, 2048]), np.array([-17.3, 903.7, 0.1])):
        there = replace(scene, meshes=tuple(moved(mesh, placed(offset=away)) for mesh in scene.meshes))
        found, _, judged = render_mask(
            gpu,
            there,
            replace(light, position=tuple(away + light.position)),
            replace(camera, position=tuple(away + camera.position)),
            SIZE,
            name,
            case.settings,
        )
        changed = int((np.abs(found - mask)[domain & judged] > 0.5).sum() + (domain != judged).sum())
        assert changed <= tolerances.MOVED_SHARE * domain.sum()


@every_case
def test_what_is_kept_for_a_static_light_gives_the_same_bits(gpu: Gpu, case: Case) -> None:
    scene, light = random_scene("fans", 1), random_light(case.kind, 1)
    skip_if_refused(gpu, case, scene, light)
    first, second = random_camera(1), random_camera(2)
    with (
        framed(gpu, scene, light, first, SIZE) as frame,
        prepared(frame, case.technique.name, case.settings) as kept,
    ):
        before = frame.read_mask()
        assert kept.render(untimed(gpu), rebuild=False).technique
        assert np.array_equal(frame.read_mask(), before)
        frame.look(second)
        frame.draw_surfaces()
        kept.render(untimed(gpu), rebuild=False)
        static = frame.read_mask()
        kept.render(untimed(gpu), rebuild=True)
        assert np.array_equal(frame.read_mask(), static)
    dynamic, _, _ = render_mask(gpu, scene, light, second, SIZE, case.technique.name, case.settings)
    assert np.array_equal(static, dynamic)


@every_kind
def test_the_first_frame_is_complete_even_when_nothing_is_to_be_rebuilt(gpu: Gpu, case: Case) -> None:
    scene, light, camera = random_scene("fans", 1), random_light(case.kind, 1), random_camera(1)
    skip_if_refused(gpu, case, scene, light)
    expected, _, _ = render_mask(gpu, scene, light, camera, SIZE, case.technique.name, case.settings)
    with (
        framed(gpu, scene, light, camera, SIZE) as frame,
        prepared(frame, case.technique.name, case.settings, rebuild=False),
    ):
        assert np.array_equal(frame.read_mask(), expected)


@every_kind
def test_a_light_that_moved_is_followed(gpu: Gpu, case: Case) -> None:
    scene, camera = random_scene("closed boxes", 1), random_camera(1)
    first, second = (replace(random_light(case.kind, seed), outer_cone_rad=0.8) for seed in (1, 3))
    skip_if_refused(gpu, case, scene, second)
    expected, _, _ = render_mask(gpu, scene, second, camera, SIZE, case.technique.name, case.settings)
    with (
        framed(gpu, scene, first, camera, SIZE) as frame,
        prepared(frame, case.technique.name, case.settings) as shadow_pass,
    ):
        assert not np.array_equal(frame.read_mask(), expected)
        frame.shine(second)
        frame.draw_surfaces()
        shadow_pass.render(untimed(gpu), rebuild=True)
        assert np.array_equal(frame.read_mask(), expected)


@every_kind
def test_counters_are_exact_and_counting_changes_nothing(gpu: Gpu, case: Case) -> None:
    scene, light, camera = random_scene("open sheets", 2), random_light(case.kind, 2), random_camera(2)
    skip_if_refused(gpu, case, scene, light)
    with (
        framed(gpu, scene, light, camera, SIZE) as frame,
        prepared(frame, case.technique.name, case.settings) as shadow_pass,
    ):
        mask = frame.read_mask()
        counters = dict(shadow_pass.count())
        assert dict(shadow_pass.count()) == counters
        assert np.array_equal(frame.read_mask(), mask)
        shadow_pass.render(untimed(gpu), rebuild=True)
        assert np.array_equal(frame.read_mask(), mask)
        assert dict(shadow_pass.count()) == counters
    assert counters
    assert all(isinstance(value, int) and value >= 0 for value in counters.values())
    assert any(counters.values())


@every_case
def test_memory_is_accounted_for(gpu: Gpu, case: Case) -> None:
    scene, light, camera = random_scene("fans", 0), random_light(case.kind, 0), random_camera(0)
    skip_if_refused(gpu, case, scene, light)
    with (
        framed(gpu, scene, light, camera, SIZE) as frame,
        prepared(frame, case.technique.name, case.settings) as shadow_pass,
    ):
        # A texel holds at least 16 bits.
        assert shadow_pass.memory_bytes >= max(1, 2 * (case.texels or 0) ** 2)


@every_kind
def test_memory_is_given_back(gpu: Gpu, case: Case) -> None:
    scene, light, camera = random_scene("fans", 0), random_light(case.kind, 0), random_camera(0)
    skip_if_refused(gpu, case, scene, light)
    with framed(gpu, scene, light, camera, SIZE) as frame:
        with prepared(frame, case.technique.name, case.settings) as first:
            first.count()
        del first
        gc.collect()
        alive = live_objects()
        with prepared(frame, case.technique.name, case.settings) as second:
            second.count()
        # By the end of the pass, not by the garbage collector: `second` is still here.
        assert live_objects() == alive
        del second


@every_kind
def test_what_comes_after_is_not_disturbed(gpu: Gpu, case: Case) -> None:
    scene, light, camera = random_scene("closed boxes", 0), random_light(case.kind, 0), random_camera(0)
    skip_if_refused(gpu, case, scene, light)
    with framed(gpu, scene, light, camera, SIZE) as frame:
        gpu.release()
        before = gl_state()
        with prepared(frame, case.technique.name, case.settings) as shadow_pass:
            frame.shade()
            after_technique = frame.read_picture()
            gpu.release()
            assert gl_state() == before
            shadow_pass.count()
            gpu.release()
            assert gl_state() == before
        # The same mask, shaded in a quiet state.
        frame.draw_surfaces()
        frame.shade()
        assert np.array_equal(frame.read_picture(), after_technique)


@every_kind
def test_a_device_too_small_is_a_reason_in_words(case: Case) -> None:
    scene, light = box_over_floor(), light_of(case.kind)
    reason = case.technique.refuses(light, scene, CRAMPED, case.settings)
    assert reason is not None
    assert len(reason.split()) >= 5
    assert reason == reason.strip()


@every_case
def test_a_fair_scene_is_not_refused(case: Case) -> None:
    assert case.technique.refuses(light_of(case.kind), box_over_floor(), ROOMY, case.settings) is None


@every_kind
def test_candidates_fit_the_device_they_are_asked_for(case: Case) -> None:
    for side in (256, 1024, 4096, 16384):
        limits = replace(ROOMY, max_texture_side=side)
        for settings in case.technique.candidates(case.kind, limits):
            assert case.technique.refuses(light_of(case.kind), box_over_floor(), limits, settings) is None


def empty_scenes() -> Sequence[Scene]:
    point = soup(np.ones((2, 3, 3)))
    line = soup(np.array([[[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]]))
    return (
        Scene("no meshes", ()),
        Scene("no faces", (Mesh("bare", np.ones((3, 3)), np.zeros((0, 3))),)),
        Scene("one point", (point,)),
        Scene("one line", (line,)),
    )


@pytest.mark.parametrize("scene", empty_scenes(), ids=lambda scene: scene.name)
@every_kind
def test_a_scene_without_surfaces_gives_an_empty_mask(gpu: Gpu, case: Case, scene: Scene) -> None:
    for light in (light_of(case.kind), replace(light_of(case.kind), range_m=3.0)):
        with (
            framed(gpu, scene, light, CAMERA, SIZE) as frame,
            prepared(frame, case.technique.name, case.settings) as shadow_pass,
        ):
            assert not frame.read_mask().any()
            assert not frame.read_domain().any()
            shadow_pass.count()


@every_case
def test_without_casters_all_is_lit(gpu: Gpu, case: Case) -> None:
    silent = tuple(replace(mesh, casts=False) for mesh in random_scene("closed boxes", 1).meshes)
    for light in (light_of(case.kind), random_light(case.kind, 1)):
        scene = Scene("silent", silent)
        skip_if_refused(gpu, case, scene, light)
        mask, _, domain = render_mask(gpu, scene, light, CAMERA, SIZE, case.technique.name, case.settings)
        assert domain.any()
        assert np.array_equal(mask == 1, domain)
        assert np.array_equal(mask == 0, ~domain)


@every_kind
def test_a_light_that_reaches_nothing_has_nothing_to_answer(gpu: Gpu, case: Case) -> None:
    lamp = light_of(case.kind)
    lights = [
        replace(lamp, range_m=0.5),
        replace(lamp, direction=(0.0, 1.0, 0.0)),
        replace(lamp, position=(0.0, -5.0, 0.0), direction=(0.0, 1.0, 0.0)),
        replace(lamp, position=(1e6, 5.0, 0.0), range_m=1.0),
        replace(lamp, inner_cone_rad=0.0, outer_cone_rad=1e-300),
    ]
    for light in lights:
        with (
            framed(gpu, box_over_floor(), light, CAMERA, SIZE) as frame,
            prepared(frame, case.technique.name, case.settings) as shadow_pass,
        ):
            domain = frame.read_domain()
            assert (frame.read_mask()[~domain] == 0).all()
            shadow_pass.count()
        if reaches_nothing(light):
            assert not domain.any()


def reaches_nothing(light: Light) -> bool:
    """Whether `light` is one of those that reach nothing of the box and the floor that the camera sees."""
    if light.kind is LightKind.DIRECTIONAL:
        return light.direction[1] > 0
    below_or_away = light.kind is LightKind.SPOT and light.direction[1] > 0 and light.position[1] > 0
    return below_or_away or np.isfinite(light.range_m)


@every_kind
def test_two_passes_share_a_frame_without_disturbing_each_other(gpu: Gpu, case: Case) -> None:
    scene, light, camera = random_scene("closed boxes", 4), random_light(case.kind, 4), random_camera(4)
    skip_if_refused(gpu, case, scene, light)
    with (
        framed(gpu, scene, light, camera, SIZE) as frame,
        prepared(frame, case.technique.name, case.settings) as ours,
    ):
        alone = frame.read_mask()
        for other in FEW:
            if other.kind is not case.kind:
                continue
            with prepared(frame, other.technique.name, other.settings):
                ours.render(untimed(gpu), rebuild=False)
                assert np.array_equal(frame.read_mask(), alone)


def cameras_around() -> Sequence[Camera]:
    return [
        look_at((0, 9, 0.001), (0, 0, 0)),
        look_at((0, -3, 4), (0, 0, 0)),
        look_at((0, 1, 0), (1, 1, 0), near_m=0.01),
        look_at((400, 300, 500), (0, 0, 0), yfov_rad=0.02),
        look_at((0.2, 4.9, 0.1), (0, 0, 0), yfov_rad=2.5),
    ]


@pytest.mark.parametrize("camera", cameras_around(), ids=["above", "below", "inside", "far", "lamp"])
@every_kind
def test_any_camera_is_answered(gpu: Gpu, case: Case, camera: Camera) -> None:
    scene, light = box_over_floor(), light_of(case.kind)
    skip_if_refused(gpu, case, scene, light)
    mask, seen, domain = render_mask(gpu, scene, light, camera, SIZE, case.technique.name, case.settings)
    bound = tolerances.VOLUME_WRONG_SHARE
    if case.texels is not None:
        bound += tolerances.SAMPLED_WRONG / case.texels
    assert judge(scene, mask, seen, domain, light, camera).wrong.sum() <= max(1, bound * domain.sum())


@pytest.mark.parametrize(
    "place",
    [(0.5, 1.0, 0.1), (0.5, 0.75, 0.2), (0.5, 0.75, 0.5), (2.0, 0.0, 1.0), (0.0, 1.25, 0.0)],
    ids=["a face", "an edge", "a corner", "the floor", "the top"],
)
@every_kind
def test_a_light_may_stand_on_what_casts(gpu: Gpu, case: Case, place: tuple[float, float, float]) -> None:
    """Rounded to float32, a triangle whose plane holds the light must not come to stand before it."""
    if case.kind is LightKind.DIRECTIONAL:
        pytest.skip("a directional light stands nowhere")
    scene = box_over_floor()
    for direction in ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.36, -0.48, 0.8)):
        light = Light("lamp", case.kind, place, direction, 0.5, 1.2)
        skip_if_refused(gpu, case, scene, light)
        mask, seen, domain = render_mask(gpu, scene, light, CAMERA, SIZE, case.technique.name, case.settings)
        bound = tolerances.VOLUME_WRONG_SHARE
        if case.texels is not None:
            bound += tolerances.SAMPLED_WRONG / case.texels
        assert judge(scene, mask, seen, domain, light, CAMERA).wrong.sum() <= max(1, bound * domain.sum())


def test_names_and_labels_are_distinct_and_found_in_any_case() -> None:
    assert (
        len({known.name for known in TECHNIQUES})
        == len({known.label for known in TECHNIQUES})
        == len(TECHNIQUES)
    )
    for known in TECHNIQUES:
        assert known.title
        for spelled in (known.name, known.label, known.name.upper(), known.label.lower()):
            assert technique(spelled) is known
    assert technique(GROUND_TRUTH).name == GROUND_TRUTH


def test_an_unknown_technique_is_refused_with_those_there_are() -> None:
    with pytest.raises(UnknownTechniqueError) as caught:
        technique("magic")
    assert "magic" in str(caught.value)
    assert all(known.label in str(caught.value) for known in TECHNIQUES)
