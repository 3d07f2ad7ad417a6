"""Where to look from in a level without cameras: four viewpoints per light, by stated rules."""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, sin, sqrt

import numpy as np

from scenes.lit_places import LitPlace, lit_places
from scenes.playable_space import PlayableSpace
from scenes.ray_caster import Bools, RayCaster
from scenes.scene import Array, Camera, Light, LightKind, Scene

RULES = ("over the shoulder", "facing the light", "from the side", "overview")
"""Names of the four, in this order."""

YFOV_RAD = float(np.pi / 3)
EYE_HEIGHT_M = 1.6

_LOWEST_RAD = float(np.radians(15))  # flatter, and the floor fills too few pixels to judge a shadow on it
_STEEPEST_RAD = float(np.pi / 4)
_UNDER_CEILING_RAD = float(np.radians(25))  # where 45 degrees up end too soon
_NEARLY = 0.97  # of the sine of the lowest angle: the floor under the eye need not be that of the place
_PULLED_IN = 0.9  # of the free path to the first wall behind the eye, and of the room's height
_FLOOR = sqrt(0.5)  # cosine: steeper is no floor to stand on
_FREE_ENOUGH = 0.6  # of the wanted distance, before another side is tried
_TURNS = np.radians([0, 20, -20, 40, -40, 65, -65])
_SURROUNDINGS = 0.1  # of the extent: so far outside the scene's bounds an eye may be
_HEMMED_IN = 0.05  # of the wanted distance: a place that can only be seen from so near is a last resort
_SEEN = 1e-3  # of the distance: what the eye strikes may be so far from the place, for the grid of both
_LIFT = 1e-5  # of the extent: above the surface, where the free path begins
# A level with a diagonal beyond these was hardly modelled in metres, or is no place for people.
_METRES = 6.0, 300.0
# Metres: the squares and inverses of what is smaller leave the floats.
_SMALLEST_EXTENT = 1e-30


@dataclass(frozen=True)
class _Wish:
    """One rule.

    Attributes:
        name: Its name.
        directions: (k, 3) unit, from the lit place to the eye, best first.
        distance: How far away the eye is to be, metres.
        enough: From here on, or from farther, a direction is good enough.
        standing: Whether the eye is to be at its height above the floor under it.
    """

    name: str
    directions: Array
    distance: float
    enough: float
    standing: bool = True


def viewpoints(scene: Scene, light: Light, caster: RayCaster | None = None) -> tuple[Camera, ...]:
    """Four cameras in playable space that look at a place which `light` lights.

    There are fewer where a rule finds no free line to it, and none where the light strikes nothing that can
    be seen from playable space: it shines on nothing, inside a wall, or only outside the level's hull
    (`PlayableSpace`).

    All look at the same place: what the light's axis strikes first (a spot's direction; below a point light;
    on a ray of a sun through the middle of the scene, ground before walls), or beside it where that is hemmed
    in, in a shadow's edge, struck flatly, or the lamp's own shade.

    - over the shoulder: from just behind a lamp along its ray, a little aside; with the sun in one's back.
    - facing the light: from the side away from the light, towards it.
    - from the side: a quarter turn from there.
    - overview: from 45 degrees up, or 25 under a low ceiling, at an angle to both, far enough to see the
      whole pool of light; a place on a wall is looked down at from above.

    Who does not look from behind a lamp or down from above stands: the eye is 1.6 m above the floor under it,
    but in a scene with a diagonal under 6 m or over 300 m between 10 % and 1 % of it, and never above 90 % of
    the room's height there. It hangs on its line where there is no floor, or where from there it would see
    the place too flatly or not at all. Every eye is about 15 degrees or more above the lit surface and on
    its lit side, with a free line to the place that it looks at, never farther than 90 % of the way to the
    first wall behind it, or to where the scene's bounds are left by a tenth of its diagonal; where that
    leaves less than 60 % of the wanted distance, or no place to stand, up to 65 degrees aside are tried, and
    steeper or flatter ones.

    Args:
        scene: Its cameras and lamps tell what is playable. One smaller than 1e-30 m has no views.
        light: One of its lights.
        caster: Of this scene with `casters_only=False`, to spare building it again for each light.
    """
    extent = float(np.linalg.norm(scene.bounds[1] - scene.bounds[0]))
    if extent < _SMALLEST_EXTENT:
        return ()
    caster = caster or RayCaster(scene, casters_only=False)
    places = lit_places(scene, light, PlayableSpace.of(scene, caster))
    if not places:
        return ()
    eye_height = _eye_height(extent)
    wishes = [_wishes(scene, light, place, extent, eye_height) for place in places]
    eyes, targets, reach, stands = _eyes(scene, caster, places, wishes, eye_height)
    wanted = np.array([[wish.distance for wish in rules] for rules in wishes])
    openness = (reach.max(axis=-1) / wanted).min(axis=-1)
    costs = np.array([place.cost for place in places])
    hemmed_in = 2.0 * (openness < _HEMMED_IN)
    chosen = int(np.argmin(costs + hemmed_in - np.minimum(openness, _FREE_ENOUGH)))
    cameras = []
    for rule, wish in enumerate(wishes[chosen]):
        best = _best(wish, reach[chosen, rule], stands[chosen, rule])
        if reach[chosen, rule, best] > 0:
            eye, target = eyes[chosen, rule, best], targets[chosen, rule, best]
            cameras.append(_camera(wish.name, eye, target, 0.06 * eye_height))
    return tuple(cameras)


