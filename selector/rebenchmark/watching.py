"""The lights of watched levels: what a model says about them, and whose answer another model moves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from features.level_survey import LevelSurvey
from models.artifact import Artifact
from models.examples import Question
from renderers.registry import technique
from scenes.formats.registry import read_level
from scenes.scene import Mobility
from selector.learning.predicting import Prediction, Predictor, reason, views_of
from selector.level_measuring import SeenLight, seen_lights
from selector.policy import Policy
from selector.rebenchmark.drift import Shift


@dataclass(frozen=True)
class Answer:
    """What a model says about a light.

    Attributes:
        technique: Id of the technique.
        label: The candidate, as people call it.
        shadow_ms: What it is expected to take.
        edge_error_px: How far it is expected to move the edge.
        confidence: That it is the better of the best two.
        reason: In a sentence or two.
    """

    technique: str
    label: str
    shadow_ms: float
    edge_error_px: float
    confidence: float
    reason: str


@dataclass(frozen=True)
class Move:
    """A light whose answer has moved, or would.

    Attributes:
        level: Path of its level.
        light: Its name.
        index: Its number in the level.
        mobility: Whether it stands still.
        old: What the model in force said before; None where it had no answer.
        new: What the other says.
        why: In words.
    """

    level: str
    light: str
    index: int
    mobility: Mobility
    old: Answer | None
    new: Answer
    why: str


@dataclass(frozen=True)
class WatchedLight:
    """A light of a watched level, with its views."""

    index: int
    seen: SeenLight


class WatchedLevel:
    """A level that is read and surveyed once, and asked about as often as there are models.

    Args:
        path: The level.

    Raises:
        LevelError: It cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._scene = read_level(path).scene
        self.digest = self._scene.digest
        self._survey: LevelSurvey | None = None
        lights = self._scene.lights if self._scene.triangle_count else ()
        seen = seen_lights(self._scene, lights) if lights else []
        self.lights = tuple(WatchedLight(index, one) for index, one in enumerate(seen) if one.cameras)

    def answers(self, artifact: Artifact, policy: Policy, size: tuple[int, int]) -> dict[int, Answer]:
        """Number of a light -> what the model says; without those for which it knows no candidate.

        Raises:
            ModelError: The model was learnt from other features than this program has.
        """
        if not self.lights:
            return {}
        if self._survey is None:
            self._survey = LevelSurvey.of(self._scene)
        predictor = Predictor(artifact, self._survey)
        found = {}
        for one in self.lights:
            light = one.seen.light
            question = Question(policy.name, str(light.mobility), policy.max_edge_error_px)
            predicted = predictor.predict(light, views_of(one.seen.cameras, *size), question)
            if predicted is not None:
                found[one.index] = _answer(predicted)
        return found

    def moves(
        self, old: dict[int, Answer] | None, new: dict[int, Answer], shifts: Sequence[Shift]
    ) -> tuple[Move, ...]:
        """Lights whose candidate is another now, in order; none where nothing was known before."""
        if old is None:
            return ()
        return tuple(
            Move(
                str(self.path),
                one.seen.light.name,
                one.index,
                one.seen.light.mobility,
                old.get(one.index),
                new[one.index],
                _why(old.get(one.index), new[one.index], one.seen.light.mobility, shifts),
            )
            for one in self.lights
            if one.index in new and (one.index not in old or old[one.index].label != new[one.index].label)
        )


def _answer(found: Prediction) -> Answer:
    chosen = found.chosen
    return Answer(
        chosen.candidate.technique,
        chosen.candidate.label,
        chosen.shadow_ms,
        chosen.edge_error_px,
        found.confidence,
        reason(found),
    )


def _why(old: Answer | None, new: Answer, mobility: Mobility, shifts: Iterable[Shift]) -> str:
    concerned = {new.technique} | ({old.technique} if old else set())
    words = [
        f"{technique(one.technique).label} takes {one.ratio:.2f} times as long as before ({mobility} lights)."
        for one in shifts
        if one.alarm and one.technique in concerned and one.mobility is mobility
    ]
    if not words:
        words = [
            "Its evidence was measured again, and the two are close." if old else "It had no answer before."
        ]
    return " ".join([*words, new.reason])
