"""A recommendation as plain values for a level file."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from scenes.light_annotation import LightAnnotation, Scalar
from selector.candidate import Candidate
from selector.measurement import Measurement
from selector.recommendation import Recommendation

SOURCE = "measured"
OF_MAPS = "map_size", "filter", "focus"
"""Settings that engines set up a map by; the hybrid's map has no filter."""


def annotation(recommendation: Recommendation) -> LightAnnotation:
    """Flat scalars for every engine, and the whole story for those that ask for it."""
    chosen = recommendation.chosen
    flat = scalars(
        chosen.candidate, chosen.shadow_ms, chosen.edge_error_px, recommendation.confidence, source=SOURCE
    )
    return LightAnnotation(flat, story(recommendation))


def scalars(
    candidate: Candidate,
    shadow_ms: float,
    edge_error_px: float | None,
    confidence: float | None,
    *,
    source: str,
) -> dict[str, Scalar]:
    """The flat scalars that stand at a light, by key; what is not known has none."""
    settings = dict(candidate.settings)
    found: dict[str, Scalar] = {"gnomon_technique": candidate.method.label}
    found |= {f"gnomon_{name}": settings[name] for name in OF_MAPS if name in settings}
    found["gnomon_shadow_ms"] = short(shadow_ms)
    if edge_error_px is not None:
        found["gnomon_edge_error_px"] = short(edge_error_px)
    if confidence is not None:
        found["gnomon_confidence"] = short(confidence)
    found["gnomon_source"] = source
    return found


def story(recommendation: Recommendation) -> dict[str, Any]:
    """The whole recommendation as JSON values: choice, reason, alternatives, provenance."""
    measurement = recommendation.measurement
    chosen = next(one for one in measurement.measurements if one.candidate == recommendation.chosen.candidate)
    return {
        **_outcome(chosen, recommendation),
        "reason": recommendation.reason,
        "withinLimit": recommendation.within_limit,
        "maxEdgeErrorPx": recommendation.max_edge_error_px,
        "confidence": recommendation.confidence,
        "source": SOURCE,
        "mobility": str(recommendation.mobility),
        "alternatives": [
            _outcome(one, recommendation)
            for one in measurement.measurements
            if one.candidate != chosen.candidate
        ],
        "provenance": {
            "generator": f"gnomon {version('gnomon')}",
            "device": measurement.device.renderer,
            "driver": measurement.device.gl_version,
            "clock": str(measurement.clock),
            "resolution": [measurement.width, measurement.height],
            "views": list(measurement.cameras),
            "rounds": len(measurement.canary_ms[0]) if measurement.canary_ms else 0,
        },
    }


def _outcome(one: Measurement, recommendation: Recommendation) -> dict[str, Any]:
    outcome: dict[str, Any] = {
        "technique": one.candidate.method.label,
        "id": one.candidate.technique,
        "settings": dict(one.candidate.settings),
        "status": str(one.status),
    }
    if one.reason:
        outcome["statusReason"] = one.reason
    figures = {
        "shadowMs": one.shadow_ms(recommendation.mobility),
        "edgeErrorPx": one.figure("edge_error_px"),
        "wrongShare": one.figure("wrong_share"),
        "flip": one.figure("flip"),
    }
    outcome |= {name: short(value) for name, value in figures.items() if value is not None}
    if one.memory_bytes:
        outcome["memoryBytes"] = one.memory_bytes
    return outcome


def short(value: float) -> float:
    """The value with four significant digits: more would be noise, and noise in a level file is a diff."""
    return float(f"{value:.4g}")
