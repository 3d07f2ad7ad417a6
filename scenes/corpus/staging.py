"""From a spec to a scene: builds the place, and chooses lights and cameras that see shadows in it."""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians

import numpy as np

from scenes.corpus.budget import closed_as, merged, refined
from scenes.corpus.cameras import YFOV_RAD, Views, camera_rays, candidate_views, length, nearer, unit
from scenes.corpus.draws import Draws, Indices
from scenes.corpus.lighting import light_of, light_places
from scenes.corpus.occupancy import Occupancy
from scenes.corpus.registry import Family, family_named
from scenes.corpus.rigs import AT_THE_EYE, SUN_RIGS
from scenes.corpus.spec import Rig, Spec, SpecError, Standpoint
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, Camera, Light, LightKind, Scene
from scenes.solids import GRID_M
from scenes.thesis.set_ups import set_ups
from scenes.thesis.staging import camera as looking

_COLUMNS, _ROWS = 14, 9
_SCORE_STEPS = 1024
# From farther away, the pool of a lamp with a range fills too few pixels to judge its shadows.
# A lamp at the eye has to reach what is seen.
_VIEW_PER_REACH, _VIEW_PER_REACH_AT_EYE = 2.5, 0.6
# So narrow a cone, or so short a reach, is looked for around the middle of the picture, where it is aimed.
_NARROW_DEG, _SHORT, _MIDDLE = 12.0, 0.1, 0.3
# Of the picture: with this much light and this much shadow one more of either adds nothing.
_ENOUGH = 0.25
_GOOD, _ATTEMPTS = 64, 4
# So many lights are chosen for what they show; further ones are scattered.
_CHOSEN = 4
_RIGS = tuple(Rig)


def instance(spec: Spec) -> Scene:
    """The scene of a spec: the same digest on every machine.

    Its first light and first camera are those that the spec describes; further ones vary them.

    Raises:
        SpecError: There is no such family or set-up, or the family cannot be built of so few or so many
            triangles, or not be lit so.
    """
    if spec.set_up:
        return _thesis_scene(spec)
    family = family_named(spec.family)
    _check(spec, family)
    stage = built(spec)
    space = Occupancy.of(stage.meshes, stage.start)
    return _Set(spec, family, stage, space).scene()


def built(spec: Spec) -> Stage:
    """The place of a spec, without lights and cameras.

    Raises:
        SpecError: There is no such family.
    """
    stage = family_named(spec.family).build(Plan(spec))
    meshes = refined(tuple(mesh for mesh in stage.meshes if mesh.triangle_count), spec.triangles)
    if spec.merged:
        meshes = (merged(meshes),)
    return replace(stage, meshes=closed_as(meshes, spec.closure, Draws(spec.family, spec.seed, "closure")))


