"""Routes of jobs that measure the lights of a level."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request, Response
from fastapi.responses import FileResponse, StreamingResponse
from starlette.types import Receive, Scope, Send

from api.service.asked import JobOptions
from api.service.describing import file_response, level_body, problems
from api.service.job_record import job_path
from api.service.job_results import ANNOTATED, REPORT, RESULT
from api.service.job_store import JobRow, State
from api.service.level_names import GLB, GLTF, annotated_name, attachment
from api.service.problems import ProblemError, bytes_of
from api.service.records import Job, MeasuredLevel
from api.service.state import Service, service_of

router = APIRouter()

RETRY_AFTER_S = 2
HEARTBEAT_S = 15.0
LONGEST_LAST_ID = 50
EVENTS = "text/event-stream"
# The page of a report runs its own script, in a world of its own: not as a page of this service.
REPORT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)
REPORT_HEADERS = {
    "Content-Security-Policy": REPORT_POLICY,
    # Browsers do not show a page that is both in a sandbox and apart from its opener (HTML, navigation).
    "Cross-Origin-Opener-Policy": "unsafe-none",
}
ACCEPTED = {
    "description": "The job is queued",
    "headers": {
        "Location": {"description": "Where the job is.", "schema": {"type": "string"}},
        "Retry-After": {"description": "When to ask again, in seconds.", "schema": {"type": "integer"}},
    },
}
STREAM = {
    "description": "Events `state` and `progress`, whose data is the record of the job",
    "content": {
        EVENTS: {
            "schema": {
                "type": "object",
                "properties": {
                    "id": {"type": "string"},
                    "event": {"type": "string", "enum": ["state", "progress"]},
                    "data": {"type": "string", "description": "The record, as JSON."},
                },
                "required": ["id", "event", "data"],
            }
        }
    },
}


@router.post(
    "/v1/jobs",
    operation_id="create_job",
    tags=["jobs"],
    status_code=202,
    response_model=Job,
    responses={202: ACCEPTED, **problems(400, 413, 415, 422, 504, 507)},
    openapi_extra=level_body(),
)
async def create_job(request: Request, options: Annotated[JobOptions, Query()]) -> Response:
    """A new job: every candidate for every light of the level is rendered and measured."""
    service = service_of(request)
    service.desk.check_room()
    wanted = options.model_dump()
    async with service.reception.upload(request) as upload:
        looked = await service.pool.ask(
            upload.request("look", _level_options(wanted), service.settings.limits)
        )
        row = service.desk.take(upload, looked, wanted)
    headers = {"Location": job_path(row.id), "Retry-After": str(RETRY_AFTER_S)}
    return Response(bytes_of(service.desk.record(row)), 202, headers, "application/json")


@router.get(
    "/v1/jobs/{job_id}", operation_id="get_job", tags=["jobs"], response_model=Job, responses=problems(404)
)
async def get_job(request: Request, job_id: str) -> Response:
    """How far a job is."""
    desk = service_of(request).desk
    row = desk.row(job_id)
    headers = {} if row.state.ended else {"Retry-After": str(RETRY_AFTER_S)}
    return Response(bytes_of(desk.record(row)), headers=headers, media_type="application/json")


@router.delete(
    "/v1/jobs/{job_id}",
    operation_id="cancel_job",
    tags=["jobs"],
    response_model=Job,
    responses=problems(404, 409),
)
async def cancel_job(request: Request, job_id: str) -> Response:
    """Cancels a job that waits or runs; one that has ended stays as it is."""
    desk = service_of(request).desk
    return Response(bytes_of(desk.record(desk.cancel(job_id))), media_type="application/json")


@router.get(
    "/v1/jobs/{job_id}/events",
    operation_id="follow_job",
    tags=["jobs"],
    response_class=StreamingResponse,
    responses={200: STREAM, **problems(404)},
)
async def follow_job(
    request: Request,
    job_id: str,
    last_event_id: Annotated[str, Header(max_length=LONGEST_LAST_ID)] = "",
) -> Response:
    """The record of a job whenever it changes, until the job has ended."""
    service = service_of(request)
    service.desk.row(job_id)
    release = service.desk.follow()
    return _Followed(_events(service, job_id, last_event_id), release)


@router.get(
    "/v1/jobs/{job_id}/result",
    operation_id="get_job_result",
    tags=["jobs"],
    response_model=MeasuredLevel,
    responses=problems(404, 409, 410),
)
async def get_job_result(request: Request, job_id: str) -> Response:
    """What a job has measured, as `gnomon annotate --json` prints it."""
    _, path = _result(request, job_id, RESULT)
    return _WholeFile(path, "application/json")


@router.get(
    "/v1/jobs/{job_id}/annotated",
    operation_id="get_annotated_level",
    tags=["jobs"],
    response_class=Response,
    responses={
        200: file_response("The level with measured annotations", GLB, GLTF),
        **problems(404, 409, 410),
    },
)
async def get_annotated_level(request: Request, job_id: str) -> Response:
    """The level with what was measured written into it."""
    row, path = _result(request, job_id, ANNOTATED)
    headers = {"Content-Disposition": attachment(annotated_name(row.level))}
    return _WholeFile(path, row.media_type, headers)


@router.get(
    "/v1/jobs/{job_id}/report",
    operation_id="get_job_report",
    tags=["jobs"],
    response_class=Response,
    responses={
        200: {"description": "The page", "content": {"text/html": {"schema": {"type": "string"}}}},
        **problems(404, 409, 410),
    },
)
async def get_job_report(request: Request, job_id: str) -> Response:
    """The page that shows all candidates side by side, as `gnomon compare` writes it."""
    _, path = _result(request, job_id, REPORT)
    return _WholeFile(path, "text/html", REPORT_HEADERS)


def _level_options(options: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in options.items() if name != "rounds"}


def _result(request: Request, job_id: str, name: str) -> tuple[JobRow, Path]:
    desk = service_of(request).desk
    row = desk.row(job_id)
    if row.state is not State.DONE:
        headers = {} if row.state.ended else {"Retry-After": str(RETRY_AFTER_S)}
        raise ProblemError(
            "not-done", "This job has no results.", known=f"It is {row.state}.", headers=headers
        )
    return row, desk.result(job_id, name)


class _Followed(StreamingResponse):
    """Counts as a follower from the moment that it is made until it has ended, however it ends."""

    def __init__(self, content: AsyncIterator[bytes], release: Callable[[], None]) -> None:
        super().__init__(content, media_type=EVENTS)
        self._release = release

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._release()


class _WholeFile(FileResponse):
    """A file from its beginning to its end, whatever part of it is asked for."""

    def __init__(self, path: Path, media_type: str, headers: dict[str, str] | None = None) -> None:
        super().__init__(path, headers={**(headers or {}), "Accept-Ranges": "none"}, media_type=media_type)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        headers = [one for one in scope["headers"] if one[0].lower() not in (b"range", b"if-range")]
        await super().__call__({**scope, "headers": headers}, receive, send)


async def _events(service: Service, job_id: str, last_id: str) -> AsyncIterator[bytes]:
    desk, said, state = service.desk, last_id, None
    while True:
        try:
            row = desk.row(job_id)
        except ProblemError:
            # It ended long ago and is forgotten.
            return
        name = desk.event_id(row)
        if name != said or row.state.ended:
            kind = "progress" if row.state is state else "state"
            yield _event(kind, name, desk.record(row))
            said, state = name, row.state
        if row.state.ended:
            return
        if not await desk.wait_for_change(job_id, HEARTBEAT_S):
            # So that a connection that is gone is found out.
            yield b": still here\n\n"


def _event(kind: str, name: str, record: dict[str, object]) -> bytes:
    return f"id: {name}\nevent: {kind}\ndata: ".encode() + bytes_of(record) + b"\n\n"
