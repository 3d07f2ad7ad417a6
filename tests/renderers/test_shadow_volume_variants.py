from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderers.context import DeviceLimits, Gpu
from renderers.frame import Frame, Mask
from renderers.registry import technique
from renderers.settings import Setting, Settings, SettingsError
from renderers.shadow_volume import EYE_IN_SHADOW, ShadowVolumePass
from renderers.technique import ShadowPass
from renderers.volume_closure import closure, lit_faces_fall_short
from renderers.volume_eye import near_rectangle_is_lit
from renderers.volume_pass import VolumePass
from renderers.volume_silhouettes import VolumeForm, silhouette_pieces
from scenes.ray_caster import RayCaster
from scenes.scene import Array, Light, LightKind, Mesh, Scene
from scenes.thesis.registry import OPEN_SCENES
from tests import tolerances
from tests.gl_state import live_objects
from tests.oracle import judge
from tests.random_scenes import CLASSES, look_at, random_camera, random_light, random_scene
from tests.rendering import framed, prepared, untimed
from tests.solids import box, floor, klein_bottle, moebius_strip, moved, placed, plane, quads

SIZE = (320, 240)
SMALL = (96, 72)
KINDS = list(LightKind)
ROOMY = DeviceLimits(max_texture_side=16384, max_buffer_bytes=2**30)
GENERAL: Settings = {"variant": "general"}
CROW: Settings = {"variant": "crow"}
UNCHECKED: Settings = {"variant": "crow", "unchecked": True}
SAME_BITS: list[Settings] = [
    CROW,
    {"variant": "mixed"},
    {"silhouettes": "cpu"},
    {"silhouettes": "cpu", "variant": "mixed"},
    {"counting": "zpass"},
]
# Other sides, turned or longer ones: their depth is rounded otherwise.
SAME_SHADOWS: list[Settings] = [
    {"volumes": "triangle"},
    {"volumes": "triangle", "silhouettes": "cpu"},
    {"extrusion": "infinite"},
    {"extrusion": "finite"},
    {"extrusion": "finite", "counting": "zpass"},
    {**CROW, "counter": "two_sided"},
    {**CROW, "counter": "one_sided"},
    {**CROW, "counter": "two_sided", "counting": "zpass"},
    {**CROW, "counter": "one_sided", "counting": "zpass"},
    {**CROW, "counter": "two_sided", "volumes": "triangle"},
    {**CROW, "counter": "two_sided", "silhouettes": "cpu"},
]


def spelled(settings: Settings) -> str:
    return "-".join(str(value) for value in settings.values())


def closed_scene(seed: int) -> Scene:
    """Closed boxes, some in each other, over a floor that does not cast."""
    ground, *boxes = random_scene("closed boxes", seed).meshes
    return Scene("closed", (replace(ground, casts=False), *boxes))


def rendered(frame: Frame, settings: Settings) -> tuple[Mask, str]:
    """The mask, and what the technique notes about it."""
    with technique("SV").prepare(frame, frame.light, settings) as shadow_pass:
        note = shadow_pass.render(untimed(frame.gpu), rebuild=True).note
        return frame.read_mask(), note


def refusal(light: Light, scene: Scene, settings: Settings) -> str | None:
    return technique("SV").refuses(light, scene, ROOMY, settings)


def light_of(kind: LightKind, position: object, target: object = (0.0, 0.0, 0.0)) -> Light:
    place = np.asarray(position, float)
    towards = np.asarray(target, float) - place
    return Light("light", kind, tuple(place), tuple(towards / np.linalg.norm(towards)), 0.4, 0.8)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("settings", SAME_BITS, ids=spelled)
def test_a_variant_gives_the_default_s_bits_on_closed_meshes(
    gpu: Gpu, kind: LightKind, settings: Settings
) -> None:
    for seed in range(3):
        scene, light = closed_scene(seed), random_light(kind, seed)
        assert refusal(light, scene, settings) is None
        with framed(gpu, scene, light, random_camera(seed), SIZE) as frame:
            expected, _ = rendered(frame, GENERAL)
            mask, note = rendered(frame, settings)
            assert not note
            assert 0 < expected[frame.read_domain()].mean() < 1
            assert np.array_equal(mask, expected)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("settings", SAME_SHADOWS, ids=spelled)
