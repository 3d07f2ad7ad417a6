from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from features.extraction import extract
from features.level_survey import LevelSurvey
from features.table import NAMES
from models.artifact import Artifact, ModelError, packed, unpacked
from models.examples import Floats, Question
from models.selector_model import PERFORMANCE, SelectorModel
from scenes.scene import Light, LightKind, Mobility, Scene, View
from selector.evidence.rows import Role
from selector.evidence.store import Store
from selector.learning.dataset import EvidenceError, Slot, choices_of, dataset, questions
from selector.learning.featuring import extractor, features_of
from selector.learning.odds import ahead
from selector.learning.predicting import Advisor, LightFacts, Predictor, reason, views_of
from selector.learning.training import Learning, judged, learning, trained
from selector.policy import MISS, POLICIES
from tests.random_scenes import look_at
from tests.selector.learning_evidence import DEVICE, FAMILIES, OF_EACH, fill, filled
from tests.solids import box, floor

BALANCED = Question("balanced", "dynamic", 1.5)
LAMP = Light("lamp", LightKind.POINT, (0.0, 4.0, 0.0), range_m=20.0)
SCENE = Scene("boxes", (floor(8.0), box((0, 1, 0), (1, 1, 1)), box((2, 2, 1), (0.3, 0.3, 0.3))), (LAMP,))
CAMERAS = (look_at((0, 6, 9), (0, 0, 0)), look_at((8, 3, 0), (0, 0, 0)))


def silent(*_: object) -> None:
    """Nobody listens."""


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with Store.open(str(filled(tmp_path_factory.mktemp("evidence") / "e.sqlite"))) as opened:
        yield opened


@pytest.fixture(scope="module")
def source(store: Store) -> Learning:
    return learning(store, None, None, silent)


@pytest.fixture(scope="module")
def artifact(source: Learning) -> Artifact:
    # As it comes out of a file, which is how users have it.
    return unpacked(packed(trained(source, ())))


@pytest.fixture(scope="module")
def survey() -> LevelSurvey:
    return LevelSurvey.of(SCENE)


def test_evidence_becomes_arrays(source: Learning, store: Store) -> None:
    data = source.dataset
    examples = data.examples
    assert source.device == DEVICE
    assert len(examples) == FAMILIES * OF_EACH
    assert examples.features.shape == (len(examples), len(NAMES))
    # Focus is the kind's own affair: a sun's map is the same choice as a spot's.
    assert len(set(data.slots)) == len(data.slots)
    assert all("focus" not in dict(slot.settings) for slot in data.slots)
    table = store.table(DEVICE.key, role=Role.TRAINING)
    assert len(data.slots) < len(table.candidates)
    volumes = data.slots.index(Slot("shadow_volume", ()))
    assert examples.offered[:, volumes].all()
    assert not examples.offered.all()
    # Each row has as many choices as candidates were tried, and the same times.
    assert (examples.offered.sum(axis=1) == (table.status >= 0).sum(axis=1)).all()
    ours, theirs = examples.times["dynamic"], table.shadow_ms(Mobility.DYNAMIC)
    assert np.nansum(np.where(examples.offered, ours, 0)) == pytest.approx(np.nansum(theirs))
    assert examples.costs.shape == (6, *examples.offered.shape)
    assert (examples.costs[:, ~examples.offered] == MISS).all()
    assert (examples.costs.min(axis=2) == 1).all()


def test_two_families_are_too_few_to_judge_a_model_by(store: Store) -> None:
    table = store.table(DEVICE.key, role=Role.TRAINING)
    times = {mobility: table.shadow_ms(mobility) for mobility in Mobility}
    known = store.features(extractor())
    families = {one.key: one.family for one in table.instances}
    few = {key: values for key, values in known.items() if families[key] in ("family 0", "family 1")}
    with pytest.raises(EvidenceError, match=f"{2 * OF_EACH} instances of 2 families") as caught:
        dataset(table, times, few)
    assert f"{(FAMILIES - 2) * OF_EACH} without features" in str(caught.value)
    three = few | {key: values for key, values in known.items() if families[key] == "family 2"}
    assert len(dataset(table, times, three).examples) == 3 * OF_EACH


def test_settings_become_numbers() -> None:
    choices, names = choices_of(
        [
            Slot("shadow_map", (("map_size", 512), ("filter", "2x2"))),
            Slot("shadow_map", (("map_size", 1024), ("filter", "1x1"))),
            Slot("shadow_volume", ()),
        ]
    )
    assert names == ("map_size", "filter")
    assert choices.method.tolist() == [0, 0, 1]
    assert choices.settings.tolist() == [[9.0, 1.0], [10.0, 0.0], [-1.0, -1.0]]
    assert choices.error_trend == (-1, 0)
    assert choices.methods == 2


