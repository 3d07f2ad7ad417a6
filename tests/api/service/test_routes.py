from __future__ import annotations

import json
from pathlib import Path

import pytest

from api.service.records import (
    Features,
    LightRecommendation,
    Policies,
    PredictedLevel,
    Readiness,
    Recommendation,
    Techniques,
)
from features.table import FEATURES
from renderers.registry import TECHNIQUES
from scenes.formats.registry import read_level
from scenes.gltf.annotation import read_annotations
from selector.policy import POLICIES
from tests.api.service.running_service import GLB, GLTF, Running, features, problem
from tests.scenes.gltf_samples import carrying, tetrahedron
from tests.small_level import small_level


@pytest.fixture(scope="module")
def level(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return small_level(tmp_path_factory.mktemp("level")).read_bytes()


def test_it_says_what_there_is(service: Running) -> None:
    techniques = Techniques.model_validate_json(service.client.get("/v1/techniques").content)
    assert [one.id for one in techniques.techniques] == [one.name for one in TECHNIQUES]
    assert all(one.summary.endswith(".") for one in techniques.techniques)
    policies = Policies.model_validate_json(service.client.get("/v1/policies").content)
    assert {one.name: one.max_edge_error_px for one in policies.policies} == {
        one.name: one.max_edge_error_px for one in POLICIES
    }
    found = Features.model_validate_json(service.client.get("/v1/features").content)
    assert [one.name for one in found.features] == [one.name for one in FEATURES]


def test_it_is_alive_and_becomes_ready(service: Running, level: bytes) -> None:
    assert service.client.get("/healthz").json() == {"status": "ok"}
    # A level waits for a reader, so that there is one afterwards.
    assert service.level(level).status_code == 200
    assert Readiness.model_validate_json(service.client.get("/readyz").content).checks["model"] == "ok"


def test_features_are_answered_at_once(service: Running) -> None:
    for kind in ("spot", "point", "directional"):
        wanted = {"kind": kind, "views": [features(kind)] * 2, "policy": "quality", "mobility": "static"}
        response = service.client.post("/v1/recommendations", json=wanted)
        assert response.status_code == 200, response.text
        found = Recommendation.model_validate_json(response.content)
        assert (found.policy, found.mobility, found.max_edge_error_px) == ("quality", "static", 0.5)
        assert found.refused == []
        costs = [found.cost, *(one.cost for one in found.alternatives)]
        assert costs == sorted(costs)


def test_techniques_can_be_left_out(service: Running) -> None:
    wanted = {"kind": "spot", "views": [features()], "techniques": ["SV", "shadow_map"]}
    found = service.client.post("/v1/recommendations", json=wanted).json()
    assert {one["id"] for one in (found, *found["alternatives"])} == {"shadow_volume", "shadow_map"}


def test_a_limit_of_its_own_replaces_the_policys(service: Running) -> None:
    wanted = {"kind": "spot", "views": [features()], "max_edge_error_px": 7}
    found = service.client.post("/v1/recommendations", json=wanted).json()
    assert (found["policy"], found["max_edge_error_px"]) == ("custom", 7)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kind": "sun"}, "kind"),
        ({"kind": "point"}, "not those of a point light"),
        ({"views": []}, "views"),
        ({"views": [features()] * 17}, "views"),
        ({"views": [{**features(), "shoe_size": 44}]}, "shoe_size"),
        ({"views": [{**features(), "crowding": "wide"}]}, "crowding"),
        ({"views": [{**features(), "crowding": 1e300}]}, "crowding"),
        ({"views": [{"crowding": 0.5}]}, "casting_triangles"),
        ({"policy": "best"}, "speed, balanced, quality"),
        ({"techniques": ["ESM"]}, "known are SM"),
        ({"max_edge_error_px": -1}, "max_edge_error_px"),
        ({"color": "red"}, "color"),
    ],
)
def test_questions_that_make_no_sense_are_refused(
    service: Running, change: dict[str, object], words: str
) -> None:
    wanted = {"kind": "spot", "views": [features()], **change}
    found = problem(service.client.post("/v1/recommendations", json=wanted), 422, "bad-value")
    assert words in found["detail"]


def test_a_number_that_is_none_is_refused(service: Running) -> None:
    text = json.dumps({"kind": "spot", "views": [features()]}).replace("0.5", "NaN", 1)
    response = service.client.post(
        "/v1/recommendations", content=text, headers={"Content-Type": "application/json"}
    )
    assert response.status_code in (400, 422)


@pytest.mark.parametrize("kind", ["", "text/plain", "application/xml"])
def test_questions_are_json(service: Running, kind: str) -> None:
    body = json.dumps({"kind": "spot", "views": [features()]})
    headers = {"Content-Type": kind} if kind else {}
    problem(service.client.post("/v1/recommendations", content=body, headers=headers), 415, "bad-media-type")
    bad = service.client.post(
        "/v1/recommendations", content=b"{", headers={"Content-Type": "application/json"}
    )
    problem(bad, 400, "bad-request")


