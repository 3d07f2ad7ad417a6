from __future__ import annotations

import json
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

import pytest

from api.client.asking import Ask
from api.client.errors import BadAnswerError
from api.client.service import Service
from tests.api.client.sample_answers import JOB, LEVEL, MEASURED, RECOMMENDATION
from tests.api.client.scripted_service import answer, json_answer, scripted


def test_simple_routes() -> None:
    policies = {"policies": [{"name": "speed", "max_edge_error_px": 4}], "default": "balanced"}
    features = {"extractor": "e", "features": [{"name": "n", "group": "g", "unit": "m", "meaning": "M."}]}
    scripts = [
        json_answer(policies),
        json_answer(features),
        answer("ok", kind="text/plain"),
        answer("gnomon_jobs 1\n", kind="text/plain; version=0.0.4"),
        json_answer({"openapi": "3.1.0"}),
    ]
    with scripted(*scripts) as fake:
        service = Service(fake.url)
        assert service.policies().policies[0].max_edge_error_px == 4.0
        assert service.features().features[0].meaning == "M."
        service.ready()
        assert service.metrics() == "gnomon_jobs 1\n"
        assert service.openapi()["openapi"] == "3.1.0"
    targets = ["/v1/policies", "/v1/features", "/readyz", "/metrics", "/openapi.json"]
    assert [(one.method, one.target) for one in fake.asked] == [("GET", target) for target in targets]


def test_features_are_sent_as_they_are() -> None:
    with scripted(json_answer(RECOMMENDATION)) as fake:
        found = Service(fake.url, token="T0k-en").recommend("spot", [{"a": 1.5}], policy="speed")  # noqa: S106
    assert found.technique == "SM"
    (asked,) = fake.asked
    assert json.loads(asked.body) == {"kind": "spot", "views": [{"a": 1.5}], "policy": "speed"}
    assert asked.headers["content-type"] == "application/json"
    assert asked.headers["authorization"] == "Bearer T0k-en"


def test_a_level_is_asked_about_with_its_options(tmp_path: Path) -> None:
    path = tmp_path / "a room.glb"
    path.write_bytes(b"glTF1234")
    ask = Ask("quality", 0.25, "static", ("SM", "SV"), "Hall", (320, 200), ("node:3", "Lámp & Co"), ("Eye",))
    with scripted(json_answer(LEVEL)) as fake:
        found = Service(fake.url + "/prefix/").level(path, ask)
    assert [light.light for light in found.lights] == ["Lamp", "Dark"]
    (asked,) = fake.asked
    assert urlsplit(asked.target).path == "/prefix/v1/levels"
    assert parse_qsl(urlsplit(asked.target).query) == [
        ("policy", "quality"),
        ("max_edge_error_px", "0.25"),
        ("mobility", "static"),
        ("scene", "Hall"),
        ("resolution", "320x200"),
        ("name", "a room.glb"),
        ("technique", "SM"),
        ("technique", "SV"),
        ("light", "node:3"),
        ("light", "Lámp & Co"),
        ("camera", "Eye"),
    ]
    assert (asked.body, asked.headers["content-type"]) == (b"glTF1234", "model/gltf-binary")
    assert "authorization" not in asked.headers


def test_no_level_goes_through_a_proxy(monkeypatch: pytest.MonkeyPatch) -> None:
    with scripted(json_answer(LEVEL)) as proxy, scripted(json_answer(LEVEL)) as fake:
        monkeypatch.setenv("http_proxy", proxy.url)
        Service(fake.url).level(b"glTF")
        assert proxy.asked == []


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ('attachment; filename="room.annotated.glb"', "room.annotated.glb"),
        ('attachment; filename="../../etc/passwd"', "passwd"),
        ('attachment; filename="C:\\evil.glb"', "evil.glb"),
        ('attachment; filename=".."', ""),
        ('attachment; filename=""', ""),
        ("attachment", ""),
        ("attachment; filename=\"L_mpe.glb\"; filename*=UTF-8''L%C3%A4mpe.glb", "Lämpe.glb"),
        ("attachment; filename*=UTF-8''..%2F..%2Fpasswd", "passwd"),
    ],
)
def test_a_download_has_a_bare_name(header: str, name: str) -> None:
    script = answer(b"glTF", f"Content-Disposition: {header}", kind="model/gltf-binary")
    with scripted(script) as fake:
        found = Service(fake.url).annotated_level(b"glTF")
    assert (found.data, found.media_type, found.name) == (b"glTF", "model/gltf-binary", name)


def test_a_job_from_its_beginning_to_its_end() -> None:
    scripts = [
        json_answer(JOB, "Retry-After: 2", status=202),
        json_answer({**JOB, "state": "done"}),
        json_answer(MEASURED),
        answer(b"glTF", kind="model/gltf-binary"),
        answer("<html>", kind="text/html; charset=utf-8"),
        json_answer({**JOB, "state": "cancelled"}),
    ]
    with scripted(*scripts) as fake:
        service = Service(fake.url)
        job = service.submit(b"glTF", Ask(rounds=5))
        assert (job.retry_after_s, job.ended) == (2.0, False)
        assert service.job(job.id).ended
        assert service.result(job.id).rounds == 3
        assert service.annotated(job.id).data == b"glTF"
        assert service.report(job.id).data == b"<html>"
        assert service.cancel(job.id).state == "cancelled"
    assert [f"{one.method} {one.target}" for one in fake.asked] == [
        "POST /v1/jobs?rounds=5",
        "GET /v1/jobs/abc",
        "GET /v1/jobs/abc/result",
        "GET /v1/jobs/abc/annotated",
        "GET /v1/jobs/abc/report",
        "DELETE /v1/jobs/abc",
    ]


def test_an_id_leads_to_a_job_and_nowhere_else() -> None:
    with scripted(json_answer(JOB)) as fake:
        Service(fake.url).job("../a/b?c#d")
        with pytest.raises(BadAnswerError):
            Service(fake.url).job("..")
    assert fake.asked[0].target == "/v1/jobs/..%2Fa%2Fb%3Fc%23d"
