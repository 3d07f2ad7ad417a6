"""A level and a model go in, and answers or an annotation come out: nothing is rendered."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from api.added_lights import check_place, write_lights_beside
from api.choosing import chosen_cameras, chosen_lights, require_file, require_triangles
from api.destinations import check_in_place, check_target
from api.wording import path_words
from features.level_survey import LevelSurvey
from models.artifact import Artifact
from models.examples import Question
from renderers.registry import technique
from scenes.errors import OutputError
from scenes.formats.registry import LevelFormat, format_of, read_level
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.level_output import luggage, write_level
from scenes.scene import Light, Mobility
from selector.learning.advice import annotation
from selector.learning.predicting import Expected, Prediction, Predictor, reason, views_of
from selector.level_measuring import STRIKES_NOTHING, seen_lights
from selector.policy import Policy

Json = dict[str, Any]

EVERY_CANDIDATE_REFUSED = "No candidate that the model knows can serve it."


@dataclass(frozen=True)
class Wish:
    """What is asked of a model about a level.

    Attributes:
        policy: What is good enough.
        mobility: Of all lights; what the level says of each where None.
        techniques: To choose from; all where empty.
        lights: Names, numbers or nodes; all where empty.
        cameras: The same; those that show what a light lights, or else viewpoints, where empty.
        size: Pixels across and down of each view.
    """

    policy: Policy
    mobility: Mobility | None
    techniques: tuple[str, ...]
    lights: Sequence[str]
    cameras: Sequence[str]
    size: tuple[int, int]


@dataclass(frozen=True)
class Predicted:
    """What came out for one light: a prediction, or why there is none.

    Attributes:
        light: Its place in the level.
        views: Names of the cameras it was judged over.
        prediction: The answer.
        problem: Why there is none; empty where there is one.
    """

    light: int
    views: tuple[str, ...] = ()
    prediction: Prediction | None = None
    problem: str = ""


def predicted(level: Level, artifact: Artifact, wish: Wish) -> Iterator[Predicted]:
    """One answer a light, in the level's order. No GPU.

    Raises:
        ModelError: The model was learnt from other features.
        LevelError: The level has no triangles or lights, or not those that are wanted.
        UnknownTechniqueError: A technique is not known.
    """
    for name in wish.techniques:
        technique(name)
    require_triangles(level)
    wanted = chosen_lights(level, wish.lights)
    seen = seen_lights(level.scene, wanted, chosen_cameras(level, wish.cameras))
    predictor = Predictor(artifact, LevelSurvey.of(level.scene))
    places = {id(light): index for index, light in enumerate(level.scene.lights)}
    for one in seen:
        index = places[id(one.light)]
        if not one.cameras:
            yield Predicted(index, problem=one.problem or STRIKES_NOTHING)
            continue
        mobility, limit = wish.mobility or one.light.mobility, wish.policy.max_edge_error_px
        question = Question(wish.policy.name, str(mobility), limit)
        found = predictor.predict(one.light, views_of(one.cameras, *wish.size), question, wish.techniques)
        views = tuple(camera.name for camera in one.cameras)
        yield Predicted(index, views, found, "" if found else EVERY_CANDIDATE_REFUSED)


@dataclass(frozen=True)
class Order:
    """What to annotate with predictions.

    Attributes:
        level: The level file.
        scene: Which of its scenes; the default one where None.
        target: The annotated level.
        in_place: Whether the level itself is overwritten; the target is the level then.
        wish: What is asked about its lights.
        added_lights: Lights in words, to be written beside plain geometry that has none.
    """

    level: Path
    scene: str | None
    target: Path
    in_place: bool
    wish: Wish
    added_lights: Sequence[str] = ()


@dataclass(frozen=True)
class Annotating:
    """A level that is ready to be annotated: everything that can be checked before has been.

    Attributes:
        order: What was asked.
        level: The level.
        left_behind: Files outside the level's folder that it names, and that do not go with it.
        lights_file: That was written with the lights added, if any were.
    """

    order: Order
    level: Level
    left_behind: tuple[Path, ...]
    lights_file: Path | None
    _source: bytes
    _format: LevelFormat

    def write(self, found: Sequence[Predicted], artifact: Artifact) -> tuple[Path, ...]:
        """Writes the annotated level, unless no light has an answer; gives all that was written.

        Raises:
            OutputError: It cannot be written, or the level has changed since.
        """
        order = self.order
        data = annotated(self._format, self._source, self.level, found, artifact)
        if data is None:
            return ()
        if order.in_place and read_level_file(order.level) != self._source:
            raise OutputError(
                "The level has changed meanwhile, so it was left as it is.",
                where=str(order.level),
                remedy="Run the command again.",
            )
        return write_level(order.level, order.target, data, self._format)


def annotating(order: Order) -> Annotating:
    """Reads the level, and checks all that can be checked before anything is asked.

    Raises:
        LevelError: The level cannot be read.
        AddedLightError: There is no place for the lights added.
        OutputError: The output could not be written.
    """
    require_file(order.level)
    level_format = format_of(order.level)
    source = read_level_file(order.level)
    lights_file = None
    if order.added_lights:
        check_place(order.level, order.added_lights)
        _check_output(order, source, level_format)
        lights_file = write_lights_beside(order.level, order.scene, order.added_lights)
    level = read_level(order.level, order.scene)
    require_triangles(level)
    _check_output(order, source, level_format)
    left_behind = luggage(order.level, order.target, source, level_format).left_behind
    return Annotating(order, level, left_behind, lights_file, source, level_format)


def annotated(
    level_format: LevelFormat, source: bytes, level: Level, found: Sequence[Predicted], artifact: Artifact
) -> bytes | None:
    """The level file with predictions, and what it said of other lights; None where there are none."""
    advice = {
        _node(level.scene.lights[one.light]): annotation(one.prediction, one.views, artifact.card)
        for one in found
        if one.prediction
    }
    if not advice:
        return None
    standing = level_format.read_annotations(source)
    return level_format.annotate(source, {**standing, **advice})


def level_record(level: Level, artifact: Artifact, wish: Wish, found: Sequence[Predicted]) -> Json:
    """All answers for a level as JSON values."""
    return {
        "level": path_words(level.path),
        "digest": level.scene.digest,
        "format": level.format,
        "model": {
            "device": str(artifact.card["device"]["renderer"]),
            "generator": str(artifact.card["generator"]),
            "training": str(artifact.card["training"]["digest"]),
        },
        "resolution": list(wish.size),
        "policy": wish.policy.name,
        "max_edge_error_px": wish.policy.max_edge_error_px,
        "lights": [prediction_record(level, one) for one in found],
    }


def _node(light: Light) -> int:
    assert light.node is not None, "every level format says which node carries a light"
    return light.node


def _check_output(order: Order, source: bytes, level_format: LevelFormat) -> None:
    if order.in_place:
        check_in_place(order.level, source, level_format)
    else:
        check_target(order.level, order.target, level_format)


def prediction_record(level: Level, one: Predicted) -> Json:
    """An answer as JSON values."""
    light = level.scene.lights[one.light]
    record: Json = {"light": light.name, "index": one.light, "node": light.node, "problem": one.problem}
    found = one.prediction
    if found is None:
        return record
    return record | answer_record(found)


def answer_record(found: Prediction) -> Json:
    """What was predicted, without the light that it is about."""
    return {
        "source": "predicted",
        "mobility": str(found.mobility),
        "policy": found.question.name,
        "max_edge_error_px": found.question.limit,
        **_expected_record(found.chosen),
        "reason": reason(found),
        "confidence": found.confidence,
        "margin": found.margin,
        "runner_up": _expected_record(found.runner_up) if found.runner_up else None,
        "alternatives": [_expected_record(one) for one in found.expected[1:]],
        "refused": [
            {"technique": one.method.label, "settings": dict(one.settings), "reason": why}
            for one, why in found.refused
        ],
        "decided_by": [
            {"feature": one.name, "group": str(one.group), "value": one.value, "words": one.words}
            for one in found.deciding
        ],
        "outside_training": list(found.outside),
        "features": dict(found.features),
    }


def _expected_record(one: Expected) -> Json:
    return {
        "technique": one.candidate.method.label,
        "id": one.candidate.technique,
        "settings": dict(one.candidate.settings),
        "shadow_ms": one.shadow_ms,
        "shadow_ms_range": list(one.shadow_ms_range),
        "edge_error_px": one.edge_error_px,
        "edge_error_px_range": list(one.edge_error_px_range),
        "works": one.works,
        "keeps_limit": one.keeps_limit,
        "cost": one.cost,
    }
