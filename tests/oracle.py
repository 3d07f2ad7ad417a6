"""What a mask should be, from rays: which pixels are wrong, and how near they lie to a true shadow edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import distance_transform_edt

from renderers.frame import Mask, Surfaces
from scenes.ray_caster import RayCaster
from scenes.scene import Array, Camera, Light, Scene
from tests import tolerances
from tests.solids import world_triangles

Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Verdict:
    """How a mask differs from the truth.

    Attributes:
        domain_px: Pixels that were judged.
        wrong: (h, w) bool.
        far: (h, w) bool: wrong, farther than a pixel from every true shadow edge, not grazing the light, and
            not on an edge of the very triangle that is seen.
    """

    domain_px: int
    wrong: Bools
    far: Bools

    @property
    def wrong_share(self) -> float:
        """Wrong pixels over judged ones."""
        return float(self.wrong.sum() / max(self.domain_px, 1))


def judge(
    scene: Scene, mask: Mask, surfaces: Surfaces, domain: Bools, light: Light, camera: Camera
) -> Verdict:
    """Compare a mask with what the light sees, in the pixels of the domain."""
    rays = RayCaster(scene)
    lit = np.zeros(mask.shape, bool)
    lit[domain] = rays.lit(
        surfaces.positions[domain],
        surfaces.normals[domain],
        light,
        position_error=_rounding(surfaces.positions[domain], camera),
    )
    wrong = domain & ((mask > 0.5) != lit)
    far = wrong & ~_near_edge(lit, domain) & (incidence(surfaces, light) >= tolerances.GRAZING)
    for row, column in np.argwhere(far):
        place = (int(row), int(column))
        far[place] = not (
            _edge_within_a_pixel(rays, surfaces, place, light, camera)
            or _on_a_mesh_edge(scene, surfaces, place, camera)
        )
    return Verdict(int(domain.sum()), wrong, far)


def _rounding(points: Array, camera: Camera) -> Array:
    """(n,) metres by which float32 view depth leaves points off their surface."""
    distance: Array = np.linalg.norm(points - camera.position, axis=1)
    return tolerances.VIEW_DEPTH * distance


def _near_edge(lit: Bools, domain: Bools) -> Bools:
    """Pixels that touch one of the other kind, at a side or a corner."""
    other = np.where(lit, _distance_to(domain & ~lit), _distance_to(domain & lit))
    near: Bools = other <= np.sqrt(2) + 1e-6
    return near


def _distance_to(there: Bools) -> Array:
    if not there.any():
        return np.full(there.shape, np.inf)
    distance: Array = distance_transform_edt(~there)
    return distance


def incidence(surfaces: Surfaces, light: Light) -> Array:
    """(h, w) float64: |cosine| of the angle between the surface's normal and the light."""
    to_light = light.homogeneous[:3] - light.homogeneous[3] * surfaces.positions
    lengths = np.linalg.norm(to_light, axis=-1)
    cosine: Array = np.abs(np.einsum("ijk,ijk->ij", surfaces.normals, to_light)) / lengths
    return cosine


def _pixel_at(position: Array, camera: Camera, height: int) -> float:
    distance = float((position - camera.position) @ np.asarray(camera.forward))
    return 2 * np.tan(camera.yfov_rad / 2) * distance / height


def _on_a_mesh_edge(scene: Scene, surfaces: Surfaces, place: tuple[int, int], camera: Camera) -> bool:
    """Whether the middle of the pixel lies on an edge of a casting triangle.

    There the side of a volume starts from the surface itself, and rounding decides where it counts.
    """
    position = surfaces.positions[place]
    corners = world_triangles(scene)
    start, along = corners.reshape(-1, 3), (np.roll(corners, -1, axis=1) - corners).reshape(-1, 3)
    squared = np.einsum("ij,ij->i", along, along)
    share = np.einsum("ij,ij->i", position - start, along) / np.where(squared > 0, squared, 1)
    distance = np.linalg.norm(position - start - np.clip(share, 0, 1)[:, None] * along, axis=1)
    pixel = _pixel_at(position, camera, surfaces.covered.shape[0])
    return bool(distance.min() <= tolerances.ON_EDGE_PX * pixel)


def _edge_within_a_pixel(
    rays: RayCaster, surfaces: Surfaces, place: tuple[int, int], light: Light, camera: Camera
) -> bool:
    """Whether the truth changes on the pixel's own surface within one pixel of its middle.

    A shadow thinner than a pixel has an edge near a pixel though no pixel shows it.
    """
    position, normal = surfaces.positions[place], surfaces.normals[place]
    eye = np.asarray(camera.position)
    pixel = _pixel_at(position, camera, surfaces.covered.shape[0])
    right = np.cross(camera.forward, camera.up)
    angles = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    radii = pixel * np.linspace(0, 1, 25)
    across, up = (np.ravel(radii[:, None] * turn(angles)) for turn in (np.cos, np.sin))
    directions = position - eye + across[:, None] * right + up[:, None] * np.asarray(camera.up)
    steps = (normal @ (position - eye)) / (directions @ normal)
    points = eye + steps[:, None] * directions
    seen = rays.lit(
        points, np.broadcast_to(normal, points.shape), light, position_error=_rounding(points, camera)
    )
    return bool(seen.any() and not seen.all())
