"""A scenario of the Algorithm Selection Library (Bischl et al., Artificial Intelligence 237, 2016).

Written as its format specification asks: no performance is missing, so what failed is imputed and has a
status. Folds are families, as none may be in training and test at once; the library's own folds are random.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from scenes.scene import Mobility
from selector.evidence.arff import Attribute, Value, arff, plain_name
from selector.evidence.rows import CandidateRow, InstanceRow
from selector.evidence.table import STATUSES, UNKNOWN, EvidenceTable, Floats
from selector.measurement import Status

FOLDS = 10
CUTOFF_MS = 4000
"""Frames that take longer are timeouts."""
IMPUTED = 10
"""What failed counts this many times the worst that did not, as in PAR10."""

RUNSTATUS = ("ok", "timeout", "memout", "not_applicable", "crash", "other")
_FEATURE_STATUS = ("ok", "timeout", "memout", "presolved", "crash", "unknown", "other")
_STATUSES = {
    Status.OK: "ok",
    Status.REFUSED: "not_applicable",
    Status.TIMEOUT: "timeout",
    Status.OUT_OF_MEMORY: "memout",
    Status.GL_ERROR: "other",
    Status.CRASHED: "crash",
}
_KEY = (Attribute("instance_id", text=True), Attribute("repetition"))


class Measure(StrEnum):
    """What a scenario is about."""

    SHADOW_MS = "shadow_ms"
    EDGE_ERROR_PX = "edge_error_px"


@dataclass(frozen=True)
class Scenario:
    """What goes into one.

    Attributes:
        name: Its id.
        measure: What is to be small.
        table: The evidence; instances without features are left out.
        extractor: Name and version of what extracted the features.
        features: Instance key -> feature -> value.
        costs: Instance key -> step -> milliseconds.
        device: In words.
    """

    name: str
    measure: Measure
    table: EvidenceTable
    extractor: str
    features: Mapping[str, Mapping[str, float]]
    costs: Mapping[str, Mapping[str, float]]
    device: str

    @property
    def rows(self) -> list[int]:
        """Which instances of the table are in it: those with features that a candidate was measured for."""
        measured = (self.status == "ok").any(axis=1)
        known = [bool(self.features.get(one.key)) for one in self.table.instances]
        return np.flatnonzero(measured & np.array(known, bool)).tolist()

    @property
    def performance(self) -> Floats:
        """(n, k) what was measured; nan where it was not."""
        if self.measure is Measure.SHADOW_MS:
            return self.table.shadow_ms(Mobility.DYNAMIC)
        return self.table.exceedance_px

    @property
    def status(self) -> np.ndarray[tuple[int, int], np.dtype[np.str_]]:
        """(n, k) words of `RUNSTATUS`; what was tried and never measured is `other`."""
        words = np.array([*(_STATUSES[status] for status in STATUSES), "other"])
        status = words[self.table.status]  # UNKNOWN is the last.
        assert UNKNOWN == -1
        return np.where((status == "ok") & np.isnan(self.performance), "other", status)

    @property
    def cutoff(self) -> int:
        """In the measure's own unit; no measured value is above it."""
        worst: int = math.ceil(np.max(self.performance[self.status == "ok"], initial=0.0))
        return max(worst, CUTOFF_MS) if self.measure is Measure.SHADOW_MS else max(IMPUTED * worst, 1)


def scenario_files(scenario: Scenario) -> dict[str, bytes]:
    """Name -> content of every file of its folder."""
    rows = scenario.rows
    ids = {row: instance_id(scenario.table.instances[row]) for row in rows}
    names = sorted({name for row in rows for name in scenario.features[scenario.table.instances[row].key]})
    step = plain_name(scenario.extractor)
    columns = [Attribute(plain_name(name)) for name in names]
    values: list[Sequence[Value]] = [
        (ids[row], 1, *(_of(scenario.features, scenario, row).get(name, math.nan) for name in names))
        for row in rows
    ]
    files = {
        "description.txt": _description(scenario, [column.name for column in columns], step),
        "algorithm_runs.arff": _runs(scenario, ids),
        "feature_values.arff": arff(f"FEATURE_VALUES_{scenario.name}", (*_KEY, *columns), values),
        "feature_runstatus.arff": arff(
            f"FEATURE_RUNSTATUS_{scenario.name}",
            (*_KEY, Attribute(step, _FEATURE_STATUS)),
            [(ids[row], 1, "ok") for row in rows],
        ),
        "cv.arff": _folds(scenario, ids),
        "readme.txt": _readme(scenario).encode("ascii"),
        "citation.bib": _CITATION,
    }
    costs = [(ids[row], 1, sum(_of(scenario.costs, scenario, row).values())) for row in rows]
    if all(_of(scenario.costs, scenario, row) for row in rows):
        files["feature_costs.arff"] = arff(f"FEATURE_COSTS_{scenario.name}", (*_KEY, Attribute(step)), costs)
    return files


