from __future__ import annotations

import io
import json
import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest

from models.artifact import Artifact, ModelError, load, packed, unpacked
from models.selector_model import METHODS, SelectorModel
from tests.models.synthetic import MISS, QUESTIONS, synthetic

EXAMPLES = synthetic()
NAMES = tuple(f"feature_{index}" for index in range(5))
CARD = {"choices": ["a"], "digest": EXAMPLES.digest}


@pytest.fixture(scope="module")
def artifact() -> Artifact:
    return Artifact(SelectorModel.fit(EXAMPLES, MISS, inner_folds=2), NAMES, CARD)


@pytest.fixture(scope="module")
def data(artifact: Artifact) -> bytes:
    return packed(artifact)


def test_a_model_comes_back_as_it_was(artifact: Artifact, data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "model.gnomon"
    path.write_bytes(data)
    again = load(path)
    assert (again.features, again.card) == (NAMES, CARD)
    for index in range(2):
        for method in METHODS:
            ours = artifact.model.costs(EXAMPLES.features, QUESTIONS[index], method)
            assert np.array_equal(again.model.costs(EXAMPLES.features, QUESTIONS[index], method), ours)
    assert again.model.inner_costs == artifact.model.inner_costs
    assert packed(again) == data


def test_the_same_evidence_gives_the_same_bytes(data: bytes) -> None:
    again = synthetic()
    assert again.digest == EXAMPLES.digest != synthetic(1).digest
    assert packed(Artifact(SelectorModel.fit(again, MISS, inner_folds=2), NAMES, CARD)) == data


def remade(data: bytes, change: str, *, method: int = zipfile.ZIP_STORED) -> bytes:
    """The file with one thing changed."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(buffer, "w", method) as new:
        for one in old.infolist():
            content = old.read(one)
            if one.filename == "model.json":
                content = changed_manifest(content, change)
            if change == one.filename:
                continue
            if change == "a pickle" and one.filename == "single.npy":
                holder = io.BytesIO()
                np.save(holder, np.array([{"a": 1}], dtype=object), allow_pickle=True)
                content = holder.getvalue()
            if change == "a bare pickle" and one.filename == "single.npy":
                content = pickle.dumps([1, 2])
            if change == "other numbers" and one.filename.endswith("forest/value.npy"):
                content = content[:-8] + np.float64(3).tobytes()
            if change == "a huge shape" and one.filename == "single.npy":
                content = content.replace(b"(2,)", b"(9000000000000,)")
            new.writestr(one.filename, content)
    return buffer.getvalue()


def changed_manifest(content: bytes, change: str) -> bytes:
    manifest = json.loads(content)
    if change == "another format":
        manifest["format"] = "something"
    if change == "another version":
        manifest["version"] = 99
    if change == "one feature less":
        manifest["features"].pop()
    if change == "an unknown method":
        manifest["model"]["method"] = "guess"
    if change == "no questions":
        manifest["model"]["questions"] = []
    if change == "odd questions":
        manifest["model"]["questions"] = [["a"]]
    if change == "an endless miss":
        manifest["model"]["miss"] = 1e999
    if change == "no card":
        manifest["card"] = 5
    if change == "a list":
        manifest = [manifest]
    return json.dumps(manifest).encode()


@pytest.mark.parametrize(
    "change",
    [
        "another format",
        "another version",
        "one feature less",
        "an unknown method",
        "no questions",
        "odd questions",
        "an endless miss",
        "no card",
        "a list",
        "a pickle",
        "a bare pickle",
        "other numbers",
        "a huge shape",
        "model.json",
        "single.npy",
        "forest/left.npy",
        "performance/error/0/value.npy",
    ],
)
def test_a_strange_model_is_refused_in_words(data: bytes, change: str) -> None:
    with pytest.raises(ModelError) as caught:
        unpacked(remade(data, change), "there.gnomon")
    assert caught.value.what.endswith(".")
    assert caught.value.where == "there.gnomon"


def test_a_compressed_model_is_refused(data: bytes) -> None:
    with pytest.raises(ModelError, match="stored"):
        unpacked(remade(data, "", method=zipfile.ZIP_DEFLATED))


def test_what_is_no_file_of_ours_is_refused_in_words(data: bytes, tmp_path: Path) -> None:
    for wrong in (b"", b"PK", b"not a model", pickle.dumps({}), data[:1000], data[: len(data) // 2]):
        with pytest.raises(ModelError):
            unpacked(wrong)
    with pytest.raises(ModelError, match="cannot be read"):
        load(tmp_path / "none")
    with pytest.raises(ModelError, match="cannot be read"):
        load(tmp_path)


def test_a_model_whose_bytes_were_hit_is_refused_or_the_same(data: bytes, artifact: Artifact) -> None:
    random = np.random.default_rng(3)
    for place in random.integers(0, len(data), 150):
        hit = bytearray(data)
        hit[place] ^= 1 << int(random.integers(8))
        try:
            again = unpacked(bytes(hit))
        except ModelError:
            continue
        # Dates and the like may be hit without harm; a card is not covered by the checksum.
        assert np.array_equal(
            again.model.costs(EXAMPLES.features[:4], QUESTIONS[0]),
            artifact.model.costs(EXAMPLES.features[:4], QUESTIONS[0]),
        )
