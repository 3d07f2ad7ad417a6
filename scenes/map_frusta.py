"""How a shadow map looks at its receivers: one matrix for each face of the map.

Near and far planes fit the receivers, not the casters: a caster nearer than the near plane is flattened onto
it by depth clamp and still casts. Guard texels around each face keep comparisons inside it.

Depth is 1 at the near plane and 0 at the far plane. The other way round, z and w of a distant point are
nearly equal and round apart: a floor a thousand times wider than the light is high then shadows itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scenes.convex import NOTHING, Body
from scenes.frusta import light_axes
from scenes.scene import Array, Light, LightKind

DEPTH_MARGIN = 0.02
# Of the far distance. A caster that is nearer still casts.
NEAREST = 1e-3
# Beyond, a single perspective map wastes most texels on the rim; six faces do better.
WIDEST_SINGLE_RAD = np.radians(75.0)
# A cone without width still needs a map that has one.
NARROWEST_RAD = 1e-6
# Of a window's distance from the axis: receivers on one line still need a map that has an area.
NARROWEST_WINDOW = 1e-6
# Of the whole body: a face that shows nothing but the light's own place, rounded, shows nothing.
POINT_SIZED = 1e-9


@dataclass(frozen=True)
class MapFit:
    """Faces of a map.

    Attributes:
        faces: (k, 4, 4) float64 clip from scene; one, or six in the order +X -X +Y -Y +Z -Z. All zeros for
            a face that shows nothing.
    """

    faces: Array


def faces_of(light: Light) -> int:
    """How many faces a map for `light` has: 6 for a point light or a very wide spot, else 1."""
    wide = light.kind is LightKind.SPOT and light.outer_cone_rad > WIDEST_SINGLE_RAD
    return 6 if wide or light.kind is LightKind.POINT else 1


def cube_axes(face: int) -> Array:
    """(3, 3) float64 rows right, up, forward of a cube's face."""
    axis = face // 2
    return np.stack(
        [np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3], np.eye(3)[axis] * (1 - 2 * (face % 2))]
    )


def face_bodies(light: Light, centre: Array, body: Body) -> list[Body]:
    """The part of `body` that each face of the light's map shows."""
    if faces_of(light) == 1:
        return [body]
    parts = [body.cut(_pyramid(cube_axes(face), centre)) for face in range(6)]
    return [part if _spread(part) > POINT_SIZED * _spread(body) else NOTHING for part in parts]


def fit_map(light: Light, centre: Array, body: Body, shrink: float, *, whole: bool = False) -> MapFit:
    """The faces of a map that cover what `light` can light of `body`; see `fit_faces`."""
    return fit_faces(light, centre, face_bodies(light, centre, body), shrink, whole=whole)


def fit_faces(
    light: Light, centre: Array, bodies: Sequence[Body], shrink: float, *, whole: bool = False
) -> MapFit:
    """The faces of a map that cover what `light` can light of each face's body.

    Args:
        light: The light.
        centre: (3,) float64 its position in scene space; anything for a directional light.
        bodies: What holds the receivers of each face, scene space.
        shrink: Share of a face's side that is left between its guard texels.
        whole: Whether a face covers its whole cone or cube side, receivers or not. Its depth fits
            the bodies all the same.
    """
    shown = [(face, body.corners) for face, body in enumerate(bodies) if len(body.corners)]
    if not shown:
        return MapFit(np.zeros((0, 4, 4)))
    faces = np.zeros((len(bodies), 4, 4))
    for face, receivers in shown:
        if light.kind is LightKind.DIRECTIONAL:
            faces[face] = _orthographic(light_axes(light), receivers, shrink)
        else:
            six = len(bodies) > 1
            axes = cube_axes(face) if six else light_axes(light)
            slope = 1.0 if six else float(np.tan(max(light.outer_cone_rad, NARROWEST_RAD)))
            faces[face] = _face(axes, centre, receivers, slope, shrink, whole=whole)
    return MapFit(faces)


def _spread(body: Body) -> float:
    return float(np.ptp(body.corners, axis=0).max()) if len(body.corners) else 0.0


def _pyramid(axes: Array, centre: Array) -> Array:
    right, up, forward = axes
    normals = np.array([forward + right, forward - right, forward + up, forward - up])
    return np.hstack([normals, -(normals @ centre)[:, None]])


def _orthographic(axes: Array, receivers: Array, shrink: float) -> Array:
    local = receivers @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    margin = DEPTH_MARGIN * (high[2] - low[2])
    near, far = low[2] - margin, high[2] + margin
    face = np.zeros((4, 4))
    for axis in (0, 1):
        scale = 2 * shrink / (high[axis] - low[axis])
        face[axis, :3] = scale * axes[axis]
        face[axis, 3] = -scale * (high[axis] + low[axis]) / 2
    face[2, :3] = -axes[2] / (far - near)
    face[2, 3] = far / (far - near)
    face[3, 3] = 1
    return face


def _face(axes: Array, centre: Array, receivers: Array, slope: float, shrink: float, *, whole: bool) -> Array:
    """A perspective face; `slope` is the tangent of its half angle, zeros if nothing lies ahead of it."""
    local = (receivers - centre) @ axes.T
    far = float(local[:, 2].max())
    ahead = local[local[:, 2] > 1e-6 * far]
    if far <= 0:
        return np.zeros((4, 4))
    window = np.array([[-slope, -slope], [slope, slope]])
    if not whole:
        ratios = ahead[:, :2] / ahead[:, 2:]
        window = np.clip(np.stack([ratios.min(axis=0), ratios.max(axis=0)]), *window)
        thin = NARROWEST_WINDOW * slope
        window = np.where(window[1] - window[0] > thin, window, window + np.array([[-thin], [thin]]))
    return _perspective(axes, centre, window, (float(local[:, 2].min()), far), shrink)


def _perspective(
    axes: Array, centre: Array, window: Array, depths: tuple[float, float], shrink: float
) -> Array:
    """Off-centre perspective; `window` is (2, 2): lowest and highest (x, y) at distance 1."""
    far = depths[1] * (1 + DEPTH_MARGIN)
    near = max(depths[0] * (1 - DEPTH_MARGIN), NEAREST * far)
    local = np.hstack([axes, -(axes @ centre)[:, None]])
    middle, half = (window[0] + window[1]) / 2, (window[1] - window[0]) / 2
    face = np.zeros((4, 4))
    for axis in (0, 1):
        face[axis] = shrink / half[axis] * (local[axis] - middle[axis] * local[2])
    face[2] = -local[2] * near / (far - near)
    face[2, 3] += near * far / (far - near)
    face[3] = local[2]
    return face
