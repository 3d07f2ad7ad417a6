"""The answer for one light: a technique with settings, what it costs, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.scene import Array, Light, Mobility
from selector.candidate import Candidate
from selector.measurement import LightMeasurement, Measurement, Status

DEFAULT_MAX_EDGE_ERROR_PX = 1.5
# A view with too short an edge for a mean displacement may still be wrong: its wrong pixels count as if its
# edge were this long, as in the definition of the figure itself.
SHORT_EDGE_PX = 64.0
FEWEST_ROUNDS = 3
RESAMPLES = 1000
RESAMPLING_SEED = 1


@dataclass(frozen=True)
class Rated:
    """A candidate with the two numbers that decide.

    Attributes:
        candidate: What was measured.
        shadow_ms: Mean over views of the median time.
        edge_error_px: Displacement of the shadow's edge over all views; None where no view shows enough edge.
        exceedance_px: What the limit is compared with: the displacement, or its stand-in for short edges.
    """

    candidate: Candidate
    shadow_ms: float
    edge_error_px: float | None
    exceedance_px: float


@dataclass(frozen=True)
class Recommendation:
    """What to use for one light.

    Attributes:
        light: The light.
        mobility: Whether times are those of a static or a dynamic light.
        max_edge_error_px: The limit.
        chosen: The candidate to use.
        runner_up: The next best among those that keep the limit, or else the next most exact; None if there
            is no other.
        within_limit: Whether the chosen candidate keeps the limit.
        confidence: How often resampled rounds agree that it is cheaper than the runner-up; 1 where errors
            alone decide, None with fewer than three rounds.
        reason: One or two sentences for a designer.
        rated: Every candidate that could be measured, cheapest first.
        failed: Those that could not, with their status and reason.
        measurement: The evidence.
    """

    light: Light
    mobility: Mobility
    max_edge_error_px: float
    chosen: Rated
    runner_up: Rated | None
    within_limit: bool
    confidence: float | None
    reason: str
    rated: tuple[Rated, ...]
    failed: tuple[Measurement, ...]
    measurement: LightMeasurement


def recommend(
    measurement: LightMeasurement, mobility: Mobility, max_edge_error_px: float = DEFAULT_MAX_EDGE_ERROR_PX
) -> Recommendation | None:
    """The cheapest candidate within the limit, else the most exact one; None if none could be measured."""
    rated = sorted(_rated(measurement, mobility), key=lambda one: one.shadow_ms)
    if not rated:
        return None
    good = [one for one in rated if one.exceedance_px <= max_edge_error_px]
    ranked = good or sorted(rated, key=lambda one: (one.exceedance_px, one.shadow_ms))
    chosen, runner_up = ranked[0], ranked[1] if len(ranked) > 1 else None
    return Recommendation(
        light=measurement.light,
        mobility=mobility,
        max_edge_error_px=max_edge_error_px,
        chosen=chosen,
        runner_up=runner_up,
        within_limit=bool(good),
        confidence=_confidence(measurement, chosen, runner_up, mobility) if good else 1.0,
        reason=_reason(measurement, chosen, rated, max_edge_error_px, kept=bool(good)),
        rated=tuple(rated),
        failed=tuple(one for one in measurement.measurements if one.status is not Status.OK),
        measurement=measurement,
    )


def _rated(measurement: LightMeasurement, mobility: Mobility) -> list[Rated]:
    rated = []
    for one in measurement.measurements:
        shadow_ms = one.shadow_ms(mobility)
        if one.status is Status.OK and shadow_ms is not None:
            edge_error_px = one.figure("edge_error_px")
            exceedance_px = max(edge_error_px or 0.0, _short_edges(one))
            rated.append(Rated(one.candidate, shadow_ms, edge_error_px, exceedance_px))
    return rated


def _short_edges(measurement: Measurement) -> float:
    wrong = [
        (view.figures.wrong_share or 0.0) * view.figures.pixels
        for view in measurement.views
        if view.figures and view.figures.edge_error_px is None
    ]
    return max(wrong, default=0.0) / SHORT_EDGE_PX


def _confidence(
    measurement: LightMeasurement, chosen: Rated, runner_up: Rated | None, mobility: Mobility
) -> float | None:
    """Share of resampled rounds in which the chosen candidate's time stays below the runner-up's.

    The bootstrap of the very statistic that ranks them (Efron 1979): rounds are drawn anew within each view,
    the same for both, since a slow moment of the machine hits all candidates of a round.
    """
    if runner_up is None:
        return 1.0
    ours, theirs = (_by_view(measurement, one.candidate, mobility) for one in (chosen, runner_up))
    views, rounds = ours.shape
    if rounds < FEWEST_ROUNDS:
        return None
    drawn = np.random.default_rng(RESAMPLING_SEED).integers(0, rounds, (RESAMPLES, views, rounds))
    ahead = _resampled_ms(theirs, drawn) - _resampled_ms(ours, drawn)
    return float(np.mean(ahead > 0) + np.mean(ahead == 0) / 2)


def _resampled_ms(times: Array, drawn: npt.NDArray[np.int64]) -> Array:
    """(RESAMPLES,) mean over views of the median over the drawn rounds."""
    resampled: Array = np.median(np.take_along_axis(times[None], drawn, axis=2), axis=2).mean(axis=1)
    return resampled


def _by_view(measurement: LightMeasurement, candidate: Candidate, mobility: Mobility) -> Array:
    """(views, rounds) shadow_ms, in the same order for every candidate, so that rounds pair up."""
    one = next(one for one in measurement.measurements if one.candidate == candidate)
    return np.array(
        [[sample.shadow_ms for sample in view.samples if sample.mobility is mobility] for view in one.views]
    )


def _reason(
    measurement: LightMeasurement, chosen: Rated, rated: Sequence[Rated], limit: float, *, kept: bool
) -> str:
    label = chosen.candidate.label
    if not kept:
        return f"No candidate keeps the edge within {limit:g} px; {label} comes nearest: it {_fault(chosen)}."
    if unseen := _unseen(measurement, chosen):
        return f"{unseen} {label} is the cheapest."
    cheaper = [one for one in rated if one.shadow_ms < chosen.shadow_ms]
    if cheaper:
        best = min(cheaper, key=lambda one: one.exceedance_px)
        return (
            f"{label} is the cheapest that keeps the edge within {limit:g} px; the nearest cheaper one, "
            f"{best.candidate.label}, {_fault(best)}."
        )
    return f"{label} is the cheapest of all and keeps the edge within {limit:g} px."


def _unseen(measurement: LightMeasurement, chosen: Rated) -> str:
    """Why the views say little about this light; empty where they show its shadow and candidates differ."""
    one = next(one for one in measurement.measurements if one.candidate == chosen.candidate)
    figures = [view.figures for view in one.views if view.figures]
    if not any(view.pixels for view in figures):
        return "No view shows anything that this light reaches."
    if chosen.exceedance_px == 0 and not any(view.boundary_px for view in figures):
        return "No view shows an edge of this light's shadow."
    return ""


def _fault(rated: Rated) -> str:
    if rated.exceedance_px > (rated.edge_error_px or 0.0):
        pixels = round(rated.exceedance_px * SHORT_EDGE_PX)
        return f"has {pixels} wrong pixels in a view that shows little edge"
    return f"is off by {rated.exceedance_px:.2f} px"
