from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from selector.policy import DEFAULT_POLICY, MISS, POLICIES, Policy, UnknownPolicyError, policy

N, K = 5, 4
TIMES = arrays(np.float64, (N, K), elements=st.floats(0.01, 1000))
ERRORS = arrays(np.float64, (N, K), elements=st.floats(0, 20))
OK = arrays(np.bool_, (N, K))
ALL = np.ones((N, K), bool)


def test_the_three_policies() -> None:
    assert [(one.name, one.max_edge_error_px) for one in POLICIES] == [
        ("speed", 4.0),
        ("balanced", 1.5),
        ("quality", 0.5),
    ]
    assert policy("Quality") is POLICIES[2]
    assert policy(DEFAULT_POLICY) is POLICIES[1]
    with pytest.raises(UnknownPolicyError, match=r"speed, balanced, quality"):
        policy("best")


def test_by_hand() -> None:
    times = np.array([[2.0, 1.0, 8.0], [2.0, 1.0, 8.0], [2.0, 1.0, 8.0], [1.0, 1.0, 1.0]])
    errors = np.array([[1.0, 3.0, 0.0], [2.0, 3.0, 4.0], [2.0, 2.0, 4.0], [np.nan, 1.0, 1.0]])
    ok = np.array([[True, True, True]] * 3 + [[True, False, False]])
    found = policy("balanced").costs(times, errors, ok)
    assert found.tolist() == [[1.0, 10.0, 4.0], [1.0, 10.0, 10.0], [2.0, 1.0, 10.0], [10.0, 10.0, 10.0]]


def test_time_and_memory_count_where_they_are_limited() -> None:
    times, errors = np.array([[2.0, 4.0, 8.0]]), np.array([[1.0, 0.5, 0.0]])
    memory = np.array([[100.0, 10.0, 10.0]])
    ok = np.ones((1, 3), bool)
    assert Policy("", 1.5, 5.0).costs(times, errors, ok).tolist() == [[1.0, 2.0, 10.0]]
    assert Policy("", 1.5, 5.0, 50.0).costs(times, errors, ok, memory).tolist() == [[10.0, 1.0, 10.0]]
    # None is quick enough: the least exceedance of any limit wins.
    assert Policy("", 1.5, 1.0).costs(times, errors, ok).tolist() == [[1.0, 10.0, 10.0]]


@given(TIMES, ERRORS, OK, st.sampled_from(POLICIES))
def test_one_candidate_at_least_costs_one_where_any_is_ok(
    times: np.ndarray, errors: np.ndarray, ok: np.ndarray, one: Policy
) -> None:
    found = one.costs(times, errors, ok)
    assert (found >= 1).all()
    assert ((found.min(axis=1) == 1) == ok.any(axis=1)).all()
    assert (found[~ok] == MISS).all()


@given(TIMES, ERRORS, st.sampled_from(POLICIES))
def test_the_cheapest_is_the_fastest_that_keeps_the_limit(
    times: np.ndarray, errors: np.ndarray, one: Policy
) -> None:
    found = one.costs(times, errors, ALL)
    for row in range(N):
        kept = np.flatnonzero(errors[row] <= one.max_edge_error_px)
        if len(kept):
            assert times[row, found[row].argmin()] == times[row, kept].min()
            assert found[row, kept] == pytest.approx(times[row, kept] / times[row, kept].min())
        else:
            assert errors[row, found[row].argmin()] == errors[row].min()


@given(TIMES, ERRORS, OK, st.sampled_from(POLICIES), st.sampled_from([0.25, 2.0, 1024.0]))
def test_a_device_that_is_faster_throughout_changes_no_cost(
    times: np.ndarray, errors: np.ndarray, ok: np.ndarray, one: Policy, factor: float
) -> None:
    assert (one.costs(times * factor, errors, ok) == one.costs(times, errors, ok)).all()


@given(TIMES, ERRORS, OK, st.sampled_from(POLICIES), st.permutations(range(K)))
def test_the_order_of_candidates_does_not_matter(
    times: np.ndarray, errors: np.ndarray, ok: np.ndarray, one: Policy, order: list[int]
) -> None:
    shuffled = one.costs(times[:, order], errors[:, order], ok[:, order])
    assert (shuffled == one.costs(times, errors, ok)[:, order]).all()


@given(TIMES, ERRORS, OK, st.sampled_from(POLICIES))
def test_getting_faster_never_raises_the_own_cost(
    times: np.ndarray, errors: np.ndarray, ok: np.ndarray, one: Policy
) -> None:
    quicker = times.copy()
    quicker[:, 0] /= 2
    assert (one.costs(quicker, errors, ok)[:, 0] <= one.costs(times, errors, ok)[:, 0]).all()
