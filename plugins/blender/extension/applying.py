"""An answer of the service becomes properties of lights."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .annotation import annotate, clear, properties
from .client.records import LevelAnswer, Recommendation
from .scene_lights import light_by_uid


@dataclass
class Applied:
    """What became of an answer.

    Attributes:
        told: Names of lights that have a recommendation now.
        problems: Sentences about the others.
        details: `session_uid` of a light to what the panel shows beyond its properties.
    """

    told: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    details: dict[int, Detail] = field(default_factory=dict)


@dataclass(frozen=True)
class Detail:
    """What is said of a light beyond its properties: why, or why not.

    Attributes:
        recommendation: The answer; None where there is none.
        words: Its reason, or the problem.
    """

    recommendation: Recommendation | None
    words: str


def apply(answer: LevelAnswer, nodes: Mapping[int, int | None]) -> Applied:
    """Gives each light the recommendation for its node. In the main thread only.

    Args:
        answer: What the service said.
        nodes: Node index to the light's `session_uid`, as exported.
    """
    done = Applied()
    for uid, details in _by_light(answer, nodes, done).items():
        light = light_by_uid(uid)
        if light is None:
            done.problems.append("A light is gone meanwhile.")
            continue
        if not light.is_editable:
            done.problems.append(f"{light.name} is linked from a library and cannot be changed here.")
            continue
        detail = _together(details)
        done.details[uid] = detail
        if detail.recommendation is None:
            clear(light)
            done.problems.append(f"{light.name}: {detail.words}")
        else:
            annotate(light, properties(detail.recommendation))
            done.told.append(light.name)
    return done


def _by_light(answer: LevelAnswer, nodes: Mapping[int, int | None], done: Applied) -> dict[int, list[Detail]]:
    found: dict[int, list[Detail]] = {}
    for one in answer.lights:
        uid = nodes.get(-1 if one.node is None else one.node)
        if uid is None:
            done.problems.append(f"{one.light[:60]} comes from geometry nodes, and is no light of its own.")
        else:
            words = one.recommendation.reason if one.recommendation else one.problem
            found.setdefault(uid, []).append(Detail(one.recommendation, words))
    return found


def _together(details: list[Detail]) -> Detail:
    """One answer for all instances of a light: that of the instance whose shadow costs the most time."""
    answered = [one for one in details if one.recommendation]
    if not answered:
        return details[0]
    costly = max(answered, key=lambda one: one.recommendation.shadow_ms if one.recommendation else 0.0)
    if len(details) == 1:
        return costly
    kinds = {
        (one.recommendation.technique, str(one.recommendation.settings))
        for one in answered
        if one.recommendation
    }
    agree = "all alike" if len(kinds) == 1 and len(answered) == len(details) else "this is for the costliest"
    return Detail(costly.recommendation, f"{costly.words} The light has {len(details)} instances; {agree}.")
