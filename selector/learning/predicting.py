"""Recommends a technique for a light without rendering anything: from features, by a model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from features.extraction import extract
from features.level_survey import LevelSurvey
from features.table import FEATURES, NAMES, Group
from models.artifact import Artifact, ModelError
from models.examples import Floats, Question
from models.expecting import interval, keeps_limit
from models.performance import ERROR, Predicted
from models.selector_model import SINGLE, SelectorModel
from renderers.context import DeviceLimits
from scenes.scene import Camera, Light, LightKind, Mobility, View
from selector.candidate import Candidate, candidates
from selector.learning.dataset import Slot, rounded
from selector.learning.odds import ahead
from selector.learning.testing import require_same_features

INTERVAL = 0.8
"""Share of lights of unseen families whose true value lies between the ends that are told."""

LEAST_SHOWN = 0.01
"""Milliseconds and pixels below this are none to a designer."""

MOST_DECIDING = 3
LEAST_INFLUENCE = 0.02
"""Of the cost: a feature that matters less has not decided."""

CONE = "cone_half_angle"
WITHOUT_CONE = {180.0: "it shines all around", 0.0: "its light is parallel"}
"""Degrees of lights that have no cone."""


@dataclass(frozen=True)
class Expected:
    """What is expected of one candidate.

    Attributes:
        candidate: The candidate.
        cost: Expected cost under the policy, at least about 1.
        shadow_ms: Mean over views.
        shadow_ms_range: Where four of five such lights lie.
        edge_error_px: The worst of the views.
        edge_error_px_range: Where four of five such lights lie.
        works: Probability that it does not fall back or fail.
        keeps_limit: Probability that it works and keeps the limit in every view.
    """

    candidate: Candidate
    cost: float
    shadow_ms: float
    shadow_ms_range: tuple[float, float]
    edge_error_px: float
    edge_error_px_range: tuple[float, float]
    works: float
    keeps_limit: float


@dataclass(frozen=True)
class Deciding:
    """A feature that speaks for the chosen technique.

    Attributes:
        name: Of the feature.
        value: Mean over views.
        group: What it is about.
        words: What the value means.
        influence: By how much the advantage over the best other technique would shrink, had the feature its
            usual value.
    """

    name: str
    value: float
    group: Group
    words: str
    influence: float


@dataclass(frozen=True)
class Prediction:
    """What to use for one light, as far as can be told without rendering.

    Attributes:
        mobility: Whether times are those of a static or a dynamic light.
        question: The policy: its name and limit.
        chosen: The candidate to use.
        runner_up: The next best; None if there is no other.
        margin: By how much more the runner-up is expected to cost, as a share of the chosen one's cost.
        confidence: Probability that the chosen candidate is the better of the two.
        expected: Every candidate that is not refused, the best first.
        refused: Candidates that cannot serve, with the reason.
        deciding: The features that decided, the weightiest first.
        outside: Features whose values lie outside those that were learnt from.
        features: Mean over views.
    """

    mobility: Mobility
    question: Question
    chosen: Expected
    runner_up: Expected | None
    margin: float | None
    confidence: float
    expected: tuple[Expected, ...]
    refused: tuple[tuple[Candidate, str], ...]
    deciding: tuple[Deciding, ...]
    outside: tuple[str, ...]
    features: Mapping[str, float]


@dataclass(frozen=True)
class LightFacts:
    """What a model is asked with about one light of a level; no policy changes it.

    Attributes:
        kind: Of the light.
        rows: (v, f) its features in each view, in the table's order.
        refused: Candidates that cannot serve, with the reason.
    """

    kind: LightKind
    rows: Floats
    refused: Mapping[Candidate, str] = field(default_factory=dict)


class Advisor:
    """A model that is ready to be asked about lights whose features are known.

    Args:
        artifact: The model.

    Raises:
        ModelError: It was learnt from other features than this program has.
    """

    def __init__(self, artifact: Artifact) -> None:
        require_same_features(artifact)
        self._model = artifact.model
        self._card = artifact.card
        self._slots = _slots(artifact)
        limits = artifact.card["limits"]
        self._limits = DeviceLimits(int(limits["max_texture_side"]), int(limits["max_buffer_bytes"]))

    def advise(
        self, light: LightFacts, question: Question, labels: tuple[str, ...] = ()
    ) -> Prediction | None:
        """The answer for one light; None where every candidate is refused.

        Args:
            light: What is known of it.
            question: The policy, and the mobility, whose time counts.
            labels: Techniques to choose from; all where empty.
        """
        wanted = self._candidates(light.kind, labels)
        left = [one for one in wanted if one not in light.refused]
        refused = tuple((one, light.refused[one]) for one in wanted if one in light.refused)
        return self._answer(rounded(light.rows), question, left, refused) if left else None

    def _candidates(self, kind: LightKind, labels: tuple[str, ...] = ()) -> list[Candidate]:
        """Those that the model knows."""
        return [
            one
            for one in candidates(kind, self._limits, labels)
            if Slot.of(one.technique, dict(one.settings)) in self._slots
        ]

    def _answer(
        self,
        rows: Floats,
        question: Question,
        left: Sequence[Candidate],
        refused: tuple[tuple[Candidate, str], ...],
    ) -> Prediction:
        columns = np.array([self._slots.index(Slot.of(one.technique, dict(one.settings))) for one in left])
        # All at once: most of the time goes into asking at all.
        everything = np.concatenate([rows, self._varied(rows)])
        predicted = self._model.performance.predict(everything, question.time)
        all_costs = self._model.costs(everything, question, predicted=predicted)
        costs = all_costs[: len(rows)].mean(axis=0)
        expected = self._expected(predicted.only(np.arange(len(rows))), costs, question, left, columns)
        ranked = sorted(expected, key=lambda one: (one.cost, one.shadow_ms))
        chosen, runner_up = ranked[0], ranked[1] if len(ranked) > 1 else None
        places = dict(zip(left, columns.tolist(), strict=True))
        return Prediction(
            mobility=Mobility(question.time),
            question=question,
            chosen=chosen,
            runner_up=runner_up,
            margin=runner_up.cost / chosen.cost - 1 if runner_up else None,
            confidence=self._confidence(chosen, runner_up, question),
            expected=tuple(ranked),
            refused=refused,
            deciding=self._deciding(rows, ranked, places, costs, all_costs[len(rows) :]),
            outside=self._outside(rows),
            features=dict(zip(NAMES, rows.mean(axis=0).tolist(), strict=True)),
        )

    def _expected(
        self,
        predicted: Predicted,
        costs: Floats,
        question: Question,
        left: Sequence[Candidate],
        columns: Floats,
    ) -> list[Expected]:
        model: SelectorModel = self._model
        likely = keeps_limit(predicted, model.missed, model.choices, question.limit)
        times, errors = (
            _ranged(predicted, model, target)[:, :, columns] for target in (question.time, ERROR)
        )
        ms = np.exp(times).mean(axis=1).T.tolist()
        px = np.maximum(np.expm1(errors).max(axis=1), 0.0).T.tolist()
        works, keeps = (values[:, columns].min(axis=0).tolist() for values in (predicted.works, likely))
        return [
            Expected(one, cost, *_with_range(ms[index]), *_with_range(px[index]), works[index], keeps[index])
            for index, (one, cost) in enumerate(zip(left, costs[columns].tolist(), strict=True))
        ]

    def _confidence(self, chosen: Expected, runner_up: Expected | None, question: Question) -> float:
        if runner_up is None:
            return 1.0
        missed = self._model.missed[question.time]
        methods = [
            self._model.choices.method[
                self._slots.index(Slot.of(one.candidate.technique, dict(one.candidate.settings)))
            ]
            for one in (chosen, runner_up)
        ]
        faster = ahead(
            np.log(chosen.shadow_ms) + missed[methods[0]], np.log(runner_up.shadow_ms) + missed[methods[1]]
        )
        ours, theirs = chosen.keeps_limit, runner_up.keeps_limit
        neither = (1 - ours) * (1 - theirs)
        return ours * (1 - theirs) + ours * theirs * faster + neither / 2

    def _varied(self, rows: Floats) -> Floats:
        """(f * v, f) the features of each view, with one after the other at its usual value."""
        if self._model.method == SINGLE:
            return rows[:0]
        usual = np.array([self._card["ranges"][name][1] for name in NAMES])
        varied = np.tile(rows[None], (len(NAMES), 1, 1))
        for index in range(len(NAMES)):
            varied[index, :, index] = usual[index]
        return rounded(varied.reshape(-1, len(NAMES)))

    def _deciding(
        self,
        rows: Floats,
        ranked: Sequence[Expected],
        columns: Mapping[Candidate, int],
        now: Floats,
        varied: Floats,
    ) -> tuple[Deciding, ...]:
        """What would shrink the advantage over the best other technique, were it as usual.

        Args:
            rows: Features by view.
            ranked: All candidates, the best first.
            columns: Their places among the costs.
            now: (k,) costs as they are.
            varied: (f * v, k) costs with each feature at its usual value.
        """
        chosen = ranked[0].candidate
        others = [one.candidate for one in ranked if one.candidate.technique != chosen.technique]
        if not len(varied) or not others:
            return ()
        ours, theirs = columns[chosen], columns[others[0]]
        usual = np.array([self._card["ranges"][name][1] for name in NAMES])
        advantage = (varied[:, theirs] - varied[:, ours]).reshape(len(NAMES), len(rows)).mean(axis=1)
        influence = (now[theirs] - now[ours]) - advantage
        mean = rows.mean(axis=0)
        found = []
        for index in np.argsort(-influence, kind="stable")[:MOST_DECIDING].tolist():
            if influence[index] < LEAST_INFLUENCE:
                break
            feature = FEATURES[index]
            value = float(mean[index])
            words = WITHOUT_CONE.get(value) if feature.name == CONE else None
            words = words or (feature.high if value > usual[index] else feature.low)
            found.append(Deciding(feature.name, value, feature.group, words, float(influence[index])))
        return tuple(found)

    def _outside(self, rows: Floats) -> tuple[str, ...]:
        ranges = np.array([self._card["ranges"][name] for name in NAMES])
        beyond = (rows < ranges[:, 0]) | (rows > ranges[:, 2])
        return tuple(np.array(NAMES)[beyond.any(axis=0)].tolist())


class Predictor(Advisor):
    """A model that is ready to be asked about the lights of a level.

    Args:
        artifact: The model.
        survey: The level.

    Raises:
        ModelError: It was learnt from other features than this program has.
    """

    def __init__(self, artifact: Artifact, survey: LevelSurvey) -> None:
        super().__init__(artifact)
        self._survey = survey

    def facts(self, light: Light, views: Sequence[View]) -> LightFacts:
        """What is known of a light of the level before the model is asked.

        Args:
            light: One of the level's lights.
            views: What it is judged over.
        """
        reasons = {
            one: one.method.refuses(light, self._survey.scene, self._limits, dict(one.settings))
            for one in self._candidates(light.kind)
        }
        refused = {one: reason for one, reason in reasons.items() if reason is not None}
        rows = [list(extract(self._survey, light, view).values.values()) for view in views]
        return LightFacts(light.kind, np.array(rows), refused)

    def predict(
        self, light: Light, views: Sequence[View], question: Question, labels: tuple[str, ...] = ()
    ) -> Prediction | None:
        """The answer for one light over some views; the arguments are those of `facts` and `advise`."""
        return self.advise(self.facts(light, views), question, labels)


def reason(prediction: Prediction) -> str:
    """One or two sentences for a designer."""
    chosen, limit = prediction.chosen, prediction.question.limit
    ms, px = _between(chosen.shadow_ms_range, "ms"), _between(chosen.edge_error_px_range, "px")
    words = f"{chosen.candidate.label} is expected to take {ms} and to move the shadow's edge by {px}"
    if chosen.keeps_limit < 0.5:
        words += f"; nothing is likely to keep it within {limit:g} px"
    if prediction.deciding:
        words += f". What decided: {', '.join(one.words for one in prediction.deciding)}"
    return f"{words}."


def _between(ends: tuple[float, float], unit: str) -> str:
    if ends[1] < LEAST_SHOWN:
        return f"less than {LEAST_SHOWN:g} {unit}"
    low, high = (f"{end:.2g}" for end in ends)
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def _ranged(predicted: Predicted, model: SelectorModel, target: str) -> Floats:
    """(3, v, k): the prediction, and the ends between which four of five lie."""
    values = predicted.target(target)
    low, high = interval(values, model.missed, model.choices, target, INTERVAL)
    return np.stack([values, np.minimum(low, values), np.maximum(high, values)])


def _with_range(three: list[float]) -> tuple[float, tuple[float, float]]:
    value, low, high = three
    return value, (low, high)


def _slots(artifact: Artifact) -> list[Slot]:
    """The model's choices.

    Raises:
        ModelError: Its card does not tell them, or not as many.
    """
    try:
        slots = [
            Slot(str(one["technique"]), tuple((str(name), value) for name, value in one["settings"]))
            for one in artifact.card["choices"]
        ]
        ranges = artifact.card["ranges"]
        complete = all(len([float(end) for end in ranges[name]]) == 3 for name in NAMES)
        limits = artifact.card["limits"]
        complete &= int(limits["max_texture_side"]) > 0 and int(limits["max_buffer_bytes"]) > 0
    except (KeyError, TypeError, ValueError) as error:
        raise ModelError("This model's card lacks a part.", known=f"{error!r:.100}") from error
    if len(slots) != len(artifact.model.choices.method) or not complete:
        raise ModelError("This model's card contradicts the model.")
    return slots


def views_of(cameras: Sequence[Camera], width: int, height: int) -> tuple[View, ...]:
    """Cameras with a resolution."""
    return tuple(View(camera, width, height) for camera in cameras)
