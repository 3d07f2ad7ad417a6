"""Where in a level one can be: not inside walls, and not outside the hull of a level that is closed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.ray_caster import Bools, RayCaster
from scenes.scene import Array, LightKind, Scene

_RAYS = 64
_MOST_ANCHORS = 256
_NEAREST = 16  # anchors that a place is tried to be joined with
_SEALED = 0.02  # of the rays: so few leave a level that is closed, through cracks
_OUTSIDE = 0.1  # of the rays: where more leave such a level, one is outside
_TURNED_AWAY = (
    0.75  # of what is struck: in walls of the four Quake levels 0.86 and more, in pools at most 0.6
)
_WOUND_WELL = 0.25  # the same, of the median anchor: beyond, the level's winding says nothing
_STOPS = 0.5, 0.95  # of the free path: where it is tried
_LIFT = 1e-5  # of the extent: above its surface, where a place is judged


@dataclass(frozen=True)
class PlayableSpace:
    """What tells the inside of a level from the inside of its walls and from the void around it.

    Cameras and lamps hang in playable space, but for a few. What most of them see in 64 even directions says
    what the level is like:

    - Nearly no ray leaves it: it is sealed, as maps of shooters are. A place that more than a tenth of the
      rays leave is outside its hull. Without such a hull nothing is outside.
    - Nearly all faces are seen from their front: then a place from which nothing leaves, and where three
      quarters of the rays strike backs of faces, is inside a wall. Where winding says nothing, or all of the
      level is inside one closed shell, there is no such evidence. Faces that cast nothing, such as those of
      water, have no back.

    What a place in playable space sees is in it too, so free lines of sight carry on what is known of a lamp
    or a lit place.

    Attributes:
        caster: Of all meshes.
        anchors: (n, 3) cameras and lamps in playable space.
        sealed: Whether the level is closed.
        wound_well: Whether the backs of faces tell the inside of walls.
    """

    caster: RayCaster
    anchors: Array
    sealed: bool
    wound_well: bool

    @classmethod
    def of(cls, scene: Scene, caster: RayCaster) -> PlayableSpace:
        """The space of a scene.

        Args:
            scene: Without cameras and lamps nothing is outside, and nothing inside a wall.
            caster: Of this scene with `casters_only=False`.
        """
        lamps = [light.position for light in scene.lights if light.kind is not LightKind.DIRECTIONAL]
        cameras = [camera.position for camera in scene.cameras]
        anchors = np.array([*cameras, *lamps], float).reshape(-1, 3)
        if not len(anchors):
            return cls(caster, anchors, sealed=False, wound_well=False)
        # As many of them as tell what most are like.
        count = min(len(anchors), _MOST_ANCHORS)
        anchors = anchors[np.arange(count) * len(anchors) // count]
        leaving, backs = _seen(caster, anchors, _sphere()[None])
        sealed = bool(np.median(leaving) <= _SEALED)
        wound_well = bool(np.median(backs) <= _WOUND_WELL)
        inside = np.ones(count, bool)
        if sealed:
            inside &= leaving <= _OUTSIDE
        if wound_well:
            inside &= backs <= _WOUND_WELL
        return cls(caster, anchors[inside], sealed, wound_well)

    def shuts_in(self, point: Array) -> bool:
        """Whether a (3,) point in the air is inside a wall."""
        if not self.wound_well:
            return False
        leaving, backs = _seen(self.caster, point[None], _sphere()[None])
        return bool(_in_wall(leaving, backs)[0])

    def holds(self, points: Array, normals: Array) -> Bools:
        """(n,) bool: whether places on surfaces can be seen from playable space.

        Args:
            points: (n, 3) float64 world, metres.
            normals: (n, 3) unit, to the side from which they are to be seen.
        """
        inside = np.ones(len(points), bool)
        if not len(points) or not (self.sealed or self.wound_well):
            return inside
        leaving, backs = _seen(self.caster, self._lifted(points, normals), _hemispheres(normals))
        if self.sealed:
            inside &= leaving <= _OUTSIDE
        if self.wound_well:
            inside &= ~_in_wall(leaving, backs)
        return inside

    def joins(self, points: Array, normals: Array) -> Bools:
        """(n,) bool: whether from places on surfaces an anchor is seen, or on the way to what is seen.

        This tells closed rooms from closed gaps between their outer walls, into which a sun may shine through
        a crack. It is true of all places of a level without a hull.

        Args:
            points: (n, 3) float64 world, metres.
            normals: (n, 3) unit, to the side from which they are to be seen.
        """
        if not self.sealed or not len(points):
            return np.ones(len(points), bool)
        lifted, directions = self._lifted(points, normals), _hemispheres(normals)
        free, _ = self.caster.hits(
            np.broadcast_to(lifted[:, None], directions.shape).reshape(-1, 3), directions.reshape(-1, 3)
        )
        free = np.where(np.isfinite(free), free, 0.0).reshape(len(points), -1, 1)
        ways = [lifted[:, None] + share * free * directions for share in _STOPS]
        stops = np.concatenate([lifted[:, None], *ways], axis=1)
        offsets = np.linalg.norm(lifted[:, None] - self.anchors, axis=2)
        nearest = np.argsort(offsets, axis=1, kind="stable")[:, :_NEAREST]
        anchors = self.anchors[nearest]
        rays = anchors[:, None] - stops[:, :, None]
        lengths = np.linalg.norm(rays, axis=-1)
        rays[lengths == 0.0] = (0.0, 1.0, 0.0)
        free, _ = self.caster.hits(
            np.broadcast_to(stops[:, :, None], rays.shape).reshape(-1, 3), rays.reshape(-1, 3)
        )
        joined: Bools = (free.reshape(lengths.shape) >= lengths).any(axis=(1, 2))
        return joined

    def _lifted(self, points: Array, normals: Array) -> Array:
        lifted: Array = points + _LIFT * self.caster.extent * normals
        return lifted


def _in_wall(leaving: Array, backs: Array) -> Bools:
    inside: Bools = (leaving <= _OUTSIDE) & (backs > _TURNED_AWAY)
    return inside


def _hemispheres(normals: Array) -> Array:
    """(n, 64, 3) unit directions to the side of each normal."""
    directions = np.broadcast_to(_sphere(), (len(normals), _RAYS, 3))
    below = np.einsum("nki,ni->nk", directions, normals) < 0
    return np.where(below[..., None], -directions, directions)


def _sphere() -> Array:
    """(64, 3) unit directions, each for an equal area of the sphere (Swinbank and Purser 2006)."""
    index = np.arange(_RAYS)
    height = 1 - (2 * index + 1) / _RAYS
    around = np.sqrt(1 - height**2)
    angle = np.pi * (3 - np.sqrt(5)) * index
    return np.stack([around * np.cos(angle), height, around * np.sin(angle)], axis=1)


def _seen(caster: RayCaster, points: Array, directions: Array) -> tuple[Array, Array]:
    """For each of (n, 3) points the share of rays that leave the scene, and of strikes on backs of faces.

    Args:
        caster: Of all meshes.
        points: Where the rays start.
        directions: (n or 1, k, 3) unit.
    """
    rays = np.broadcast_to(directions, (len(points), *directions.shape[1:]))
    origins = np.broadcast_to(points[:, None], rays.shape)
    _, triangle = caster.hits(origins.reshape(-1, 3), rays.reshape(-1, 3))
    struck = triangle >= 0
    backs = np.zeros(len(triangle), bool)
    backs[struck] = caster.strikes_back(triangle[struck], rays.reshape(-1, 3)[struck])
    counts = struck.reshape(len(points), -1).sum(axis=1)
    share = backs.reshape(len(points), -1).sum(axis=1) / np.maximum(counts, 1)
    return 1 - counts / rays.shape[1], share
