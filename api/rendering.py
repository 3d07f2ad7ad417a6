"""One light by one technique in one view: a picture, what it cost, and how wrong it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from api.added_lights import level_with_lights
from api.choosing import chosen_cameras, chosen_lights, require_file, require_triangles
from api.destinations import check_spares_level, check_writable
from api.pictures import file_word, write_png
from api.settings_choice import read_settings, with_usual
from api.showing import ERROR, Subject, check_view, debug_view, error_view
from api.wording import path_words
from renderers.context import Gpu
from renderers.registry import technique
from scenes.errors import DeviceError, GnomonError, LevelError, OutputError
from scenes.formats.registry import format_of
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.scene import Camera, Light
from scenes.viewpoints import RULES, viewpoints
from selector.candidate import Candidate
from selector.level_measuring import seen_lights
from selector.measurement import LightMeasurement, Measurement
from selector.measurement_record import candidate_record, light_record, view_record
from selector.measuring import Bench, Plan
from selector.truth import Shown


@dataclass(frozen=True)
class Order:
    """What to render.

    Attributes:
        level: The level file.
        scene: Which of its scenes; the default one where None.
        technique: Id or label.
        settings: Those that differ from the usual ones, as text.
        view: The debug view to show in place of the shaded picture, if any.
        light: Name, number or node; the first where None.
        camera: Name, number or node, or a viewpoint by its rule's name; where None the first that shows what
            the light lights, else a viewpoint.
        output: The PNG; a name made from all this where None.
        width: Pixels across.
        height: Pixels down.
        device: Index or name; the first that works where None.
        added_lights: Lights in words, which come after the level's own.
    """

    level: Path
    scene: str | None
    technique: str
    settings: Mapping[str, str]
    view: str | None
    light: str | None
    camera: str | None
    output: Path | None
    width: int
    height: int
    device: str | None
    added_lights: Sequence[str] = ()


@dataclass(frozen=True)
class Rendering:
    """What was rendered.

    Attributes:
        level: The level.
        camera: The view.
        output: The PNG that was written.
        view: The debug view that it shows, None for the shaded picture.
        measurement: Of the one candidate in the one view.
        others: How many more lights the wanted name stands for.
    """

    level: Level
    camera: Camera
    output: Path
    view: str | None
    measurement: LightMeasurement
    others: int

    @property
    def run(self) -> Measurement:
        """The candidate's own measurement."""
        return self.measurement.measurements[0]

    def record(self) -> dict[str, Any]:
        """Everything as JSON values."""
        measurement, run = self.measurement, self.run
        return {
            "level": path_words(self.level.path),
            "picture": path_words(self.output),
            "view": self.view,
            "light": light_record(measurement.light),
            "camera": self.camera.name,
            "resolution": [measurement.width, measurement.height],
            "device": measurement.device.as_dict(),
            "clock": str(measurement.clock),
            **candidate_record(run.candidate),
            "status": str(run.status),
            "reason": run.reason,
            "memory_bytes": run.memory_bytes,
            **view_record(run.views[0]),
        }


def rendered(order: Order) -> Rendering:
    """Renders, measures and writes the picture.

    Raises:
        LevelError: The level cannot be read, or has no such light, camera or scene.
        DeviceError: There is no such device, or it cannot do it.
        OutputError: The picture cannot be written.
        GnomonError: The technique is not known, lacks a setting or a view, or refuses the light.
    """
    method = technique(order.technique)
    asked = read_settings(method, order.settings)
    check_view(order.view)
    require_file(order.level)
    if order.output is not None and order.output.suffix.lower() != ".png":
        raise OutputError(
            "The picture is a PNG, so its name must end in .png.",
            where=str(order.output),
            remedy="Choose such a name with -o.",
        )
    level = level_with_lights(order.level, order.scene, order.added_lights)
    require_triangles(level)
    lights = chosen_lights(level, _one(order.light))
    light = lights[0]
    named = format_of(order.level).companions(read_level_file(order.level), order.level)
    camera = _camera(level, light, order.camera)
    with Gpu(order.device) as gpu:
        candidate = Candidate.of(method, with_usual(method, asked, light, level.scene, gpu.device.limits))
        output = order.output or _default_output(level, light, candidate, order.view)
        check_spares_level(output, order.level, named, "-o")
        check_writable(output)
        subject = Subject(level.scene, light, camera, candidate, (order.width, order.height))
        _require_no_refusal(gpu, subject)
        view = order.view
        debug = debug_view(gpu, subject, view) if view is not None and view != ERROR else None
        measurement, shown = _measured(gpu, subject)
    picture = debug if debug is not None else error_view(subject, shown) if view else shown.picture
    write_png(output, picture)
    return Rendering(level, camera, output, view, measurement, len(lights) - 1 if order.light else 0)


def _require_no_refusal(gpu: Gpu, subject: Subject) -> None:
    candidate = subject.candidate
    limits, settings = gpu.device.limits, dict(candidate.settings)
    reason = candidate.method.refuses(subject.light, subject.scene, limits, settings)
    if reason is not None:
        raise GnomonError(f"{candidate.label} refuses {subject.light.name or 'this light'}: {reason}.")


def _measured(gpu: Gpu, subject: Subject) -> tuple[LightMeasurement, Shown]:
    pictures: dict[Candidate | None, Shown] = {}

    def keep(light: Light, camera: Camera, candidate: Candidate | None, shown: Shown) -> None:
        del light, camera
        pictures[candidate] = shown

    candidate, light = subject.candidate, subject.light
    with Bench(gpu, subject.scene, Plan(*subject.size)) as bench:
        measurement = bench.measure(light, [subject.camera], [candidate], on_picture=keep)
    run = measurement.measurements[0]
    if candidate not in pictures:
        where = f"{candidate.label} for {light.name}"
        raise DeviceError(f"It could not be rendered ({run.status}).", where=where, known=run.reason)
    return measurement, pictures[candidate]


def _camera(level: Level, light: Light, wanted: str | None) -> Camera:
    made = _viewpoint(level, light, wanted)
    cameras = (made,) if made else chosen_cameras(level, _one(wanted))[:1]
    (seen,) = seen_lights(level.scene, [light], cameras)
    if not seen.cameras:
        raise LevelError(
            seen.problem,
            where=f"{level.path}, light {light.name}",
            remedy="Choose another light, or add a camera to the level.",
        )
    return seen.cameras[0]


def _viewpoint(level: Level, light: Light, wanted: str | None) -> Camera | None:
    """The viewpoint of that name, if it is one's and no camera of the level has it."""
    if wanted not in RULES or any(camera.name == wanted for camera in level.scene.cameras):
        return None
    return next((camera for camera in viewpoints(level.scene, light) if camera.name == wanted), None)


def _default_output(level: Level, light: Light, candidate: Candidate, view: str | None) -> Path:
    words = [level.path.stem, light.name, candidate.label, *([view] if view else [])]
    return Path(".".join(file_word(word) for word in words) + ".png")


def _one(wanted: str | None) -> Sequence[str]:
    return [] if wanted is None else [wanted]
