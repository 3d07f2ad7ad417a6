"""What a reader remembers of the last levels: it saves work, and changes no answer."""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict, replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from api.predicting import KnownLight, NamedLight, Outline
from api.service import reading_worker
from api.service.asked import LevelOptions
from api.service.child_process import Work
from api.service.level_folder import PARTS, ReadyLevel
from api.service.level_memory import MOST_LEVELS, Known, LevelMemory
from api.service.level_names import GLB
from api.service.settings import Limits
from api.service.state_folder import MEMORY, empty_memory
from models.artifact import Artifact, load
from scenes.scene import LightKind, Mobility
from selector.candidate import Candidate
from selector.learning.predicting import LightFacts
from selector.level_measuring import STRIKES_NOTHING
from tests.small_level import POINT, SPOT, small_level, small_scene

ASKED = LevelOptions()
numbers = count()


def known(words: str = "") -> Known:
    refused = {Candidate("shadow_volume", (("variant", "mixed"), ("map_size", 256))): "It is too large."}
    facts = LightFacts(LightKind.SPOT, np.array([[0.1, 1 / 3], [-0.0, 1e300]]), refused)
    lights = (
        KnownLight(0, Mobility.STATIC, ("Eye", "\ud800"), facts),
        KnownLight(1, Mobility.DYNAMIC, problem=STRIKES_NOTHING),
    )
    return Outline(
        "glTF", words, (NamedLight("Lamp", 3, "spot"), NamedLight("\u202e", None, "point"))
    ), lights


