"""The pieces of shadow volumes found on the CPU, as engines did before compute shaders: all faces at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from renderers.world import World
from scenes.frusta import Reach, reach
from scenes.scene import Array, Light, Triangles
from scenes.topology import Counts, face_signs

Pieces = npt.NDArray[np.int32]


@dataclass(frozen=True)
class VolumeForm:
    """How the boundary of the volumes is put together.

    Attributes:
        variant: "general" makes volumes of all faces, "crow" of those alone whose front is lit (Crow 1977),
            "mixed" of those where a closed mesh allows it, and of all elsewhere.
        caps: Near and far ends are drawn, not the sides alone.
        per_triangle: Every face closes its own volume, instead of sides at silhouettes only.
        unit_weights: Sides of weight 1, turned and repeated as need be, for counters that add only ones.
        on_cpu: Pieces are found by NumPy and uploaded, instead of by compute shaders.
        extrusion: "receivers" ends volumes on a plane beyond all receivers where there is one, "infinite"
            never, "finite" after a fixed length.
    """

    variant: str = "general"
    caps: bool = True
    per_triangle: bool = False
    unit_weights: bool = False
    on_cpu: bool = False
    extrusion: str = "receivers"


def silhouette_pieces(
    world: World, light: Light, form: VolumeForm, least: int | Pieces
) -> tuple[Pieces, Pieces]:
    """Caps (c, 4) int32: corners, weight; sides (s, 4) int32: two vertices, weight, 0.

    Lesser signs of faces than `least`, one for all or (t,), are raised to it.

    The same formulas as `shadow_volume.glsl`, on the same float32 positions but in float64: only faces that
    lie in the light's plane to within float32 get another sign.
    """
    triangles = world.triangles[: world.caster_count]
    corners = world.positions[triangles].astype(np.float64)
    signs = face_signs(corners, _homogeneous(light, world.origin))
    signs = np.maximum(signs, least).astype(np.int8)
    signs[_out_of_reach(corners, reach(light, world.origin))] = 0
    kept = signs != 0
    caps = np.column_stack([triangles, signs])[kept]
    if form.per_triangle:
        ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2)[kept].reshape(-1, 2)
        sides = _weighted(ends, np.repeat(signs[kept].astype(np.int64), 3))
    else:
        sides = _weighted(world.topology.edges, world.topology.multiplicities(signs))
    return caps.astype(np.int32), _units(sides) if form.unit_weights else sides


def _homogeneous(light: Light, origin: Array) -> Array:
    homogeneous = light.homogeneous
    homogeneous[:3] -= homogeneous[3] * origin
    return homogeneous.astype(np.float32).astype(np.float64)


def _out_of_reach(corners: Array, within: Reach) -> npt.NDArray[np.bool_]:
    heights = corners @ within.planes[:, :3].T + within.planes[:, 3]
    nearest = np.clip(within.centre, corners.min(axis=1), corners.max(axis=1))
    too_far = np.linalg.norm(nearest - within.centre, axis=1) > within.range_m
    outside: npt.NDArray[np.bool_] = too_far | (heights.max(axis=1) < 0).any(axis=1)
    return outside


def _weighted(ends: Triangles, weights: Counts) -> Pieces:
    kept = weights != 0
    return np.column_stack([ends[kept], weights[kept], np.zeros(int(kept.sum()))]).astype(np.int32)


def _units(sides: Pieces) -> Pieces:
    turned = np.where(sides[:, 2:3] < 0, sides[:, 1::-1], sides[:, :2])
    repeated = np.repeat(turned, np.abs(sides[:, 2]), axis=0)
    return _weighted(repeated, np.ones(len(repeated), np.int64))
