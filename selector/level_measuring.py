"""Asks for every light of a level which technique it should use, one light after the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from renderers.context import DeviceLimits
from scenes.errors import GnomonError
from scenes.lit_view import shows_light
from scenes.ray_caster import RayCaster
from scenes.scene import Camera, Light, Mobility, Scene
from scenes.viewpoints import viewpoints
from selector.candidate import candidates
from selector.measurement import LightMeasurement, Status
from selector.measuring import Bench, OnPicture, OnStep, Plan
from selector.recommendation import DEFAULT_MAX_EDGE_ERROR_PX, Recommendation, recommend

STRIKES_NOTHING = (
    "It strikes no surface within its reach that is seen from inside the level, so there is no view of it."
)


@dataclass(frozen=True)
class SeenLight:
    """A light with the views it is judged over.

    Attributes:
        light: The light.
        cameras: Its views.
        problem: Why it has none; empty where it has some.
    """

    light: Light
    cameras: tuple[Camera, ...]
    problem: str = ""


@dataclass(frozen=True)
class Request:
    """What is asked about the lights of a level.

    Attributes:
        max_edge_error_px: How far a shadow's edge may be off.
        techniques: Ids or labels of those that may be chosen; all where empty.
        mobility: Of all lights; what the level says of each where None.
        plan: How carefully to measure.
    """

    max_edge_error_px: float = DEFAULT_MAX_EDGE_ERROR_PX
    techniques: tuple[str, ...] = ()
    mobility: Mobility | None = None
    plan: Plan = field(default_factory=Plan)

    def steps(self, seen: SeenLight, limits: DeviceLimits) -> int:
        """How many steps one light takes."""
        count = len(candidates(seen.light.kind, limits, self.techniques))
        return self.plan.steps(len(seen.cameras), count)


@dataclass(frozen=True)
class Answer:
    """What came out for one light.

    Attributes:
        light: The light.
        recommendation: None where no candidate could serve.
        measurement: None where nothing could be measured.
        problem: Why there is no recommendation; empty where there is one.
    """

    light: Light
    recommendation: Recommendation | None = None
    measurement: LightMeasurement | None = None
    problem: str = ""


def seen_lights(
    scene: Scene, lights: Sequence[Light], cameras: Sequence[Camera] = ()
) -> tuple[SeenLight, ...]:
    """Each light with its views: `cameras`, else those of the level's own that show what it lights.

    Where none does, four viewpoints are made for the light. It has no views where it strikes nothing that can
    be seen from inside the level, or where making viewpoints for it failed.
    """
    if cameras:
        return tuple(SeenLight(light, tuple(cameras)) for light in lights)
    surfaces = RayCaster(scene, casters_only=False)
    casters = RayCaster(scene) if scene.cameras else surfaces
    return tuple(_seen_light(scene, light, surfaces, casters) for light in lights)


def _seen_light(scene: Scene, light: Light, surfaces: RayCaster, casters: RayCaster) -> SeenLight:
    showing = tuple(one for one in scene.cameras if shows_light(one, light, surfaces, casters))
    return SeenLight(light, showing) if showing else _seen_from_viewpoints(scene, light, surfaces)


def _seen_from_viewpoints(scene: Scene, light: Light, caster: RayCaster) -> SeenLight:
    try:
        cameras = viewpoints(scene, light, caster)
    except Exception as error:  # noqa: BLE001  the other lights must not be lost with this one
        return SeenLight(light, (), _words(error))
    return SeenLight(light, cameras, "" if cameras else STRIKES_NOTHING)


def answers(
    bench: Bench,
    limits: DeviceLimits,
    seen: Sequence[SeenLight],
    request: Request,
    on_step: OnStep,
    on_picture: OnPicture | None = None,
) -> Iterator[Answer]:
    """One answer for each light, as soon as it is there. What goes wrong with one light stays with it."""
    for one in seen:
        if not one.cameras:
            yield Answer(one.light, problem=one.problem or STRIKES_NOTHING)
            continue
        wanted = candidates(one.light.kind, limits, request.techniques)
        measurement = None
        try:
            measurement = bench.measure(
                one.light, one.cameras, wanted, on_step=on_step, on_picture=on_picture
            )
            mobility = request.mobility or one.light.mobility
            recommendation = recommend(measurement, mobility, request.max_edge_error_px)
        except Exception as error:  # noqa: BLE001  hours of other lights must not be lost with this one
            yield Answer(one.light, measurement=measurement, problem=_words(error))
            continue
        problem = "" if recommendation else _why_none(measurement)
        yield Answer(one.light, recommendation, measurement, problem)


def _words(error: Exception) -> str:
    from_gnomon = isinstance(error, GnomonError)
    return str(error) if from_gnomon else f"An error inside Gnomon: {type(error).__name__}: {error}"


def _why_none(measurement: LightMeasurement) -> str:
    reasons = [
        f"{one.candidate.label}: {one.status}{f' ({one.reason})' if one.reason else ''}"
        for one in measurement.measurements
        if one.status is not Status.OK
    ]
    return "No candidate could serve it. " + "; ".join(reasons) + "."