def test_a_variant_gives_the_default_s_shadows_on_closed_meshes(
    gpu: Gpu, kind: LightKind, settings: Settings
) -> None:
    differing, judged = 0, 0
    for seed in range(3):
        scene, light = closed_scene(seed), random_light(kind, seed)
        assert refusal(light, scene, settings) is None
        with framed(gpu, scene, light, random_camera(seed), SIZE) as frame:
            expected, _ = rendered(frame, GENERAL)
            mask, note = rendered(frame, settings)
            assert not note
            judged += int(frame.read_domain().sum())
            differing += int(np.count_nonzero(mask != expected))
    assert judged > 90_000
    assert differing <= max(1, tolerances.VOLUME_END_SHARE * judged)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometry", CLASSES)
@pytest.mark.parametrize(
    "settings", [{"variant": "mixed"}, {"silhouettes": "cpu"}, {"volumes": "triangle"}], ids=spelled
)
def test_what_takes_any_geometry_agrees_with_the_default_on_it(
    gpu: Gpu, kind: LightKind, geometry: str, settings: Settings
) -> None:
    scene, light = random_scene(geometry, 1), random_light(kind, 1)
    assert refusal(light, scene, settings) is None
    with framed(gpu, scene, light, random_camera(1), SIZE) as frame:
        expected, _ = rendered(frame, GENERAL)
        mask, note = rendered(frame, settings)
        assert not note
        assert np.count_nonzero(mask != expected) <= max(1, tolerances.VOLUME_END_SHARE * mask.size)


def test_crow_draws_half_the_caps_and_mixed_what_lies_between(gpu: Gpu) -> None:
    light, camera = random_light(LightKind.DIRECTIONAL, 1), random_camera(1)
    counts = {}
    for name, scene in {"closed": closed_scene(1), "over a floor": random_scene("closed boxes", 1)}.items():
        with framed(gpu, scene, light, camera, SIZE) as frame:
            for variant in ("general", "mixed", "crow"):
                with prepared(frame, "SV", {"variant": variant, "unchecked": True}) as shadow_pass:
                    counts[name, variant] = shadow_pass.count()
    general, crow = counts["closed", "general"], counts["closed", "crow"]
    # Of each box's twelve faces six are lit.
    assert crow["cap_triangles"] * 2 == general["cap_triangles"] == 2 * 12 * 12
    assert crow["silhouette_edges"] == general["silhouette_edges"]
    assert crow["volume_fragments"] < general["volume_fragments"]
    assert counts["closed", "mixed"] == crow
    assert counts["over a floor", "mixed"]["cap_triangles"] == 2 * (12 * 6 + 2)
    assert counts["over a floor", "general"]["cap_triangles"] == 2 * (12 * 12 + 2)


def wrong_share(frame: Frame, mask: Mask, scene: Scene) -> float:
    """Share of pixels where rays say otherwise."""
    surfaces, domain = frame.read_surfaces(), frame.read_domain()
    points = surfaces.positions[domain]
    rounding = tolerances.VIEW_DEPTH * np.linalg.norm(points - frame.camera.position, axis=1)
    lit = RayCaster(scene).lit(points, surfaces.normals[domain], frame.light, position_error=rounding)
    assert len(lit) > 3000
    return float(np.mean((mask[domain] > 0.5) != lit))


@pytest.mark.parametrize("key", OPEN_SCENES)
def test_crow_refuses_open_geometry_and_is_wrong_there_where_the_default_is_right(gpu: Gpu, key: str) -> None:
    scene = OPEN_SCENES[key]()
    light, camera = scene.lights[0], scene.cameras[0]
    reason = refusal(light, scene, CROW)
    assert reason is not None
    assert "edges" in reason
    assert "variant=general" in reason
    assert refusal(light, scene, UNCHECKED) is None
    with framed(gpu, scene, light, camera, SIZE) as frame:
        wrong, note = rendered(frame, UNCHECKED)
        assert note == reason
        assert wrong_share(frame, wrong, scene) > tolerances.CROW_WRONG_ON_OPEN
        for variant in ("general", "mixed"):
            mask, note = rendered(frame, {"variant": variant})
            assert not note
            found = judge(scene, mask, frame.read_surfaces(), frame.read_domain(), light, camera)
            assert not found.far.any()
            assert found.wrong_share <= tolerances.VOLUME_WRONG_SHARE


