"""The client and the real service, over real connections."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from api.client.asking import Ask
from api.client.errors import ProblemError
from api.client.records import LevelAnswer
from api.client.service import Service
from api.client.waiting import wait_for_job
from api.service.settings import Settings
from features.table import NAMES
from models.artifact import packed
from selector.evidence.store import Store
from selector.learning.training import learning, trained
from tests.api.client.test_page import run_examples
from tests.api.service.running_service import features, running
from tests.selector.learning_evidence import filled
from tests.small_level import small_level

TOKEN = "t0ken-of-a-test-that-is-long"  # noqa: S105  no secret
QUICK = Ask(resolution=(96, 64), rounds=1, techniques=("SV",), lights=("Lamp",))


@pytest.fixture(scope="module")
def settings(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    folder = tmp_path_factory.mktemp("service")
    with Store.open(str(filled(folder / "e.sqlite"))) as store:
        artifact = trained(learning(store, None, None, lambda *_: None), ())
    (folder / "made.model").write_bytes(packed(artifact))
    return Settings(state=folder / "state", model=folder / "made.model", readers=1, token=TOKEN)


@pytest.fixture(scope="module")
def url(settings: Settings) -> Iterator[str]:
    with running(settings) as up:
        address = f"http://127.0.0.1:{up.port}"
        # Its processes take a while to start, on a busy machine a long one.
        Service(address, token=TOKEN, patience_s=120).ready()
        yield address


@pytest.fixture
def service(url: str) -> Service:
    return Service(url, token=TOKEN)


def as_gltf(glb: Path, folder: Path) -> Path:
    """The same level as a .gltf with its geometry in a file of its own."""
    data = glb.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20 : 20 + length])
    document["buffers"][0]["uri"] = "the%20data/geometry%26more.bin"
    (folder / "the data").mkdir()
    (folder / "the data/geometry&more.bin").write_bytes(data[28 + length :])
    path = folder / "a level.gltf"
    path.write_text(json.dumps(document))
    return path


def told(answer: LevelAnswer) -> list[tuple[str, int | None, str]]:
    return [
        (one.light, one.node, one.recommendation.reason if one.recommendation else "")
        for one in answer.lights
    ]


def test_it_says_what_there_is(service: Service) -> None:
    service.alive()
    service.ready()
    assert {one.label for one in service.techniques().techniques} >= {"SM", "PSM", "SV", "Chan"}
    assert service.policies().default in {one.name for one in service.policies().policies}
    assert tuple(one.name for one in service.features().features) == NAMES
    assert "gnomon_" in service.metrics()
    assert "/v1/levels" in service.openapi()["paths"]


def test_a_level_in_pieces_is_the_same_level(service: Service, tmp_path: Path) -> None:
    glb = small_level(tmp_path)
    whole, pieces = service.level(glb), service.level(as_gltf(glb, tmp_path))
    assert [name for name, _, _ in told(whole)] == ["Lamp", "Torch", "Sun"]
    assert told(pieces) == told(whole)
    assert (whole.level, pieces.level) == ("small.glb", "a level.gltf")
    assert service.level(glb.read_bytes(), Ask(lights=("Torch",))).lights[0].index == 1


def test_an_annotated_level_comes_back_as_what_went_in(service: Service, tmp_path: Path) -> None:
    glb = small_level(tmp_path)
    binary, text = service.annotated_level(glb), service.annotated_level(as_gltf(glb, tmp_path))
    assert (binary.name, binary.media_type) == ("small.annotated.glb", "model/gltf-binary")
    assert (text.name, text.media_type) == ("a level.annotated.gltf", "model/gltf+json")
    assert binary.data.count(b'"gnomon_technique"') == text.data.count(b'"gnomon_technique"') > 0


def test_features_are_enough(service: Service) -> None:
    found = service.recommend(
        "spot", [features("spot")], policy="quality", techniques=["SM", "SV"], mobility="static"
    )
    assert found.technique in ("SM", "SV")
    assert (found.policy, found.mobility, found.source) == ("quality", "static", "predicted")


def test_a_no_has_its_sentence(service: Service, url: str) -> None:
    with pytest.raises(ProblemError) as bad:
        service.level(b"glTF garbage")
    with pytest.raises(ProblemError) as unknown:
        service.job("unknown")
    with pytest.raises(ProblemError) as stranger:
        Service(url, token="x" * 20).techniques()
    with pytest.raises(ProblemError) as lightless:
        service.recommend("spot", [{"nonsense": 1.0}])
    assert [one.value.status for one in (bad, unknown, stranger, lightless)] == [422, 404, 401, 422]
    for one in (bad, unknown, stranger, lightless):
        assert one.value.detail.endswith(".")


def test_a_job_is_measured(service: Service, tmp_path: Path) -> None:
    seen = []
    job = service.submit(small_level(tmp_path), QUICK)
    ended = wait_for_job(service, job.id, lambda one: seen.append(one.state), seconds=240)
    assert ended.state == "done", ended.problem
    assert seen[-1] == "done"
    (light,) = service.result(job.id).lights
    assert light.recommendation
    assert light.recommendation.chosen.label == "SV"
    assert service.annotated(job.id).name == "small.annotated.glb"
    assert service.report(job.id).media_type == "text/html"
    with pytest.raises(ProblemError) as late:
        service.cancel(job.id)
    assert late.value.status == 409


def test_a_job_is_cancelled(service: Service, tmp_path: Path) -> None:
    path = small_level(tmp_path)
    first, second = service.submit(path), service.submit(path)
    assert service.cancel(second.id).state == "cancelled"
    service.cancel(first.id)
    assert wait_for_job(service, first.id, seconds=120).state == "cancelled"
    with pytest.raises(ProblemError) as none:
        service.result(second.id)
    assert none.value.status == 409


def test_the_examples_of_the_page_run(
    url: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run_examples(f"Service({url!r}, token={TOKEN!r})", monkeypatch)
    said = capsys.readouterr().out
    assert "street.annotated.glb model/gltf-binary" in said
    assert "done" in said
