from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.evaluation import closed_gap, evaluate, evaluate_as_is
from models.examples import Choices, folds
from models.expecting import expected_costs, interval, keeps_limit
from models.performance import ERROR, PERCENTS, PerformanceModel, Predicted, residuals
from models.selector_model import FOREST, METHODS, PERFORMANCE, SelectorModel, chosen, single_best
from tests.models.synthetic import CHOICES, MISS, QUESTIONS, synthetic
from tests.tolerances import COVERAGE, LEARNT_GAP

EXAMPLES = synthetic()


@pytest.fixture(scope="module")
def model() -> SelectorModel:
    return SelectorModel.fit(EXAMPLES, MISS)


def test_folds_never_part_a_family() -> None:
    families = np.array([*"aaaabbbccdef"])
    seen = []
    for train, test in folds(families, 3):
        assert not set(families[train]) & set(families[test])
        assert len(train) + len(test) == len(families)
        seen += test.tolist()
    assert sorted(seen) == list(range(12))
    assert len(list(folds(families, 99))) == 6
    assert [test.tolist() for _, test in folds(families, 3)] == [
        test.tolist() for _, test in folds(families, 3)
    ]


def test_every_family_weighs_the_same() -> None:
    some = EXAMPLES.only(np.arange(20))
    weights = some.weights
    assert weights.sum() == pytest.approx(20)
    assert weights[:14].sum() == pytest.approx(weights[14:].sum())


def test_a_learner_closes_most_of_the_gap_on_unseen_families() -> None:
    for verdict in evaluate(EXAMPLES, MISS, count=3):
        assert verdict.gap.claimed
        assert verdict.gap.closed is not None
        assert verdict.gap.closed > LEARNT_GAP
        assert verdict.gap.low is not None
        assert verdict.gap.high is not None
        assert verdict.gap.low < verdict.gap.closed < verdict.gap.high
        assert set(verdict.by_family) == set(EXAMPLES.families.tolist())
        assert verdict.wins.sum() == verdict.picks.sum() == len(EXAMPLES)
        assert set(verdict.methods) == {PERFORMANCE, FOREST}
        assert 0 <= verdict.misses <= verdict.worse <= 1
        assert verdict.regret_time >= 0


def test_a_finished_model_is_judged_wherever_its_choices_stand() -> None:
    families = np.unique(EXAMPLES.families)
    unseen = np.isin(EXAMPLES.families, families[:3])
    model = SelectorModel.fit(EXAMPLES.only(np.flatnonzero(~unseen)), MISS)
    held = EXAMPLES.only(np.flatnonzero(unseen))
    same = np.arange(held.offered.shape[1])
    verdicts = evaluate_as_is(model, held, same, MISS)
    for index, verdict in enumerate(verdicts):
        question = EXAMPLES.questions[index]
        picked = chosen(model.costs(held.features, question), held.offered, model.single_for(question))
        assert verdict.picks.tolist() == np.bincount(picked, minlength=len(same)).tolist()
        assert verdict.gap.model <= verdict.gap.single
        assert set(verdict.by_family) == set(families[:3].tolist())
    turned = same[::-1]
    moved = replace(
        held,
        choices=Choices(held.choices.method[turned], held.choices.settings[turned], held.choices.error_trend),
        offered=held.offered[:, turned],
        ok=held.ok[:, turned],
        times={name: values[:, turned] for name, values in held.times.items()},
        error=held.error[:, turned],
        costs=held.costs[:, :, turned],
    )
    for before, after in zip(verdicts, evaluate_as_is(model, moved, turned, MISS), strict=True):
        assert after.gap == before.gap
        assert after.picks[turned].tolist() == before.picks.tolist()


def test_features_that_say_nothing_teach_nothing() -> None:
    """Shuffled features: not much is gained, and the single best choice keeps the harm small."""
    order = np.random.default_rng(1).permutation(len(EXAMPLES))
    blind = replace(EXAMPLES, features=EXAMPLES.features[order])
    for verdict in evaluate(blind, MISS, count=3):
        assert verdict.gap.closed is not None
        assert verdict.gap.closed < LEARNT_GAP


def test_the_gap_by_hand() -> None:
    families = np.array(["a", "a", "b"])
    single, best = np.array([3.0, 3.0, 5.0]), np.ones(3)
    assert closed_gap(best, single, best, families).closed == 1.0
    assert closed_gap(single, single, best, families).closed == 0.0
    # Families weigh alike: of a two thirds are closed, of b none.
    half = closed_gap(np.array([1.0, 3.0, 5.0]), single, best, families)
    assert half.closed == pytest.approx((4.0 - 3.5) / (4.0 - 1.0))
    assert (half.model, half.single, half.best) == (3.5, 4.0, 1.0)
    nothing = closed_gap(best, best, best, families)
    assert nothing.closed is None
    assert not nothing.claimed
    assert not closed_gap(best, 1.05 * best, best, families).claimed


