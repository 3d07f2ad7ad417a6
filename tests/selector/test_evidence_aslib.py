"""A scenario reads back as what was measured, by a reader of ARFF that is not ours."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.io import arff

from scenes.scene import Mobility
from selector.evidence.aslib import Measure, Scenario, algorithm_names, folds_of, instance_id, scenario_files
from selector.evidence.rows import CandidateRow
from selector.evidence.store import Store
from selector.evidence.table import EvidenceTable
from selector.measurement import Status
from tests.selector.evidence_rows import DEVICE, SM, SV, asked, filled, instance, judgement, timing

PSM = CandidateRow("perspective_shadow_map", {"map_size": 512, "depth": "a,b c"})


@pytest.fixture
def table(tmp_path: Path) -> EvidenceTable:
    with Store.open(str(tmp_path / "evidence.sqlite")) as store:
        filled(store, 6)
        for index, status in enumerate((Status.OK, Status.REFUSED, Status.TIMEOUT, Status.OUT_OF_MEMORY)):
            row = instance(index, "cave" if index % 2 else "forest")
            failed = [timing(asked(row, PSM), status=status)] if status is Status.TIMEOUT else []
            store.add(row, [PSM], [judgement(asked(row, PSM), status=status)], failed)
        unmeasured = instance(30, "empty")
        store.add(unmeasured, [], [judgement(asked(unmeasured, SV), status=Status.CRASHED)], [])
        return store.table(DEVICE.key)


def scenario(table: EvidenceTable, measure: Measure) -> Scenario:
    features = {
        one.key: {"polygon count": float(index), "odd/name": np.nan if index == 1 else 0.1}
        for index, one in enumerate(table.instances)
    }
    del features[table.instances[2].key]
    costs = {key: {"all": 1.5, "more": 0.25} for key in features}
    return Scenario("GNOMON-TEST", measure, table, "first 1", features, costs, "softpipe, (x)")


def read(data: bytes) -> tuple[np.ndarray, list[str]]:
    """SciPy reads no strings, so the words that occur are declared instead."""
    text = data.decode("ascii")
    header, _, rows = text.partition("@DATA\n")
    table = [line.split(",") for line in rows.splitlines()]
    for column, kind in enumerate(re.findall(r"@ATTRIBUTE \S+ (\S+)", header)):
        if kind == "STRING":
            words = ",".join(sorted({row[column] for row in table}))
            header = header.replace(" STRING", " {" + words + "}", 1)
    values, meta = arff.loadarff(io.StringIO(f"{header}@DATA\n{rows}"))
    return values, meta.names()


def description(files: dict[str, bytes]) -> dict[str, object]:
    lines = files["description.txt"].decode("ascii").splitlines()
    return {name: json.loads(value) for name, _, value in (line.partition(": ") for line in lines)}


@pytest.mark.parametrize("measure", Measure)
def test_every_pair_has_a_run_with_what_was_measured_or_a_status(
    table: EvidenceTable, measure: Measure
) -> None:
    made = scenario(table, measure)
    files = scenario_files(made)
    runs, names = read(files["algorithm_runs.arff"])
    assert names == ["instance_id", "repetition", "algorithm", str(measure), "runstatus"]
    kept = made.rows
    assert len(kept) == 5
    assert len(runs) == len(kept) * 3
    ids = {instance_id(table.instances[row]).encode(): row for row in kept}
    columns = {name.encode(): column for column, name in enumerate(algorithm_names(table.candidates))}
    truth = table.shadow_ms(Mobility.DYNAMIC) if measure is Measure.SHADOW_MS else table.exceedance_px
    seen = set()
    for name, repetition, algorithm, value, status in runs:
        cell = ids[name], columns[algorithm]
        seen.add(cell)
        assert repetition == 1
        assert value == (truth[cell] if status == b"ok" else made.cutoff)
        assert (status == b"ok") == (table.ok[cell] and np.isfinite(truth[cell]))
    assert len(seen) == len(runs)
    assert {b"ok", b"not_applicable", b"memout"} <= set(runs["runstatus"])
    assert made.cutoff >= np.nanmax(truth[table.ok])


def test_all_files_are_about_the_same_instances_and_features(table: EvidenceTable) -> None:
    made = scenario(table, Measure.SHADOW_MS)
    files = scenario_files(made)
    said = description(files)
    values, names = read(files["feature_values.arff"])
    status, steps = read(files["feature_runstatus.arff"])
    costs, cost_steps = read(files["feature_costs.arff"])
    folds, _ = read(files["cv.arff"])
    runs, _ = read(files["algorithm_runs.arff"])
    for other in (status, costs, folds):
        assert other["instance_id"].tolist() == values["instance_id"].tolist()
    assert list(dict.fromkeys(runs["instance_id"])) == values["instance_id"].tolist()
    assert names[2:] == ["odd/name", "polygon_count"] == said["features_deterministic"]
    assert steps[2:] == cost_steps[2:] == said["default_steps"] == list(said["feature_steps"])  # type: ignore[call-overload]
    assert said["feature_steps"] == {"first_1": {"provides": names[2:]}}
    assert set(costs["first_1"]) == {1.75}
    assert values["polygon_count"].tolist() == made.rows
    assert np.isnan(values["odd/name"]).tolist() == [row == 1 for row in made.rows]
    assert {name.decode() for name in runs["algorithm"]} == set(said["algorithms_stochastic"])  # type: ignore[call-overload]
    lengths = {len(said[name]) for name in ("performance_measures", "maximize", "performance_type")}  # type: ignore[arg-type]
    assert lengths == {1}
    families = {name.split(b"/")[0] for name in folds["instance_id"]}
    for family in families:
        assert len({row["fold"] for row in folds if row["instance_id"].startswith(family)}) == 1
    assert set(files) == {
        "description.txt",
        "algorithm_runs.arff",
        "feature_values.arff",
        "feature_runstatus.arff",
        "feature_costs.arff",
        "cv.arff",
        "readme.txt",
        "citation.bib",
    }


def test_costs_that_are_not_all_known_are_left_out(table: EvidenceTable) -> None:
    made = scenario(table, Measure.EDGE_ERROR_PX)
    some = Scenario(**{**vars(made), "costs": dict(list(made.costs.items())[:2])})
    assert "feature_costs.arff" not in scenario_files(some)


def test_folds_are_families_and_even() -> None:
    families = ["a"] * 5 + ["b"] * 3 + ["c"] * 2 + ["d"]
    assert folds_of(families) == [1] * 5 + [2] * 3 + [3] * 2 + [4]
    many = [f"family {index % 26}" for index in range(26 * 4)]
    folds = folds_of(many)
    assert set(folds) == set(range(1, 11))
    assert max(map(folds.count, set(folds))) - min(map(folds.count, set(folds))) == 4
    assert len(set(zip(many, folds, strict=True))) == 26


def test_names_of_algorithms_differ() -> None:
    alike = [CandidateRow("a", {"x": "1 2"}), CandidateRow("a", {"x": "1,2"}), SM]
    names = algorithm_names(alike)
    assert len(set(names)) == 3
    assert names[2] == "shadow_map-map_size=1024-filter=2x2-bias=0.5-flip=True"
