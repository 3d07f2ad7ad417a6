"""What the client expects is what the service says of itself in /openapi.json."""

from __future__ import annotations

import types
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import pytest

from api.client import records
from api.client.asking import Ask
from api.client.reading import record
from api.service.application import create_app
from api.service.settings import Settings
from tests.api.command import QUICK, answered
from tests.small_level import small_level

# Method and path -> what the client makes of the answer; None for files, text and what it only passes on.
ROUTES = {
    ("get", "/healthz"): None,
    ("get", "/readyz"): None,
    ("get", "/metrics"): None,
    ("get", "/v1/techniques"): records.Techniques,
    ("get", "/v1/policies"): records.Policies,
    ("get", "/v1/features"): records.Features,
    ("post", "/v1/recommendations"): records.Recommendation,
    ("post", "/v1/levels"): records.LevelAnswer,
    ("post", "/v1/levels/annotated"): None,
    ("post", "/v1/jobs"): records.Job,
    ("get", "/v1/jobs/{job_id}"): records.Job,
    ("delete", "/v1/jobs/{job_id}"): records.Job,
    ("get", "/v1/jobs/{job_id}/events"): None,
    ("get", "/v1/jobs/{job_id}/result"): records.MeasuredLevel,
    ("get", "/v1/jobs/{job_id}/annotated"): None,
    ("get", "/v1/jobs/{job_id}/report"): None,
}
# Read from headers, or gathered from keys that lie beside the record's own.
NOT_IN_JSON = {"retry_after_s", "recommendation"}
SCALARS = {str: "string", float: "number", int: "integer", bool: "boolean"}


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return create_app(Settings(state=tmp_path_factory.mktemp("state"))).openapi()


def resolved(api: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    while "$ref" in schema:
        schema = api["components"]["schemas"][schema["$ref"].rpartition("/")[2]]
    return schema


def differences(api: dict[str, Any], kind: Any, schema: dict[str, Any], where: str) -> list[str]:
    """Where a type of the client's and a schema of the service's do not agree."""
    schema, origin, arguments = resolved(api, schema), get_origin(kind), get_args(kind)
    if kind is Any or says_nothing(schema):
        return []
    if origin in (Union, types.UnionType):
        return union_differences(api, arguments, schema, where)
    if "anyOf" in schema:
        # Two shapes of a light: the client has one record for both.
        return [one for choice in schema["anyOf"] for one in differences(api, kind, choice, where)]
    if is_dataclass(kind):
        return record_differences(api, kind, schema, where)
    if origin is tuple:
        return differences(api, arguments[0], schema.get("items", {}), f"{where}[]")
    return value_differences(kind, schema, where)


def value_differences(kind: Any, schema: dict[str, Any], where: str) -> list[str]:
    if get_origin(kind) is Literal:
        allowed = schema.get("enum", [schema.get("const")])
        return [] if set(allowed) <= set(get_args(kind)) else [f"{where}: {allowed} are not all known"]
    wanted = "object" if get_origin(kind) is dict else SCALARS[kind]
    found = schema.get("type", "string" if isinstance(schema.get("const"), str) else None)
    return [] if found == wanted else [f"{where}: {found} where {wanted} is expected"]


def says_nothing(schema: dict[str, Any]) -> bool:
    """Anything, or an object of anything: what a job has measured is held against a measurement below."""
    return set(schema) <= {"title", "description"} or (
        schema.get("additionalProperties") is True and "properties" not in schema
    )


def union_differences(api: dict[str, Any], choices: Any, schema: dict[str, Any], where: str) -> list[str]:
    shapes = [resolved(api, one) for one in schema.get("anyOf", [schema])]
    known = [choice for choice in choices if choice is not types.NoneType]
    found = []
    for shape in shapes:
        if shape.get("type") == "null":
            found += [] if types.NoneType in choices else [f"{where}: may be null"]
        elif all(differences(api, choice, shape, where) for choice in known):
            found += differences(api, known[-1], shape, where)
    return found


def record_differences(api: dict[str, Any], kind: Any, schema: dict[str, Any], where: str) -> list[str]:
    hints, shown = get_type_hints(kind), schema.get("properties", {})
    found = []
    for field in fields(kind):
        needed = field.default is MISSING and field.default_factory is MISSING
        if field.name in NOT_IN_JSON:
            continue
        if field.name not in shown:
            found += [f"{where}.{field.name}: the service does not say it"] if needed else []
            continue
        if needed and field.name not in schema.get("required", []):
            found.append(f"{where}.{field.name}: may be missing")
        found += differences(api, hints[field.name], shown[field.name], f"{where}.{field.name}")
    return found


def test_the_client_knows_every_route(api: dict[str, Any]) -> None:
    routes = {(method, path) for path, methods in api["paths"].items() for method in methods}
    pages = {("get", path) for path in api["paths"] if path == "/" or path.startswith("/page")}
    assert routes - pages == set(ROUTES)


@pytest.mark.parametrize("route", [route for route, kind in ROUTES.items() if kind])
def test_answers_are_what_the_client_reads(route: tuple[str, str], api: dict[str, Any]) -> None:
    method, path = route
    responses = api["paths"][path][method]["responses"]
    (good,) = [responses[status] for status in responses if status.startswith("2")]
    schema = good["content"]["application/json"]["schema"]
    assert differences(api, ROUTES[route], schema, path) == []


def test_a_light_s_recommendation_is_what_the_client_reads(api: dict[str, Any]) -> None:
    schemas = resolved(
        api, api["paths"]["/v1/levels"]["post"]["responses"]["200"]["content"]["application/json"]["schema"]
    )
    shapes = [resolved(api, one) for one in schemas["properties"]["lights"]["items"]["anyOf"]]
    (full,) = [shape for shape in shapes if "technique" in shape["properties"]]
    assert differences(api, records.Recommendation, full, "light") == []


def test_a_problem_is_what_the_client_reads(api: dict[str, Any]) -> None:
    assert differences(api, records.Problem, api["components"]["schemas"]["Problem"], "problem") == []


@pytest.mark.parametrize(("path", "unknown"), [("/v1/levels", {"rounds"}), ("/v1/jobs", set())])
def test_all_that_can_be_asked_is_known(path: str, unknown: set[str], api: dict[str, Any]) -> None:
    known = {one["name"] for one in api["paths"][path]["post"]["parameters"] if one["in"] == "query"}
    ask = Ask("speed", 1.0, "static", ("SM",), "0", (64, 64), ("Lamp",), ("Eye",), "a.glb", 3)
    asked = {pair.partition("=")[0] for pair in ask.query().removeprefix("?").split("&")}
    assert asked - unknown == known
    assert unknown == asked - known


def test_what_a_job_has_measured_is_what_the_client_reads(tmp_path: Path) -> None:
    measured = answered("annotate", small_level(tmp_path), *QUICK, "-o", tmp_path / "out.glb")
    found = record(records.MeasuredLevel, measured)
    assert [light.name for light in found.lights] == ["Lamp", "Torch", "Sun"]
    for light, said in zip(found.lights, measured["lights"], strict=True):
        assert light.recommendation
        assert light.recommendation.chosen.label == said["chosen"]["label"] == "SV"
        assert len(light.recommendation.candidates) == len(said["candidates"])
