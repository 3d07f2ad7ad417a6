"""Watched levels of a re-benchmark job: read, asked, and compared."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from models.artifact import Artifact, ModelError
from scenes.errors import GnomonError
from selector.policy import Policy
from selector.rebenchmark.drift import Shift
from selector.rebenchmark.origins import level_paths
from selector.rebenchmark.report import Watched
from selector.rebenchmark.watching import Move, WatchedLevel

Problems = list[tuple[str, str]]


class Wish(Protocol):
    """How watched lights are asked about."""

    @property
    def policy(self) -> Policy:
        """What is good enough."""

    @property
    def size(self) -> tuple[int, int]:
        """Of the views, in pixels."""


def watched_levels(places: Sequence[Path]) -> tuple[list[WatchedLevel], Problems]:
    """The levels among some files and folders, and those that cannot be read, with the reason.

    Of files with the same scene, such as a level and its annotated copy, the first stands for all.
    """
    levels: dict[str, WatchedLevel] = {}
    problems: Problems = []
    for path in level_paths(places):
        try:
            level = WatchedLevel(path)
        except GnomonError as error:
            problems.append((str(path), error.what))
        else:
            levels.setdefault(level.digest, level)
    return list(levels.values()), problems


def watched(
    levels: Sequence[WatchedLevel],
    problems: Problems,
    old: Artifact | None,
    new: Artifact | None,
    wish: Wish,
    shifts: Sequence[Shift],
    *,
    in_force: bool,
) -> Watched:
    """Lights whose answer the new model moves.

    Args:
        levels: The levels.
        problems: Levels that could not be read.
        old: The model in force before; None where there was none, or it cannot be asked.
        new: The one that was learnt; None where none was, so nothing moves.
        wish: How they are asked about.
        shifts: What has drifted, to say why.
        in_force: Whether the new one is.
    """
    moves: list[Move] = []
    found = list(problems)
    for level in levels:
        if not level.lights:
            found.append((str(level.path), "It has no lights that strike anything."))
        elif new is not None:
            try:
                before = level.answers(old, wish.policy, wish.size) if old else None
            except ModelError:
                before = None
            moves += level.moves(before, level.answers(new, wish.policy, wish.size), shifts)
    lights = sum(len(level.lights) for level in levels)
    return Watched(
        len(levels), lights, wish.policy.name, tuple(moves), in_force, tuple(found), old is not None
    )