def test_the_single_best_is_the_cheapest_for_all() -> None:
    best = single_best(EXAMPLES, MISS)
    means = np.average(EXAMPLES.costs, axis=1, weights=EXAMPLES.weights)
    assert (means[np.arange(2), best] == means.min(axis=1)).all()
    # What is not offered to some costs a miss there.
    offered = EXAMPLES.offered.copy()
    offered[: len(EXAMPLES) * 3 // 4, best[0]] = False
    assert single_best(replace(EXAMPLES, offered=offered), MISS)[0] != best[0]


def test_only_what_is_offered_is_chosen() -> None:
    costs = np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]])
    offered = np.array([[False, True, True], [False, False, False]])
    assert chosen(costs, offered, 2).tolist() == [1, 2]


def test_predictions_are_near_on_what_was_learnt(model: SelectorModel) -> None:
    predicted = model.performance.predict(EXAMPLES.features)
    true = np.log(EXAMPLES.times["dynamic"])
    missed = np.abs(predicted.log_times["dynamic"] - true)[EXAMPLES.ok]
    assert np.median(missed) < np.median(np.abs(true - np.median(true)))
    assert ((predicted.works >= 0) & (predicted.works <= 1)).all()
    # Larger maps are never predicted to err more.
    assert (np.diff(predicted.log_error[:, :3], axis=1) <= 0).all()


def test_intervals_hold_on_unseen_families() -> None:
    train, test = next(iter(folds(EXAMPLES.families, 3)))
    learnt, held = EXAMPLES.only(train), EXAMPLES.only(test)
    fitted = SelectorModel.fit(learnt, MISS)
    predicted = fitted.performance.predict(held.features)
    low, high = interval(predicted.log_times["dynamic"], fitted.missed, CHOICES, "dynamic", 0.9)
    true = np.log(held.times["dynamic"])
    inside = ((true >= low) & (true <= high))[held.ok]
    assert inside.mean() > 0.9 - COVERAGE


def test_expected_costs_by_hand() -> None:
    zeros = np.zeros((3, len(PERCENTS)))
    missed = {"dynamic": zeros, ERROR: zeros}
    log_error = np.log1p(np.array([[3.0, 2.0, 0.1, 1.0, 1.0, 0.0]]))
    log_time = np.log(np.array([[1.0, 2.0, 4.0, 1.0, 3.0, 8.0]]))
    works = np.array([[1.0, 1.0, 1.0, 0.0, 0.5, 1.0]])
    predicted = Predicted({"dynamic": log_time}, log_error, works)
    keeps = keeps_limit(predicted, missed, CHOICES, 2.5)
    assert keeps.tolist() == [[0.0, 1.0, 1.0, 0.0, 0.5, 1.0]]
    costs = expected_costs(predicted, missed, CHOICES, QUESTIONS[0], MISS)
    # With a limit of 4 all keep it; the fourth never works, the fifth every second time.
    assert costs == pytest.approx(np.array([[1.0, 2.0, 4.0, MISS, 0.5 * 3 + 5, 8.0]]))
    # Where none keeps the limit, the least error wins.
    hopeless = replace(predicted, log_error=log_error + 1.0)
    strict = expected_costs(hopeless, missed, CHOICES, QUESTIONS[1], MISS)
    assert strict.argmin() == 5


def test_misses_are_kept_as_percentiles_of_true_minus_predicted() -> None:
    shape = EXAMPLES.offered.shape
    zero = Predicted({"dynamic": np.zeros(shape)}, np.zeros(shape), np.zeros(shape))
    found = residuals(EXAMPLES, zero)
    assert set(found) == {"dynamic", ERROR, "works"}
    times = np.log(EXAMPLES.times["dynamic"])[:, CHOICES.method == 2]
    assert found["dynamic"][2, [0, -1]] == pytest.approx([times.min(), times.max()])
    assert all((np.diff(one, axis=1) >= 0).all() for one in found.values())


def test_the_way_of_choosing_is_the_one_that_did_best(model: SelectorModel) -> None:
    assert model.method == min(METHODS, key=lambda name: model.inner_costs[name])
    assert model.inner_costs[model.method] < model.inner_costs["single best"]
    for name in METHODS:
        assert model.costs(EXAMPLES.features[:3], QUESTIONS[0], name).shape == (3, 6)


def test_a_method_without_examples_is_predicted_all_the_same() -> None:
    ok = EXAMPLES.ok & (CHOICES.method != 1)
    fitted = PerformanceModel.fit(replace(EXAMPLES, ok=ok))
    assert np.isfinite(fitted.predict(EXAMPLES.features).log_error).all()
    assert (fitted.predict(EXAMPLES.features).works[:, CHOICES.method == 1] == 0).all()
