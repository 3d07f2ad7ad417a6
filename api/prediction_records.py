"""Predictions as JSON values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from api.predicting import NamedLight, Outline, Predicted, Wish
from models.artifact import Artifact
from selector.learning.predicting import Expected, Prediction, reason

Json = dict[str, Any]


def level_record(
    name: str, level: Outline, artifact: Artifact, wish: Wish, found: Sequence[Predicted]
) -> Json:
    """All answers for a level as JSON values; `name` is what it is called."""
    return {
        "level": name,
        "digest": level.digest,
        "format": level.format,
        "model": {
            "device": str(artifact.card["device"]["renderer"]),
            "generator": str(artifact.card["generator"]),
            "training": str(artifact.card["training"]["digest"]),
        },
        "resolution": list(wish.size),
        "policy": wish.policy.name,
        "max_edge_error_px": wish.policy.max_edge_error_px,
        "lights": [prediction_record(level.lights[one.light], one) for one in found],
    }


def prediction_record(light: NamedLight, one: Predicted) -> Json:
    """An answer as JSON values."""
    named = {"light": light.name, "index": one.light, "node": light.node, "kind": light.kind}
    record: Json = {**named, "problem": one.problem}
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
