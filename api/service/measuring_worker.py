"""What the process does that measures: one job, whose results are there whole or not at all."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from api.annotating import Order, Workload, result_record, workload, write_results
from api.comparing import MOST_LIGHTS
from api.comparison_model import LightPart
from api.comparison_page import PageFacts, page_bytes
from api.comparison_parts import LightParts
from api.comparison_pictures import PictureBook
from api.service.asked import JobOptions
from api.service.child_process import Say, Work, work_through
from api.service.job_results import ANNOTATED, PARTIAL, REPORT, RESULT, finish
from api.service.level_folder import shown_as_name
from api.service.level_names import annotated_name
from api.service.problems import ProblemError
from api.service.reading_worker import wish_of
from renderers.registry import technique
from scenes.atomic_file import write_atomically
from selector.level_measuring import Answer, Request
from selector.measuring import Plan

SECONDS_BETWEEN_WORDS = 0.2

Json = dict[str, Any]


def enter(pipe: Connection, parent: int, device: str | None, seconds: float) -> None:
    """Runs in the process.

    Drivers reserve addresses as they like: only the memory that it holds is limited, from outside.
    """
    work_through(pipe, parent, 0, seconds, lambda: _measurer(device))


def _measurer(device: str | None) -> Work:
    def work(request: Json, say: Say) -> Json:
        folder = Path(request["folder"])
        level = folder / request["level"]
        options = JobOptions.model_validate(request["options"])
        shutil.rmtree(folder / PARTIAL, ignore_errors=True)
        (folder / PARTIAL).mkdir()
        with shown_as_name(level):
            steps = _measured(folder / PARTIAL, level, options, device, say)
        finish(folder)
        return {"steps": steps}

    return work


def _measured(results: Path, level: Path, options: JobOptions, device: str | None, say: Say) -> int:
    order = _order(level, options, device)
    # An attempt that died may have left it.
    order.target.unlink(missing_ok=True)
    with workload(order) as work:
        # One measurement serves the level, the record and the page.
        book, maker, parts = PictureBook(), LightParts(), list[LightPart]()
        steps = _Steps(sum(work.steps), say)
        shown = len(work.seen) if options.light else MOST_LIGHTS
        found: list[Answer] = []
        for answer in work.measured(steps.step, book.keep):
            found.append(answer)
            mobility = order.request.mobility or answer.light.mobility
            pictures = book.taken()
            if len(parts) < shown:
                parts.append(maker.part(answer, mobility, pictures))
        steps.writing()
        written = write_results(work, found)
        if work.problems:
            raise work.problems[0]
        if not written:
            raise _no_answers(level, found)
        # What the record says of files is what a client gets, not where they lie here.
        named = {"level": level.name, "output": order.target.name, "written": [order.target.name]}
        record = result_record(work, found, written) | named
        write_atomically(results / RESULT, json.dumps(record, allow_nan=False).encode())
        write_atomically(results / REPORT, page_bytes(_facts(work, len(work.seen) - len(parts)), parts))
        order.target.rename(results / ANNOTATED)
        return steps.total


def _order(level: Path, options: JobOptions, device: str | None) -> Order:
    wish = wish_of(options)
    return Order(
        level=level,
        scene=options.scene,
        target=level.with_name(annotated_name(level.name)),
        in_place=False,
        lights=wish.lights,
        cameras=wish.cameras,
        request=Request(
            wish.policy.max_edge_error_px,
            wish.techniques,
            wish.mobility,
            Plan(*wish.size, options.rounds),
        ),
        pictures=None,
        measurements=None,
        device=device,
    )


class _Steps:
    """Says how far the work is, now and then."""

    def __init__(self, total: int, say: Say) -> None:
        self.total, self._say = total, say
        self._begun = 0
        self._said = 0.0

    def step(self, what: str) -> None:
        self._begun = min(self._begun + 1, self.total)
        if time.monotonic() - self._said >= SECONDS_BETWEEN_WORDS:
            self._tell(self._begun - 1, what)

    def writing(self) -> None:
        self._tell(self.total, "writing the results")

    def _tell(self, done: int, what: str) -> None:
        self._said = time.monotonic()
        self._say({"kind": "progress", "done": done, "total": self.total, "what": what})


def _facts(work: Workload, left_out: int) -> PageFacts:
    request = work.order.request
    return PageFacts(
        level=work.level.path.name,
        format=work.level.format,
        digest=work.level.scene.digest,
        triangles=work.level.scene.triangle_count,
        left_out=left_out,
        techniques=tuple(dict.fromkeys(technique(name).label for name in request.techniques)),
        width=request.plan.width,
        height=request.plan.height,
        rounds=request.plan.rounds,
        limit_px=request.max_edge_error_px,
        device=work.device,
        clock=work.clock,
        date=datetime.now(UTC).date(),
    )


def _no_answers(level: Path, found: Sequence[Answer]) -> ProblemError:
    reasons = "; ".join(dict.fromkeys(one.problem for one in found if one.problem))
    return ProblemError("bad-level", f"{level.name}: no light has a recommendation.", known=reasons)
