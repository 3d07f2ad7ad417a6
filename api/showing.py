"""Looks into a technique: draws one of its debug views in place of the shaded picture."""

from __future__ import annotations

from dataclasses import dataclass

from api.error_map import FALSE_LIT, FALSE_SHADOW, IN_SHADOW, LIT, error_map
from api.pictures import Picture
from api.view_caption import captioned
from renderers.clock import ClockKind, StageClock
from renderers.context import Gpu
from renderers.debug_picture import DebugPicture, Legend, Panel
from renderers.debug_views import DEBUG_VIEWS, DebugView
from renderers.frame import Frame
from renderers.internals import Internals
from renderers.registry import technique
from renderers.technique import Outcome, ShadowPass
from renderers.world import World
from scenes.errors import GnomonError
from scenes.scene import Camera, Light, Scene
from selector.candidate import Candidate
from selector.truth import Shown

ERROR, ERROR_TITLE = "error", "Error"
VIEW_NAMES = (*(view.name for view in DEBUG_VIEWS), ERROR)


class ViewError(GnomonError):
    """There is no such debug view, or the technique does not have it."""

    exit_code = 2


@dataclass(frozen=True)
class Subject:
    """What is looked at.

    Attributes:
        scene: Its scene.
        light: The light.
        camera: The view.
        candidate: A technique with settings that does not refuse the light.
        size: Pixels across and down.
    """

    scene: Scene
    light: Light
    camera: Camera
    candidate: Candidate
    size: tuple[int, int]


def check_view(name: str | None) -> None:
    """Refuse a debug view that no technique has.

    Raises:
        ViewError: There is none of this name.
    """
    if name is not None and name not in VIEW_NAMES:
        raise ViewError(f'There is no view "{name}".', known=f"Known: {', '.join(VIEW_NAMES)}.")


def debug_view(gpu: Gpu, subject: Subject, name: str) -> Picture:
    """(h, w, 3) uint8 sRGB: the view `name`, any but the error, with its legend.

    Raises:
        ViewError: The technique has no such view.
        GlError: The device failed.
        OutputError: Text cannot be drawn here.
    """
    view = next(one for one in DEBUG_VIEWS if one.name == name)
    method, settings = subject.candidate.method, dict(subject.candidate.settings)
    with gpu.guard(f"{name} of {subject.candidate.label}"):
        world = World.of(gpu, subject.scene)
        try:
            with Frame(world, *subject.size) as frame:
                frame.look(subject.camera)
                frame.shine(subject.light)
                with method.prepare(frame, subject.light, settings) as shadow_pass:
                    drawn, outcome = _drawn(frame, shadow_pass, view, method.label)
        finally:
            world.release()
    fallen = f",  drawn as {technique(outcome.technique).label}" if outcome.technique != method.name else ""
    return captioned(drawn, view.title, _details(subject) + fallen)


def error_view(subject: Subject, shown: Shown) -> Picture:
    """(h, w, 3) uint8 sRGB: where the candidate is wrong, with a legend.

    Raises:
        OutputError: Text cannot be drawn here.
    """
    truth = shown.truth
    picture = error_map(shown.mask, truth.lit, truth.domain, truth.picture)
    lit, dark = (round(LIT),) * 3, (round(IN_SHADOW),) * 3
    swatches = ((FALSE_LIT, "false light"), (FALSE_SHADOW, "false shadow"), (lit, "light"), (dark, "shadow"))
    debug = DebugPicture((Panel(picture),), Legend(swatches))
    return captioned(debug, ERROR_TITLE, _details(subject))


def _drawn(
    frame: Frame, shadow_pass: ShadowPass, view: DebugView, label: str
) -> tuple[DebugPicture, Outcome]:
    frame.draw_surfaces()
    frame.draw_domain()
    outcome = shadow_pass.render(StageClock(frame.gpu, ClockKind.WALL, staged=False), rebuild=True)
    frame.shade()
    internals = shadow_pass.internals()
    if not view.has(internals):
        raise ViewError(
            f'{label} has no view "{view.name}".', known=f"It has {', '.join(_names(internals))}."
        )
    return view.draw(frame, internals), outcome


def _names(internals: Internals) -> list[str]:
    return [*(view.name for view in DEBUG_VIEWS if view.has(internals)), ERROR]


def _details(subject: Subject) -> str:
    return f"{subject.candidate.label},  {subject.light.name},  {subject.camera.name}"