@pytest.mark.parametrize(
    "mesh", [klein_bottle(), moebius_strip(), plane((0, 1, 0), 1.0)], ids=lambda m: m.name
)
def test_the_reason_counts_the_edges(mesh: Mesh) -> None:
    scene = Scene("two", (replace(mesh, placements=np.stack([placed(), placed(offset=(9, 0, 0))])),))
    edges = closure(mesh).open_edges
    assert edges > 0
    assert f"{2 * edges:,} edges" in str(lit_faces_fall_short(light_of(LightKind.POINT, (0, 5, 0)), scene))


INSIDE_OUT = Mesh("room", box((0, 0, 0), (2, 2, 2)).positions, box((0, 0, 0), (2, 2, 2)).triangles[:, ::-1])
BODY = box((0, 0, 0), (2, 2, 2))
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])
TWO_SIDED = Mesh("card", BODY.positions, np.vstack([BODY.triangles[:2], BODY.triangles[:2, ::-1]]))


@pytest.mark.parametrize(
    ("mesh", "height", "right"),
    [
        (BODY, 5.0, True),
        (BODY, 0.0, False),
        (INSIDE_OUT, 5.0, False),
        (INSIDE_OUT, 0.0, True),
        (moved(BODY, MIRROR), 5.0, False),
        (moved(BODY, MIRROR), 0.0, True),
        (moved(INSIDE_OUT, MIRROR), 5.0, True),
        (TWO_SIDED, 5.0, True),
        (TWO_SIDED, 0.5, True),
    ],
)
def test_crow_needs_a_light_that_no_mesh_winds_around_more_than_elsewhere(
    mesh: Mesh, height: float, *, right: bool
) -> None:
    light = light_of(LightKind.POINT, (0.3, height, 0.2), (0, -9, 0))
    assert (refusal(light, Scene("body", (mesh,)), CROW) is None) == right
    distant = light_of(LightKind.DIRECTIONAL, (0, 5, 0))
    outwards = right == (height > 2) or mesh is TWO_SIDED
    assert (refusal(distant, Scene("body", (mesh,)), CROW) is None) == outwards


@pytest.mark.parametrize("eye", [(0.5, 0.3, 1.2), (0.5, 2.5, 6.0)], ids=["inside", "outside"])
@pytest.mark.parametrize("height", [0.0, 1.0, 4.0])
@pytest.mark.parametrize("room", [BODY, INSIDE_OUT], ids=["outwards", "inwards"])
def test_crow_is_right_wherever_it_does_not_refuse_and_mixed_everywhere(
    gpu: Gpu, room: Mesh, height: float, eye: tuple[float, float, float]
) -> None:
    furniture = box((0.6, -1.2, -0.4), (0.4, 0.5, 0.3))
    scene = Scene("room", (floor(6.0, -2.5, casts=False), room, furniture))
    light = light_of(LightKind.POINT, (-0.5, height, 0.3), (0, -9, 0))
    with framed(gpu, scene, light, look_at(eye, (0, -1, -0.5)), SIZE) as frame:
        expected, _ = rendered(frame, GENERAL)
        mixed, _ = rendered(frame, {"variant": "mixed"})
        assert np.array_equal(mixed, expected)
        crow, note = rendered(frame, UNCHECKED)
        assert note or np.array_equal(crow, expected)


def test_crow_without_its_condition_loses_the_shadow_of_what_encloses_the_light(gpu: Gpu) -> None:
    scene = Scene("lampshade", (floor(6.0, -2.5, casts=False), BODY))
    light = light_of(LightKind.POINT, (0.0, 0.0, 0.0), (0, -9, 0))
    with framed(gpu, scene, light, look_at((0.5, 4, 8), (0, -2, 0)), SIZE) as frame:
        expected, _ = rendered(frame, GENERAL)
        assert not expected.any()
        crow, note = rendered(frame, UNCHECKED)
        assert "encloses" in note
        assert crow.any()