class _Set:
    """Lights and cameras for one stage."""

    def __init__(self, spec: Spec, family: Family, stage: Stage, space: Occupancy) -> None:
        self._spec, self._family, self._stage, self._space = spec, family, stage, space
        self._draws = Draws(spec.family, spec.seed, "set")
        self._extent = space.extent

    def scene(self) -> Scene:
        view, place = self._first()
        lights = [self._light(self._spec, 0, place, view)]
        lights += [self._further_light(number, view) for number in range(1, min(self._spec.lights, _CHOSEN))]
        lights += self._scattered_lights(self._spec.lights - _CHOSEN)
        views = [view, *(self._further_view(number, place) for number in range(1, self._spec.cameras))]
        cameras = tuple(_camera(view, number) for number, view in enumerate(views))
        return Scene(
            self._spec.family.replace("_", " ").capitalize(), self._stage.meshes, tuple(lights), cameras
        )

    def _first(self) -> tuple[Views, Array]:
        """View and light of the spec: the best of some candidates, or of ever more where all are dull."""
        tried = []
        for attempt in range(_ATTEMPTS):
            views = self._views(self._spec.standpoint, "camera", attempt)
            places = self._places(views, self._spec, attempt)
            score = self._scores(views, places, self._spec)
            best = int(np.argmax(score))
            tried.append((int(score[best]), -attempt, views.at(np.array([best])), places[best]))
            if score[best] >= _GOOD:
                break
        _, _, view, place = max(tried, key=lambda one: one[:2])
        return view, place

    def _views(self, standpoint: Standpoint, *part: str | int) -> Views:
        views = candidate_views(self._stage, self._space, standpoint, self._draws.of(*part))
        if self._spec.reach is not None:
            share = _VIEW_PER_REACH_AT_EYE if self._spec.rig in AT_THE_EYE else _VIEW_PER_REACH
            views = nearer(views, share * self._spec.reach * self._extent)
        # Few views are tried with several lights each.
        repeated = np.repeat(np.arange(len(views.eyes)), max(24 // len(views.eyes), 1))
        return views.at(repeated)

    def _places(self, views: Views, spec: Spec, number: int) -> Array:
        draws = self._draws.of("light", number)
        return light_places(self._stage, self._space, views, spec, draws)

    def _further_light(self, number: int, view: Views) -> Light:
        draws = self._draws.of("further light", number)
        kind = self._family.KINDS[draws.one_below(len(self._family.KINDS))]
        rigs = SUN_RIGS if kind is LightKind.DIRECTIONAL else _RIGS
        spec = replace(self._spec, kind=kind, rig=rigs[draws.one_below(len(rigs))])
        views = view.at(np.zeros(16, dtype=np.int64))
        places = self._places(views, spec, number)
        return self._light(spec, number, places[self._best(views, places, spec)], view)

    def _scattered_lights(self, count: int) -> list[Light]:
        """Lamps all over the place, seen from the first camera or not, as levels have them."""
        lights: list[Light] = []
        kinds = [kind for kind in self._family.KINDS if kind is not LightKind.DIRECTIONAL]
        while len(lights) < count:
            draws = self._draws.of("scattered", len(lights))
            views = candidate_views(self._stage, self._space, Standpoint.NEAR, draws)
            spec = replace(self._spec, kind=kinds[draws.one_below(len(kinds))], rig=Rig.OVERHEAD)
            places = self._places(views, spec, _CHOSEN + len(lights))
            for index in range(min(len(places), count - len(lights))):
                view = views.at(np.array([index]))
                lights.append(self._light(spec, _CHOSEN + len(lights), places[index], view))
        return lights

    def _further_view(self, number: int, place: Array) -> Views:
        standpoint = (Standpoint.FAR, Standpoint.NEAR)[number % 2]
        views = self._views(standpoint, "further camera", number)
        places = np.broadcast_to(place, views.eyes.shape)
        if self._spec.kind is LightKind.DIRECTIONAL:
            return views.at(np.zeros(1, dtype=np.int64))
        return views.at(np.array([self._best(views, places, self._spec)]))

    def _light(self, spec: Spec, number: int, place: Array, view: Views) -> Light:
        name = spec.rig.replace("_", " ").capitalize() + (f" {number + 1}" if number else "")
        return light_of(spec, name, place, view, self._extent, self._draws.of("color", number))

    def _best(self, views: Views, places: Array, spec: Spec) -> int:
        """The candidate with the highest score, the first of equals."""
        return int(np.argmax(self._scores(views, places, spec)))

    def _scores(self, views: Views, places: Array, spec: Spec) -> Indices:
        """(n,) int64: how much light and shadow is in view together, at most 256."""
        lit, shadowed = self._shares(views, places, spec)
        scores: Indices = np.round(
            np.minimum(lit, _ENOUGH) * np.minimum(shadowed, _ENOUGH) / _ENOUGH * _SCORE_STEPS
        ).astype(np.int64)
        return scores

    def _shares(self, views: Views, places: Array, spec: Spec) -> tuple[Array, Array]:
        """(n,) shares of each picture that are lit, and in shadow within the light's cone and range."""
        small = (spec.kind is LightKind.SPOT and spec.cut_off_deg < _NARROW_DEG) or (
            spec.reach or 1.0
        ) < _SHORT
        rays = camera_rays(views, _COLUMNS, _ROWS, _MIDDLE if small else 1.0)
        count = rays.shape[1]
        origins = np.repeat(views.eyes, count, axis=0)
        flat = rays.reshape(-1, 3)
        seen = self._space.first_hits(origins, flat, self._extent)
        hit = np.isfinite(seen)
        points = origins + np.where(hit, seen - 1.5 * self._space.cell, 0.0)[:, None] * flat
        ways = np.repeat(places, count, axis=0) - points
        aims = np.repeat(unit(views.targets - places), count, axis=0)
        if spec.kind is LightKind.DIRECTIONAL:
            ways = -self._extent * aims
        distances = np.maximum(length(ways), GRID_M)
        directions = ways / distances[:, None]
        inside = hit & self._inside(directions, aims, distances, spec)
        through = self._space.passing(points, directions, distances)
        lit = np.where(inside, through, 0.0).reshape(-1, count)
        dark = np.where(inside, 1.0 - through, 0.0).reshape(-1, count)
        return _mean(lit), _mean(dark)

    def _inside(self, directions: Array, aims: Array, distances: Array, spec: Spec) -> Array:
        inside = np.ones(len(directions), dtype=bool)
        if spec.kind is LightKind.SPOT:
            products = directions * aims
            inside &= -((products[:, 0] + products[:, 1]) + products[:, 2]) > cos(radians(spec.cut_off_deg))
        if spec.kind is not LightKind.DIRECTIONAL and spec.reach is not None:
            inside &= distances < spec.reach * self._extent
        return inside


def _mean(values: Array) -> Array:
    # Whole numbers: a sum of floats depends on its order.
    steps = np.round(values * _SCORE_STEPS).astype(np.int64)
    means: Array = steps.sum(axis=1) / (_SCORE_STEPS * values.shape[1])
    return means


def _camera(view: Views, number: int) -> Camera:
    eye, target = (tuple(points[0].tolist()) for points in (view.eyes, view.targets))
    name = "View" if number == 0 else f"View {number + 1}"
    return replace(looking(name, eye, target, YFOV_RAD), near_m=0.0625)


def _check(spec: Spec, family: Family) -> None:
    low, high = family.TRIANGLES
    if not low <= spec.triangles <= high:
        raise SpecError(
            f'The family "{spec.family}" has {low:,} to {high:,} triangles.',
            where="spec",
            known=f"Wanted are {spec.triangles:,}.",
        )
    if spec.kind not in family.KINDS:
        raise SpecError(
            f'The family "{spec.family}" is not lit by a {spec.kind} light.',
            where="spec",
            known=f"It takes {', '.join(family.KINDS)}.",
        )
    if spec.kind is LightKind.DIRECTIONAL and spec.rig not in SUN_RIGS:
        raise SpecError(
            f"A directional light has no place, so its rig cannot be {spec.rig}.",
            where="spec",
            known=f"It takes {', '.join(SUN_RIGS)}.",
        )


def _thesis_scene(spec: Spec) -> Scene:
    for set_up in set_ups():
        if set_up.name == spec.set_up:
            return set_up.staged()
    known = ", ".join(f'"{one.name}"' for one in set_ups())
    raise SpecError(f'The thesis has no set-up "{spec.set_up}".', known=f"It has {known}.")
