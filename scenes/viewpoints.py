"""Where to look from in a level without cameras: four viewpoints per light, by stated rules."""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, cos, sin, sqrt

import numpy as np

from scenes.lit_places import LitPlace, lit_places
from scenes.ray_caster import RayCaster
from scenes.scene import Array, Camera, Light, LightKind, Scene

YFOV_RAD = float(np.pi / 3)
EYE_HEIGHT_M = 1.7

_LOWEST_RAD = float(np.radians(15))  # flatter, and the floor fills too few pixels to judge a shadow on it
_PULLED_IN = 0.9  # of the free path to the first wall behind the eye
_FREE_ENOUGH = 0.6  # of the wanted distance, before another side is tried
_TURNS = np.radians([0, 20, -20, 40, -40, 65, -65])
_SURROUNDINGS = 0.1  # of the extent: so far outside the scene's bounds an eye may be
_HEMMED_IN = 0.05  # of the wanted distance: a place that can only be seen from so near is a last resort
_SEEN = 1e-3  # of the distance: what the eye strikes may be so far from the place, for the grid of both
_LIFT = 1e-5  # of the extent: above the surface, where the free path begins
# Metres: the squares and inverses of what is smaller leave the floats.
_SMALLEST_EXTENT = 1e-30


@dataclass(frozen=True)
class _Wish:
    """One rule: its name, (k, 3) unit directions from the lit place to the eye, best first, the distance."""

    name: str
    directions: Array
    distance: float


def viewpoints(scene: Scene, light: Light, caster: RayCaster | None = None) -> tuple[Camera, ...]:
    """Four cameras that look at a place which `light` lights; none where it strikes nothing.

    All look at the same place: what the light's axis strikes first (a spot's direction; below a point light;
    on a ray of a sun through the middle of the scene, ground before walls), or beside it where that is hemmed
    in, in a shadow's edge, struck flatly, or the lamp's own shade.

    - over the shoulder: from just behind a lamp along its ray, a little aside; with the sun in one's back.
    - facing the light: from the side away from the light, towards it.
    - from the side: a quarter turn from there.
    - overview: from 45 degrees up, at an angle to both, far enough to see the whole pool of light.

    The eye is at the height of a man, 1.7 m, or between 1 % and 10 % of the scene's diagonal where that is
    much larger or smaller, and at least 15 degrees above the lit surface. It is on the lit side, with a free
    line to the place that it looks at, never farther than 90 % of the way to the first wall behind it, or
    to where the scene's bounds are left by a tenth of its diagonal; where that leaves less than 60 % of the
    wanted distance, up to 65 degrees aside are tried.

    Args:
        scene: Its cameras do not count. One smaller than 1e-30 m has no views.
        light: One of its lights.
        caster: Of this scene with `casters_only=False`, to spare building it again for each light.
    """
    extent = float(np.linalg.norm(scene.bounds[1] - scene.bounds[0]))
    if extent < _SMALLEST_EXTENT:
        return ()
    caster = caster or RayCaster(scene, casters_only=False)
    places = lit_places(scene, light, caster)
    if not places:
        return ()
    eye_height = min(max(EYE_HEIGHT_M, 0.01 * extent), 0.1 * extent)
    wishes = [_wishes(scene, light, place, extent, eye_height) for place in places]
    eyes, targets, reach = _eyes(scene, caster, places, wishes)
    wanted = np.array([[wish.distance for wish in rules] for rules in wishes])
    openness = (reach.max(axis=-1) / wanted).min(axis=-1)
    costs = np.array([place.cost for place in places])
    hemmed_in = 2.0 * (openness < _HEMMED_IN)
    chosen = int(np.argmin(costs + hemmed_in - np.minimum(openness, _FREE_ENOUGH)))
    cameras = []
    for rule, wish in enumerate(wishes[chosen]):
        best = _best(wish, reach[chosen, rule])
        eye, target = eyes[chosen, rule, best], targets[chosen, rule, best]
        cameras.append(_camera(wish.name, eye, target, 0.06 * eye_height))
    return tuple(cameras)


def _wishes(scene: Scene, light: Light, place: LitPlace, extent: float, eye_height: float) -> list[_Wish]:
    to_light, beside = _surface_frame(scene, place)
    near = min(max(2 * place.pool, 2 * eye_height), extent / 2)
    rise = asin(min(max(eye_height / near, sin(_LOWEST_RAD)), sqrt(0.5)))
    far = min(max(3 * place.pool, 4 * eye_height), extent)
    if light.kind is LightKind.DIRECTIONAL:
        shoulder = _Wish("over the shoulder", _turned(to_light, place.normal, rise), near)
    else:
        ray = place.to_light + 0.25 * beside
        level = ray - (ray @ place.normal) * place.normal
        height = asin(min(max(float(ray @ place.normal / np.linalg.norm(ray)), sin(_LOWEST_RAD)), 1.0))
        directions = _turned(level / np.linalg.norm(level), place.normal, height)
        behind_lamp = min(max(1.15 * place.distance, eye_height), extent)
        shoulder = _Wish("over the shoulder", directions, behind_lamp)
    return [
        shoulder,
        _Wish("facing the light", _turned(-to_light, place.normal, rise), near),
        _Wish("from the side", _turned(beside, place.normal, rise), near),
        _Wish("overview", _turned(-(to_light + beside) * sqrt(0.5), place.normal, np.pi / 4), far),
    ]


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


def _turned(level: Array, normal: Array, rise: float) -> Array:
    """(k, 3) unit: `level` raised towards `normal` by an angle, and the same turned aside, least first."""
    sideways = np.cross(normal, level)
    turned = np.cos(_TURNS)[:, None] * level + np.sin(_TURNS)[:, None] * sideways
    return turned * cos(rise) + normal * sin(rise)


def _eyes(
    scene: Scene, caster: RayCaster, places: list[LitPlace], wishes: list[list[_Wish]]
) -> tuple[Array, Array, Array]:
    """Where eyes may be, at what they look, both (places, rules, directions, 3), and from how far.

    The distance is 0 where the place cannot be seen from there after all.
    """
    directions = np.array([[wish.directions for wish in rules] for rules in wishes])
    wanted = np.array([[wish.distance for wish in rules] for rules in wishes])[..., None]
    points = np.array([place.point for place in places])[:, None, None]
    normals = np.array([place.normal for place in places])[:, None, None]
    starts = np.broadcast_to(points + _LIFT * caster.extent * normals, directions.shape)
    free = _free_paths(scene, caster, starts, directions)
    reach = np.minimum(wanted, _PULLED_IN * free)
    # On a grid of 2^-14 of the distance, where the last bits of cosines do not matter.
    grid = 2.0 ** (np.floor(np.log2(np.maximum(reach, _LIFT * caster.extent))) - 14)[..., None]
    eyes = np.round((starts + reach[..., None] * directions) / grid) * grid
    targets = np.round(points / grid) * grid
    sights = targets - eyes
    lengths = np.linalg.norm(sights, axis=-1)
    there = lengths > 0
    sights[~there] = -directions[~there]
    struck, _ = caster.hits(eyes.reshape(-1, 3), sights.reshape(-1, 3))
    seen = there & (np.abs(struck.reshape(lengths.shape) - lengths) <= _SEEN * lengths)
    return eyes, targets, np.where(seen, reach, 0.0)


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


def _best(wish: _Wish, reach: Array) -> int:
    enough = reach >= _FREE_ENOUGH * wish.distance
    return int(np.argmax(enough) if enough.any() else np.argmax(reach))


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
