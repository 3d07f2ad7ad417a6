from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from renderers.context import DeviceLimits, Gpu
from renderers.map_back_faces import mirrors
from renderers.registry import technique
from renderers.settings import Settings
from scenes.frusta import light_axes
from scenes.scene import Array, Light, LightKind, Mesh, Scene
from tests import tolerances
from tests.oracle import judge
from tests.random_scenes import look_at, random_camera, random_light
from tests.rendering import render_mask
from tests.solids import box, floor, moved

KINDS = list(LightKind)
ROOMY = DeviceLimits(max_texture_side=16384, max_buffer_bytes=2**30)
BACK: Settings = {"map_size": 512, "filter": "2x2", "map_faces": "back"}


def flipped(mesh: Mesh) -> Mesh:
    """The same faces, seen from the other side."""
    return replace(mesh, triangles=mesh.triangles[:, ::-1])


def mirrored(mesh: Mesh) -> Mesh:
    """The same body, as a mirrored placement of its mirror image."""
    flip = np.diag([-1.0, 1, 1, 1])
    turned = Mesh(mesh.name, mesh.positions @ flip[:3, :3].astype("f4"), mesh.triangles[:, ::-1])
    return moved(turned, flip)


def closed_scene(seed: int) -> Scene:
    """Boxes above a slab: as they are, inside out, in mirrored placements, and both."""
    random = np.random.default_rng([seed, 5])
    boxes = [
        box(
            (random.uniform(-3, 3), random.uniform(0.4, 3), random.uniform(-3, 3)),
            random.uniform(0.2, 0.9, 3),
            Rotation.from_quat(random.normal(size=4)),
        )
        for _ in range(12)
    ]
    changes = [lambda mesh: mesh, flipped, mirrored, lambda mesh: flipped(mirrored(mesh))]
    slab = box((0, -0.5, 0), (6, 0.5, 6))
    # What casts nothing may be open; a mesh may be placed as it is and as its mirror image.
    rug = floor(2.0, height=0.05, casts=False)
    twins = replace(boxes[0], placements=np.stack([np.eye(4), np.diag([-1.0, 1, 1, 1])]))
    return Scene("closed", (rug, slab, twins, *(changes[i % 4](mesh) for i, mesh in enumerate(boxes))))


@pytest.mark.parametrize("name", ["shadow_map", "perspective_shadow_map"])
@pytest.mark.parametrize("kind", KINDS)
def test_back_faces_cast_what_whole_bodies_cast(gpu: Gpu, kind: LightKind, name: str) -> None:
    judged, wrong, shadowed = 0, 0, 0
    for seed in range(6):
        scene, light, camera = closed_scene(seed), random_light(kind, seed), random_camera(seed)
        if technique(name).refuses(light, scene, ROOMY, BACK) is not None:
            continue
        mask, seen, domain = render_mask(gpu, scene, light, camera, (160, 120), name, BACK)
        found = judge(scene, mask, seen, domain, light, camera)
        wrong, judged = wrong + int(found.wrong.sum()), judged + found.domain_px
        shadowed += int((mask[domain] < 0.5).sum())
    assert shadowed > 0.03 * judged > 500
    assert wrong <= tolerances.SAMPLED_WRONG / 512 * judged, (wrong, judged)


@pytest.mark.parametrize("kind", KINDS)
def test_lit_faces_need_no_bias_but_on_their_rims(gpu: Gpu, kind: LightKind) -> None:
    # A lone convex body shadows nothing that faces the light, at any slope. Within a texel of its outline the
    # filter reads a back face that is nearer than what lies inside of it.
    for seed in range(4):
        turn = Rotation.from_quat(np.random.default_rng(seed).normal(size=4))
        scene, light = Scene("lone", (box((0, 1, 0), (1.5, 1, 1), turn),)), random_light(kind, seed)
        unbiased = {"bias_slope": 0, "bias_units": 0, "bias_normal": 0}
        shares = {}
        for faces in ("back", "both"):
            settings = {"map_size": 256, "filter": "2x2", "map_faces": faces, **unbiased}
            mask, _, domain = render_mask(
                gpu, scene, light, look_at(light.position, (0, 1, 0)), (96, 72), "shadow_map", settings
            )
            shares[faces] = float((mask[domain] < 1).mean())
        assert shares["back"] <= tolerances.BACK_FACE_RIM
        assert shares["both"] > 0.2


