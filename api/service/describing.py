"""/openapi.json: what FastAPI finds out by itself, and the problems and bodies that it cannot know."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from api.service.level_names import GLB, GLTF
from api.service.problems import KINDS, MEDIA_TYPE
from api.service.receiving import MULTIPART
from api.service.records import Problem

DESCRIPTION = (
    "Which shadow technique should each light use? Send a level, or the features of a light, and get an "
    "answer; or have the lights of a level measured. Every error is application/problem+json with a "
    "sentence. Where the service was started with a token, every request but those for the page and for "
    "health shows it as a bearer token."
)
_PROBLEM_REF = {"$ref": "#/components/schemas/Problem"}
_OF_EVERY_ROUTE = (401, 403, 408, 421, 422, 500, 503, 507)
_BINARY = {"type": "string", "format": "binary"}

Json = dict[str, Any]


def problems(*statuses: int) -> dict[int | str, Json]:
    """The problems of a route, beside those of every route."""
    return {status: _problem_response(status) for status in sorted({*_OF_EVERY_ROUTE, *statuses})}


def _problem_response(status: int) -> Json:
    titles = [title for known, title in KINDS.values() if known == status]
    content = {MEDIA_TYPE: {"schema": _PROBLEM_REF}}
    return {"description": " or ".join(dict.fromkeys(titles)), "content": content}


def file_response(description: str, *media_types: str) -> Json:
    """An answer that is a file."""
    return {"description": description, "content": {one: {"schema": _BINARY} for one in media_types}}


def level_body() -> Json:
    """The bodies of requests that bring a level."""
    files = {"type": "array", "minItems": 1, "items": _BINARY}
    whole = {
        "type": "object",
        "properties": {
            "files": {**files, "description": "One .gltf or .glb, and the files that its uris name."}
        },
        "required": ["files"],
    }
    content = {
        GLB: {"schema": {**_BINARY, "description": "A level in one file."}},
        GLTF: {"schema": {**_BINARY, "description": "A level whose buffers are data URIs."}},
        MULTIPART: {"schema": whole},
    }
    return {"requestBody": {"required": True, "content": content}}


def describe(app: FastAPI) -> None:
    """Makes /openapi.json of an application complete."""

    def described() -> Json:
        if app.openapi_schema is None:
            app.openapi_schema = _described(app)
        return app.openapi_schema

    app.openapi = described  # type: ignore[method-assign]


def _described(app: FastAPI) -> Json:
    found: Json = get_openapi(
        title="Gnomon",
        version=version("gnomon"),
        summary="Algorithm selection for real-time shadows",
        description=DESCRIPTION,
        routes=app.routes,
        license_info={"name": "MIT", "identifier": "MIT"},
        openapi_version="3.1.0",
    )
    components = found.setdefault("components", {})
    schemas = components.setdefault("schemas", {})
    schemas["Problem"] = Problem.model_json_schema(ref_template="#/components/schemas/{model}")
    components["securitySchemes"] = {"token": {"type": "http", "scheme": "bearer"}}
    # The token is one of those who were told: without one, no request needs it.
    found["security"] = [{}, {"token": []}]
    return found
