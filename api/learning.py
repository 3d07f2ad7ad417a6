"""Learning from outside: features of lights, models trained and judged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from api.choosing import chosen_cameras, chosen_lights, require_triangles
from api.wording import path_words
from features.extraction import extract, extractor_version
from features.level_survey import LevelSurvey
from features.table import FEATURES
from models.artifact import Artifact, packed
from models.evaluation import OnFold, Verdict, Winners
from models.evaluation import winners as who_wins
from scenes.atomic_file import write_atomically
from scenes.level import Level
from scenes.scene import View
from selector.evidence.importing import bring_in
from selector.evidence.rows import Role
from selector.evidence.store import Store
from selector.learning.dataset import EvidenceError
from selector.learning.featuring import OnInstance
from selector.learning.testing import tested
from selector.learning.training import Learning, judged, learning, trained, verdict_record
from selector.level_measuring import STRIKES_NOTHING, seen_lights
from selector.policy import MISS

Json = dict[str, Any]


@contextmanager
def evidence(store: str, folder: Path | None) -> Iterator[Store]:
    """An open store; a temporary one with what is in a folder of files, where one is named.

    Raises:
        StoreError: It cannot be opened, or the files are no evidence.
    """
    if folder is None:
        with Store.open(store) as opened:
            yield opened
        return
    with TemporaryDirectory(prefix="gnomon-") as place, Store.open(str(Path(place) / "evidence")) as opened:
        bring_in(opened, [folder])
        yield opened


def learnt(source: Store, device: str | None, levels: Path | None, on_instance: OnInstance) -> Learning:
    """What there is to learn from, for one device's times."""
    return learning(source, device, levels, on_instance)


def test_data(source: Store, device: str | None, levels: Path | None, on_instance: OnInstance) -> Learning:
    """What no model may learn from, for one device's times.

    Raises:
        EvidenceError: There is none, or too little.
    """
    if not any(True for _ in source.instances(role=Role.TEST)):
        raise EvidenceError(
            "This evidence holds no test data.",
            known="All of it is for learning, and a model is not asked about what it may have learnt.",
            remedy="Measure some levels apart: `gnomon benchmark --corpus LEVELS --test`.",
        )
    return learning(source, device, levels, on_instance, Role.TEST)


def evaluation_of(model: Artifact, source: Learning) -> tuple[Verdict, ...]:
    """How good a finished model is on what it was not learnt from.

    Raises:
        ModelError: It knows other features.
        EvidenceError: Some of its choices were not measured.
    """
    return tested(model, source)


def evaluation(source: Learning, on_fold: OnFold) -> tuple[Verdict, ...]:
    """How good a model of it is, on families that it was not learnt from."""
    return judged(source, on_fold)


def winners(source: Learning) -> tuple[Winners, ...]:
    """Who wins under each policy, and what there is to gain."""
    return who_wins(source.dataset.examples, MISS)


def winners_record(source: Learning, found: Sequence[Winners]) -> Json:
    """Winners as JSON values: mobility -> policy -> technique -> how often, and what there is to gain."""
    slots = source.dataset.slots
    record: Json = {}
    for one in found:
        counts: dict[str, int] = {}
        for slot, count in zip(slots, one.wins.tolist(), strict=True):
            label = slot.label.split()[0]
            counts[label] = counts.get(label, 0) + count
        record.setdefault(one.time, {})[one.question] = {
            "wins": counts,
            "single_best": slots[one.single].label,
            "single_over_best": one.single_over_best,
        }
    return record


def write_model(source: Learning, verdicts: tuple[Verdict, ...], target: Path) -> Artifact:
    """Learns from everything, and writes the model.

    Raises:
        OutputError: The file cannot be written.
    """
    artifact = trained(source, verdicts)
    write_atomically(target, packed(artifact))
    return artifact


def learning_record(source: Learning) -> Json:
    """What was learnt from, as JSON values."""
    data = source.dataset
    return {
        "device": asdict(source.device),
        "instances": len(data.examples),
        "families": len(set(data.examples.families.tolist())),
        "choices": [slot.label for slot in data.slots],
        "left_out": {name: count for name, count in data.left_out.items() if count},
        "problems": dict(source.problems),
        "resolutions": list(source.resolutions),
        "digest": data.examples.digest,
    }


def evaluation_record(source: Learning, verdicts: Sequence[Verdict]) -> Json:
    """Verdicts as JSON values: mobility -> policy -> its closed gap and the rest."""
    labels = tuple(slot.label for slot in source.dataset.slots)
    found: Json = {}
    for one in verdicts:
        found.setdefault(one.time, {})[one.question] = verdict_record(one, labels)
    return found


def feature_records(
    level: Level, lights: Sequence[str], cameras: Sequence[str], size: tuple[int, int]
) -> Json:
    """Every feature of lights of a level, in every view that shows them, as JSON values.

    Raises:
        LevelError: The level has no triangles or lights, or not those that are wanted.
    """
    require_triangles(level)
    wanted = chosen_lights(level, lights)
    seen = seen_lights(level.scene, wanted, chosen_cameras(level, cameras))
    survey = LevelSurvey.of(level.scene)
    records = []
    for one in seen:
        views = [
            {"camera": camera.name, **_extracted(survey, one.light, View(camera, *size))}
            for camera in one.cameras
        ]
        problem = "" if views else one.problem or STRIKES_NOTHING
        records.append({"light": one.light.name, "node": one.light.node, "views": views, "problem": problem})
    return {
        "level": path_words(level.path),
        "digest": level.scene.digest,
        "resolution": list(size),
        "extractor": extractor_version(),
        "level_seconds": survey.seconds,
        "features": [
            {"name": one.name, "group": str(one.group), "unit": one.unit, "meaning": one.meaning}
            for one in FEATURES
        ],
        "lights": records,
    }


def _extracted(survey: LevelSurvey, light: Any, view: View) -> Json:
    found = extract(survey, light, view)
    return {"seconds": found.seconds, "values": dict(found.values)}