def placed(folder: Path, **files: bytes) -> ReadyLevel:
    place = folder / f"upload {next(numbers)}" / "level"
    for name, data in files.items():
        path = place / name.replace("__", "/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return ReadyLevel(place / next(iter(files)), GLB)


@pytest.fixture
def memory(tmp_path: Path, artifact: Artifact) -> LevelMemory:
    return LevelMemory(empty_memory(tmp_path), artifact)


@pytest.fixture(scope="module")
def artifact(model: Path) -> Artifact:
    return load(model)


def found(memory: LevelMemory, level: ReadyLevel, options: LevelOptions = ASKED) -> bool:
    """Whether it was remembered."""
    return memory.known(level, options, lambda: known("anew"))[0].digest != "anew"


def test_what_is_remembered_is_what_was_found_out(tmp_path: Path, memory: LevelMemory) -> None:
    level = placed(tmp_path, a=b"one")
    memory.known(level, ASKED, known)
    outline, lights = memory.known(level, ASKED, lambda: known("anew"))
    assert (outline, lights[1]) == (known()[0], known()[1][1])
    (one, other) = (lights[0].facts, known()[1][0].facts)
    assert one
    assert other
    assert (one.kind, dict(one.refused)) == (other.kind, dict(other.refused))
    assert one.rows.tobytes() == other.rows.tobytes()
    assert replace(lights[0], facts=None) == replace(known()[1][0], facts=None)


def test_a_level_is_known_by_what_its_files_hold(tmp_path: Path, memory: LevelMemory) -> None:
    memory.known(placed(tmp_path, a=b"one", b__c=b"two"), ASKED, known)
    other = LevelOptions(policy="quality", mobility="static", technique=["SV"], name="other.glb")
    for same in (ASKED, other):
        assert found(memory, placed(tmp_path, a=b"one", b__c=b"two"), same)
    for files in ({"a": b"one"}, {"a": b"one", "b__d": b"two"}, {"a": b"onet", "b__c": b"wo"}):
        assert not found(memory, placed(tmp_path, **files))


@pytest.mark.parametrize(
    "change", [{"scene": "1"}, {"resolution": "64x48"}, {"light": ["Lamp"]}, {"camera": ["Eye"]}]
)
def test_what_decides_features_is_asked_anew(
    tmp_path: Path, memory: LevelMemory, change: dict[str, Any]
) -> None:
    level = placed(tmp_path, a=b"one")
    memory.known(level, ASKED, known)
    assert not found(memory, level, LevelOptions.model_validate(change))


def test_another_model_asks_anew(tmp_path: Path, memory: LevelMemory, artifact: Artifact) -> None:
    level = placed(tmp_path, a=b"one")
    memory.known(level, ASKED, known)
    small = dict(artifact.card, limits={"max_texture_side": 1024, "max_buffer_bytes": 64})
    assert not found(LevelMemory(tmp_path / MEMORY, replace(artifact, card=small)), level)
    assert found(LevelMemory(tmp_path / MEMORY, artifact), level)


def test_the_level_that_was_asked_about_longest_ago_is_forgotten(tmp_path: Path, memory: LevelMemory) -> None:
    levels = [placed(tmp_path, a=bytes([number])) for number in range(MOST_LEVELS + 1)]
    for level in levels[:-1]:
        memory.known(level, ASKED, known)
    assert found(memory, levels[0])
    memory.known(levels[-1], ASKED, known)
    assert found(memory, levels[0])
    assert not found(memory, levels[1])
    assert len(list((tmp_path / MEMORY).iterdir())) == MOST_LEVELS


def test_what_cannot_be_read_or_written_is_found_out_again(tmp_path: Path, memory: LevelMemory) -> None:
    level, place = placed(tmp_path, a=b"one"), tmp_path / MEMORY
    memory.known(level, ASKED, known)
    (path,) = place.iterdir()
    path.write_bytes(path.read_bytes()[:-9])
    assert not found(memory, level)
    shutil.rmtree(place)
    assert not found(memory, level)
    assert not place.exists()


def test_what_went_wrong_is_tried_again(tmp_path: Path, memory: LevelMemory) -> None:
    level, (outline, lights) = placed(tmp_path, a=b"one"), known()
    failed = outline, (lights[0], replace(lights[1], problem="MemoryError"))
    assert memory.known(level, ASKED, lambda: failed) == failed
    assert not found(memory, level)


def test_only_what_readers_have_written_is_removed(tmp_path: Path) -> None:
    place = empty_memory(tmp_path)
    (place / "notes.txt").write_text("mine")
    for name in ("0" * 64 + ".json", "0" * 64 + ".json.17"):
        (place / name).write_text("{}")
    empty_memory(tmp_path)
    assert [path.name for path in place.iterdir()] == ["notes.txt"]


def ask(work: Work, level: Path, folder: Path, task: str = "predict", **options: Any) -> bytes:
    upload = folder / f"upload {next(numbers)}"
    (upload / PARTS).mkdir(parents=True)
    shutil.copy(level, upload / PARTS / "0")
    part = {"place": f"{PARTS}/0", "name": level.name, "media_type": GLB}
    request = {
        "folder": str(upload),
        "options": LevelOptions.model_validate(options).model_dump(mode="json"),
        "parts": [part],
        "limits": asdict(Limits()),
        "task": task,
    }
    return (upload / work(request, lambda _: None)["file"]).read_bytes()


def test_another_policy_surveys_nothing_again_and_is_answered_as_ever(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def reader(memory: str) -> Work:
        return reading_worker._reader(model, empty_memory(tmp_path / memory))

    level = small_level(tmp_path)
    others = (
        {"policy": "quality"},
        {"mobility": "static", "max_edge_error_px": 0.25},
        {"technique": ["SM", "SV"]},
    )
    fresh = [ask(reader("one"), level, tmp_path, **options) for options in others]
    annotated = ask(reader("one"), level, tmp_path, "annotate", policy="speed")
    ask(reader("two"), level, tmp_path)
    # Another process remembers what this one has found out.
    work = reading_worker._reader(model, tmp_path / "two" / MEMORY)
    with monkeypatch.context() as patch:
        patch.setattr(reading_worker, "read_level", lambda *_: pytest.fail("the level was read again"))
        assert [ask(work, level, tmp_path, **options) for options in others] == fresh
        assert ask(work, level, tmp_path, "annotate", policy="speed") == annotated
    moved = small_level(
        tmp_path, scene=small_scene((replace(SPOT, position=(3.0, 6.5, 2.0)), replace(POINT, range_m=9.0)))
    )
    answer = json.loads(ask(work, moved, tmp_path))
    assert len(answer["lights"]) == 2
    assert ask(work, moved, tmp_path) == ask(reader("three"), moved, tmp_path)
