"""Measurements and recommendations as JSON values, for files and for other programs."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from renderers.error_figures import ErrorFigures
from scenes.scene import Light
from selector.candidate import Candidate
from selector.level_measuring import Answer
from selector.measurement import LightMeasurement, Measurement, ViewRun
from selector.recommendation import Rated, Recommendation

Json = dict[str, Any]


def light_record(light: Light) -> Json:
    """What a program needs to find the light again."""
    return {"node": light.node, "name": light.name, "kind": str(light.kind)}


def candidate_record(candidate: Candidate) -> Json:
    """A technique by id and label, with its settings."""
    return {
        "technique": candidate.technique,
        "label": candidate.method.label,
        "settings": dict(candidate.settings),
    }


def answer_record(answer: Answer) -> Json:
    """The recommendation for one light with all that was weighed, or why there is none."""
    record = light_record(answer.light)
    if answer.measurement:
        record["verified_wrong_share"] = answer.measurement.verified_wrong_share
    if answer.recommendation is None:
        return {**record, "problem": answer.problem}
    return {**record, **_recommendation_record(answer.recommendation)}


def measurement_record(measurement: LightMeasurement) -> Json:
    """Everything that was measured about one light: every sample, counter and figure of every view."""
    light = asdict(measurement.light)
    light["range_m"] = _finite(measurement.light.range_m)
    return {
        "light": light,
        "resolution": [measurement.width, measurement.height],
        "device": measurement.device.as_dict(),
        "clock": str(measurement.clock),
        "views": list(measurement.cameras),
        "canary_ms": [list(times) for times in measurement.canary_ms],
        "verified_wrong_share": measurement.verified_wrong_share,
        "candidates": [_candidate_measurement(one) for one in measurement.measurements],
    }


def _recommendation_record(recommendation: Recommendation) -> Json:
    measurement, runner_up = recommendation.measurement, recommendation.runner_up
    return {
        "chosen": _rated_record(recommendation.chosen),
        "runner_up": _rated_record(runner_up) if runner_up else None,
        "within_limit": recommendation.within_limit,
        "confidence": recommendation.confidence,
        "reason": recommendation.reason,
        "mobility": str(recommendation.mobility),
        "views": list(measurement.cameras),
        "candidates": [_summary(one, recommendation) for one in measurement.measurements],
    }


def _rated_record(rated: Rated) -> Json:
    return {
        **candidate_record(rated.candidate),
        "shadow_ms": rated.shadow_ms,
        "edge_error_px": rated.edge_error_px,
    }


def _summary(one: Measurement, recommendation: Recommendation) -> Json:
    mobility = recommendation.mobility
    return {
        **candidate_record(one.candidate),
        "status": str(one.status),
        "reason": one.reason,
        "shadow_ms": one.shadow_ms(mobility),
        "frame_ms": one.frame_ms(mobility),
        "memory_bytes": one.memory_bytes,
        "edge_error_px": one.figure("edge_error_px"),
        "wrong_share": one.figure("wrong_share"),
        "flip": one.figure("flip"),
        "flicker": one.figure("flicker"),
    }


def _candidate_measurement(one: Measurement) -> Json:
    return {
        **candidate_record(one.candidate),
        "status": str(one.status),
        "reason": one.reason,
        "memory_bytes": one.memory_bytes,
        "views": [view_record(view) for view in one.views],
    }


def view_record(view: ViewRun) -> Json:
    """Everything about one candidate in one view."""
    return {
        "camera": view.camera,
        "truth": str(view.truth),
        "note": view.note,
        "fallback": view.fallback or None,
        "figures": figures_record(view.figures),
        "flip": view.flip,
        "flicker": view.flicker,
        "counters": dict(view.counters),
        "samples": [
            {
                "round": sample.round,
                "mobility": str(sample.mobility),
                "shadow_ms": sample.shadow_ms,
                "frame_ms": sample.frame_ms,
                "stages_ms": dict(sample.stages_ms),
            }
            for sample in view.samples
        ],
    }


def figures_record(figures: ErrorFigures | None) -> Json | None:
    """Error figures by name."""
    return asdict(figures) if figures else None


def _finite(value: float) -> float | None:
    # JSON has no infinity: null stands for a light without range.
    return value if math.isfinite(value) else None
