"""What is known of the levels that were asked about last: another policy reads and surveys nothing again."""

from __future__ import annotations

import hashlib
import os
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path

from api.predicting import KnownLight, Outline
from api.service.asked import LevelOptions
from api.service.level_folder import ReadyLevel

MOST_LEVELS = 4
"""Kilobytes each: a light is some hundred numbers. Geometry is not kept."""
DECIDING = {"scene", "resolution", "light", "camera"}
"""Options on which the features of a level depend."""

Known = tuple[Outline, tuple[KnownLight, ...]]


class LevelMemory:
    """The last few levels, by what their files hold and by what decides their lights' features."""

    def __init__(self) -> None:
        self._known: OrderedDict[str, Known] = OrderedDict()

    def known(self, ready: ReadyLevel, options: LevelOptions, find: Callable[[], Known]) -> Known:
        """What is known of a level; found out where it is not among the last.

        Args:
            ready: The level.
            options: What is asked about it.
            find: Finds it out.
        """
        key = _key(ready, options)
        found = self._known.pop(key, None) or find()
        self._known[key] = found
        if len(self._known) > MOST_LEVELS:
            self._known.popitem(last=False)
        return found


def _key(ready: ReadyLevel, options: LevelOptions) -> str:
    digest = hashlib.sha256(options.model_dump_json(include=DECIDING).encode())
    folder = ready.path.parent
    paths = (Path(place, name) for place, _, names in os.walk(folder) for name in names)
    for path in sorted(paths):
        digest.update(os.fsencode(path.relative_to(folder)) + b"\0")
        with path.open("rb") as file:
            digest.update(hashlib.file_digest(file, "sha256").digest())
    return digest.hexdigest()
