"""What is known of the levels that were asked about last: another policy reads and surveys nothing again.

It lies in files, one a level, so that it outlives the reader that has found it out: an answer that its client
no longer waits for ends its reader. Files hold JSON, as all that a reader says.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from api.predicting import KnownLight, NamedLight, Outline
from api.service.asked import LevelOptions
from api.service.level_folder import ReadyLevel
from features.extraction import extractor_version
from models.artifact import Artifact
from scenes.scene import LightKind, Mobility
from selector.candidate import Candidate
from selector.learning.predicting import LightFacts
from selector.level_measuring import STRIKES_NOTHING

MOST_LEVELS = 16
MOST_BYTES = 32 << 20
"""Of one level: a light takes some kilobytes for each of its views."""
DECIDING = {"scene", "resolution", "light", "camera"}
"""Options on which the features of a level depend."""

Json = dict[str, Any]
Known = tuple[Outline, tuple[KnownLight, ...]]


class LevelMemory:
    """The last levels, by what their files hold and by what decides their lights' features.

    Args:
        folder: Where it lies; all readers of a service share it.
        artifact: The model, whose limits decide what is refused.
    """

    def __init__(self, folder: Path, artifact: Artifact) -> None:
        self._folder = folder
        about = json.dumps([extractor_version(), artifact.card["limits"], artifact.card["choices"]])
        self._about = about.encode()

    def known(self, ready: ReadyLevel, options: LevelOptions, find: Callable[[], Known]) -> Known:
        """What is known of a level; found out where it is not among the last.

        Args:
            ready: The level.
            options: What is asked about it.
            find: Finds it out.
        """
        path = self._folder / f"{self._key(ready, options)}.json"
        # What cannot be read is found out again.
        with suppress(OSError, ValueError):
            data = path.read_bytes()
            os.utime(path)
            return _known(json.loads(data))
        found = find()
        if not all(one.problem in ("", STRIKES_NOTHING) for one in found[1]):
            # Something went wrong with a light, such as want of memory: it need not do so again.
            return found
        data = json.dumps(_record(found), separators=(",", ":")).encode()
        if len(data) <= MOST_BYTES:
            # Without room, or without the folder, answers are as right, and slower.
            with suppress(OSError):
                written = path.with_name(f"{path.name}.{os.getpid()}")
                written.write_bytes(data)
                written.replace(path)
                self._forget()
        return found

    def _forget(self) -> None:
        """Another reader may forget the same at the same time."""
        ages = {}
        for path in self._folder.iterdir():
            with suppress(FileNotFoundError):
                ages[path] = path.stat().st_mtime_ns
        for path in sorted(ages, key=lambda one: ages[one], reverse=True)[MOST_LEVELS:]:
            path.unlink(missing_ok=True)

    def _key(self, ready: ReadyLevel, options: LevelOptions) -> str:
        digest = hashlib.sha256(self._about)
        digest.update(options.model_dump_json(include=DECIDING).encode())
        folder = ready.path.parent
        paths = (Path(place, name) for place, _, names in os.walk(folder) for name in names)
        for path in sorted(paths):
            digest.update(os.fsencode(path.relative_to(folder)) + b"\0")
            with path.open("rb") as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
        return digest.hexdigest()


def _record(known: Known) -> Json:
    level, lights = known
    named = [[one.name, one.node, one.kind] for one in level.lights]
    facts = [_light_record(one) for one in lights]
    return {"format": level.format, "digest": level.digest, "named": named, "lights": facts}


def _light_record(one: KnownLight) -> Json:
    record = {"light": one.light, "mobility": str(one.mobility), "views": one.views, "problem": one.problem}
    if one.facts is None:
        return record
    refused = [[known.technique, known.settings, why] for known, why in one.facts.refused.items()]
    return record | {"kind": str(one.facts.kind), "rows": one.facts.rows.tolist(), "refused": refused}


def _known(record: Json) -> Known:
    named = tuple(NamedLight(*one) for one in record["named"])
    return Outline(record["format"], record["digest"], named), tuple(map(_known_light, record["lights"]))


def _known_light(record: Json) -> KnownLight:
    facts = None
    if "rows" in record:
        facts = LightFacts(
            LightKind(record["kind"]), np.array(record["rows"], np.float64), _refused(record["refused"])
        )
    mobility, views = Mobility(record["mobility"]), tuple(record["views"])
    return KnownLight(record["light"], mobility, views, facts, record["problem"])


def _refused(record: Iterable[tuple[str, list[tuple[str, Any]], str]]) -> dict[Candidate, str]:
    return {
        Candidate(technique, tuple((name, value) for name, value in settings)): why
        for technique, settings, why in record
    }