def test_light_leaks_at_the_foot_of_what_stands_in_the_floor(gpu: Gpu) -> None:
    # The block's far side goes on below the floor: within a texel of its foot the map holds a place down
    # there, behind the floor. Its near side is metres off.
    block = box((0, 0.75, 0), (2, 1, 1))
    scene = Scene("block", (box((0, -0.5, 0), (6, 0.5, 6)), block))
    sun = Light("sun", LightKind.DIRECTIONAL, direction=(0.0, -0.6, 0.8))
    camera = look_at((0, 2, 3.5), (0, 0, 1))
    lit = {}
    for faces in ("both", "back"):
        settings = {"map_size": 64, "filter": "2x2", "map_faces": faces}
        mask, seen, domain = render_mask(gpu, scene, sun, camera, (320, 240), "shadow_map", settings)
        x, y, z = np.moveaxis(seen.positions, -1, 0)
        foot = domain & (np.abs(x) < 1.5) & (np.abs(y) < 0.01) & (z > 1) & (z < 1.1)
        assert foot.sum() > 200
        lit[faces] = float(mask[foot].mean())
    assert lit["both"] == 0
    assert lit["back"] > 0.05


def refusal(scene: Scene, light: Light) -> str | None:
    return technique("SM").refuses(light, scene, ROOMY, BACK)


def test_open_meshes_are_refused() -> None:
    reason = refusal(Scene("open", (floor(3.0), box((0, 1, 0), (1, 1, 1)))), random_light(LightKind.SPOT, 0))
    assert reason is not None
    assert '4 edges of "sheet"' in reason
    assert refusal(Scene("silent", (floor(3.0, casts=False),)), random_light(LightKind.SPOT, 0)) is None


@pytest.mark.parametrize("change", [lambda mesh: mesh, flipped, mirrored])
def test_a_body_around_the_light_is_refused(change: object) -> None:
    assert callable(change)
    scene = Scene("room", (change(box((0, 0, 0), (2, 2, 2))),))
    lamp = Light("lamp", LightKind.POINT, (0.5, 0.5, 0.5))
    reason = refusal(scene, lamp)
    assert reason is not None
    assert "encloses" in reason
    assert refusal(scene, replace(lamp, position=(0.5, 2.5, 0.5))) is None
    assert refusal(scene, Light("sun", LightKind.DIRECTIONAL)) is None


@pytest.mark.parametrize("seed", range(5))
def test_a_mirrored_face_is_told_by_what_it_shows(seed: int) -> None:
    random = np.random.default_rng(seed)
    light = random_light(LightKind.SPOT, seed)
    right, up, forward = light_axes(light)
    local = np.vstack([np.hstack([np.stack([right, up, forward]), np.zeros((3, 1))]), [0, 0, 0, 1]])
    local[:3, 3] = -local[:3, :3] @ np.asarray(light.position)
    # z is 1 over the distance, reversed.
    face = np.array([local[0], local[1], [0.0, 0, 0, 1], local[2]])
    corners = np.asarray(light.position) + random.uniform(1, 3) * forward
    corners = corners + np.array([np.zeros(3), right, up])
    assert signed_area(face, corners) > 0
    assert facing(corners, light)
    assert not mirrors(face)
    assert mirrors(np.diag([-1.0, 1, 1, 1]) @ face)


def signed_area(face: Array, corners: Array) -> float:
    q = np.hstack([corners, np.ones((3, 1))]) @ face.T
    a, b, c = q[:, :2] / q[:, 3:]
    return float(np.cross(np.append(b - a, 0), np.append(c - a, 0))[2])


def facing(corners: Array, light: Light) -> bool:
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return bool(normal @ (np.asarray(light.position) - corners[0]) > 0)