def test_virtual_devices_learn_from_counters(store: Store) -> None:
    phone = learning(store, "virtual:phone", None, silent)
    assert phone.device.virtual == "virtual:phone"
    assert len(phone.dataset.examples) == FAMILIES * OF_EACH
    assert phone.dataset.examples.digest != learning(store, None, None, silent).dataset.examples.digest


def test_devices_are_found_by_name_and_missed_in_words(store: Store) -> None:
    assert learning(store, "MADE-UP", None, silent).device == DEVICE
    assert learning(store, DEVICE.key[:6], None, silent).device == DEVICE
    with pytest.raises(EvidenceError, match="virtual:phone"):
        learning(store, "abacus", None, silent)


def test_too_little_evidence_is_refused_in_words(tmp_path: Path) -> None:
    with Store.open(str(tmp_path / "empty.sqlite")) as empty:
        with pytest.raises(EvidenceError, match="No device was timed"):
            learning(empty, None, None, silent)
        with pytest.raises(EvidenceError, match="no evidence yet"):
            learning(empty, "virtual:phone", None, silent)
        fill(empty)
        assert learning(empty, None, None, silent).dataset.left_out["without features"] == 0


def test_instances_whose_scene_is_gone_are_counted(store: Store) -> None:
    row = next(iter(store.instances()))
    unknown = replace(row, origin="gone.glb", scene_digest="0")
    changed = replace(row, origin='{"family":"box_grid","triangles":200}', scene_digest="1")
    found, problems = features_of(store, [row, unknown, changed], None, silent)
    assert list(found) == [row.key]
    assert "gone.glb is not there" in problems[unknown.key]
    assert "differently" in problems[changed.key]


def test_the_same_evidence_gives_the_same_model(artifact: Artifact, store: Store) -> None:
    again = trained(learning(store, None, None, silent), ())
    assert packed(again) == packed(artifact)


def test_the_chain_learns(source: Learning) -> None:
    verdicts = judged(source)
    assert [(one.time, one.question) for one in verdicts] == [
        (mobility, policy.name) for mobility in ("dynamic", "static") for policy in POLICIES
    ]
    assert all(one.gap.instances == FAMILIES * OF_EACH for one in verdicts)
    best = max(one.gap.closed or 0.0 for one in verdicts)
    assert best > 0


def test_a_prediction_says_all_that_a_designer_asks(artifact: Artifact, survey: LevelSurvey) -> None:
    found = Predictor(artifact, survey).predict(LAMP, views_of(CAMERAS, 320, 200), BALANCED)
    assert found is not None
    assert len({one.candidate.technique for one in found.expected}) >= 4
    assert found.chosen.cost == min(one.cost for one in found.expected)
    assert found.runner_up is found.expected[1]
    assert found.margin is not None
    assert found.margin >= 0
    assert 0 <= found.confidence <= 1
    assert set(found.features) == set(NAMES)
    for one in found.expected:
        assert one.shadow_ms_range[0] <= one.shadow_ms <= one.shadow_ms_range[1]
        assert one.edge_error_px_range[0] <= one.edge_error_px <= one.edge_error_px_range[1]
        assert 0 <= one.keeps_limit <= one.works + 1e-12 <= 1 + 1e-9
    assert found.chosen.candidate.label in reason(found)
    # A scene of some boxes is unlike the made-up features in many ways, and the answer says so.
    assert found.outside
    assert len(found.deciding) <= 3


def test_predictions_are_the_mean_time_and_the_worst_error_of_the_views(
    artifact: Artifact, survey: LevelSurvey
) -> None:
    predictor = Predictor(artifact, survey)
    one, other = (predictor.predict(LAMP, views_of([camera], 320, 200), BALANCED) for camera in CAMERAS)
    both = predictor.predict(LAMP, views_of(CAMERAS, 320, 200), BALANCED)
    assert one
    assert other
    assert both
    of_one = {each.candidate: each for each in one.expected}
    of_other = {each.candidate: each for each in other.expected}
    for each in both.expected:
        mine, theirs = of_one[each.candidate], of_other[each.candidate]
        assert each.shadow_ms == pytest.approx((mine.shadow_ms + theirs.shadow_ms) / 2)
        assert each.edge_error_px == pytest.approx(max(mine.edge_error_px, theirs.edge_error_px))
        assert each.keeps_limit == pytest.approx(min(mine.keeps_limit, theirs.keeps_limit))


