from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import moderngl
import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from renderers import volume_pieces
from renderers.context import Gpu
from renderers.frame import Frame
from renderers.volume_pass import VolumePass
from scenes.scene import Array, Camera, Light, LightKind, Mesh, Scene
from tests import tolerances
from tests.oracle import Verdict, incidence, judge
from tests.random_scenes import CLASSES, look_at, random_camera, random_light, random_scene
from tests.rendering import framed, render_mask
from tests.solids import (
    box,
    floor,
    klein_bottle,
    moebius_strip,
    moved,
    placed,
    plane,
    quads,
    world_triangles,
)

SIZE = (320, 240)
KINDS = list(LightKind)
SEEDS = range(5)


def verdict(gpu: Gpu, scene: Scene, light: Light, camera: Camera, size: tuple[int, int] = SIZE) -> Verdict:
    mask, surfaces, domain = render_mask(gpu, scene, light, camera, size, "shadow_volume", {})
    return judge(scene, mask, surfaces, domain, light, camera)


def assert_exact(found: Verdict) -> None:
    assert found.domain_px > 0
    assert not found.far.any(), f"wrong far from any shadow edge: {np.argwhere(found.far)[:5].tolist()}"
    # One pixel is more than the share allows in a small domain.
    assert found.wrong.sum() <= max(1, tolerances.VOLUME_WRONG_SHARE * found.domain_px)


