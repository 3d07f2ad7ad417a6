"""`gnomon train`, `evaluate`, `recommend`, `features` and `annotate --mode predict`, as users run them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from features.table import NAMES
from models.artifact import load
from scenes.formats.registry import format_of
from selector.evidence.rows import Role
from tests.api.command import answered, gnomon, succeeded
from tests.selector.learning_evidence import FAMILIES, OF_EACH, filled
from tests.small_level import small_level
from tests.tolerances import LEARNT_GAP


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return filled(tmp_path_factory.mktemp("evidence") / "made.sqlite")


@pytest.fixture(scope="module")
def model(store: Path) -> Path:
    path = store.with_name("made.model")
    succeeded("train", "--store", store, "--quick", "-o", path)
    return path


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path)


def test_the_same_evidence_gives_the_same_bytes(store: Path, model: Path, tmp_path: Path) -> None:
    found = answered("train", "--store", store, "--quick", "-o", tmp_path / "again.model")
    assert found["instances"] == FAMILIES * OF_EACH
    assert found["families"] == FAMILIES
    assert (tmp_path / "again.model").read_bytes() == model.read_bytes()


def test_files_of_evidence_do_as_well_as_a_store(store: Path, model: Path, tmp_path: Path) -> None:
    succeeded("evidence", "export", tmp_path / "files", "--store", store)
    succeeded("train", "--evidence", tmp_path / "files", "--quick", "-o", tmp_path / "of-files.model")
    assert (tmp_path / "of-files.model").read_bytes() == model.read_bytes()


def test_a_judged_model_says_in_its_card_what_evaluate_says(store: Path, tmp_path: Path) -> None:
    told = answered("evaluate", "--store", store)["closed_gap"]
    table = succeeded("train", "--store", store, "-o", tmp_path / "judged.model", width=160).stdout
    card = load(tmp_path / "judged.model").card["evaluation"]
    assert [told[one["mobility"]][one["policy"]] for one in card] == card
    assert "closed gap by family" in table
    assert "family 3" in table
    assert "most often best" in table
    for mobility in ("dynamic", "static"):
        for policy in ("speed", "balanced", "quality"):
            one = told[mobility][policy]
            assert one["claimed"] == (one["closed_gap"] is not None)
            assert set(one["by_family"]) == {f"family {index}" for index in range(FAMILIES)}
            assert sum(one["wins"].values()) == sum(one["picks"].values()) == FAMILIES * OF_EACH


def test_who_wins_is_said_without_judging_a_model(store: Path) -> None:
    found = answered("evaluate", "--store", store, "--quick")
    assert found["closed_gap"] == {}
    for of_mobility in found["winners"].values():
        for one in of_mobility.values():
            assert sum(one["wins"].values()) == FAMILIES * OF_EACH
            assert one["single_best"] in found["choices"]
            assert one["single_over_best"] >= 1
    assert "one for all" in succeeded("evaluate", "--store", store, "--quick", width=160).stdout


def test_a_finished_model_is_asked_about_test_data(store: Path, model: Path, tmp_path: Path) -> None:
    apart = filled(tmp_path / "apart.sqlite", Role.TEST, seed=99)
    found = answered("evaluate", "--store", apart, "--model", model)
    assert found["instances"] == FAMILIES * OF_EACH
    for policies in found["closed_gap"].values():
        for one in policies.values():
            assert sum(one["wins"].values()) == sum(one["picks"].values()) == FAMILIES * OF_EACH
            assert set(one["picks"]) <= set(found["choices"])
    # What the made-up times depend on is what the model was taught.
    assert found["closed_gap"]["dynamic"]["balanced"]["closed_gap"] > LEARNT_GAP
    table = succeeded("evaluate", "--store", apart, "--model", model, width=160)
    assert "closed gap by family" in table.stdout
    assert "Asking" in table.stderr
    for arguments, code, words in (
        (("--store", store, "--model", model), 3, "holds no test data"),
        (("--store", apart, "--model", model, "--quick"), 2, "--quick judges no model"),
        (("--store", apart, "--model", apart), 3, "no model"),
    ):
        result = gnomon("evaluate", *arguments)
        assert (result.exit_code, words in result.stderr) == (code, True), result.stderr


def test_choices_that_were_not_measured_are_named(model: Path, tmp_path: Path) -> None:
    apart = filled(tmp_path / "apart.sqlite", Role.TEST, without="chan_hybrid")
    result = gnomon("evaluate", "--store", apart, "--model", model)
    assert result.exit_code == 3
    assert "It lacks Chan" in result.stderr


def test_recommend_answers_every_light_and_renders_nothing(level: Path, model: Path) -> None:
    found = answered("recommend", level, "--model", model, "--resolution", "96x64")
    assert [one["light"] for one in found["lights"]] == ["Lamp", "Torch", "Sun"]
    for one in found["lights"]:
        assert one["source"] == "predicted"
        assert one["shadow_ms_range"][0] <= one["shadow_ms"] <= one["shadow_ms_range"][1]
        assert {other["id"] for other in one["alternatives"]} | {one["id"]} >= {
            "shadow_map",
            "perspective_shadow_map",
            "shadow_volume",
            "chan_hybrid",
        }
        assert set(one["features"]) == set(NAMES)
    # The level says that its lamp stands still.
    assert [one["mobility"] for one in found["lights"]] == ["static", "dynamic", "dynamic"]


def test_the_policy_and_the_techniques_are_the_users(level: Path, model: Path) -> None:
    asked = ("recommend", level, "--model", model, "--light", "Torch")
    found = answered(*asked, "--policy", "quality")
    assert (found["policy"], found["max_edge_error_px"]) == ("quality", 0.5)
    found = answered(*asked, "--max-edge-error-px", "0.1", "-t", "SV")
    assert (found["policy"], found["max_edge_error_px"]) == ("custom", 0.1)
    assert [one["technique"] for one in found["lights"]] == ["SV"]
    table = succeeded(*asked, width=160).stdout
    assert "Torch" in table
    assert "is expected to take" in table


def test_predictions_go_into_the_level_and_out_again(level: Path, model: Path, tmp_path: Path) -> None:
    target, cleared = tmp_path / "annotated.glb", tmp_path / "cleared.glb"
    predict = ("annotate", level, "--mode", "predict", "--model", model)
    found = answered(*predict, "-o", target)
    assert found["output"].endswith("annotated.glb")
    standing = format_of(target).read_annotations(target.read_bytes())
    by_node = {one["node"]: one for one in found["lights"]}
    assert set(standing) == set(by_node)
    for node, told in standing.items():
        assert told.extras["gnomon_technique"] == by_node[node]["technique"]
        assert told.extras["gnomon_source"] == "predicted"
        assert told.extension["source"] == "predicted"
        assert told.extension["provenance"]["device"] == "made-up renderer"
        json.dumps(dict(told.extension), allow_nan=False)
    answered(*predict, "-o", tmp_path / "again.glb")
    assert (tmp_path / "again.glb").read_bytes() == target.read_bytes()
    succeeded("annotate", target, "--clear", "-o", cleared)
    assert cleared.read_bytes() == level.read_bytes()


def test_lights_that_are_not_asked_about_keep_what_they_have(
    level: Path, model: Path, tmp_path: Path
) -> None:
    first, second = tmp_path / "first.glb", tmp_path / "second.glb"
    measured = ("--resolution", "96x64", "--rounds", "1", "-t", "SV", "--light", "Sun")
    succeeded("annotate", level, *measured, "-o", first)
    succeeded("annotate", first, "--mode", "predict", "--model", model, "--light", "Lamp", "-o", second)
    sources = {
        one.extras["gnomon_source"]
        for one in format_of(second).read_annotations(second.read_bytes()).values()
    }
    assert sources == {"measured", "predicted"}


@pytest.mark.parametrize(
    "more",
    [
        ("--rounds", "4"),
        ("--pictures", "pictures"),
        ("--measurements", "m.json"),
        ("--verify",),
        ("--flicker",),
        ("--device", "0"),
    ],
)
def test_predicting_takes_nothing_that_is_about_rendering(level: Path, more: tuple[str, ...]) -> None:
    result = gnomon("annotate", level, "--mode", "predict", *more)
    assert result.exit_code == 2
    assert f"{more[0]} is about rendering" in result.stderr
    assert list(level.parent.iterdir()) == [level]


def test_a_model_that_measuring_would_not_ask_is_wrong_usage(level: Path, model: Path) -> None:
    result = gnomon("annotate", level, "--model", model)
    assert result.exit_code == 2
    assert "--mode predict" in result.stderr


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"no model at all"])
def test_what_is_no_model_is_said_to_be_none(level: Path, content: bytes) -> None:
    strange = level.with_name("strange.model")
    strange.write_bytes(content)
    for asked in (("recommend", level), ("annotate", level, "--mode", "predict")):
        result = gnomon(*asked, "--model", strange)
        assert result.exit_code == 3
        assert "This is no model" in result.stderr
        assert "strange.model" in result.stderr
    result = gnomon("recommend", level, "--model", level.with_name("absent.model"))
    assert result.exit_code == 3
    assert "gnomon train" in result.stderr


def test_unknown_names_are_answered_with_the_known_ones(level: Path, model: Path, store: Path) -> None:
    for arguments, code, words in (
        (("recommend", level, "--model", model, "--light", "Moon"), 3, '"Lamp"'),
        (("recommend", level, "--model", model, "-t", "XY"), 2, "SV"),
        (("recommend", level, "--model", model, "--policy", "best"), 2, "balanced"),
        (("recommend", level, "--mode", "guess"), 2, "predict"),
        (("train", "--store", store, "--device", "abacus"), 3, "virtual:phone"),
        (("evaluate", "--store", store, "--evidence", level.parent), 2, "two sources"),
    ):
        result = gnomon(*arguments)
        assert result.exit_code == code, arguments
        assert words in result.stderr


def test_features_are_shown_with_their_units(level: Path) -> None:
    found: Any = answered("features", level, "--resolution", "96x64")
    assert [one["name"] for one in found["features"]] == list(NAMES)
    assert all(one["unit"] and one["meaning"] for one in found["features"])
    assert [one["light"] for one in found["lights"]] == ["Lamp", "Torch", "Sun"]
    assert all(set(view["values"]) == set(NAMES) for one in found["lights"] for view in one["views"])
    table = succeeded("features", level, "--light", "Sun").stdout
    assert "is_directional" in table
    assert "degrees" in table