def test_only_the_wanted_techniques_are_predicted(artifact: Artifact, survey: LevelSurvey) -> None:
    found = Predictor(artifact, survey).predict(LAMP, views_of(CAMERAS, 320, 200), BALANCED, ("SV",))
    assert found is not None
    assert [one.candidate.label for one in found.expected] == ["SV"]
    assert (found.runner_up, found.margin, found.confidence) == (None, None, 1.0)


def test_what_does_not_fit_a_device_is_refused_with_a_reason(artifact: Artifact, survey: LevelSurvey) -> None:
    small = dict(artifact.card, limits={"max_texture_side": 16_384, "max_buffer_bytes": 64})
    predictor = Predictor(replace(artifact, card=small), survey)
    found = predictor.predict(LAMP, views_of(CAMERAS, 320, 200), BALANCED)
    assert found is not None
    refused = {one.label: why for one, why in found.refused}
    assert "buffers" in refused["SV"]
    assert all(one.candidate.technique != "shadow_volume" for one in found.expected)
    assert predictor.predict(LAMP, views_of(CAMERAS, 320, 200), BALANCED, ("SV",)) is None


def test_a_stricter_limit_is_never_likelier_kept(artifact: Artifact, survey: LevelSurvey) -> None:
    predictor, views = Predictor(artifact, survey), views_of(CAMERAS, 320, 200)
    lax, strict = (predictor.predict(LAMP, views, replace(BALANCED, limit=limit)) for limit in (4.0, 0.1))
    assert lax
    assert strict
    kept = {one.candidate: one.keeps_limit for one in lax.expected}
    assert all(one.keeps_limit <= kept[one.candidate] for one in strict.expected)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"extractor": "other"}, "other features"),
        ({"choices": []}, "contradicts"),
        ({"choices": [{"technique": 3}]}, "lacks"),
        ({"ranges": {}}, "lacks"),
        ({"limits": {"max_texture_side": 0, "max_buffer_bytes": 1}}, "contradicts"),
    ],
)
def test_a_model_of_something_else_is_refused(
    artifact: Artifact, survey: LevelSurvey, change: dict[str, object], words: str
) -> None:
    strange = unpacked(packed(replace(artifact, card=artifact.card | change)))
    with pytest.raises(ModelError, match=words):
        Predictor(strange, survey)


def test_odds_by_hand() -> None:
    low, high = np.linspace(0, 1, 41), np.linspace(2, 3, 41)
    assert ahead(low, high) == 1.0
    assert ahead(high, low) == 0.0
    assert ahead(low, low) == 0.5
    assert ahead(low, low + 0.5) == pytest.approx(0.875, abs=0.01)


def test_features_do_not_depend_on_the_order_in_which_lights_are_asked_about(survey: LevelSurvey) -> None:
    view = View(CAMERAS[0], 320, 200)
    first = extract(survey, LAMP, view).values
    extract(survey, replace(LAMP, range_m=2.0), view)
    assert extract(survey, LAMP, view).values == first


@pytest.mark.parametrize(
    ("kind", "degrees", "words"),
    [
        (LightKind.SPOT, 170.0, "a wide cone"),
        (LightKind.SPOT, 0.1, "a narrow cone"),
        (LightKind.POINT, 180.0, "it shines all around"),
        (LightKind.DIRECTIONAL, 0.0, "its light is parallel"),
    ],
)
def test_a_light_without_a_cone_is_not_said_to_have_one(
    artifact: Artifact, monkeypatch: pytest.MonkeyPatch, kind: LightKind, degrees: float, words: str
) -> None:
    advisor = Advisor(replace(artifact, model=replace(artifact.model, method=PERFORMANCE)))
    cone = NAMES.index("cone_half_angle")
    usual = np.array([artifact.card["ranges"][name][1] for name in NAMES])
    rows = usual[None].copy()
    rows[0, cone] = degrees

    def costs(_model: SelectorModel, features: Floats, _asked: Question, **_: object) -> Floats:
        """The first technique is ahead, the more the farther the cone is from its usual angle."""
        found = np.full((len(features), len(artifact.model.choices.method)), 9.0)
        first = artifact.model.choices.method == artifact.model.choices.method[0]
        found[:, first] = 8.0 - (features[:, cone, None] != usual[cone])
        return found

    monkeypatch.setattr(SelectorModel, "costs", costs)
    found = advisor.advise(LightFacts(kind, rows), questions()[0])
    assert found is not None
    assert [one.words for one in found.deciding] == [words]