def test_a_level_is_answered_light_by_light(service: Running, level: bytes) -> None:
    response = service.level(level, name="C:\\levels\\tower.glb", policy="speed", resolution="320x200")
    assert response.status_code == 200, response.text
    found = PredictedLevel.model_validate_json(response.content)
    assert (found.level, found.resolution, found.policy) == ("tower.glb", [320, 200], "speed")
    assert [one.light for one in found.lights] == ["Lamp", "Torch", "Sun"]
    assert all(isinstance(one, LightRecommendation) and one.node is not None for one in found.lights)


def test_a_level_is_annotated(service: Running, level: bytes, tmp_path: Path) -> None:
    response = service.level(level, "/v1/levels/annotated", name="tower.glb", light="Torch")
    assert response.status_code == 200, response.text
    assert response.headers["content-type"] == GLB
    assert 'filename="tower.annotated.glb"' in response.headers["content-disposition"]
    path = tmp_path / "back.glb"
    path.write_bytes(response.content)
    torch = next(one for one in read_level(path).scene.lights if one.name == "Torch")
    assert set(read_annotations(response.content)) == {torch.node}


def test_lights_without_an_answer_say_why(service: Running) -> None:
    # It ends before it reaches anything.
    nodes = [{"mesh": 0}, carrying(0, translation=[0, 500, 0])]
    source = tetrahedron(nodes=nodes, scenes=[{"nodes": [0, 1]}])
    source["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "range": 1.0}]}}
    content = json.dumps(source).encode()
    found = PredictedLevel.model_validate_json(service.level(content, kind=GLTF).content)
    assert [one.problem != "" for one in found.lights] == [True]
    refused = problem(service.level(content, "/v1/levels/annotated", GLTF), 422, "bad-level")
    assert "no light has a recommendation" in refused["detail"]


@pytest.mark.parametrize("query", [{"light": "Moon"}, {"camera": "7"}, {"scene": "other"}])
def test_what_is_not_in_the_level_is_named(service: Running, level: bytes, query: dict[str, str]) -> None:
    found = problem(service.level(level, **query), 422, "bad-level")
    assert found["detail"].startswith("level.glb")


@pytest.mark.parametrize(
    "query",
    [
        {"resolution": "640"},
        {"resolution": "9999x9999"},
        {"policy": "best"},
        {"technique": "ESM"},
        {"mobility": "slow"},
        {"max_edge_error_px": "inf"},
        {"polcy": "speed"},
        {"light": "x" * 201},
    ],
)
def test_options_that_make_no_sense_are_refused(
    service: Running, level: bytes, query: dict[str, str]
) -> None:
    problem(service.level(level, **query), 422, "bad-value")


def test_every_error_is_a_problem(service: Running) -> None:
    client = service.client
    problem(client.get("/nothing"), 404, "not-found")
    problem(client.get("/v1/jobs/../../etc/passwd"), 404, "not-found")
    refused = client.put("/v1/techniques")
    problem(refused, 405, "bad-method")
    assert refused.headers["allow"] == "GET"
    problem(
        client.post("/v1/levels", content=b"x", headers={"Content-Type": "image/png"}), 415, "bad-media-type"
    )
    problem(client.post("/v1/levels"), 415, "bad-media-type")
    problem(service.level(b""), 422, "bad-level")


def test_requests_are_counted_by_route(service: Running) -> None:
    service.client.get("/v1/policies")
    text = service.client.get("/metrics").text
    assert 'gnomon_requests_total{method="GET",route="/v1/policies",status="200"}' in text
    # Paths hold what only one client may know.
    service.client.get("/v1/jobs/secret-secret-secret")
    assert "secret-secret" not in service.client.get("/metrics").text
    assert 'route="/v1/jobs/{job_id}"' in service.client.get("/metrics").text


def test_the_page_may_load_nothing_from_elsewhere(service: Running) -> None:
    response = service.client.get("/")
    assert response.status_code == 200
    assert response.headers["content-type"].startswith("text/html")
    policy = response.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "http" not in policy
    for name in ("page.css", "page.js"):
        assert service.client.get(f"/page/{name}").status_code == 200
    for name in ("nothing.js", "..%2Fapplication.py", "%2e%2e/settings.py", "", "__init__.py"):
        problem(service.client.get(f"/page/{name}"), 404, "not-found")


def test_answers_are_kept_from_others(service: Running) -> None:
    headers = service.client.get("/v1/policies").headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"] == "no-store"
    assert "access-control-allow-origin" not in headers
    assert "server" not in headers
    assert len(headers["x-request-id"]) == 16