def _eye_height(extent: float) -> float:
    in_metres = _METRES[0] <= extent <= _METRES[1]
    return EYE_HEIGHT_M if in_metres else min(max(EYE_HEIGHT_M, 0.01 * extent), 0.1 * extent)


def _wishes(scene: Scene, light: Light, place: LitPlace, extent: float, eye_height: float) -> list[_Wish]:
    to_light, beside = _surface_frame(scene, place)
    near = min(max(2 * place.pool, 2 * eye_height), eye_height / sin(_LOWEST_RAD), extent / 2)
    rise = asin(min(max(eye_height / near, sin(_LOWEST_RAD)), sin(_STEEPEST_RAD)))
    rises = (rise, _STEEPEST_RAD)
    far = min(max(3 * place.pool, 4 * eye_height), extent)
    if light.kind is LightKind.DIRECTIONAL:
        shoulder = _Wish(
            "over the shoulder", _turned(to_light, place.normal, rises), near, _FREE_ENOUGH * near
        )
    else:
        ray = place.to_light + 0.25 * beside
        level = ray - (ray @ place.normal) * place.normal
        height = asin(min(max(float(ray @ place.normal / np.linalg.norm(ray)), sin(_LOWEST_RAD)), 1.0))
        directions = _turned(level / np.linalg.norm(level), place.normal, (height, height))
        behind_lamp = min(max(1.15 * place.distance, eye_height), extent)
        enough = _FREE_ENOUGH * behind_lamp
        shoulder = _Wish("over the shoulder", directions, behind_lamp, enough, standing=False)
    above = _turned(_overlooking(place, to_light, beside), place.normal, (_STEEPEST_RAD, _UNDER_CEILING_RAD))
    return [
        shoulder,
        _Wish("facing the light", _turned(-to_light, place.normal, rises), near, _FREE_ENOUGH * near),
        _Wish("from the side", _turned(beside, place.normal, rises), near, _FREE_ENOUGH * near),
        _Wish("overview", above, far, min(_FREE_ENOUGH * far, 4 * eye_height), standing=False),
    ]


def _overlooking(place: LitPlace, to_light: Array, beside: Array) -> Array:
    """(3,) unit, in the lit surface: where an overview is taken from; up along a wall."""
    if abs(place.normal[1]) >= _FLOOR:
        across: Array = -(to_light + beside) * sqrt(0.5)
        return across
    up = np.array([0.0, 1.0, 0.0]) - place.normal[1] * place.normal
    upwards: Array = up / np.linalg.norm(up)
    return upwards


def _surface_frame(scene: Scene, place: LitPlace) -> tuple[Array, Array]:
    """Two unit vectors in the lit surface: towards the light, and across.

    Where the light stands upright over the surface, the scene's longest side replaces the first.
    """
    sides = np.eye(3)[np.argsort(scene.bounds[0] - scene.bounds[1], kind="stable")]
    for wish in (place.to_light, *sides):
        level = wish - (wish @ place.normal) * place.normal
        length = float(np.linalg.norm(level))
        if length > 0.05:
            return level / length, np.cross(place.normal, level / length)
    raise AssertionError("three orthogonal directions cannot all be one normal")


def _turned(level: Array, normal: Array, rises: tuple[float, float]) -> Array:
    """(k, 3) unit: `level` turned aside, least first, raised to `normal` by one angle, then by another."""
    sideways = np.cross(normal, level)
    turned = np.cos(_TURNS)[:, None] * level + np.sin(_TURNS)[:, None] * sideways
    return np.concatenate([turned * np.cos(rise) + normal * np.sin(rise) for rise in rises])


