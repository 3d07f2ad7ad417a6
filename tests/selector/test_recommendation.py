from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.scene import Mobility
from selector.measurement import Status
from selector.recommendation import SHORT_EDGE_PX, recommend
from tests.selector.measurements import SV, figures, light_measurement, measured, shadow_map, view

CHEAP, GOOD, FINE = shadow_map(256), shadow_map(1024), shadow_map(4096)


def test_the_cheapest_within_the_limit_wins() -> None:
    measurement = light_measurement(
        measured(CHEAP, view([1.0], figures(3.0))),
        measured(FINE, view([9.0], figures(0.1))),
        measured(GOOD, view([4.0], figures(1.5))),
        measured(SV, view([6.0], figures(0.0))),
    )
    answer = recommend(measurement, Mobility.DYNAMIC, 1.5)
    assert answer is not None
    assert answer.chosen.candidate == GOOD
    assert answer.runner_up is not None
    assert answer.runner_up.candidate == SV
    assert answer.within_limit
    assert "SM 256 2x2, is off by 3.00 px" in answer.reason


def test_the_most_exact_wins_where_none_keeps_the_limit() -> None:
    measurement = light_measurement(
        measured(CHEAP, view([1.0], figures(9.0))),
        measured(GOOD, view([2.0], figures(5.0))),
        measured(FINE, view([7.0], figures(5.0))),
    )
    answer = recommend(measurement, Mobility.DYNAMIC, 1.5)
    assert answer is not None
    # Of two that are equally exact, the cheaper one.
    assert answer.chosen.candidate == GOOD
    assert not answer.within_limit
    assert answer.reason.startswith("No candidate keeps the edge within 1.5 px")


def test_a_tie_goes_to_the_first_candidate() -> None:
    times = view([2.0, 2.0, 2.0], figures(0.5))
    answer = recommend(light_measurement(measured(GOOD, times), measured(SV, times)), Mobility.DYNAMIC)
    assert answer is not None
    assert answer.chosen.candidate == GOOD
    assert answer.confidence == 0.5


def test_a_view_with_a_short_edge_judges_by_its_wrong_pixels() -> None:
    pixels = 6400
    share = 2 * SHORT_EDGE_PX / pixels
    measurement = light_measurement(
        measured(CHEAP, view([1.0], figures(None, wrong_share=share, pixels=pixels, boundary_px=20.0))),
        measured(SV, view([5.0], figures(None, pixels=pixels, boundary_px=20.0))),
    )
    strict = recommend(measurement, Mobility.DYNAMIC, 1.5)
    lax = recommend(measurement, Mobility.DYNAMIC, 2.0)
    assert strict is not None
    assert lax is not None
    assert strict.chosen.candidate == SV
    assert strict.chosen.edge_error_px is None
    assert lax.chosen.candidate == CHEAP
    assert lax.chosen.exceedance_px == pytest.approx(2.0)


def test_the_worst_view_decides() -> None:
    measurement = light_measurement(
        measured(CHEAP, view([1.0], figures(0.1)), view([1.0], figures(2.0), camera="Other")),
        measured(SV, view([5.0], figures(0.0)), view([5.0], figures(0.0), camera="Other")),
    )
    answer = recommend(measurement, Mobility.DYNAMIC, 1.5)
    assert answer is not None
    assert answer.chosen.candidate == SV


def test_a_candidate_that_failed_is_never_chosen_and_always_named() -> None:
    failing = [status for status in Status if status is not Status.OK]
    failed = [
        measured(shadow_map(128 + index), view([0.1], figures(0.0)), status=status, reason="because")
        for index, status in enumerate(failing)
    ]
    measurement = light_measurement(*failed, measured(SV, view([5.0], figures(0.0))))
    answer = recommend(measurement, Mobility.DYNAMIC)
    assert answer is not None
    assert answer.chosen.candidate == SV
    assert answer.runner_up is None
    assert answer.confidence == 1.0
    assert [one.status for one in answer.failed] == failing


