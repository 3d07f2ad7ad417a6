"""schemathesis asks the service what /openapi.json says that it may be asked, and what it may not."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest
import schemathesis.transport
from hypothesis import HealthCheck, Phase, settings
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    negative_data_rejection,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
    unsupported_method,
)

from api.service.application import create_app
from api.service.problems import KINDS, MEDIA_TYPE
from api.service.settings import Settings
from tests.api.service.running_service import GLB, GLTF, Running
from tests.small_level import small_level

schemathesis.transport.serializer.alias([GLB, GLTF], "application/octet-stream")

EXAMPLES = int(os.environ.get("GNOMON_SCHEMA_EXAMPLES") or 12)
CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    negative_data_rejection,
    unsupported_method,
]
OPENAPI: dict[str, Any] = create_app(Settings(state=Path("unused"))).openapi()
SCHEMA = schemathesis.openapi.from_dict(OPENAPI)
LEVEL_PATHS = {"/v1/levels", "/v1/levels/annotated", "/v1/jobs"}


@SCHEMA.parametrize()
@settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=True,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=list(HealthCheck),
)
def test_the_service_is_as_it_says(service: Running, case: schemathesis.Case) -> None:
    response = case.call(base_url=f"http://127.0.0.1:{service.port}", timeout=120)
    case.validate_response(response, checks=CHECKS)


def test_a_job_is_as_the_schema_says_in_every_state(service: Running, tmp_path: Path) -> None:
    level = small_level(tmp_path).read_bytes()
    job = service.job(level, resolution="64x48", rounds=1, technique="SV", light="0")
    done = service.ended(job["id"])
    assert done["state"] == "done"
    base = f"http://127.0.0.1:{service.port}"
    for part in ("", "/result", "/annotated", "/report", "/events"):
        operation = SCHEMA[f"/v1/jobs/{{job_id}}{part}"]["GET"]
        case = operation.Case(path_parameters={"job_id": job["id"]})
        response = case.call(base_url=base)
        assert response.status_code == 200
        case.validate_response(response, checks=CHECKS[:-2])


def test_a_client_can_be_made_of_the_description() -> None:
    json.dumps(OPENAPI, allow_nan=False)
    operations = [one for path in OPENAPI["paths"].values() for one in path.values()]
    names = [one["operationId"] for one in operations]
    assert len(set(names)) == len(names) == 16
    for one in operations:
        assert one["description"]
        for status, response in one["responses"].items():
            assert response["description"]
            if status[0] in "45":
                assert list(response["content"]) == [MEDIA_TYPE]
                assert int(status) in {known for known, _ in KINDS.values()}
    for path in LEVEL_PATHS:
        body = OPENAPI["paths"][path]["post"]["requestBody"]
        assert set(body["content"]) == {"model/gltf-binary", "model/gltf+json", "multipart/form-data"}


def test_every_reference_leads_somewhere() -> None:
    schemas = OPENAPI["components"]["schemas"]
    named = {part.split('"')[0] for part in json.dumps(OPENAPI).split("#/components/schemas/")[1:]}
    assert named <= set(schemas)
    assert "HTTPValidationError" not in schemas


@pytest.mark.parametrize("status", sorted({status for status, _ in KINDS.values()}))
def test_every_status_of_a_problem_is_declared(status: int) -> None:
    declared = {
        int(code) for path in OPENAPI["paths"].values() for one in path.values() for code in one["responses"]
    }
    # No route is described for what is not there, or cannot be done to one.
    assert status in declared or status == 405
