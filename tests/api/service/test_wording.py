"""Values that are wrong are told in sentences, on every route, with what is taken."""

from __future__ import annotations

import pytest

from tests.api.service.running_service import GLTF, Running, features, problem
from tests.api.service.test_uploads import bytes_of, source_with

LEVEL = bytes_of(source_with(None))
RAW = ("String should", "Extra inputs", "Value error", "Input should", "--")


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("resolution=0x0", "resolution must be WxH, each 16 to 4096, such as 640x360."),
        ("resolution=640", "resolution must be WxH, each 16 to 4096, such as 640x360."),
        ("max_edge_error_px=", "max_edge_error_px must be a number."),
        ("max_edge_error_px=-1", "max_edge_error_px must be at least 0."),
        ("max_edge_error_px=nan", "max_edge_error_px must be a finite number."),
        ("polcy=x", "There is no parameter 'polcy' here."),
        ("technique=SM&technique=ESM", "technique: there is no technique of this name; known are SM"),
        ("mobility=slow", "mobility must be 'dynamic' or 'static'."),
        ("policy=speed&policy=quality", "policy is given 2 times."),
        (f"light={'x' * 201}", "light may have at most 200 characters."),
    ],
)
def test_options_are_refused_in_sentences(service: Running, query: str, words: str) -> None:
    found = problem(service.client.post(f"/v1/levels?{query}", content=LEVEL), 422, "bad-value")
    assert found["detail"].startswith(words)
    assert found["remedy"]
    assert not [raw for raw in RAW if raw in str(found)]


def test_the_parameters_that_there_are_are_named(service: Running) -> None:
    found = problem(service.client.post("/v1/jobs?polcy=x", content=LEVEL), 422, "bad-value")
    assert "policy" in found["known"]
    assert "rounds" in found["known"]


@pytest.mark.parametrize(
    "path", ["/healthz", "/v1/techniques", "/v1/jobs/x", "/v1/jobs/x/events", "/metrics"]
)
def test_routes_without_parameters_take_none(service: Running, path: str) -> None:
    found = problem(service.client.get(f"{path}?a=b"), 422, "bad-value")
    assert found["known"] == "This route takes none."


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"views": []}, "views must have at least 1 entry."),
        ({"views": [{**features(), "crowding": True}]}, "views[0].crowding: true and false are no numbers."),
        ({"views": [{**features(), "crowding": "wide"}]}, "views[0].crowding must be a number."),
        ({"views": 3}, "views must be a list."),
        ({"views": [3]}, "views[0] must be a JSON object."),
        ({"max_edge_error_px": True}, "max_edge_error_px: true and false are no numbers."),
        ({"color": "red"}, "there is no field color."),
        ({"kind": "sun"}, "kind must be 'spot', 'point' or 'directional'."),
    ],
)
def test_questions_are_refused_in_sentences(service: Running, change: dict[str, object], words: str) -> None:
    wanted = {"kind": "spot", "views": [features()], **change}
    found = problem(service.client.post("/v1/recommendations", json=wanted), 422, "bad-value")
    assert found["detail"] == words


def test_a_field_that_is_not_there_is_named(service: Running) -> None:
    found = problem(service.client.post("/v1/recommendations", json={"kind": "spot"}), 422, "bad-value")
    assert found["detail"] == "views is missing."


def test_a_body_that_is_not_utf8_is_told(service: Running) -> None:
    headers = {"Content-Type": "application/json"}
    response = service.client.post("/v1/recommendations", content=b'{"\xff": 1}', headers=headers)
    assert problem(response, 400, "bad-request")["detail"] == "The body is not valid JSON."


def test_a_scene_is_named_by_a_parameter(service: Running) -> None:
    found = problem(service.level(LEVEL, kind=GLTF, scene=9), 422, "bad-level")
    assert "--" not in str(found)
    assert "the query parameter scene" in found["remedy"]


def test_too_much_is_told_with_what_helps_there(service: Running) -> None:
    body = b" " * (service.parts.settings.limits.question_bytes + 1)
    headers = {"Content-Type": "application/json"}
    response = service.client.post("/v1/recommendations", content=body, headers=headers)
    assert "texture" not in problem(response, 413, "too-large")["remedy"]
