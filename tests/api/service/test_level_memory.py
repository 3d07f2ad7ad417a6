"""What a reader remembers of the last levels: it saves work, and changes no answer."""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict, replace
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from api.predicting import Outline
from api.service import reading_worker
from api.service.asked import LevelOptions
from api.service.child_process import Work
from api.service.level_folder import PARTS, ReadyLevel
from api.service.level_memory import MOST_LEVELS, Known, LevelMemory
from api.service.level_names import GLB
from api.service.settings import Limits
from tests.small_level import POINT, SPOT, small_level, small_scene

ASKED = LevelOptions()
numbers = count()


def known(words: str = "") -> Known:
    return Outline(Path(words), "glTF", words, ()), ()


def placed(folder: Path, **files: bytes) -> ReadyLevel:
    place = folder / f"upload {next(numbers)}" / "level"
    for name, data in files.items():
        path = place / name.replace("__", "/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return ReadyLevel(place / next(iter(files)), GLB)


def test_a_level_is_known_by_what_its_files_hold(tmp_path: Path) -> None:
    memory = LevelMemory()
    found = memory.known(placed(tmp_path, a=b"one", b__c=b"two"), ASKED, known)
    other = LevelOptions(policy="quality", mobility="static", technique=["SV"], name="other.glb")
    for same in (ASKED, other):
        assert memory.known(placed(tmp_path, a=b"one", b__c=b"two"), same, lambda: known("anew")) is found
    for files in ({"a": b"one"}, {"a": b"one", "b__d": b"two"}, {"a": b"onet", "b__c": b"wo"}):
        assert memory.known(placed(tmp_path, **files), ASKED, lambda: known("anew"))[0].digest == "anew"


@pytest.mark.parametrize(
    "change", [{"scene": "1"}, {"resolution": "64x48"}, {"light": ["Lamp"]}, {"camera": ["Eye"]}]
)
def test_what_decides_features_is_asked_anew(tmp_path: Path, change: dict[str, Any]) -> None:
    memory, level = LevelMemory(), placed(tmp_path, a=b"one")
    memory.known(level, ASKED, known)
    other = LevelOptions.model_validate(change)
    assert memory.known(level, other, lambda: known("anew"))[0].digest == "anew"


def test_the_level_that_was_asked_about_longest_ago_is_forgotten(tmp_path: Path) -> None:
    memory = LevelMemory()
    levels = [placed(tmp_path, a=bytes([number])) for number in range(MOST_LEVELS + 1)]
    for level in levels[:-1]:
        memory.known(level, ASKED, known)
    memory.known(levels[0], ASKED, lambda: known("anew"))
    memory.known(levels[-1], ASKED, known)
    assert memory.known(levels[0], ASKED, lambda: known("anew"))[0].digest == ""
    assert memory.known(levels[1], ASKED, lambda: known("anew"))[0].digest == "anew"


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
    level = small_level(tmp_path)
    others = (
        {"policy": "quality"},
        {"mobility": "static", "max_edge_error_px": 0.25},
        {"technique": ["SM", "SV"]},
    )
    fresh = [ask(reading_worker._reader(model), level, tmp_path, **options) for options in others]
    annotated = ask(reading_worker._reader(model), level, tmp_path, "annotate", policy="speed")
    work = reading_worker._reader(model)
    ask(work, level, tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(reading_worker, "read_level", lambda *_: pytest.fail("the level was read again"))
        assert [ask(work, level, tmp_path, **options) for options in others] == fresh
        assert ask(work, level, tmp_path, "annotate", policy="speed") == annotated
    moved = small_level(
        tmp_path, scene=small_scene((replace(SPOT, position=(3.0, 6.5, 2.0)), replace(POINT, range_m=9.0)))
    )
    answer = json.loads(ask(work, moved, tmp_path))
    assert len(answer["lights"]) == 2
    assert ask(work, moved, tmp_path) == ask(reading_worker._reader(model), moved, tmp_path)
