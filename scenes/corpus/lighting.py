"""Where lights may be, as seen from a camera and its target: one rule for each rig."""

from __future__ import annotations

from math import radians

import numpy as np

from scenes.corpus.cameras import Views, length, on_grid, risen, room_of, unit
from scenes.corpus.close_grid import Space
from scenes.corpus.draws import Draws
from scenes.corpus.occupancy import leaving
from scenes.corpus.rigs import AT_THE_EYE
from scenes.corpus.spec import Rig, Spec
from scenes.corpus.stage import Stage
from scenes.scene import Array, Light, LightKind
from scenes.solids import Color
from scenes.thesis.staging import unit_from

_UP = np.array([0.0, 1.0, 0.0])
_PULLED_IN = 0.8
_WITHIN_REACH = 0.6
_FALL_OFF = 0.875
# How high, in 1/256 turns over the horizon; nearest, and how much farther, as shares of the room's diagonal.
_OVER_THE_HORIZON: dict[Rig, tuple[tuple[int, int], float, float]] = {
    Rig.FAR_LOW_SUN: ((3, 10), 0.6, 0.9),
    Rig.FROM_THE_SIDE: ((12, 36), 0.1, 0.5),
    Rig.OVERHEAD: ((44, 60), 0.15, 0.6),
}
_SUNS: dict[Rig, Color] = {Rig.FAR_LOW_SUN: (1.0, 0.72, 0.46)}
_LAMPS: tuple[Color, ...] = ((1.0, 0.94, 0.82), (1.0, 0.82, 0.58), (0.86, 0.92, 1.0), (1.0, 0.88, 0.70))
_IN_THE_ROOM = (Rig.MINERS_LAMP, Rig.OVER_THE_SHOULDER, Rig.BETWEEN, Rig.AT_THE_WALL)
# From what is lit, as shares of the diagonal of the place.
_AT_THE_WALL = (0.001, 0.009)
_DAYLIGHT: Color = (1.0, 0.95, 0.86)


def light_places(stage: Stage, space: Space, views: Views, spec: Spec, draws: Draws) -> Array:
    """(n, 3) where the light of each view is; for a sun, its target plus the way towards it.

    Lamps stay in the room, in front of what stands between them and the target, and near enough to reach it;
    only one that stands for a low sun may be far outside, where there is an outside.
    """
    rig, kind = spec.rig, spec.kind
    if stage.lamps is not None and rig not in _IN_THE_ROOM and spec.reach is None:
        return on_grid(draws.of("lamps").points(len(views.eyes), *stage.lamps))
    ways, distances = _wishes(stage, space, views, rig, draws)
    if kind is LightKind.DIRECTIONAL:
        return views.targets + _snapped_ways(ways)
    low, high = room_of(stage, space)
    anchors = views.eyes if rig in AT_THE_EYE else views.targets
    free = space.first_hits(anchors, ways, float(distances.max()))
    if rig is not Rig.FAR_LOW_SUN or stage.start is not None:
        free = np.minimum(free, leaving(anchors, ways, low, high))
    reach = np.minimum(distances, _PULLED_IN * free)
    if spec.reach is not None:
        within = _WITHIN_REACH / 2 if rig in AT_THE_EYE else _WITHIN_REACH
        reach = np.minimum(reach, within * spec.reach * space.extent)
    return on_grid(anchors + reach[:, None] * ways)


def light_of(spec: Spec, name: str, place: Array, view: Views, extent: float, draws: Draws) -> Light:
    """The light at a place of `light_places`, that shines on the first target of `view`."""
    target = tuple(float(one) for one in view.targets[0])
    position = tuple(float(one) for one in place)
    range_m = float("inf") if spec.reach is None else float(on_grid(np.array(spec.reach * extent)))
    color = _LAMPS[draws.one_below(len(_LAMPS))]
    if spec.kind is LightKind.DIRECTIONAL:
        color = _SUNS.get(spec.rig, _DAYLIGHT)
        direction = unit_from(position, target)  # type: ignore[arg-type]
        return Light(name, spec.kind, direction=direction, intensity=40.0, color=color)
    if spec.kind is LightKind.POINT:
        return Light(name, spec.kind, position, range_m=range_m, intensity=400.0, color=color)  # type: ignore[arg-type]
    cut_off = radians(spec.cut_off_deg)
    return Light(
        name,
        spec.kind,
        position,  # type: ignore[arg-type]
        unit_from(position, target),  # type: ignore[arg-type]
        inner_cone_rad=_FALL_OFF * cut_off,
        outer_cone_rad=cut_off,
        range_m=range_m,
        intensity=1000.0,
        color=color,
    )


def _wishes(stage: Stage, space: Space, views: Views, rig: Rig, draws: Draws) -> tuple[Array, Array]:
    """(n, 3) unit ways from the anchor, and (n,) metres along them."""
    low, high = room_of(stage, space)
    share = draws.of("share").numbers(len(views.eyes))
    if rig in _OVER_THE_HORIZON:
        (lowest, highest), nearest, farther = _OVER_THE_HORIZON[rig]
        distances = float(length(high - low)) * (nearest + farther * share)
        return risen(draws.of(rig), len(share), lowest, highest), distances
    aside = draws.of("aside").unit_vectors(len(share))
    if rig is Rig.AT_THE_WALL:
        nearest, farthest = _AT_THE_WALL
        return unit(aside + 0.5 * _UP), space.extent * (nearest + (farthest - nearest) * share)
    return _beside_the_view(views, rig, aside, share)


def _beside_the_view(views: Views, rig: Rig, aside: Array, share: Array) -> tuple[Array, Array]:
    to_eye, apart = unit(views.eyes - views.targets), length(views.eyes - views.targets)
    if rig is Rig.MINERS_LAMP:
        return unit(aside + 0.5 * _UP), np.maximum((0.02 + 0.03 * share) * apart, 0.15)
    if rig is Rig.OVER_THE_SHOULDER:
        return unit(to_eye + 0.6 * aside + 0.5 * _UP), (0.25 + 0.75 * share) * apart
    if rig is Rig.BETWEEN:
        return unit(to_eye + 0.35 * aside + 0.5 * _UP), (0.3 + 0.3 * share) * apart
    assert rig is Rig.DUELLING_FRUSTA, f"{rig} has no rule"
    level = to_eye * [1.0, 0.0, 1.0]
    return unit(-level + 0.35 * aside + (0.3 + 0.3 * share[:, None]) * _UP), (0.5 + share) * apart


def _snapped_ways(ways: Array) -> Array:
    snapped: Array = np.round(ways * 2.0**14) / 2.0**14
    return snapped
