"""One light by one technique in one view: a picture, what it cost, and how wrong it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log2
from pathlib import Path
from typing import Any

from api.choosing import chosen_cameras, chosen_lights, require_file, require_triangles
from api.destinations import check_spares_level, check_writable
from api.pictures import Picture, file_word, write_png
from api.technique_choice import chosen_technique
from api.wording import path_words
from renderers.context import DeviceLimits, Gpu
from renderers.registry import technique
from renderers.technique import Setting, Settings
from scenes.errors import DeviceError, GnomonError, LevelError, OutputError
from scenes.formats.registry import format_of, read_level
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.scene import Camera, Light, LightKind
from selector.candidate import Candidate
from selector.level_measuring import seen_lights
from selector.measurement import LightMeasurement, Measurement, Status
from selector.measurement_record import candidate_record, light_record, view_record
from selector.measuring import Bench, Plan

USUAL_MAP_SIZE, USUAL_FILTER = 1024, "2x2"


class SettingsError(GnomonError):
    """A technique was asked for something it does not have."""

    exit_code = 2


@dataclass(frozen=True)
class Order:
    """What to render.

    Attributes:
        level: The level file.
        scene: Which of its scenes; the default one where None.
        technique: Id or label.
        settings: Those that differ from the usual ones.
        light: Name, number or node; the first where None.
        camera: Name, number or node; the first, or the first viewpoint, where None.
        output: The PNG; a name made from all this where None.
        width: Pixels across.
        height: Pixels down.
        device: Index or name; the first that works where None.
    """

    level: Path
    scene: str | None
    technique: str
    settings: Mapping[str, Setting]
    light: str | None
    camera: str | None
    output: Path | None
    width: int
    height: int
    device: str | None


@dataclass(frozen=True)
class Rendering:
    """What was rendered.

    Attributes:
        level: The level.
        camera: The view.
        output: The PNG that was written.
        measurement: Of the one candidate in the one view.
        others: How many more lights the wanted name stands for.
    """

    level: Level
    camera: Camera
    output: Path
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
        GnomonError: The technique is not known, lacks a setting, or refuses the light.
    """
    method = chosen_technique(order.technique)
    require_file(order.level)
    if order.output is not None and order.output.suffix.lower() != ".png":
        raise OutputError(
            "The picture is a PNG, so its name must end in .png.",
            where=str(order.output),
            remedy="Choose such a name with -o.",
        )
    level = read_level(order.level, order.scene)
    require_triangles(level)
    lights = chosen_lights(level, _one(order.light))
    light = lights[0]
    named = format_of(order.level).companions(read_level_file(order.level), order.level)
    camera = _camera(level, light, order.camera)
    with Gpu(order.device) as gpu:
        settings = chosen_settings(order, light.kind, gpu.device.limits)
        candidate = Candidate.of(method, settings)
        output = order.output or _default_output(level, light, candidate)
        check_spares_level(output, order.level, named, "-o")
        check_writable(output)
        measurement, picture = _measured(gpu, level, light, camera, candidate, order)
    write_png(output, picture)
    return Rendering(level, camera, output, measurement, len(lights) - 1 if order.light else 0)


def chosen_settings(order: Order, kind: LightKind, limits: DeviceLimits) -> Settings:
    """The usual settings of the technique for this kind of light, with those that were asked for.

    Raises:
        SettingsError: The technique has no setting of that name.
    """
    method = technique(order.technique)
    nearest: Settings = min(method.candidates(kind, limits), key=_unusual)
    usual = dict(nearest)
    for name in order.settings:
        if name not in usual:
            raise SettingsError(
                f"{method.label} has no --{name.replace('_', '-')}.",
                known=f"It has {', '.join(usual) or 'no settings'}.",
            )
    return {**usual, **order.settings}


def _unusual(settings: Settings) -> tuple[float, bool]:
    size = settings.get("map_size", USUAL_MAP_SIZE)
    return abs(log2(float(size) / USUAL_MAP_SIZE)), settings.get("filter", USUAL_FILTER) != USUAL_FILTER


def _measured(
    gpu: Gpu, level: Level, light: Light, camera: Camera, candidate: Candidate, order: Order
) -> tuple[LightMeasurement, Picture]:
    pictures: dict[Candidate | None, Picture] = {}

    def keep(light: Light, camera: Camera, candidate: Candidate | None, picture: Picture) -> None:
        del light, camera
        pictures[candidate] = picture

    with Bench(gpu, level.scene, Plan(order.width, order.height)) as bench:
        measurement = bench.measure(light, [camera], [candidate], on_picture=keep)
    run = measurement.measurements[0]
    if candidate not in pictures:
        where = f"{candidate.label} for {light.name}"
        if run.status is Status.REFUSED:
            raise GnomonError(f"{candidate.method.label} refuses this light: {run.reason}.", where=where)
        raise DeviceError(f"It could not be rendered ({run.status}).", where=where, known=run.reason)
    return measurement, pictures[candidate]


def _camera(level: Level, light: Light, wanted: str | None) -> Camera:
    cameras = chosen_cameras(level, _one(wanted))[:1]
    (seen,) = seen_lights(level.scene, [light], cameras)
    if not seen.cameras:
        raise LevelError(
            seen.problem,
            where=f"{level.path}, light {light.name}",
            remedy="Choose another light, or add a camera to the level.",
        )
    return seen.cameras[0]


def _default_output(level: Level, light: Light, candidate: Candidate) -> Path:
    words = [level.path.stem, light.name, candidate.label]
    return Path(".".join(file_word(word) for word in words) + ".png")


def _one(wanted: str | None) -> Sequence[str]:
    return [] if wanted is None else [wanted]