def _eyes(
    scene: Scene, caster: RayCaster, places: list[LitPlace], wishes: list[list[_Wish]], eye_height: float
) -> tuple[Array, Array, Array, Bools]:
    """Where eyes may be, at what they look, both (places, rules, directions, 3), how far away, which stand.

    The distance is 0 where the place cannot be seen from there after all.
    """
    directions = np.array([[wish.directions for wish in rules] for rules in wishes])
    wanted = np.array([[wish.distance for wish in rules] for rules in wishes])[..., None]
    standing = np.array([[wish.standing for wish in rules] for rules in wishes])[..., None]
    points = np.array([place.point for place in places])[:, None, None]
    normals = np.array([place.normal for place in places])[:, None, None]
    starts = np.broadcast_to(points + _LIFT * caster.extent * normals, directions.shape)
    free = _free_paths(scene, caster, starts, directions)
    reach = np.minimum(wanted, _PULLED_IN * free)
    # On a grid of 2^-14 of the distance, where the last bits of cosines do not matter.
    grid = 2.0 ** (np.floor(np.log2(np.maximum(reach, _LIFT * caster.extent))) - 14)[..., None]
    targets = np.round(points / grid) * grid
    hanging = starts + reach[..., None] * directions
    eyes = np.round(hanging / grid) * grid
    upright, on_floor = _standing(caster, hanging, eye_height)
    upright = np.round(upright / grid) * grid
    sight = upright - targets
    flat = np.einsum("...i,...i->...", sight, normals) < _NEARLY * sin(_LOWEST_RAD) * np.linalg.norm(
        sight, axis=-1
    )
    stands = standing & on_floor & ~flat & _sees(caster, upright, targets)
    seen = stands | _sees(caster, eyes, targets)
    return np.where(stands[..., None], upright, eyes), targets, np.where(seen, reach, 0.0), stands


def _standing(caster: RayCaster, eyes: Array, eye_height: float) -> tuple[Array, Bools]:
    """Each of (..., 3) eyes moved up or down to its height above the floor, and whether there is a floor."""
    down = np.broadcast_to([0.0, -1.0, 0.0], eyes.shape).reshape(-1, 3)
    depth, triangle = caster.hits(eyes.reshape(-1, 3), down)
    room, _ = caster.hits(eyes.reshape(-1, 3), -down)
    floor = triangle >= 0
    corners = caster.corners(triangle[floor])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    floor[floor] = np.abs(normals[:, 1]) > _FLOOR * np.linalg.norm(normals, axis=1)
    depth = np.where(floor, depth, 0.0)
    height = np.minimum(eye_height, _PULLED_IN * (depth + room))
    moved = eyes.copy()
    moved[..., 1] += (height - depth).reshape(eyes.shape[:-1])
    return moved, floor.reshape(eyes.shape[:-1])


def _sees(caster: RayCaster, eyes: Array, targets: Array) -> Bools:
    """(...,) bool: whether nothing lies between (..., 3) eyes and what they look at."""
    sights = targets - eyes
    lengths = np.linalg.norm(sights, axis=-1)
    there = lengths > 0
    sights[~there] = (0.0, 1.0, 0.0)
    struck, _ = caster.hits(eyes.reshape(-1, 3), sights.reshape(-1, 3))
    seen: Bools = there & (np.abs(struck.reshape(lengths.shape) - lengths) <= _SEEN * lengths)
    return seen


def _free_paths(scene: Scene, caster: RayCaster, starts: Array, directions: Array) -> Array:
    """Metres from each start to the first surface, or to where the scene's surroundings end."""
    free, _ = caster.hits(starts.reshape(-1, 3), directions.reshape(-1, 3))
    margin = _SURROUNDINGS * caster.extent
    with np.errstate(divide="ignore", over="ignore"):
        leaving = np.maximum(
            (scene.bounds[0] - margin - starts) / directions,
            (scene.bounds[1] + margin - starts) / directions,
        ).min(axis=-1)
    paths: Array = np.minimum(free.reshape(leaving.shape), leaving)
    return paths


def _best(wish: _Wish, reach: Array, stands: Bools) -> int:
    enough = reach >= wish.enough
    for good in (enough & stands, enough):
        if good.any():
            return int(np.argmax(good))
    return int(np.argmax(reach))


def _camera(name: str, eye: Array, target: Array, near_limit: float) -> Camera:
    x, y, z = (float(component) for component in target - eye)
    distance = sqrt(x * x + y * y + z * z)
    forward = (x / distance, y / distance, z / distance)
    return Camera(
        name,
        position=(float(eye[0]), float(eye[1]), float(eye[2])),
        forward=forward,
        up=_upright(forward),
        yfov_rad=YFOV_RAD,
        near_m=min(0.01 * distance, near_limit),
    )


def _upright(forward: tuple[float, float, float]) -> tuple[float, float, float]:
    """The unit vector orthogonal to `forward` that is nearest to Y, or to -Z where one looks up or down."""
    x, y, z = forward
    level = x * x + z * z
    if level > 1e-6:
        length = sqrt(level)
        return (-x * y / length, length, -z * y / length)
    length = sqrt(x * x + y * y)
    return (x * z / length, y * z / length, -length)
