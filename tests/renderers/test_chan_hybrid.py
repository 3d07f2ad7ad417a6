"""Where the map answers it must be right, where it cannot the volumes must, and nothing else may be drawn."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from renderers import volume_tiles
from renderers.chan_hybrid import ChanHybridPass
from renderers.context import DeviceLimits, Gpu
from renderers.frame import Frame, Mask
from renderers.registry import technique
from renderers.settings import Settings, SettingsError
from renderers.volume_tiles import TiledVolumePass
from scenes.scene import Light, LightKind, Scene
from scenes.thesis.registry import OPEN_SCENES
from tests import tolerances
from tests.oracle import incidence, judge
from tests.random_scenes import CLASSES, look_at, random_camera, random_light, random_scene
from tests.rendering import framed, prepared
from tests.solids import box, floor, moebius_strip, moved, placed, plane, sheet, soup

SIZE = (320, 240)
SMALL = (160, 120)
KINDS = list(LightKind)
ROOMY = DeviceLimits(max_texture_side=16384, max_buffer_bytes=2**30)
CAMERAS = [
    look_at((0, 8, 5), (0, 0, 0)),
    look_at((6, 3, 1), (0, 0.5, 0)),
    look_at((-1.5, 0.6, -5), (0, 0.8, 0)),
]

every_kind = pytest.mark.parametrize("kind", KINDS)


def light_of(kind: LightKind) -> Light:
    """A light of any kind, aslant, so that no face of an upright box grazes it."""
    towards = np.array([0.25, -1.0, 0.15])
    towards /= np.linalg.norm(towards)
    return Light("light", kind, tuple(-6 * towards), tuple(towards), 0.5, 0.8)


def hovering_boxes() -> Scene:
    """Nine boxes of about a metre, clear of the floor and of each other."""
    random = np.random.default_rng(0)
    places = [(x, 1.2 + 0.3 * random.random(), z) for x in (-2.4, 0.0, 2.4) for z in (-2.4, 0.0, 2.4)]
    turns = [Rotation.from_rotvec([0, angle, 0]) for angle in random.uniform(0, 1.5, 9)]
    halves = random.uniform(0.4, 0.7, (9, 3))
    return Scene("boxes", (floor(6.0), *map(box, places, halves, turns)))


def thin_posts() -> Scene:
    """A box, and 27 posts three centimetres thick."""
    posts = [
        box((x, 1.0, z), (0.015, 0.6, 0.015), Rotation.from_rotvec([0.3 * x, 0, 0.2 * z + 0.5]))
        for x in np.linspace(-2, 2, 9)
        for z in (-1.0, 0.0, 1.0)
    ]
    return Scene("posts", (floor(6.0), box((0, 1.2, 2.2), (0.5, 0.4, 0.3)), *posts))


def open_scenes() -> dict[str, Scene]:
    """Geometry that bounds no volume: leaf cards, a fence of single quads, a strip with one side."""
    random = np.random.default_rng(3)
    cards = np.array([[[-1, -1, 0], [1, -1, 0], [1, 1, 0]], [[-1, -1, 0], [1, 1, 0], [-1, 1, 0]]]) * 0.25
    turns = Rotation.from_quat(random.normal(size=(30, 4)))
    places = random.uniform((-1.2, 1.4, -1.2), (1.2, 2.6, 1.2), (30, 3))
    leaves = np.concatenate([turn.apply(cards.reshape(-1, 3)).reshape(-1, 3, 3) for turn in turns])
    tree = (box((0, 0.6, 0), (0.12, 0.6, 0.12)), soup(leaves + np.repeat(places, 2, axis=0)[:, None]))
    slat = moved(plane((0, 0, 1), 0.5), np.diag([0.2, 1.0, 1.0, 1.0]))
    fence = [moved(slat, placed(offset=(x, 0.7, 0.3))) for x in np.linspace(-2, 2, 9)]
    strip = moved(moebius_strip(), placed(offset=(0.0, 1.2, 0.0)))
    parts = {"tree": tree, "fence": fence, "moebius strip": [strip]}
    return {name: Scene(name, (floor(6.0), *meshes)) for name, meshes in parts.items()}


def hybrid(frame: Frame, settings: Settings) -> tuple[Mask, dict[str, int]]:
    with prepared(frame, "Chan", settings) as shadow_pass:
        return frame.read_mask(), dict(shadow_pass.count())


def truth(frame: Frame) -> Mask:
    with prepared(frame, "SV", {}):
        return frame.read_mask()


def silhouette_pixels(frame: Frame, shadow_pass: ChanHybridPass) -> npt.NDArray[np.bool_]:
    """(h, w) bool, top row first."""
    depth = np.frombuffer(shadow_pass._silhouettes.depth.read(alignment=1), np.float32)
    return depth.reshape(frame.height, -1)[::-1] > 0


@pytest.mark.parametrize("map_size", [256, 512])
@every_kind
def test_boxes_much_larger_than_a_texel_are_exact(gpu: Gpu, kind: LightKind, map_size: int) -> None:
    for camera in CAMERAS:
        with framed(gpu, hovering_boxes(), light_of(kind), camera, SIZE) as frame:
            expected = truth(frame)
            sampled, counters = hybrid(frame, {"map_size": map_size})
            wide, _ = hybrid(frame, {"map_size": map_size, "kernel": "4x4"})
            covered, _ = hybrid(frame, {"map_size": map_size, "casters": "covering"})
            judged = int(frame.read_domain().sum())
        assert 0.1 < expected.sum() / judged < 0.95
        assert 0 < counters["silhouette_pixels"] < tolerances.SILHOUETTE_SHARE * judged
        assert np.array_equal(covered, expected)
        assert np.array_equal(wide, expected)
        # The very tip of a corner is thinner than a texel, and may slip between samples.
        assert np.count_nonzero(sampled != expected) <= tolerances.CORNER_TIPS


def test_the_seams_of_six_faces_are_exact(gpu: Gpu) -> None:
    # The lamp hangs low among the boxes, so that their shadows cross the seams that run over floor and walls.
    lamp = replace(light_of(LightKind.POINT), position=(0.3, 2.6, 0.2))
    walls = [
        moved(plane((-1, 0, 0), 5.0), placed(offset=(5.0, 2.0, 0.0))),
        moved(plane((0, 0, 1), 5.0), placed(offset=(0.0, 2.0, -5.0))),
    ]
    scene = Scene("room", (*hovering_boxes().meshes, *walls))
    for target in ((4, 1, -4), (4, 1, 4), (-4, 0, -4), (0, 0, 0.1)):
        with framed(gpu, scene, lamp, look_at((0, 3.5, 0), target, yfov_rad=1.4), SIZE) as frame:
            expected = truth(frame)
            covered, _ = hybrid(frame, {"map_size": 512, "casters": "covering"})
            assert np.count_nonzero(covered != expected) <= tolerances.CORNER_TIPS


def test_thin_casters_are_lost_less_the_finer_the_map_and_not_at_all_once_covered(gpu: Gpu) -> None:
    wrong, false_lit, covered_false_lit = [], [], []
    with framed(gpu, thin_posts(), light_of(LightKind.SPOT), CAMERAS[0], SIZE) as frame:
        expected = truth(frame)
        for map_size in (32, 64, 128, 256):
            mask, _ = hybrid(frame, {"map_size": map_size})
            covered, _ = hybrid(frame, {"map_size": map_size, "casters": "covering"})
            wrong.append(np.count_nonzero(mask != expected))
            false_lit.append(np.count_nonzero(mask > expected))
            covered_false_lit.append(np.count_nonzero(covered > expected))
    assert wrong[0] > 200
    assert wrong == sorted(wrong, reverse=True)
    assert wrong[-1] <= wrong[0] / 4
    assert false_lit[0] >= 0.9 * wrong[0]
    assert max(covered_false_lit) == 0


@pytest.mark.parametrize("name", open_scenes())
@every_kind
def test_open_geometry_is_what_rays_say(gpu: Gpu, kind: LightKind, name: str) -> None:
    scene, light, camera = open_scenes()[name], light_of(kind), CAMERAS[1]
    with (
        framed(gpu, scene, light, camera, SIZE) as frame,
        prepared(frame, "Chan", {"map_size": 1024, "casters": "covering"}),
    ):
        mask, surfaces, domain = frame.read_mask(), frame.read_surfaces(), frame.read_domain()
    found = judge(scene, mask, surfaces, domain, light, camera)
    assert (mask[domain] == 0).sum() > 100
    assert found.wrong_share <= tolerances.HYBRID_OPEN_SHARE


@pytest.mark.parametrize("name", OPEN_SCENES)
def test_the_open_scenes_of_the_thesis_are_what_rays_say(gpu: Gpu, name: str) -> None:
    scene = OPEN_SCENES[name]()
    light, camera = scene.lights[0], scene.cameras[0]
    with (
        framed(gpu, scene, light, camera, SIZE) as frame,
        prepared(frame, "Chan", {"map_size": 1024, "casters": "covering"}),
    ):
        mask, surfaces, domain = frame.read_mask(), frame.read_surfaces(), frame.read_domain()
    found = judge(scene, mask, surfaces, domain, light, camera)
    assert (mask[domain] == 0).sum() > 1000
    assert found.wrong_share <= tolerances.HYBRID_OPEN_SHARE


@pytest.mark.parametrize("kernel", ["2x2", "4x4"])
def test_silhouette_pixels_are_those_whose_texels_disagree(gpu: Gpu, kernel: str) -> None:
    settings = {"map_size": 256, "kernel": kernel}
    reach = {"2x2": (0, 1), "4x4": (-1, 0, 1, 2)}[kernel]
    with framed(gpu, hovering_boxes(), light_of(LightKind.SPOT), CAMERAS[0], SIZE) as frame:
        with prepared(frame, "Chan", settings) as one:
            shadow_pass = cast(ChanHybridPass, one)
            found = silhouette_pixels(frame, shadow_pass)
            depths = np.frombuffer(shadow_pass._map.texture.read(alignment=1), np.float32).reshape(256, 256)
            matrix = shadow_pass._map.atlas_from_clip(0) @ shadow_pass._fit.faces[0]
            counted = shadow_pass.count()["silhouette_pixels"]
        surfaces, domain = frame.read_surfaces(), frame.read_domain()
        points = surfaces.positions - frame.world.origin
    assert counted == found.sum()
    q = points @ matrix[:, :3].T + matrix[:, 3]
    place = q[..., :2] / q[..., 3:] * 256 - 0.5
    cell = np.floor(np.where(domain[..., None], place, 0)).astype(int)
    around = np.stack([depths[cell[..., 1] + y, cell[..., 0] + x] for y in reach for x in reach])
    lit = q[..., 2] / q[..., 3] >= around
    expected = domain & (lit.any(axis=0) != lit.all(axis=0))
    assert expected.sum() > 500
    assert not found[~domain].any()
    assert np.count_nonzero(found != expected) <= tolerances.CELL_SHARE * expected.sum()


def test_grazed_pixels_are_left_to_the_volumes(gpu: Gpu) -> None:
    with framed(
        gpu, random_scene("open sheets", 1), random_light(LightKind.POINT, 1), CAMERAS[0], SIZE
    ) as frame:
        seen, domain = frame.read_surfaces(), frame.read_domain()
        with prepared(frame, "Chan", {"map_size": 256, "grazing": 0.3}) as one:
            found = silhouette_pixels(frame, cast(ChanHybridPass, one))
        with prepared(frame, "Chan", {"map_size": 256}) as one:
            without = silhouette_pixels(frame, cast(ChanHybridPass, one))
        cosine = incidence(seen, frame.light)
    assert found[domain & (cosine < 0.299)].all()
    assert np.array_equal(found[cosine > 0.301], without[cosine > 0.301])
    assert not without[domain & (cosine < 0.299)].all()


@every_kind
@pytest.mark.parametrize("geometry", CLASSES)
def test_tiles_change_no_bit_and_draw_no_more(gpu: Gpu, geometry: str, kind: LightKind) -> None:
    scene, light = random_scene(geometry, 2), random_light(kind, 2)
    for camera in (random_camera(2), look_at((0.1, 0.5, 0.2), (1, 0.4, 0.7), near_m=0.02)):
        with framed(gpu, scene, light, camera, SMALL) as frame:
            whole, plain = hybrid(frame, {"map_size": 256, "tiles": "off"})
            for tiles in (16, 37, 64, 1024):
                mask, counters = hybrid(frame, {"map_size": 256, "tiles": tiles})
                assert np.array_equal(mask, whole)
                assert counters["volume_fragments"] <= plain["volume_fragments"]
                assert counters["volume_fragments_counted"] <= plain["volume_fragments_counted"]
                assert counters["silhouette_pixels"] == plain["silhouette_pixels"]


def test_tiles_save_fragments_and_lose_none_that_count(gpu: Gpu) -> None:
    with framed(gpu, hovering_boxes(), light_of(LightKind.SPOT), CAMERAS[1], (640, 480)) as frame:
        with prepared(frame, "SV", {}) as volumes:
            volume = volumes.count()
        _, plain = hybrid(frame, {"map_size": 512, "tiles": "off"})
        _, tiled = hybrid(frame, {"map_size": 512, "tiles": 32})
    assert plain["volume_fragments"] == volume["volume_fragments"]
    assert plain["volume_fragments_counted"] < volume["volume_fragments_counted"] / 4
    assert tiled["volume_fragments_counted"] == plain["volume_fragments_counted"]
    assert tiled["volume_fragments"] < plain["volume_fragments"] / 2


def test_triangles_without_room_in_the_tiles_are_drawn_whole(
    gpu: Gpu, monkeypatch: pytest.MonkeyPatch
) -> None:
    with framed(gpu, hovering_boxes(), light_of(LightKind.SPOT), CAMERAS[1], SIZE) as frame:
        mask, tiled = hybrid(frame, {"map_size": 512, "tiles": 32})
        monkeypatch.setattr(volume_tiles, "CUTS", 0)
        without_room, whole = hybrid(frame, {"map_size": 512, "tiles": 32})
    assert np.array_equal(mask, without_room)
    assert whole["volume_triangles"] < tiled["volume_triangles"]
    assert whole["volume_fragments"] > tiled["volume_fragments"]


def test_tiles_serve_volumes_without_a_map_as_well(gpu: Gpu) -> None:
    for seed in range(3):
        scene, light = random_scene("closed boxes", seed), random_light(LightKind.POINT, seed)
        with (
            framed(gpu, scene, light, random_camera(seed), SIZE) as frame,
            prepared(frame, "SV", {"variant": "general"}) as volumes,
        ):
            expected = volumes._volumes.counts.read()  # type: ignore[attr-defined]
            tiled = TiledVolumePass(frame, frame.depth, 32)
            tiled.find_silhouettes()
            tiled.cull()
            tiled.draw()
            assert tiled.counts.read() == expected
            tiled.release()


def test_what_is_asked_of_the_hybrid_is_checked(gpu: Gpu) -> None:
    known, scene, light = technique("Chan"), hovering_boxes(), light_of(LightKind.SPOT)
    for settings in ({"kernel": "3x3"}, {"tiles": 8}, {"grazing": 2.0}, {"filter": "2x2"}):
        with framed(gpu, scene, light, CAMERAS[0], SMALL) as frame, pytest.raises(SettingsError):
            known.prepare(frame, light, settings)
    # 110 triangles: the tiles take 7,040 bytes, edges 5,280, and without room for these no setting helps.
    cramped = replace(ROOMY, max_buffer_bytes=4096)
    assert "tiles=off" in str(known.refuses(light, scene, replace(ROOMY, max_buffer_bytes=6000), {}))
    assert "tiles" not in str(known.refuses(light, scene, cramped, {}))
    sheets = Scene("sheet", (sheet(lambda u, v: np.stack([u, 0 * u, v], axis=-1), 50),))
    assert "buffers" in str(known.refuses(light, sheets, cramped, {"tiles": "off"}))
    assert known.refuses(light, scene, ROOMY, {}) is None


@every_kind
def test_candidates_are_small_maps_with_safe_defaults(kind: LightKind) -> None:
    known = technique("Chan")
    sizes = [settings["map_size"] for settings in known.candidates(kind, ROOMY)]
    assert sizes == ([128, 256, 512] if kind is LightKind.POINT else [256, 512, 1024])
    for settings in known.candidates(kind, ROOMY):
        assert not any(known.options[name].replay for name in settings)
