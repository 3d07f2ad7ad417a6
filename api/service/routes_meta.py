"""Routes that say what there is, and how the service is."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from fastapi.responses import JSONResponse

from api.service.describing import problems
from api.service.metrics import MEDIA_TYPE
from api.service.problems import ProblemError
from api.service.records import Features, Health, Policies, Readiness, Techniques
from api.service.state import service_of
from api.service.state_folder import shortage
from features.extraction import extractor_version
from features.table import FEATURES
from renderers.registry import TECHNIQUES
from selector.policy import DEFAULT_POLICY, POLICIES

router = APIRouter()


@router.get(
    "/v1/techniques",
    operation_id="list_techniques",
    tags=["what there is"],
    response_model=Techniques,
    responses=problems(),
)
async def list_techniques() -> Response:
    """The techniques that lights are served by."""
    found = [
        {"id": one.name, "label": one.label, "summary": (one.__doc__ or one.title).strip().partition("\n")[0]}
        for one in TECHNIQUES
    ]
    return JSONResponse({"techniques": found})


@router.get(
    "/v1/policies",
    operation_id="list_policies",
    tags=["what there is"],
    response_model=Policies,
    responses=problems(),
)
async def list_policies() -> Response:
    """The policies that can be asked for: how far the edge of a shadow may be off."""
    found = [{"name": one.name, "max_edge_error_px": one.max_edge_error_px} for one in POLICIES]
    return JSONResponse({"policies": found, "default": DEFAULT_POLICY})


@router.get(
    "/v1/features",
    operation_id="list_features",
    tags=["what there is"],
    response_model=Features,
    responses=problems(),
)
async def list_features() -> Response:
    """The numbers about a light in a view that recommendations are made from."""
    found = [
        {"name": one.name, "group": str(one.group), "unit": one.unit, "meaning": one.meaning}
        for one in FEATURES
    ]
    return JSONResponse({"extractor": extractor_version(), "features": found})


@router.get("/healthz", operation_id="health", tags=["health"], response_model=Health, responses=problems())
async def health() -> Response:
    """Whether the service is alive."""
    return JSONResponse({"status": "ok"})


@router.get(
    "/readyz", operation_id="readiness", tags=["health"], response_model=Readiness, responses=problems()
)
async def readiness(request: Request) -> Response:
    """Whether it can work: its model loads, its state can be written and has room, its processes are up."""
    service = service_of(request)
    found = {
        "model": service.adviser.problem,
        "readers": service.pool.problem,
        "queue": service.desk.problem,
        "room": shortage(service.settings.state, service.settings.limits.upload_bytes),
    }
    wrong = {name: problem for name, problem in found.items() if problem}
    if wrong:
        detail = " ".join(f"{name}: {problem.detail}" for name, problem in wrong.items())
        first = next(iter(wrong.values()))
        raise ProblemError(
            "not-ready", detail, known=first.known, remedy=first.remedy, headers={"Retry-After": "2"}
        )
    return JSONResponse({"status": "ready", "checks": dict.fromkeys(found, "ok")})


@router.get(
    "/metrics",
    operation_id="metrics",
    tags=["health"],
    response_class=Response,
    responses={
        200: {
            "description": "In Prometheus' text form",
            "content": {"text/plain": {"schema": {"type": "string"}}},
        },
        **problems(),
    },
)
async def metrics(request: Request) -> Response:
    """Counters and times, for Prometheus."""
    return Response(service_of(request).metrics.text(), media_type=MEDIA_TYPE)
