"""A recommendation as plain values for a level file."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from scenes.light_annotation import LightAnnotation
from selector.measurement import Measurement
from selector.recommendation import Recommendation

SOURCE = "measured"


def annotation(recommendation: Recommendation) -> LightAnnotation:
    """Flat scalars for every engine, and the whole story for those that ask for it."""
    settings = dict(recommendation.chosen.candidate.settings)
    scalars: dict[str, str | float | int | bool] = {
        "gnomon_technique": recommendation.chosen.candidate.method.label
    }
    if "map_size" in settings:
        scalars["gnomon_map_size"] = settings["map_size"]
        scalars["gnomon_filter"] = settings["filter"]
        scalars["gnomon_focus"] = settings["focus"]
    scalars["gnomon_shadow_ms"] = _short(recommendation.chosen.shadow_ms)
    if recommendation.chosen.edge_error_px is not None:
        scalars["gnomon_edge_error_px"] = _short(recommendation.chosen.edge_error_px)
    if recommendation.confidence is not None:
        scalars["gnomon_confidence"] = _short(recommendation.confidence)
    scalars["gnomon_source"] = SOURCE
    return LightAnnotation(scalars, story(recommendation))


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
    outcome |= {name: _short(value) for name, value in figures.items() if value is not None}
    if one.memory_bytes:
        outcome["memoryBytes"] = one.memory_bytes
    return outcome


def _short(value: float) -> float:
    """Four significant digits: more would be noise, and noise in a level file is a diff."""
    return float(f"{value:.4g}")