def test_crow_is_right_where_faces_are_out_of_reach_beside_faces_that_are_not(gpu: Gpu) -> None:
    table = box((0, 1, 0), (2.5, 0.05, 2.5))
    scene = Scene("table", (floor(6.0, casts=False), table, box((0, 1.3, 0), (0.1, 0.1, 0.1))))
    lamp = replace(light_of(LightKind.SPOT, (0.1, 2, 0)), inner_cone_rad=0.1, outer_cone_rad=0.5)
    short = replace(light_of(LightKind.POINT, (2.4, 1.4, 0)), range_m=1.6)
    for light in (lamp, short):
        with framed(gpu, scene, light, look_at((4, 2.5, 4), (0, 0.6, 0)), SIZE) as frame:
            expected, _ = rendered(frame, GENERAL)
            domain = frame.read_domain()
            assert 0 < expected[domain].mean() < 1
            with prepared(frame, "SV", GENERAL) as general, prepared(frame, "SV", CROW) as crow:
                assert np.array_equal(frame.read_mask(), expected)
                assert crow.count()["cap_triangles"] < general.count()["cap_triangles"] < 2 * 24


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometry", CLASSES)
def test_no_volume_holds_a_near_rectangle_that_is_said_to_be_lit(
    gpu: Gpu, kind: LightKind, geometry: str
) -> None:
    scene, said = random_scene(geometry, 2), []
    for seed in range(12):
        camera = replace(random_camera(seed), near_m=[0.05, 0.5][seed % 2])
        light = replace(random_light(kind, seed), range_m=float("inf"), outer_cone_rad=float(np.pi / 2))
        with framed(gpu, scene, light, camera, SMALL) as frame:
            volumes = VolumePass(frame)
            volumes.find_silhouettes()
            volumes.draw("1")
            held = bool(np.frombuffer(volumes.counts.read(), np.float32).any())
            volumes.release()
            said.append(near_rectangle_is_lit(frame))
            assert not (said[-1] and held)
    assert any(said)


@pytest.mark.parametrize("kind", KINDS)
def test_z_pass_is_wrong_with_the_eye_in_shadow_and_says_so(gpu: Gpu, kind: LightKind) -> None:
    roof = moved(plane((0, 1, 0), 1.0), placed(offset=(0.0, 2.5, 0)))
    scene, light = Scene("roof", (floor(6.0), roof)), light_of(kind, (0.1, 6, 0.1), (0, 0, 0))
    with framed(gpu, scene, light, look_at((0.0, 1.5, 0.3), (0, 0.0, -0.8)), SIZE) as frame:
        expected, _ = rendered(frame, GENERAL)
        mask, note = rendered(frame, {"counting": "zpass"})
        assert note == EYE_IN_SHADOW
        assert np.count_nonzero(mask != expected) > 1000
    with framed(gpu, scene, light, look_at((0.0, 3.5, 4.0), (0, 0.0, -2.5)), SIZE) as frame:
        expected, _ = rendered(frame, GENERAL)
        mask, note = rendered(frame, {"counting": "zpass"})
        assert not note
        assert np.array_equal(mask, expected)


def test_a_light_in_the_near_plane_clears_no_near_rectangle(gpu: Gpu) -> None:
    camera = look_at((0, 1, 4), (0, 1, 0), near_m=0.25)
    scene = closed_scene(0)
    beside = light_of(LightKind.POINT, (2.0, 3.0, 3.75))
    with framed(gpu, scene, beside, camera, SMALL) as frame:
        assert not near_rectangle_is_lit(frame)


