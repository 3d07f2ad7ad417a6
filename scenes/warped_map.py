"""Picks, for each face of a light's map, the warp whose texels look smallest on the screen, or none.

A light that shines towards the viewer undoes the camera's perspective, and near the eye there is little to
gain: then the ordinary map is the better one, and the choice says so.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from scenes.convex import Body
from scenes.scene import Array
from scenes.texel_footprint import screen_footprints, weighted_percentile

# A warp has to promise texels this much smaller than the ordinary map's, in the 95th percentile.
WORTHWHILE = 0.9
PERCENT = 95.0
WIDEST_CONE_RAD = np.radians(75.0)
# Smallest w over largest: beyond, the warp spends its texels on a spot before the eye.
STEEPEST = 1e-3
# More probes change the percentile by a per cent or two.
MOST_PROBES = 256
# Where eye and light look at each other no plane is seen by both; any normal will do.
FACING_AWAY = np.array([0.0, 1e-6, 0.0])


@dataclass(frozen=True)
class Sight:
    """A camera's view and what it shows of a light's receivers.

    Attributes:
        eye: (3,) float64 scene space.
        light: (4,) float64 homogeneous, scene space.
        eye_from_scene: (4, 4) float64.
        clip_from_scene: (4, 4) float64.
        size: Width and height in pixels.
        points: (n, 3) float64 probes on surfaces that are seen and may be lit, scene space.
        normals: (n, 3) float64 unit.
        weights: (n,) float64 share of the view of each.
    """

    eye: Array
    light: Array
    eye_from_scene: Array
    clip_from_scene: Array
    size: tuple[int, int]
    points: Array
    normals: Array
    weights: Array

    def inside(self, body: Body) -> Sight:
        """The same, with the probes inside `body` only, and no more of them than are needed.

        Where there are none, which happens to a close look into a large level, places in the body stand for
        them, each on a plane that eye and light see alike.
        """
        planes = body.planes
        kept = np.flatnonzero((self.points @ planes[:, :3].T + planes[:, 3] >= 0).all(axis=1))
        kept = kept[:: -(-len(kept) // MOST_PROBES) or 1]
        if len(kept):
            return replace(
                self, points=self.points[kept], normals=self.normals[kept], weights=self.weights[kept]
            )
        points = (body.corners + body.corners.mean(axis=0)) / 2
        towards = [self.eye - points, self.light[:3] - self.light[3] * points]
        halfway = sum(one / np.linalg.norm(one, axis=1, keepdims=True) for one in towards) + FACING_AWAY
        normals = halfway / np.linalg.norm(halfway, axis=1, keepdims=True)
        return replace(self, points=points, normals=normals, weights=np.ones(len(points)))

    def texel_px(self, maps: Array, side: int) -> Array:
        """(k,) float64 pixels: 95th percentile of a texel's longest extent on each of (k, 3, 4) maps."""
        extents = screen_footprints(self.points, self.normals, maps, side, self.clip_from_scene, self.size)
        return weighted_percentile(extents, self.weights, PERCENT)


@dataclass(frozen=True)
class Maps:
    """Maps to choose from.

    Attributes:
        rows: (k, 3, 4) float64 x, y and w of clip from scene.
        usable: (k,) bool: whether the receivers lie well inside.
        finish: The (4, 4) clip from scene of the map with a given index.
    """

    rows: Array
    usable: npt.NDArray[np.bool_]
    finish: Callable[[int], Array]


@dataclass(frozen=True)
class Choice:
    """Faces of a map.

    Attributes:
        faces: (f, 4, 4) float64 clip from scene.
        shown: How many show anything.
        share: Share of the view that lies on warped faces.
        note: Why some are not warped.
    """

    faces: Array
    shown: int
    share: float
    note: str


def choose_faces(
    ordinary: Array,
    bodies: Sequence[Body],
    sight: Sight,
    side: int,
    maps_of: Callable[[Body], Maps],
    *,
    always: bool,
) -> Choice:
    """For each face its best warped map, or the ordinary one where no warp is worthwhile.

    Args:
        ordinary: (f, 4, 4) float64 faces without warp; all zeros where nothing is shown.
        bodies: The receivers of each face.
        sight: The view.
        side: Texels along a face.
        maps_of: The warped maps to choose from.
        always: Whether a usable warp is taken even if it promises nothing.
    """
    faces, note = ordinary.copy(), ""
    warped, weights = [], []
    shown = [index for index, face in enumerate(ordinary) if face.any()]
    for index in shown:
        seen = sight.inside(bodies[index])
        chosen = _chosen(ordinary[index], bodies[index], seen, side, maps_of, always=always)
        weights.append(float(seen.weights.sum()))
        warped.append(not isinstance(chosen, str))
        if isinstance(chosen, str):
            note = chosen
        else:
            faces[index] = chosen
    total = sum(weights)
    share = sum(weight for weight, is_warped in zip(weights, warped, strict=True) if is_warped)
    if len(shown) > 1 and not all(warped):
        helped = f"only {sum(warped)}" if any(warped) else "none"
        note = f"a warp helps {helped} of {len(shown)} faces ({100 * share / total:.0f} % of the view)"
    return Choice(faces, len(shown), share / total if total else 0.0, note)


def _chosen(
    ordinary: Array, body: Body, sight: Sight, side: int, maps_of: Callable[[Body], Maps], *, always: bool
) -> Array | str:
    maps = maps_of(body)
    if not maps.usable.any():
        return "the receivers surround the light as the camera's perspective shows them"
    *warped, usual = sight.texel_px(np.concatenate([maps.rows, ordinary[None, [0, 1, 3]]]), side)
    promised = np.where(maps.usable, warped, np.inf)
    best = int(promised.argmin())
    if not always and not promised[best] < WORTHWHILE * usual:
        return f"the warp would not help: texels of {promised[best]:.1f} px instead of {usual:.1f} px"
    return maps.finish(best)