def instance_id(row: InstanceRow) -> str:
    """Family, scene and the beginning of the key, which tells lights and views of one scene apart."""
    return plain_name(f"{row.family}/{row.scene.replace('/', '_')}/{row.key[:12]}")


def algorithm_names(candidates: Sequence[CandidateRow]) -> list[str]:
    """Technique and settings of each; no two alike."""
    names = [
        plain_name("-".join([row.technique, *(f"{name}={value}" for name, value in row.settings.items())]))
        for row in candidates
    ]
    often = Counter(names)
    return [
        f"{name}-{row.key[:8]}" if often[name] > 1 else name
        for name, row in zip(names, candidates, strict=True)
    ]


def folds_of(families: Sequence[str]) -> list[int]:
    """A fold from 1 on for each instance; a family is in one, and folds are as even as families allow."""
    sizes = Counter(families)
    filled = [0] * min(FOLDS, len(sizes))
    fold_of: dict[str, int] = {}
    for family in sorted(sizes, key=lambda family: (-sizes[family], family)):
        smallest = filled.index(min(filled))
        fold_of[family] = smallest + 1
        filled[smallest] += sizes[family]
    return [fold_of[family] for family in families]


def _of(values: Mapping[str, Mapping[str, float]], scenario: Scenario, row: int) -> Mapping[str, float]:
    return values.get(scenario.table.instances[row].key, {})


def _runs(scenario: Scenario, ids: Mapping[int, str]) -> bytes:
    names = algorithm_names(scenario.table.candidates)
    status, cutoff = scenario.status, float(scenario.cutoff)
    performance = np.where(status == "ok", scenario.performance, cutoff)
    attributes = (
        *_KEY,
        Attribute("algorithm", text=True),
        Attribute(str(scenario.measure)),
        Attribute("runstatus", RUNSTATUS),
    )
    runs: list[Sequence[Value]] = [
        (ids[row], 1, name, float(performance[row, column]), str(status[row, column]))
        for row in ids
        for column, name in enumerate(names)
    ]
    return arff(f"ALGORITHM_RUNS_{scenario.name}", attributes, runs)


def _folds(scenario: Scenario, ids: Mapping[int, str]) -> bytes:
    folds = folds_of([scenario.table.instances[row].family for row in ids])
    rows = [(name, 1, fold) for name, fold in zip(ids.values(), folds, strict=True)]
    return arff(f"CV_{scenario.name}", (*_KEY, Attribute("fold")), rows)


def _description(scenario: Scenario, features: Sequence[str], step: str) -> bytes:
    runtime = scenario.measure is Measure.SHADOW_MS
    algorithms = algorithm_names(scenario.table.candidates)
    entries = {
        "scenario_id": scenario.name,
        "performance_measures": [str(scenario.measure)],
        "maximize": [False],
        "performance_type": ["runtime" if runtime else "solution_quality"],
        "algorithm_cutoff_time": scenario.cutoff if runtime else CUTOFF_MS,
        "algorithm_cutoff_memory": "?",
        "features_cutoff_time": "?",
        "features_cutoff_memory": "?",
        "algorithms_deterministic": [] if runtime else algorithms,
        "algorithms_stochastic": algorithms if runtime else [],
        "number_of_feature_steps": 1,
        "feature_steps": {step: {"provides": list(features)}},
        "default_steps": [step],
        "features_deterministic": list(features),
        "features_stochastic": [],
    }
    # Values of JSON are values of YAML.
    return "".join(f"{name}: {json.dumps(value)}\n" for name, value in entries.items()).encode("ascii")


def _readme(scenario: Scenario) -> str:
    families = len({scenario.table.instances[row].family for row in scenario.rows})
    return f"""{scenario.name}

Which shadow technique, with which settings, for one light of a scene seen in one view? Measured by Gnomon on
{plain_name(scenario.device)}: {len(scenario.rows)} instances of {families} families,
{len(scenario.table.candidates)} algorithms, each a technique with settings.

Measure: {_MEASURES[scenario.measure]}
Instances are called family/scene/key. Algorithms are called technique-setting=value.
All times, cut-offs and feature costs among them, are in milliseconds.
Runs that are not "ok" have the value {scenario.cutoff}, which nothing measured exceeds. "not_applicable" is a
technique that refuses the light, "other" one that was not measured on the instance or failed in OpenGL.
Folds of cv.arff are families of scenes: random folds would let a selector recognise a scene.
Features were extracted by {plain_name(scenario.extractor)}; none is missing unless it has no meaning there.
"""


_MEASURES = {
    Measure.SHADOW_MS: "median time of the technique's own passes for a light that moves, drift divided out.",
    Measure.EDGE_ERROR_PX: "mean displacement of the shadow's edge in pixels against exact shadow volumes;\n"
    "where a view shows less than 64 pixels of edge, wrong pixels over 64.",
}
_CITATION = b"""@misc{gnomon,
  title = {Gnomon: automatic algorithm selection for real-time shadows},
  note = {Scenario in the format of ASlib}
}
"""
