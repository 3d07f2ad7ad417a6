"""What is said of a candidate's error, in the words that tables and sheets share."""

from __future__ import annotations

from renderers.registry import GROUND_TRUTH
from selector.measurement import Measurement, Truth
from selector.recommendation import Rated, Recommendation

EXACT = "exact"


def is_exact_by_definition(one: Measurement) -> bool:
    """Whether it is the ground truth itself, so that its error says nothing."""
    return one.candidate.technique == GROUND_TRUTH and all(
        view.truth is Truth.SHADOW_VOLUME for view in one.views
    )


def off_words(one: Measurement, rated: Rated, edge: str = "{:.2f}") -> str:
    """How far off a candidate is: `0.52`, `exact`, `wrong 2.8 %`, or nothing where there is no figure.

    Args:
        one: What was measured of it.
        rated: What was made of that.
        edge: How a displacement of the edge in pixels is said.

    The share of wrong pixels is told where there is no displacement, and beside it where views with too
    little edge for one decide.
    """
    if is_exact_by_definition(one) and not rated.exceedance_px:
        return EXACT
    parts = [] if rated.edge_error_px is None else [edge.format(rated.edge_error_px)]
    wrong_share = one.figure("wrong_share")
    if wrong_share is not None and (not parts or rated.exceedance_px > (rated.edge_error_px or 0.0)):
        parts.append(f"wrong {100 * wrong_share:.2g} %")
    return ", ".join(parts)


def measurement_of(recommendation: Recommendation, rated: Rated) -> Measurement:
    """The evidence for one candidate."""
    return next(one for one in recommendation.measurement.measurements if one.candidate == rated.candidate)


def shows_shadow_edge(recommendation: Recommendation) -> bool:
    """Whether any view shows the edge of a shadow of this light.

    Where none does, the light may as well shine without shadows, unless it is wholly in the dark there, as
    a lamp behind a wall is.
    """
    return any(shows_edge(one) for one in recommendation.measurement.measurements)


def shows_edge(one: Measurement) -> bool:
    """Whether any view of a candidate shows the edge of a true shadow."""
    return any(view.figures.boundary_px > 0 for view in one.views if view.figures)
