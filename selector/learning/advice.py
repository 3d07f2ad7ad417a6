"""A prediction as plain values for a level file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import Any

from scenes.light_annotation import LightAnnotation
from selector.annotation import scalars, short
from selector.learning.predicting import Expected, Prediction, reason

SOURCE = "predicted"


def annotation(found: Prediction, views: Sequence[str], card: Mapping[str, Any]) -> LightAnnotation:
    """Flat scalars for every engine, and the whole story for those that ask for it.

    Args:
        found: What was predicted.
        views: Names of the cameras it was judged over.
        card: What the model says of itself.
    """
    chosen = found.chosen
    flat = scalars(chosen.candidate, chosen.shadow_ms, chosen.edge_error_px, found.confidence, source=SOURCE)
    return LightAnnotation(flat, _story(found, views, card))


def _story(found: Prediction, views: Sequence[str], card: Mapping[str, Any]) -> dict[str, Any]:
    return {
        **_outcome(found.chosen),
        "reason": reason(found),
        "keepsLimit": short(found.chosen.keeps_limit),
        "maxEdgeErrorPx": found.question.limit,
        "policy": found.question.name,
        "confidence": short(found.confidence),
        "source": SOURCE,
        "mobility": str(found.mobility),
        "alternatives": [
            *(_outcome(one) for one in found.expected if one is not found.chosen),
            *(
                {
                    "technique": one.method.label,
                    "id": one.technique,
                    "settings": dict(one.settings),
                    "status": "refused",
                    "statusReason": why,
                }
                for one, why in found.refused
            ),
        ],
        "decidedBy": [
            {"feature": one.name, "group": str(one.group), "value": short(one.value), "words": one.words}
            for one in found.deciding
        ],
        "outsideTraining": list(found.outside),
        "provenance": {
            "generator": f"gnomon {version('gnomon')}",
            "device": str(card["device"]["renderer"]),
            "trainingDigest": str(card["training"]["digest"]),
            "trainedAt": list(card["training"]["resolutions"]),
            "views": list(views),
        },
    }


def _outcome(one: Expected) -> dict[str, Any]:
    return {
        "technique": one.candidate.method.label,
        "id": one.candidate.technique,
        "settings": dict(one.candidate.settings),
        "shadowMs": short(one.shadow_ms),
        "shadowMsRange": [short(end) for end in one.shadow_ms_range],
        "edgeErrorPx": short(one.edge_error_px),
        "edgeErrorPxRange": [short(end) for end in one.edge_error_px_range],
        "keepsLimit": short(one.keeps_limit),
    }
