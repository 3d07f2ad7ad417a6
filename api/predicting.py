"""A level and a model go in, and answers come out: nothing is rendered."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from api.choosing import chosen_cameras, chosen_lights, require_triangles
from features.level_survey import LevelSurvey
from models.artifact import Artifact
from models.examples import Question
from renderers.registry import technique
from scenes.level import Level
from scenes.scene import Mobility
from selector.learning.predicting import Advisor, LightFacts, Prediction, Predictor, views_of
from selector.level_measuring import STRIKES_NOTHING, seen_lights
from selector.policy import Policy

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


@dataclass(frozen=True)
class NamedLight:
    """A light as an answer names it.

    Attributes:
        name: As in the level.
        node: That carries it.
        kind: Spot, point or directional.
    """

    name: str
    node: int | None
    kind: str


@dataclass(frozen=True)
class Outline:
    """What is left of a level where its geometry is no longer needed.

    Attributes:
        format: What its file holds.
        digest: Of the scene.
        lights: All of them, in the level's order.
    """

    format: str
    digest: str
    lights: tuple[NamedLight, ...]

    @classmethod
    def of(cls, level: Level) -> Outline:
        """Of a level."""
        lights = (NamedLight(one.name, one.node, str(one.kind)) for one in level.scene.lights)
        return cls(level.format, level.scene.digest, tuple(lights))


@dataclass(frozen=True)
class KnownLight:
    """A light of a level before a model is asked about it; neither policy nor mobility change it.

    Attributes:
        light: Its place in the level.
        mobility: What the level says of it.
        views: Names of the cameras that it is judged over.
        facts: What a model is asked with; None where nothing can be asked.
        problem: Why not; empty where there are facts.
    """

    light: int
    mobility: Mobility
    views: tuple[str, ...] = ()
    facts: LightFacts | None = None
    problem: str = ""


def known_lights(level: Level, artifact: Artifact, wish: Wish) -> Iterator[KnownLight]:
    """The lights that are wanted, in the level's order, with their features. No GPU.

    Raises:
        ModelError: The model was learnt from other features.
        LevelError: The level has no triangles or lights, or not those that are wanted.
    """
    require_triangles(level)
    wanted = chosen_lights(level, wish.lights)
    seen = seen_lights(level.scene, wanted, chosen_cameras(level, wish.cameras))
    predictor = Predictor(artifact, LevelSurvey.of(level.scene))
    places = {id(light): index for index, light in enumerate(level.scene.lights)}
    for one in seen:
        index, mobility = places[id(one.light)], one.light.mobility
        if one.cameras:
            facts = predictor.facts(one.light, views_of(one.cameras, *wish.size))
            yield KnownLight(index, mobility, tuple(camera.name for camera in one.cameras), facts)
        else:
            yield KnownLight(index, mobility, problem=one.problem or STRIKES_NOTHING)


def answered(lights: Iterable[KnownLight], artifact: Artifact, wish: Wish) -> Iterator[Predicted]:
    """One answer a light, in the order given.

    Raises:
        ModelError: The model was learnt from other features.
        UnknownTechniqueError: A technique is not known.
    """
    for name in wish.techniques:
        technique(name)
    advisor = Advisor(artifact)
    for one in lights:
        if one.facts is None:
            yield Predicted(one.light, problem=one.problem)
            continue
        mobility, limit = wish.mobility or one.mobility, wish.policy.max_edge_error_px
        question = Question(wish.policy.name, str(mobility), limit)
        found = advisor.advise(one.facts, question, wish.techniques)
        yield Predicted(one.light, one.views, found, "" if found else EVERY_CANDIDATE_REFUSED)


def predicted(level: Level, artifact: Artifact, wish: Wish) -> Iterator[Predicted]:
    """One answer a light, in the level's order; what may be raised is told at the two steps."""
    return answered(known_lights(level, artifact, wish), artifact, wish)
