"""Routes that take a level and predict: as records, or written into the level."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from api.service.asked import LevelOptions
from api.service.describing import file_response, level_body, problems
from api.service.level_names import GLB, GLTF, annotated_name, attachment
from api.service.records import PredictedLevel
from api.service.state import service_of
from api.service.wanted import while_wanted

router = APIRouter()

LEVEL_PROBLEMS = problems(400, 413, 415, 422, 504, 507)


@router.post(
    "/v1/levels",
    operation_id="predict_level",
    tags=["levels"],
    response_model=PredictedLevel,
    responses=LEVEL_PROBLEMS,
    openapi_extra=level_body(),
)
async def predict_level(request: Request, options: Annotated[LevelOptions, Query()]) -> Response:
    """A recommendation for every light of a level, predicted: nothing is rendered."""
    service = service_of(request)
    async with service.reception.upload(request) as upload:
        asked = upload.request("predict", options.model_dump(), service.settings.limits)
        answer = await while_wanted(request, service.pool.ask(asked))
        data = await run_in_threadpool((upload.folder / answer["file"]).read_bytes)
    return Response(data, media_type="application/json")


@router.post(
    "/v1/levels/annotated",
    operation_id="annotate_level",
    tags=["levels"],
    response_class=Response,
    responses={200: file_response("The level with predicted annotations", GLB, GLTF), **LEVEL_PROBLEMS},
    openapi_extra=level_body(),
)
async def annotate_level(request: Request, options: Annotated[LevelOptions, Query()]) -> Response:
    """The level itself, with predicted recommendations written into it; of a multipart upload its .gltf."""
    service = service_of(request)
    async with service.reception.upload(request) as upload:
        asked = upload.request("annotate", options.model_dump(), service.settings.limits)
        answer = await while_wanted(request, service.pool.ask(asked))
        data = await run_in_threadpool((upload.folder / answer["file"]).read_bytes)
    headers = {"Content-Disposition": attachment(annotated_name(answer["name"]))}
    return Response(data, headers=headers, media_type=answer["media_type"])
