"""A level goes in, its lights are measured, and the level comes out annotated."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from api.added_lights import check_place, write_lights_beside
from api.choosing import (
    chosen_cameras,
    chosen_lights,
    require_file,
    require_triangles,
)
from api.destinations import (
    MEASUREMENT_KEYS,
    check_in_place,
    check_measurements,
    check_output,
    check_spares_level,
    check_target,
    default_target,
    ready_folder,
)
from api.picture_folder import PictureFolder
from api.verdicts import shows_shadow_edge
from api.wording import path_words
from renderers.clock import ClockKind, truthful_clock
from renderers.context import Device, Gpu
from renderers.registry import technique
from scenes.atomic_file import write_atomically
from scenes.errors import GnomonError, OutputError
from scenes.formats.registry import LevelFormat, format_of, read_level
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.level_output import luggage, write_level
from scenes.light_annotation import LightAnnotation
from scenes.scene import Camera, Light
from selector.annotation import annotation
from selector.candidate import Candidate
from selector.level_measuring import Answer, Request, SeenLight, answers, seen_lights
from selector.measurement_record import answer_record, measurement_record
from selector.measuring import Bench, OnPicture
from selector.truth import Shown

Json = dict[str, Any]


@dataclass(frozen=True)
class Order:
    """What to annotate, and how.

    Attributes:
        level: The level file.
        scene: Which of its scenes; the default one where None.
        target: The annotated level.
        in_place: Whether the level itself is overwritten; the target is the level then.
        lights: Names, numbers or nodes; all where empty.
        cameras: The same for cameras; those that show what a light lights, or else viewpoints, where empty.
        request: What is asked about each light.
        pictures: Folder for pictures; none where None.
        measurements: File for the raw samples; none where None.
        device: Index or name; the first that works where None.
        added_lights: Lights in words, to be written beside plain geometry that has none.
    """

    level: Path
    scene: str | None
    target: Path
    in_place: bool
    lights: Sequence[str]
    cameras: Sequence[str]
    request: Request
    pictures: Path | None
    measurements: Path | None
    device: str | None
    added_lights: Sequence[str] = ()


@dataclass(frozen=True)
class Workload:
    """A level that is ready to be measured: everything that can be checked before has been.

    Attributes:
        order: What was asked.
        level: The level.
        source: The bytes it was read from.
        seen: Its lights with their views.
        device: Where they are measured.
        clock: How time is told there.
        steps: Steps of each light.
        standing: What the level says of its lights so far, by node; it stays where nothing new is found.
        left_behind: Files outside the level's folder that the level names, and that do not go with it.
        problems: What went wrong with an output so far; it must not cost the other results.
        lights_file: That was written with the lights added, if any were.
    """

    order: Order
    level: Level
    source: bytes
    seen: tuple[SeenLight, ...]
    device: Device
    clock: ClockKind
    steps: list[int]
    standing: Mapping[int, LightAnnotation]
    left_behind: tuple[Path, ...]
    problems: list[GnomonError]
    lights_file: Path | None
    _gpu: Gpu

    def measured(
        self, on_step: Callable[[str], None], on_picture: OnPicture | None = None
    ) -> Iterator[Answer]:
        """One answer a light, as soon as it is there, its pictures written.

        Args:
            on_step: Told of each step before it begins.
            on_picture: Given every picture, too, for a page about the same measurement.

        Raises:
            DeviceError: The device cannot hold the level.
        """
        order = self.order
        folder = PictureFolder(order.pictures, self.level, self.seen) if order.pictures else None
        with Bench(self._gpu, self.level.scene, order.request.plan) as bench:

            def without_loss(action: Callable[..., None], *what: object) -> None:
                nonlocal folder
                try:
                    action(*what)
                except Exception as error:  # noqa: BLE001  pictures must not cost the level
                    self.problems.append(_problem(error, "The pictures"))
                    folder = None

            def keep(light: Light, camera: Camera, candidate: Candidate | None, shown: Shown) -> None:
                if folder:
                    without_loss(folder.keep, light, camera, candidate, shown.picture)
                if on_picture:
                    on_picture(light, camera, candidate, shown)

            wanted = keep if folder or on_picture else None
            for answer in answers(bench, self.device.limits, self.seen, order.request, on_step, wanted):
                if folder:
                    without_loss(folder.write, answer)
                yield answer


@contextmanager
def workload(order: Order) -> Iterator[Workload]:
    """Reads the level, and checks all that can be checked before anything is measured.

    Raises:
        LevelError: The level cannot be read, has no lights or triangles, or not those that are wanted.
        AddedLightError: There is no place for the lights added.
        OutputError: An output could not be written.
        DeviceError: There is no such device.
        UnknownTechniqueError: A technique is not known.
    """
    for name in order.request.techniques:
        technique(name)
    require_file(order.level)
    level_format = format_of(order.level)
    source = read_level_file(order.level)
    lights_file = _write_added_lights(order, source, level_format) if order.added_lights else None
    level = read_level(order.level, order.scene)
    require_triangles(level)
    lights, cameras = chosen_lights(level, order.lights), chosen_cameras(level, order.cameras)
    check_output(order, source, level_format)
    standing = level_format.read_annotations(source)
    # What the file's form forbids is found now: a bare annotation meets the same obstacles as a real one.
    trial = level_format.annotate(source, {_node(light): LightAnnotation({}, {}) for light in lights})
    left_behind = luggage(order.level, order.target, trial, level_format).left_behind
    if order.measurements:
        _check_measurements(order, order.measurements, level_format.companions(source, order.level))
    if order.pictures:
        ready_folder(order.pictures)
    with Gpu(order.device) as gpu:
        seen = seen_lights(level.scene, lights, cameras)
        steps = [order.request.steps(one, gpu.device.limits) for one in seen]
        yield Workload(
            order,
            level,
            source,
            seen,
            gpu.device,
            truthful_clock(gpu),
            steps,
            standing,
            left_behind,
            [],
            lights_file,
            gpu,
        )


def write_results(work: Workload, found: Sequence[Answer]) -> tuple[Path, ...]:
    """Writes the raw samples and the annotated level; gives all level files that were written.

    What cannot be written is added to the problems. No level is written where no light has a
    recommendation.
    """
    order = work.order
    try:
        if order.measurements:
            write_atomically(order.measurements, _measurements_file(work, found))
    except Exception as error:  # noqa: BLE001  the level must not be lost with its measurements
        work.problems.append(_problem(error, "The measurements"))
    try:
        return _write_annotated(work, found)
    except Exception as error:  # noqa: BLE001  what was measured is still to be told
        work.problems.append(_problem(error, "The annotated level"))
        return ()


def _problem(error: Exception, what: str) -> GnomonError:
    if isinstance(error, GnomonError):
        return error
    return OutputError(
        f"{what} could not be written, by a bug inside Gnomon.",
        known=f"{type(error).__name__}: {error}",
        remedy="Please report it.",
    )


def _write_annotated(work: Workload, found: Sequence[Answer]) -> tuple[Path, ...]:
    order, level_format = work.order, format_of(work.order.level)
    advice = {
        _node(answer.light): annotation(answer.recommendation) for answer in found if answer.recommendation
    }
    if not advice:
        return ()
    data = level_format.annotate(work.source, {**work.standing, **advice})
    if order.in_place and read_level_file(order.level) != work.source:
        raise OutputError(
            "The level has changed while its lights were measured, so it was left as it is.",
            where=str(order.level),
            remedy="Run the command again.",
        )
    return write_level(order.level, order.target, data, level_format)


@dataclass(frozen=True)
class Clearing:
    """What became of a level whose annotation was taken out."""

    target: Path
    restored: bool
    note: str
    written: bool
    left_behind: tuple[Path, ...] = ()


def clear_level(level: Path, target: Path, *, in_place: bool) -> Clearing:
    """Writes the level without our annotation; one that has none is written to another name only.

    Raises:
        LevelError: The level cannot be read.
        OutputError: The result cannot be written.
    """
    require_file(level)
    level_format = format_of(level)
    source = read_level_file(level)
    cleared = level_format.clear(source)
    if in_place and cleared.data == source:
        return Clearing(target, cleared.restored, cleared.note, written=False)
    if in_place:
        check_in_place(level, source, level_format)
    else:
        check_target(level, target, level_format, cleared.data)
    left_behind = luggage(level, target, cleared.data, level_format).left_behind
    write_level(level, target, cleared.data, level_format)
    return Clearing(target, cleared.restored, cleared.note, written=True, left_behind=left_behind)


def target_of(level: Path, output: Path | None, *, in_place: bool) -> Path:
    """Where the annotated level goes."""
    return level if in_place else output or default_target(level)


def result_record(work: Workload, found: Sequence[Answer], written: Sequence[Path]) -> Json:
    """The whole result as JSON values."""
    plan = work.order.request.plan
    return {
        "level": path_words(work.level.path),
        "format": work.level.format,
        "digest": work.level.scene.digest,
        "output": path_words(written[-1]) if written else None,
        "written": [path_words(path) for path in (*filter(None, [work.lights_file]), *written)],
        "device": work.device.as_dict(),
        "clock": str(work.clock),
        "resolution": [plan.width, plan.height],
        "rounds": plan.rounds,
        "max_edge_error_px": work.order.request.max_edge_error_px,
        "lights": [_light_record(answer) for answer in found],
        "problems": [str(problem) for problem in work.problems],
    }


def _light_record(answer: Answer) -> Json:
    record = answer_record(answer)
    if answer.recommendation:
        record["shadow_edge_seen"] = shows_shadow_edge(answer.recommendation)
    return record


def _measurements_file(work: Workload, found: Sequence[Answer]) -> bytes:
    measurements = [measurement_record(answer.measurement) for answer in found if answer.measurement]
    record = {
        "level": path_words(work.level.path),
        "digest": work.level.scene.digest,
        "lights": measurements,
    }
    assert tuple(record) == MEASUREMENT_KEYS, "by these an earlier file is known"
    text = json.dumps(record, indent=1, allow_nan=False, ensure_ascii=False) + "\n"
    # Names in a level may hold halves of surrogate pairs, which have no UTF-8.
    return text.encode(errors="replace")


def _write_added_lights(order: Order, source: bytes, level_format: LevelFormat) -> Path:
    """Writes them when all that is cheap to check has been: a lights file left behind would be in the way."""
    check_place(order.level, order.added_lights)
    check_output(order, source, level_format)
    return write_lights_beside(order.level, order.scene, order.added_lights)


def _check_measurements(order: Order, path: Path, named: Sequence[Path]) -> None:
    for level in (order.level, order.target):
        check_spares_level(path, level, named, "--measurements")
    check_measurements(path)


def _node(light: Light) -> int:
    assert light.node is not None, "every level format says which node carries a light"
    return light.node