def light_of(kind: LightKind, position: npt.ArrayLike, target: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Light:
    """A light of any kind that shines from `position` at `target`."""
    towards = np.asarray(target, float) - np.asarray(position, float)
    direction = towards / np.linalg.norm(towards)
    return Light("light", kind, tuple(np.asarray(position, float)), tuple(direction), 0.4, 0.8)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometry", CLASSES)
def test_random_scenes_are_what_rays_say(gpu: Gpu, geometry: str, kind: LightKind) -> None:
    judged, wrong = 0, 0
    for seed in SEEDS:
        found = verdict(gpu, random_scene(geometry, seed), random_light(kind, seed), random_camera(seed))
        assert_exact(found)
        judged, wrong = judged + found.domain_px, wrong + int(found.wrong.sum())
    assert judged > 50_000
    assert wrong <= tolerances.VOLUME_WRONG_SHARE * judged


@contextmanager
def volumes_of(frame: Frame) -> Iterator[VolumePass]:
    volumes = VolumePass(frame)
    try:
        volumes.find_silhouettes()
        yield volumes
    finally:
        volumes.release()


def counted(frame: Frame, depth_func: str = "<=") -> npt.NDArray[np.float32]:
    """(h, w) sums of weights, top row first."""
    with volumes_of(frame) as volumes:
        volumes.draw(depth_func)
        return np.frombuffer(volumes.counts.read(), np.float32).reshape(frame.height, -1)[::-1]


def run_to_infinity(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(volume_pieces, "end_plane", lambda *_: None)


@pytest.mark.parametrize("layers", [255, 256, 257, 512])
@pytest.mark.parametrize("kind", KINDS)
def test_no_number_of_overlapping_volumes_overflows(gpu: Gpu, kind: LightKind, layers: int) -> None:
    heights = np.linspace(1.0, 2.0, layers)
    corners = np.array([[-1.0, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]])
    stack = Mesh(
        "stack",
        (corners + heights[:, None, None] * [0, 1, 0]).reshape(-1, 3),
        quads(np.arange(4 * layers).reshape(-1, 4)),
    )
    scene = Scene("stack", (floor(5.0, casts=False), stack))
    light, camera = light_of(kind, (0.01, 6, 0.02)), look_at((0, 0.7, 4), (0, 0, 0))
    assert_exact(verdict(gpu, scene, light, camera, (96, 72)))
    with framed(gpu, scene, light, camera, (96, 72)) as frame:
        on_floor = frame.read_surfaces().positions[..., 1] < 0.5
        assert counted(frame)[on_floor].max() == layers


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometry", CLASSES)
def test_caps_have_the_depth_bits_of_the_surfaces_they_lie_on(
    gpu: Gpu, monkeypatch: pytest.MonkeyPatch, geometry: str, kind: LightKind
) -> None:
    run_to_infinity(monkeypatch)
    # Near enough that the near plane cuts some of the casters.
    camera = replace(look_at((1.5, 1.0, 2.0), (0, 1, 0)), near_m=0.5)
    light = replace(light_of(kind, (0.0, 60, 0), (6.0, 0, 4.2)), outer_cone_rad=float(np.pi / 2))
    with framed(gpu, random_scene(geometry, 3), light, camera, SIZE) as frame:
        assert differing_depths(frame) == 0


def differing_depths(frame: Frame) -> int:
    """Texels whose depth differs when caps are drawn instead of surfaces; volumes must run to infinity."""
    gpu = frame.gpu
    depth = gpu.depth_texture(frame.width, frame.height)
    target = gpu.ctx.framebuffer(depth_attachment=depth)
    with volumes_of(frame) as volumes:
        # A face edge-on to the light has no cap but may be seen.
        assert volumes.pieces()[0] == np.count_nonzero(face_areas(frame))
        target.use()
        target.clear(depth=0.0)
        gpu.ctx.enable_only(moderngl.DEPTH_TEST)
        # Far caps lie at depth 0, infinitely far: they never pass, and only near caps are drawn.
        gpu.ctx.depth_func = ">"
        pieces = volumes._pieces
        pieces._block.bind_to_uniform_block(2)
        volume_pieces._bind(frame.world.vertex_buffer, pieces._caps)
        pieces._draw_caps.render_indirect(pieces._cap_command, moderngl.TRIANGLES, count=1)
        gpu.ctx.enable_only(moderngl.NOTHING)
    caps = np.frombuffer(depth.read(), np.uint32)
    surfaces = np.frombuffer(frame.depth.read(), np.uint32)
    gpu.release(target, depth)
    assert np.count_nonzero(surfaces) > 1000
    return int(np.count_nonzero(caps != surfaces))


def face_areas(frame: Frame) -> Array:
    corners = frame.world.positions.astype(np.float64)[frame.world.triangles]
    areas: Array = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return areas


def shaded_by(scene: Scene, point: Array, light: Light) -> int:
    """How many casting triangles cut the way from `point` to the light, by Moeller and Trumbore, float64."""
    corners = world_triangles(scene)
    along = light.homogeneous[:3] - light.homogeneous[3] * point
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(along, second)
    determinant = np.einsum("ij,ij->i", first, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        offset = point - corners[:, 0]
        u = np.einsum("ij,ij->i", offset, across) / determinant
        turned = np.cross(offset, first)
        v = turned @ along / determinant
        t = np.einsum("ij,ij->i", second, turned) / determinant
        ends = 1.0 if light.homogeneous[3] else np.inf
        return int(np.count_nonzero((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (t < ends)))


@pytest.mark.parametrize("end", ["plane", "infinity"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometry", CLASSES)
def test_volumes_are_watertight(
    gpu: Gpu, monkeypatch: pytest.MonkeyPatch, geometry: str, kind: LightKind, end: str
) -> None:
    # Without a depth test all crossings of a closed boundary cancel, but for the volumes that the eye is in.
    if end == "infinity":
        run_to_infinity(monkeypatch)
    for seed in SEEDS[:2]:
        scene, camera = random_scene(geometry, seed), random_camera(seed)
        light = replace(random_light(kind, seed), range_m=float("inf"))
        with framed(gpu, scene, light, camera, SIZE) as frame:
            inside = shaded_by(scene, np.array(camera.position), replace(light, kind=around(kind)))
            assert np.unique(counted(frame, "1")).tolist() == [inside]


def around(kind: LightKind) -> LightKind:
    return LightKind.DIRECTIONAL if kind is LightKind.DIRECTIONAL else LightKind.POINT


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometry", CLASSES)
def test_volumes_ended_on_a_plane_light_the_same_pixels_as_endless_ones(
    gpu: Gpu, monkeypatch: pytest.MonkeyPatch, geometry: str, kind: LightKind
) -> None:
    # The far parts of a side have other slopes, so that its near parts may be rounded to the next pixel.
    judged, differing = 0, 0
    for seed in SEEDS:
        light = replace(random_light(kind, seed), range_m=float("inf"))
        with framed(gpu, random_scene(geometry, seed), light, random_camera(seed), SIZE) as frame:
            domain = frame.read_domain()
            ended = counted(frame)
            with monkeypatch.context() as patch:
                run_to_infinity(patch)
                endless = counted(frame)
        judged += int(domain.sum())
        differing += int(np.count_nonzero(((ended > 0.5) != (endless > 0.5)) & domain))
    assert differing <= tolerances.VOLUME_END_SHARE * judged


def street(kind: LightKind = LightKind.POINT) -> tuple[Scene, Light]:
    """Boxes on a floor, and a light above them."""
    boxes = [box((x, 0.6, z), (0.4, 0.6, 0.3)) for x in (-2.0, 0.0, 2.0) for z in (-2.0, 0.5)]
    return Scene("boxes", (floor(6.0), *boxes)), light_of(kind, (1.0, 5.0, 2.0))


@pytest.mark.parametrize("kind", KINDS)
def test_the_eye_may_be_inside_volumes(gpu: Gpu, kind: LightKind) -> None:
    roof = plane((0, 1, 0), 2.0, cells=4)
    scene, light = street(kind)
    scene = replace(scene, meshes=(*scene.meshes, moved(roof, placed(offset=(0.0, 2.5, 0)))))
    eye = np.array([0.1, 1.8, 1.2])
    assert shaded_by(scene, eye, replace(light, kind=around(kind))) > 0
    assert_exact(verdict(gpu, scene, light, look_at(eye, (0.5, 0.3, -1.0))))


@pytest.mark.parametrize("kind", KINDS)
def test_the_near_plane_may_cut_casters_and_their_volumes(gpu: Gpu, kind: LightKind) -> None:
    scene, light = street(kind)
    for near in (0.3, 1.0, 2.5):
        camera = replace(look_at((0.5, 1.4, 1.8), (0, 0.5, 0)), near_m=near)
        assert_exact(verdict(gpu, scene, light, camera))


@pytest.mark.parametrize("kind", [LightKind.SPOT, LightKind.POINT])
def test_a_light_may_stand_in_view(gpu: Gpu, kind: LightKind) -> None:
    scene, _ = street()
    light = light_of(kind, (0.4, 1.6, -0.6), (0.0, 0, -1.5))
    assert_exact(verdict(gpu, scene, light, look_at((0, 3, 6), (0, 0.5, 0))))


@pytest.mark.parametrize("height", [1e-6, -1e-6, 1e-4, 0.0])
def test_a_light_may_all_but_touch_a_faces_plane(gpu: Gpu, height: float) -> None:
    scene, _ = street()
    # Level with the tops of the boxes, where every top is edge-on.
    light = light_of(LightKind.POINT, (4.5, 1.2 + height, 0.7))
    camera = look_at((0.5, 4, 5), (0, 0.5, 0))
    mask, surfaces, domain = render_mask(gpu, scene, light, camera, SIZE, "shadow_volume", {})
    clear = domain & (incidence(surfaces, light) > tolerances.GRAZING)
    assert_exact(judge(scene, mask, surfaces, clear, light, camera))


@pytest.mark.parametrize("kind", KINDS)
def test_a_caster_may_cross_the_eyes_plane(gpu: Gpu, kind: LightKind) -> None:
    scene, light = street(kind)
    bar = box((0, 1.9, 3.0), (0.1, 0.1, 6.0))
    scene = replace(scene, meshes=(*scene.meshes, bar))
    assert_exact(verdict(gpu, scene, light, look_at((0.05, 1.2, 3.0), (0, 0.8, -3))))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("kind", KINDS)
def test_an_open_plane_is_lit_in_front_and_dark_behind(gpu: Gpu, kind: LightKind, side: int) -> None:
    sheet = moved(plane((0, side, 0), 1.0, cells=3), placed(offset=(0.0, 1.0, 0)))
    scene, light = Scene("sheet", (floor(6.0), sheet)), light_of(kind, (0.3, 5, 0.2))
    from_above = render_mask(gpu, scene, light, look_at((0, 3, 4), (0, 1, 0)), SIZE, "shadow_volume", {})
    on_sheet = from_above[1].covered & (from_above[1].positions[..., 1] > 0.5)
    assert on_sheet.sum() > 1000
    assert (from_above[0][on_sheet] == 1).all()
    from_below = render_mask(gpu, scene, light, look_at((0, 0.2, 4), (0, 1, 0)), SIZE, "shadow_volume", {})
    beneath = from_below[1].covered & (from_below[1].positions[..., 1] > 0.5)
    assert beneath.sum() > 1000
    assert (from_below[0][beneath] == 0).all()
    assert_exact(verdict(gpu, scene, light, look_at((0, 3, 4), (0, 0, 0))))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("surface", [klein_bottle(), moebius_strip()], ids=lambda mesh: mesh.name)
def test_surfaces_with_one_side_cast(gpu: Gpu, kind: LightKind, surface: Mesh) -> None:
    scene = Scene(surface.name, (floor(6.0), moved(surface, placed(offset=(0.0, 1.6, 0.0)))))
    for eye in ((0.0, 4.0, 5.0), (1.5, 1.6, 0.9)):
        assert_exact(verdict(gpu, scene, light_of(kind, (1.0, 6.0, 2.0)), look_at(eye, (0, 0.8, 0))))


PLACES = [(1e-3, 0.0), (1e-2, 0.0), (1e2, 0.0), (1e3, 0.0), (1.0, 1e4), (1e-3, 1e2)]


@pytest.mark.parametrize(("scale", "offset"), PLACES)
@pytest.mark.parametrize("kind", KINDS)
def test_neither_size_nor_place_matters(gpu: Gpu, kind: LightKind, scale: float, offset: float) -> None:
    turn = Rotation.from_euler("xyz", [0.3, -0.5, 0.7])
    placement = placed(scale, turn, np.array([offset, -offset, 0.3 * offset]))
    scene, light = street(kind)
    scene = replace(scene, meshes=tuple(moved(mesh, placement) for mesh in scene.meshes))
    camera = look_at((0.5, 3, 5), (0, 0.5, 0))
    light = replace(
        light,
        position=tuple((placement @ [*light.position, 1])[:3]),
        direction=tuple(turn.apply(light.direction)),
    )
    camera = replace(
        camera,
        position=tuple((placement @ [*camera.position, 1])[:3]),
        forward=tuple(turn.apply(camera.forward)),
        up=tuple(turn.apply(camera.up)),
        near_m=camera.near_m * scale,
    )
    assert_exact(verdict(gpu, scene, light, camera))


def test_a_caster_out_of_range_or_cone_costs_nothing(gpu: Gpu) -> None:
    scene, _ = street()
    lamp = replace(
        light_of(LightKind.SPOT, (0.0, 1.4, 0.5), (0.0, 0, 0.5)), inner_cone_rad=0.1, outer_cone_rad=0.2
    )
    camera = look_at((0.5, 3, 5), (0, 0.5, 0))
    with framed(gpu, scene, lamp, camera, SIZE) as frame, volumes_of(frame) as volumes:
        # The floor, and the one box beneath the lamp.
        assert volumes.pieces()[0] <= 2 + 12
    near = replace(lamp, kind=LightKind.POINT, range_m=0.3)
    with framed(gpu, scene, near, camera, SIZE) as frame, volumes_of(frame) as volumes:
        assert volumes.pieces()[0] == 2
