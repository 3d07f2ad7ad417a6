"""A level goes in, its lights are measured, and one page comes out that shows all candidates side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from api.added_lights import level_with_lights
from api.choosing import chosen_cameras, chosen_lights, require_file, require_triangles
from api.comparison_model import LightPart
from api.comparison_page import PageFacts, page_bytes
from api.comparison_parts import LightParts
from api.comparison_pictures import PictureBook
from api.destinations import check_page, check_spares_level
from api.wording import path_words
from renderers.clock import ClockKind, truthful_clock
from renderers.context import Device, Gpu
from renderers.registry import technique
from scenes.atomic_file import write_atomically
from scenes.formats.registry import format_of
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.scene import Light
from selector.level_measuring import Answer, Request, SeenLight, answers, seen_lights
from selector.measurement_record import answer_record, measurement_record
from selector.measuring import Bench

MOST_LIGHTS = 8
"""Lights of a page for which nobody asked: a level may have 200, and a reader has ten minutes."""
SUFFIX = ".compare.html"

Json = dict[str, Any]


@dataclass(frozen=True)
class Order:
    """What to compare, and how.

    Attributes:
        level: The level file.
        scene: Which of its scenes; the default one where None.
        target: The page.
        lights: Names, numbers or nodes; the first few where empty.
        cameras: The same for cameras; those that show what a light lights, or else viewpoints, where empty.
        request: What is asked about each light.
        device: Index or name; the first that works where None.
        added_lights: Lights in words, which come after the level's own.
    """

    level: Path
    scene: str | None
    target: Path
    lights: Sequence[str]
    cameras: Sequence[str]
    request: Request
    device: str | None
    added_lights: Sequence[str] = ()


@dataclass
class Workload:
    """A level that is ready to be compared: everything that can be checked before has been.

    Attributes:
        order: What was asked.
        level: The level.
        seen: The lights of the page with their views.
        left_out: How many more lights the level has.
        device: Where they are measured.
        clock: How time is told there.
        steps: Steps of each light.
        answers: Those that are there so far.
        parts: What the page says of them.
    """

    order: Order
    level: Level
    seen: tuple[SeenLight, ...]
    left_out: int
    device: Device
    clock: ClockKind
    steps: list[int]
    _gpu: Gpu
    answers: list[Answer] = field(default_factory=list)
    parts: list[LightPart] = field(default_factory=list)

    def measured(self, on_step: Callable[[str], None]) -> Iterator[Answer]:
        """One answer a light, as soon as it is there.

        Raises:
            DeviceError: The device cannot hold the level.
            OutputError: A picture cannot be encoded.
        """
        request, book, maker = self.order.request, PictureBook(), LightParts()
        with Bench(self._gpu, self.level.scene, request.plan) as bench:
            for answer in answers(bench, self.device.limits, self.seen, request, on_step, book.keep):
                mobility = request.mobility or answer.light.mobility
                self.parts.append(maker.part(answer, mobility, book.taken()))
                self.answers.append(answer)
                yield answer


@contextmanager
def comparison(order: Order) -> Iterator[Workload]:
    """Reads the level, and checks all that can be checked before anything is measured.

    Raises:
        LevelError: The level cannot be read, has no lights or triangles, or not those that are wanted.
        OutputError: The page could not be written.
        DeviceError: There is no such device.
        UnknownTechniqueError: A technique is not known.
    """
    for name in order.request.techniques:
        technique(name)
    require_file(order.level)
    level_format = format_of(order.level)
    level = level_with_lights(order.level, order.scene, order.added_lights)
    require_triangles(level)
    lights, cameras = chosen_lights(level, order.lights), chosen_cameras(level, order.cameras)
    named = level_format.companions(read_level_file(order.level), order.level)
    check_spares_level(order.target, order.level, named, "-o")
    check_page(order.target)
    on_page = lights if order.lights else _first(lights, len(order.added_lights))
    with Gpu(order.device) as gpu:
        seen = seen_lights(level.scene, on_page, cameras)
        steps = [order.request.steps(one, gpu.device.limits) for one in seen]
        left_out = len(lights) - len(on_page)
        yield Workload(order, level, seen, left_out, gpu.device, truthful_clock(gpu), steps, gpu)


def write_page(work: Workload) -> int:
    """Writes the page, whole or not at all; gives its size in bytes.

    Raises:
        OutputError: The system refuses it.
    """
    page = page_bytes(_facts(work), work.parts)
    write_atomically(work.order.target, page)
    return len(page)


def target_of(level: Path, output: Path | None) -> Path:
    """Where the page goes: `NAME.compare.html` beside the level where nobody says otherwise."""
    return output or level.with_name(level.stem + SUFFIX)


def result_record(work: Workload, size: int) -> Json:
    """The whole result as JSON values: each light's recommendation, with all that was measured."""
    order, plan = work.order, work.order.request.plan
    return {
        "level": path_words(order.level),
        "format": work.level.format,
        "digest": work.level.scene.digest,
        "output": path_words(order.target),
        "output_bytes": size,
        "device": work.device.as_dict(),
        "clock": str(work.clock),
        "resolution": [plan.width, plan.height],
        "rounds": plan.rounds,
        "max_edge_error_px": order.request.max_edge_error_px,
        "lights_left_out": work.left_out,
        "lights": [
            {
                **answer_record(answer),
                "measurement": measurement_record(answer.measurement) if answer.measurement else None,
            }
            for answer in work.answers
        ],
    }


def _first(lights: tuple[Light, ...], added: int) -> tuple[Light, ...]:
    """As many as a page takes, and in any case the last `added` of them, which somebody asked for."""
    own = len(lights) - added
    return (*lights[: min(own, max(MOST_LIGHTS - added, 0))], *lights[own:])


def _facts(work: Workload) -> PageFacts:
    request = work.order.request
    return PageFacts(
        level=work.level.path.name,
        format=work.level.format,
        digest=work.level.scene.digest,
        triangles=work.level.scene.triangle_count,
        left_out=work.left_out,
        techniques=tuple(dict.fromkeys(technique(name).label for name in request.techniques)),
        width=request.plan.width,
        height=request.plan.height,
        rounds=request.plan.rounds,
        limit_px=request.max_edge_error_px,
        device=work.device,
        clock=work.clock,
        date=datetime.now(UTC).date(),
    )
