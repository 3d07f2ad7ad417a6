"""What a process does that reads levels of strangers: look at them, predict, annotate."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from api.choosing import chosen_cameras, chosen_lights, require_triangles
from api.predicting import Predicted, Wish, annotated, level_record, predicted
from api.service.asked import LevelOptions
from api.service.child_process import Say, Work, work_through
from api.service.level_claims import check_names, check_size, refuse_more
from api.service.level_folder import Part, ReadyLevel, arranged, shown_as_name
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


def enter(pipe: Connection, parent: int, model: str, memory_bytes: int, seconds: float) -> None:
    """Runs in the process."""
    work_through(pipe, parent, memory_bytes, seconds, lambda: _reader(Path(model)))


def _reader(model: Path) -> Work:
    artifact = load(model)

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
            return _DOES[request["task"]](artifact, upload, ready, options, limits)

    return work


def _predict(
    artifact: Artifact, upload: Path, ready: ReadyLevel, options: LevelOptions, limits: Json
) -> Json:
    level = _read(ready, options, limits)
    wish = wish_of(options)
    found = list(predicted(level, artifact, wish))
    record = level_record(level, artifact, wish, found) | {"level": ready.path.name}
    text = json.dumps(record, allow_nan=False, separators=(",", ":"))
    (upload / ANSWER).write_text(text, encoding="ascii")
    return {"file": ANSWER}


def _annotate(
    artifact: Artifact, upload: Path, ready: ReadyLevel, options: LevelOptions, limits: Json
) -> Json:
    level = _read(ready, options, limits)
    found = list(predicted(level, artifact, wish_of(options)))
    data = annotated(format_of(ready.path), read_level_file(ready.path), level, found, artifact)
    if data is None:
        raise _no_answers(ready, found)
    (upload / ANNOTATED).write_bytes(data)
    return {"file": ANNOTATED, "name": ready.path.name, "media_type": ready.media_type}


def _look(artifact: Artifact, upload: Path, ready: ReadyLevel, options: LevelOptions, limits: Json) -> Json:
    """Reads a level that is to be measured later, and makes sure that it will be there then."""
    del artifact
    level = _read(ready, options, limits)
    _sync(upload)
    lights = len(chosen_lights(level, options.light))
    return {"name": ready.path.name, "media_type": ready.media_type, "lights": lights}


_DOES = {"predict": _predict, "annotate": _annotate, "look": _look}


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