def stack(layers: int, middle: object, half: float) -> Mesh:
    """Squares that face up, one above the other within a metre."""
    corners = half * np.array([[-1.0, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]) + np.asarray(middle, float)
    heights = np.linspace(0.0, 1.0, layers)[:, None, None] * [0, 1, 0]
    return Mesh("stack", (corners + heights).reshape(-1, 3), quads(np.arange(4 * layers).reshape(-1, 4)))


def counted(shadow_pass: ShadowPass, frame: Frame) -> Array:
    """(h, w) counts, top row first."""
    assert isinstance(shadow_pass, ShadowVolumePass)
    counts: Array = np.frombuffer(shadow_pass._volumes.counts.read(), np.float32).reshape(frame.height, -1)
    return counts[::-1].astype(np.float64)


@pytest.mark.parametrize("layers", [255, 256, 257, 512])
def test_a_stencil_counter_that_wraps_is_wrong_at_multiples_of_256_only(gpu: Gpu, layers: int) -> None:
    scene = Scene("stack", (floor(5.0, casts=False), stack(layers, (0, 1, 0), 1.0)))
    light, camera = light_of(LightKind.POINT, (0.01, 6, 0.02)), look_at((0, 0.7, 4), (0, 0, 0))
    settings = {**UNCHECKED, "counter": "two_sided"}
    with framed(gpu, scene, light, camera, SMALL) as frame:
        with prepared(frame, "SV", {}) as shadow_pass:
            # Elsewhere only some of the layers lie between.
            behind_all = frame.read_domain() & (counted(shadow_pass, frame) == layers)
            assert behind_all.sum() > 50
            assert not frame.read_mask()[behind_all].any()
        with prepared(frame, "SV", settings) as shadow_pass:
            assert (counted(shadow_pass, frame)[behind_all] == layers % 256).all()
            assert (frame.read_mask()[behind_all] == (layers % 256 == 0)).all()


@pytest.mark.parametrize(
    ("layers", "right"), [(200, True), (254, True), (255, False), (300, False), (511, False)]
)
def test_a_saturating_counter_loses_shadows_before_more_than_254_layers(
    gpu: Gpu, layers: int, *, right: bool
) -> None:
    # Behind the wall each pixel's ray passes through the whole stack's volumes; a canopy shades the wall.
    wall = sheet_upright()
    canopy = moved(plane((0, 1, 0), 0.6), placed(offset=(0.0, 3.0, 1.9)))
    scene = Scene("wall", (floor(9.0, casts=False), wall, canopy, stack(layers, (0, 2.5, -1.0), 1.2)))
    light = light_of(LightKind.DIRECTIONAL, (0.0, 6, 0.0001))
    with framed(gpu, scene, light, look_at((0, 1.2, 5), (0, 1.0, 0)), SMALL) as frame:
        surfaces = frame.read_surfaces()
        expected, _ = rendered(frame, GENERAL)
        shaded = frame.read_domain() & (surfaces.positions[..., 2] > 1.6) & (expected == 0)
        shaded &= (np.abs(surfaces.positions[..., 0]) < 0.4) & (surfaces.positions[..., 1] > 0.7)
        assert shaded.sum() > 50
        wraps, _ = rendered(frame, {**UNCHECKED, "counter": "two_sided"})
        assert not wraps[shaded].any()
        stops, _ = rendered(frame, {**UNCHECKED, "counter": "one_sided"})
        assert (stops[shaded] == 0).all() if right else (stops[shaded] == 1).all()


def sheet_upright() -> Mesh:
    """A wall that leans back, so that light from above strikes it; it does not cast."""
    mesh = moved(plane((0, 0.5, 1.0), 1.0), placed(offset=(0.0, 0.6, 1.9)))
    return replace(mesh, casts=False)


def test_finite_volumes_end_above_the_floor_beneath_a_wide_caster_near_the_lamp(gpu: Gpu) -> None:
    shade = moved(plane((0, 1, 0), 1.5), placed(offset=(0.0, 0.8, 0.0)))
    scene = Scene("lamp", (floor(2.0), shade))
    lamp = replace(light_of(LightKind.POINT, (0.0, 1.0, 0.0)), range_m=3.0)
    with framed(gpu, scene, lamp, look_at((0, 0.5, 3.5), (0, 0.1, 0)), SIZE) as frame:
        ground = frame.read_domain() & (frame.read_surfaces().positions[..., 1] < 0.1)
        assert ground.sum() > 1000
        assert not rendered(frame, GENERAL)[0][ground].any()
        assert rendered(frame, {"extrusion": "finite"})[0][ground].mean() > 0.5


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometry", CLASSES)
def test_the_cpu_finds_the_pieces_that_the_gpu_finds(gpu: Gpu, kind: LightKind, geometry: str) -> None:
    for seed in range(4):
        scene, light = random_scene(geometry, seed), random_light(kind, seed)
        with framed(gpu, scene, light, random_camera(seed), SMALL) as frame:
            volumes = VolumePass(frame)
            volumes.find_silhouettes()
            pieces = volumes._pieces
            found = [
                np.frombuffer(buffer.read(), np.int32).reshape(-1, 4)[:count]
                for buffer, count in zip((pieces._caps, pieces._sides), volumes.pieces(), strict=True)
            ]
            volumes.release()
            expected = silhouette_pieces(frame.world, light, VolumeForm(), -1)
        for ours, theirs in zip(found, expected, strict=True):
            assert len(theirs) > 0
            assert np.array_equal(np.unique(ours, axis=0), np.unique(theirs, axis=0))
            assert len(ours) == len(theirs)


@pytest.mark.parametrize("settings", [*SAME_BITS, *SAME_SHADOWS], ids=spelled)
def test_a_variant_follows_camera_and_light_and_gives_everything_back(gpu: Gpu, settings: Settings) -> None:
    scene, first, second = closed_scene(1), random_light(LightKind.SPOT, 1), random_light(LightKind.SPOT, 4)
    with framed(gpu, scene, first, random_camera(1), SMALL) as frame:
        rendered(frame, settings)
        alive = live_objects()
        with prepared(frame, "SV", settings) as shadow_pass:
            frame.look(random_camera(2))
            frame.draw_surfaces()
            shadow_pass.render(untimed(gpu), rebuild=False)
            seen = frame.read_mask()
            assert np.array_equal(seen, rendered(frame, settings)[0])
            frame.shine(second)
            frame.draw_surfaces()
            shadow_pass.render(untimed(gpu), rebuild=True)
            assert not np.array_equal(frame.read_mask(), seen)
            mask = frame.read_mask()
            counters = dict(shadow_pass.count())
            assert dict(shadow_pass.count()) == counters
            assert np.array_equal(frame.read_mask(), mask)
            assert np.array_equal(mask, rendered(frame, settings)[0])
            assert shadow_pass.memory_bytes > 0
        assert live_objects() == alive


def test_counters_of_what_lies_behind_and_in_front_add_up(gpu: Gpu) -> None:
    scene, light = closed_scene(1), random_light(LightKind.POINT, 1)
    with framed(gpu, scene, light, random_camera(1), SIZE) as frame:
        counted_by = {}
        for name, settings in {
            "behind": CROW,
            "in front": {**CROW, "counting": "zpass"},
            "stencil": {**CROW, "counter": "two_sided"},
            "stencil in front": {**CROW, "counter": "one_sided", "counting": "zpass"},
        }.items():
            with prepared(frame, "SV", settings) as shadow_pass:
                counted_by[name] = dict(shadow_pass.count())
    behind, in_front = counted_by["behind"], counted_by["in front"]
    # Nothing of a cap lies in front of a surface, so that its fragments are all among those behind.
    assert in_front["cap_triangles"] == 0
    assert (
        behind["volume_fragments"] - behind["volume_fragments_counted"]
        == (in_front["volume_fragments_counted"])
    )
    assert counted_by["stencil"] == behind
    assert counted_by["stencil in front"] == in_front


def test_a_stencil_counter_refuses_what_weighs_more_than_one() -> None:
    scene, light = closed_scene(0), random_light(LightKind.POINT, 1)
    for counter in ("two_sided", "one_sided"):
        for variant in ("general", "mixed"):
            reason = refusal(light, scene, {"counter": counter, "variant": variant})
            assert reason is not None
            assert "variant=crow" in reason
        assert refusal(light, scene, {"counter": counter, "variant": "crow"}) is None


def test_a_stencil_counter_takes_an_edge_between_four_faces(gpu: Gpu) -> None:
    corner = [box((-0.5, 1, -0.5), (0.5, 0.5, 0.5)), box((0.5, 1, 0.5), (0.5, 0.5, 0.5))]
    scene, light = (
        Scene("corner", (floor(6.0, casts=False), *corner)),
        light_of(LightKind.POINT, (0.9, 6, -1.2)),
    )
    with framed(gpu, scene, light, look_at((3, 3, 3), (0, 0.5, 0)), SIZE) as frame:
        assert (frame.world.topology.valences == 4).any()
        for silhouettes in ("gpu", "cpu"):
            mask, _ = rendered(frame, {**CROW, "counter": "two_sided", "silhouettes": silhouettes})
            assert np.count_nonzero(mask != rendered(frame, GENERAL)[0]) <= 1


@pytest.mark.parametrize(
    ("name", "value"),
    [("variant", "carmack"), ("counting", "zboth"), ("map_size", 512), ("unchecked", "yes")],
)
def test_what_cannot_be_set_is_said(gpu: Gpu, name: str, value: Setting) -> None:
    light = random_light(LightKind.POINT, 0)
    with framed(gpu, closed_scene(0), light, random_camera(0), SMALL) as frame, pytest.raises(SettingsError):
        technique("SV").prepare(frame, light, {name: value})


def test_replay_settings_are_no_candidates() -> None:
    known = technique("SV")
    for kind in KINDS:
        for settings in known.candidates(kind, ROOMY):
            assert not any(known.options[name].replay for name in settings)
