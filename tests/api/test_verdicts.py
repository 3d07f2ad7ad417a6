from __future__ import annotations

from api.verdicts import measurement_of, off_words, shows_shadow_edge
from renderers.error_figures import ErrorFigures
from scenes.scene import Mobility
from selector.candidate import Candidate
from selector.recommendation import Recommendation, recommend
from tests.selector.measurements import SV, figures, light_measurement, measured, shadow_map, view

SHORT = figures(None, wrong_share=0.028, pixels=1000, boundary_px=20.0)


def recommended(*views: ErrorFigures, candidate: Candidate | None = None) -> Recommendation:
    shown = [view([1.0], one) for one in views]
    found = recommend(light_measurement(measured(candidate or shadow_map(256), *shown)), Mobility.DYNAMIC)
    assert found is not None
    return found


def words(*views: ErrorFigures, candidate: Candidate | None = None) -> str:
    found = recommended(*views, candidate=candidate)
    return off_words(measurement_of(found, found.chosen), found.chosen)


def test_an_edge_is_told_in_pixels() -> None:
    assert words(figures(0.52, wrong_share=0.01)) == "0.52"


def test_without_an_edge_the_wrong_pixels_are_told() -> None:
    assert words(SHORT) == "wrong 2.8 %"


def test_both_are_told_where_the_view_without_an_edge_decides() -> None:
    assert words(figures(0.2, wrong_share=0.001), SHORT) == "0.20, wrong 2.8 %"


def test_the_ground_truth_is_exact_and_no_other() -> None:
    assert words(figures(0.0), candidate=SV) == "exact"
    assert words(figures(0.0)) == "0.00"


def test_nothing_is_told_where_nothing_is_seen() -> None:
    assert words(figures(None, pixels=0)) == ""


def test_a_shadow_shows_by_its_edge() -> None:
    assert shows_shadow_edge(recommended(figures(None, boundary_px=0.0), SHORT))
    assert not shows_shadow_edge(recommended(figures(None, boundary_px=0.0), figures(None, pixels=0)))
