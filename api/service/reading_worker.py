"""What a process does that reads levels of strangers: look at them, predict, annotate."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from api.choosing import chosen_cameras, chosen_lights, require_triangles
from api.predicted_annotating import annotated
from api.predicting import Outline, Predicted, Wish, answered, known_lights
from api.prediction_records import level_record
from api.service.asked import LevelOptions
from api.service.child_process import Say, Work, work_through
from api.service.level_claims import check_names, check_size, refuse_more
from api.service.level_folder import Part, ReadyLevel, arranged, shown_as_name
from api.service.level_memory import Known, LevelMemory
from api.service.problems import ProblemError
from models.artifact import Artifact, load
from scenes.entry import Entry
from scenes.formats.registry import format_of, read_level
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.scene import Mobility
from selector.policy import policy

ANSWER, ANNOTATED = "answer.json", "annotated"
MOST_TRIANGLES, MOST_LIGHTS, MOST_FILES = "triangles", "lights", "parts"

Json = dict[str, Any]


def enter(pipe: Connection, parent: int, model: str, memory: str, memory_bytes: int, seconds: float) -> None:
    """Runs in the process."""
    work_through(pipe, parent, memory_bytes, seconds, lambda: _reader(Path(model), Path(memory)))


def _reader(model: Path, memory: Path) -> Work:
    reader = _Reader(load(model), memory)

    def work(request: Json, say: Say) -> Json:
        del say
        upload = Path(request["folder"])
        options = LevelOptions.model_validate(request["options"])
        parts = [Part(**part) for part in request["parts"]]
        limits = request["limits"]

        def check(root: Entry) -> None:
            check_names(root)
            check_size(
                root,
                options.scene,
                some_lights=bool(options.light),
                lights=limits[MOST_LIGHTS],
                triangles=limits[MOST_TRIANGLES],
            )

        ready = arranged(upload, parts, options.name, check, limits[MOST_FILES])
        with shown_as_name(ready.path):
            return _DOES[request["task"]](reader, _Asked(upload, ready, options, limits))

    return work


@dataclass(frozen=True)
class _Asked:
    """A level of a client, and what is to be done with it.

    Attributes:
        upload: The folder for what comes out.
        ready: The level.
        options: What is asked about it.
        limits: How large it may be.
    """

    upload: Path
    ready: ReadyLevel
    options: LevelOptions
    limits: Json


class _Reader:
    """Answers, and remembers the last levels."""

    def __init__(self, artifact: Artifact, memory: Path) -> None:
        self._artifact = artifact
        self._memory = LevelMemory(memory, artifact)

    def predict(self, asked: _Asked) -> Json:
        level, found = self._predicted(asked)
        record = level_record(asked.ready.path.name, level, self._artifact, wish_of(asked.options), found)
        text = json.dumps(record, allow_nan=False, separators=(",", ":"))
        (asked.upload / ANSWER).write_text(text, encoding="ascii")
        return {"file": ANSWER}

    def annotate(self, asked: _Asked) -> Json:
        level, found = self._predicted(asked)
        path = asked.ready.path
        nodes = [light.node for light in level.lights]
        data = annotated(format_of(path), read_level_file(path), nodes, found, self._artifact)
        if data is None:
            raise _no_answers(asked.ready, found)
        (asked.upload / ANNOTATED).write_bytes(data)
        return {"file": ANNOTATED, "name": path.name, "media_type": asked.ready.media_type}

    def look(self, asked: _Asked) -> Json:
        """Reads a level that is to be measured later, and makes sure that it will be there then."""
        level = _read(asked.ready, asked.options, asked.limits)
        _sync(asked.upload)
        lights = len(chosen_lights(level, asked.options.light))
        return {"name": asked.ready.path.name, "media_type": asked.ready.media_type, "lights": lights}

    def _predicted(self, asked: _Asked) -> tuple[Outline, list[Predicted]]:
        wish = wish_of(asked.options)

        def find() -> Known:
            level = _read(asked.ready, asked.options, asked.limits)
            return Outline.of(level), tuple(known_lights(level, self._artifact, wish))

        level, lights = self._memory.known(asked.ready, asked.options, find)
        return level, list(answered(lights, self._artifact, wish))


_DOES = {"predict": _Reader.predict, "annotate": _Reader.annotate, "look": _Reader.look}


def _read(ready: ReadyLevel, options: LevelOptions, limits: Json) -> Level:
    level = read_level(ready.path, options.scene)
    require_triangles(level)
    wanted = len(chosen_lights(level, options.light))
    chosen_cameras(level, options.camera)
    for count, what, remedy in (
        (level.scene.triangle_count, MOST_TRIANGLES, "Split the level, or simplify its meshes."),
        (wanted, MOST_LIGHTS, "Ask about some of them, with light=NAME."),
    ):
        refuse_more(count, what, limits[what], remedy, ready.path.name)
    return level


def wish_of(options: LevelOptions) -> Wish:
    """The same for the code that answers."""
    return Wish(
        policy=policy(options.policy, options.max_edge_error_px),
        mobility=Mobility(options.mobility) if options.mobility else None,
        techniques=tuple(options.technique),
        lights=options.light,
        cameras=options.camera,
        size=options.size,
    )


def _no_answers(ready: ReadyLevel, found: Sequence[Predicted]) -> ProblemError:
    reasons = "; ".join(dict.fromkeys(one.problem for one in found if one.problem))
    return ProblemError("bad-level", f"{ready.path.name}: no light has a recommendation.", known=reasons)


def _sync(folder: Path) -> None:
    """What is in it survives a power cut."""
    for place, _, names in os.walk(folder):
        for path in (*(Path(place, name) for name in names), Path(place)):
            descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)
