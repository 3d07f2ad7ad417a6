"""From a spec to a scene: builds the place, and chooses lights and cameras that see shadows in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scenes.corpus.budget import closed_as, merged, refined
from scenes.corpus.cameras import CANDIDATES, YFOV_RAD, Views, candidate_views, length, nearer, on_grid
from scenes.corpus.close_grid import CloseGrid, Space
from scenes.corpus.draws import Draws
from scenes.corpus.exposure import promising, scores
from scenes.corpus.lighting import light_of, light_places
from scenes.corpus.occupancy import Occupancy
from scenes.corpus.registry import Family, family_named
from scenes.corpus.rigs import AT_THE_EYE, RIGS
from scenes.corpus.spec import Rig, Spec, SpecError, Standpoint
from scenes.corpus.stage import Plan, Stage
from scenes.scene import Array, Camera, Light, LightKind, Scene
from scenes.thesis.set_ups import set_ups
from scenes.thesis.staging import camera as looking

# From farther away, the pool of a lamp with a range fills too few pixels to judge its shadows.
# A lamp at the eye has to reach what is seen.
_VIEW_PER_REACH, _VIEW_PER_REACH_AT_EYE = 2.5, 0.6
_GOOD, _ATTEMPTS = 64, 4
# So many lights are chosen for what they show; further ones are scattered.
_CHOSEN = 4
_NEAR_PLANE_M, _SHORTEST_NEAR_PLANE_M, _NEAR_PLANE = 2.0**-4, 2.0**-10, 0.125


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
        view, place, space = self._first()
        lights = [self._light(self._spec, 0, place, view)]
        lights += [
            self._further_light(number, view, space) for number in range(1, min(self._spec.lights, _CHOSEN))
        ]
        lights += self._scattered_lights(self._spec.lights - _CHOSEN)
        views = [view, *(self._further_view(number, place) for number in range(1, self._spec.cameras))]
        cameras = tuple(_camera(view, number) for number, view in enumerate(views))
        return Scene(
            self._spec.family.replace("_", " ").capitalize(), self._stage.meshes, tuple(lights), cameras
        )

    def _first(self) -> tuple[Views, Array, Space]:
        """View and light of the spec, and the grid that they were placed in."""
        if self._spec.standpoint is not Standpoint.CLOSE:
            return (*self._tried(self._spec.standpoint, self._space), self._space)
        # Where light meets shadow, seen from nearby, there is something to see from close by.
        around, _ = self._tried(Standpoint.NEAR, self._space)
        space = CloseGrid.of(self._space, self._stage.meshes, around.targets[0], around.eyes[0])
        return (*self._tried(Standpoint.CLOSE, space), space)

    def _tried(self, standpoint: Standpoint, space: Space) -> tuple[Views, Array]:
        """The best of some candidates, or of ever more where all are dull: a view, and its light."""
        tried = []
        for attempt in range(_ATTEMPTS):
            views = self._views(standpoint, space, "camera", attempt)
            places = self._places(views, self._spec, attempt, space)
            if len(views.eyes) > CANDIDATES:
                few = promising(space, views, places, self._spec, CANDIDATES)
                views, places = views.at(few), places[few]
            score = scores(space, views, places, self._spec)
            best = int(np.argmax(score))
            tried.append((int(score[best]), -attempt, views.at(np.array([best])), places[best]))
            if score[best] >= _GOOD:
                break
        _, _, view, place = max(tried, key=lambda one: one[:2])
        return view, place

    def _views(self, standpoint: Standpoint, space: Space, *part: str | int) -> Views:
        views = candidate_views(self._stage, space, standpoint, self._draws.of(*part))
        if self._spec.reach is not None:
            share = _VIEW_PER_REACH_AT_EYE if self._spec.rig in AT_THE_EYE else _VIEW_PER_REACH
            views = nearer(views, share * self._spec.reach * self._extent)
        # Few views are tried with several lights each.
        repeated = np.repeat(np.arange(len(views.eyes)), max(24 // len(views.eyes), 1))
        return views.at(repeated)

    def _places(self, views: Views, spec: Spec, number: int, space: Space) -> Array:
        draws = self._draws.of("light", number)
        return light_places(self._stage, space, views, spec, draws)

    def _further_light(self, number: int, view: Views, space: Space) -> Light:
        draws = self._draws.of("further light", number)
        kind = self._family.KINDS[draws.one_below(len(self._family.KINDS))]
        rigs = RIGS[kind]
        spec = replace(self._spec, kind=kind, rig=rigs[draws.one_below(len(rigs))])
        views = view.at(np.zeros(16, dtype=np.int64))
        places = self._places(views, spec, number, space)
        return self._light(spec, number, places[self._best(views, places, spec, space)], view)

    def _scattered_lights(self, count: int) -> list[Light]:
        """Lamps all over the place, seen from the first camera or not, as levels have them."""
        lights: list[Light] = []
        kinds = [kind for kind in self._family.KINDS if kind is not LightKind.DIRECTIONAL]
        while len(lights) < count:
            draws = self._draws.of("scattered", len(lights))
            views = candidate_views(self._stage, self._space, Standpoint.NEAR, draws)
            spec = replace(self._spec, kind=kinds[draws.one_below(len(kinds))], rig=Rig.OVERHEAD)
            places = self._places(views, spec, _CHOSEN + len(lights), self._space)
            for index in range(min(len(places), count - len(lights))):
                view = views.at(np.array([index]))
                lights.append(self._light(spec, _CHOSEN + len(lights), places[index], view))
        return lights

    def _further_view(self, number: int, place: Array) -> Views:
        standpoint = (Standpoint.FAR, Standpoint.NEAR)[number % 2]
        views = self._views(standpoint, self._space, "further camera", number)
        places = np.broadcast_to(place, views.eyes.shape)
        if self._spec.kind is LightKind.DIRECTIONAL:
            return views.at(np.zeros(1, dtype=np.int64))
        return views.at(np.array([self._best(views, places, self._spec, self._space)]))

    def _light(self, spec: Spec, number: int, place: Array, view: Views) -> Light:
        name = spec.rig.replace("_", " ").capitalize() + (f" {number + 1}" if number else "")
        return light_of(spec, name, place, view, self._extent, self._draws.of("color", number))

    def _best(self, views: Views, places: Array, spec: Spec, space: Space) -> int:
        """The candidate with the highest score, the first of equals."""
        return int(np.argmax(scores(space, views, places, spec)))


def _camera(view: Views, number: int) -> Camera:
    eye, target = (tuple(points[0].tolist()) for points in (view.eyes, view.targets))
    name = "View" if number == 0 else f"View {number + 1}"
    # An eye right before a wall must not cut it.
    wanted = float(on_grid(_NEAR_PLANE * length(view.eyes - view.targets))[0])
    near_m = min(max(wanted, _SHORTEST_NEAR_PLANE_M), _NEAR_PLANE_M)
    return replace(looking(name, eye, target, YFOV_RAD), near_m=near_m)


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
    if spec.rig not in RIGS[spec.kind]:
        raise SpecError(
            f"The rig of a {spec.kind} light cannot be {spec.rig}.",
            where="spec",
            known=f"It takes {', '.join(RIGS[spec.kind])}.",
        )
    if spec.standpoint is Standpoint.REMOTE and family.INDOOR:
        raise SpecError(
            f'The family "{spec.family}" is indoors: its camera cannot be remote.',
            where="spec",
            known=f"It takes {', '.join(one for one in Standpoint if one is not Standpoint.REMOTE)}.",
        )


def _thesis_scene(spec: Spec) -> Scene:
    for set_up in set_ups():
        if set_up.name == spec.set_up:
            return set_up.staged()
    known = ", ".join(f'"{one.name}"' for one in set_ups())
    raise SpecError(f'The thesis has no set-up "{spec.set_up}".', known=f"It has {known}.")