def test_no_answer_where_nothing_could_be_measured() -> None:
    measurement = light_measurement(measured(SV, status=Status.GL_ERROR, reason="broken"))
    assert recommend(measurement, Mobility.DYNAMIC) is None


def test_static_lights_are_judged_by_static_times() -> None:
    measurement = light_measurement(
        measured(GOOD, view([9.0], figures(0.5), static=[1.0])),
        measured(SV, view([5.0], figures(0.0), static=[4.0])),
    )
    static, dynamic = (recommend(measurement, mobility) for mobility in (Mobility.STATIC, Mobility.DYNAMIC))
    assert static is not None
    assert dynamic is not None
    assert (static.chosen.candidate, static.chosen.shadow_ms) == (GOOD, 1.0)
    assert (dynamic.chosen.candidate, dynamic.chosen.shadow_ms) == (SV, 5.0)


def confidence(ours: list[float], theirs: list[float]) -> float | None:
    answer = recommend(
        light_measurement(measured(GOOD, view(ours, figures(0.5))), measured(SV, view(theirs, figures(0.0)))),
        Mobility.DYNAMIC,
    )
    assert answer is not None
    return answer.confidence


def test_confidence_says_how_often_resampled_rounds_agree() -> None:
    once_slow = confidence([1.0, 2.0, 9.0, 2.0], [4.0, 4.0, 4.0, 4.0])
    assert once_slow is not None
    assert 0.6 < once_slow < 0.95
    assert confidence([1.0, 1.1, 1.2], [4.0, 4.1, 4.2]) == 1.0
    # The faster median belongs to the one that is chosen, however rarely it wins a round.
    close = confidence([1.0, 2.0, 3.0], [1.01, 2.01, 3.01])
    assert close == 1.0
    mixed = confidence([1.0, 2.0, 3.0], [3.0, 2.1, 1.0])
    assert mixed is not None
    assert 0.3 < mixed < 0.9


def test_two_rounds_are_too_few_for_confidence() -> None:
    assert confidence([1.0, 1.0], [4.0, 4.0]) is None


def test_time_is_the_mean_over_views_of_the_median_over_rounds() -> None:
    one = measured(
        SV, view([1.0, 2.0, 90.0], figures(0.0)), view([4.0, 4.0, 4.0], figures(0.0), camera="Other")
    )
    answer = recommend(light_measurement(one), Mobility.DYNAMIC)
    assert answer is not None
    assert answer.chosen.shadow_ms == 3.0


@pytest.mark.parametrize(
    ("errors", "words"),
    [
        (figures(None, pixels=0), "No view shows anything that this light reaches."),
        (figures(None, boundary_px=0.0), "No view shows an edge of this light's shadow."),
    ],
)
def test_the_reason_says_where_views_say_nothing(errors: object, words: str) -> None:
    answer = recommend(light_measurement(measured(SV, view([1.0], errors))), Mobility.DYNAMIC)  # type: ignore[arg-type]
    assert answer is not None
    assert answer.reason.startswith(words)


@given(st.lists(st.tuples(st.floats(0.01, 100), st.floats(0, 20)), min_size=1, max_size=8), st.floats(0, 10))
def test_nothing_that_keeps_the_limit_is_cheaper(figures_of: list[tuple[float, float]], limit: float) -> None:
    measurement = light_measurement(
        *(measured(shadow_map(index), view([ms], figures(px))) for index, (ms, px) in enumerate(figures_of))
    )
    answer = recommend(measurement, Mobility.DYNAMIC, limit)
    assert answer is not None
    good = [ms for ms, px in figures_of if px <= limit]
    assert answer.within_limit == bool(good)
    if good:
        assert answer.chosen.shadow_ms == min(good)
    else:
        assert answer.chosen.exceedance_px == min(px for _, px in figures_of)
