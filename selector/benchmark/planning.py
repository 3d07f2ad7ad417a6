"""Which questions a benchmark asks, the most informative first."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TypeVar

from scenes.corpus.corpora import CORPORA, corpus
from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.scene import Scene
from selector.benchmark.questions import LevelQuestion, Question, SpecQuestion
from selector.evidence.rows import Role
from selector.level_measuring import SeenLight, seen_lights

Item = TypeVar("Item")

HUGE = 200_000
"""Triangles from which on an instance, which takes as long as ten, waits for the others of its family."""


def corpus_questions(name: str) -> list[Question]:
    """One for each spec of a corpus.

    Raises:
        SpecError: There is none of that name.
    """
    return [SpecQuestion(spec) for spec in corpus(name)]


def level_questions(path: Path, role: Role, lights: int | None, views: int | None) -> list[Question]:
    """Lights of a level in their views: the first view of each, then the second of each, and so on.

    Args:
        path: The file.
        role: What the answers may be used for.
        lights: At most so many, spread evenly over the level's list; all where None.
        views: At most so many of each; all where None.

    Raises:
        LevelError: The file cannot be read, or has no triangles or no lights that strike anything.
    """
    scene = read_level(path).scene
    if not scene.triangle_count or not scene.lights:
        lacks = "lights that cast shadows" if scene.triangle_count else "triangles"
        raise LevelError(f"This level has no {lacks}.", where=str(path), remedy="Leave it out.")
    seen = _seen(scene, lights)
    if not seen:
        raise LevelError("No light of this level strikes anything.", where=str(path), remedy="Leave it out.")
    by_light = [
        [
            LevelQuestion(
                path, scene.digest, scene.name, scene.triangle_count, one.light, index, camera, role
            )
            for camera in spread(one.cameras, views)
        ]
        for index, one in seen.items()
    ]
    return [question for view in zip_longest(*by_light) for question in view if question is not None]


def planned(questions: Iterable[Question]) -> list[Question]:
    """The questions in the order in which they are asked: one of each family in turn.

    So whenever a benchmark is stopped, all families have had the same number of questions, give or take one:
    evidence is judged family by family, and another of the same family tells less than the first of a new
    one. Within a family they keep their order, which the corpora deal evenly over all their axes; only the
    huge ones come last.
    """
    by_family: dict[str, list[Question]] = defaultdict(list)
    for question in questions:
        by_family[question.family].append(question)
    turns = [sorted(of_one, key=lambda one: one.triangles > HUGE) for of_one in by_family.values()]
    return [question for turn in zip_longest(*turns) for question in turn if question is not None]


def is_corpus(name: str) -> bool:
    """Whether a corpus has this name."""
    return name in CORPORA


def spread(items: Sequence[Item], most: int | None) -> list[Item]:
    """At most so many of some items, evenly over their order; all where None."""
    if most is None or most >= len(items):
        return list(items)
    return [items[(2 * place + 1) * len(items) // (2 * most)] for place in range(most)]


def _seen(scene: Scene, most: int | None) -> dict[int, SeenLight]:
    """Number -> light with its views, for so many lights that have any, in the level's order."""
    found: dict[int, SeenLight] = {}
    for some in _draws(len(scene.lights), most):
        for index, one in zip(some, seen_lights(scene, [scene.lights[index] for index in some]), strict=True):
            if one.cameras and (most is None or len(found) < most):
                found[index] = one
        if most is not None and len(found) >= most:
            break
    return dict(sorted(found.items()))


def _draws(count: int, most: int | None) -> Iterator[list[int]]:
    """Numbers of lights in batches: evenly spread ones first, others where some of these strike nothing."""
    remaining = list(range(count))
    while remaining:
        some = spread(remaining, most)
        yield some
        remaining = [index for index in remaining if index not in set(some)]
