"""The service as an ASGI application."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, closing, contextmanager
from dataclasses import dataclass

from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException

from api.service import (
    measuring_worker,
    reading_worker,
    routes_jobs,
    routes_levels,
    routes_meta,
    routes_page,
    routes_recommendations,
)
from api.service.describing import describe
from api.service.guard import Guard
from api.service.job_desk import JobDesk
from api.service.job_folders import JobFolders
from api.service.job_store import JobStore
from api.service.metrics import Metrics
from api.service.problems import on_http_error, on_invalid
from api.service.reading_pool import ReadingPool
from api.service.receiving import Reception
from api.service.settings import Settings
from api.service.state import Adviser, Service
from api.service.worker import Entry
from scenes.errors import GnomonError


@dataclass(frozen=True)
class Entries:
    """What runs in the processes of the service.

    Attributes:
        reading: In those that read levels.
        measuring: In the one that measures.
    """

    reading: Entry = reading_worker.enter
    measuring: Entry = measuring_worker.enter


def create_app(settings: Settings, entries: Entries | None = None) -> FastAPI:
    """The application; its processes start and end with its lifespan.

    Starting raises `JobStoreError` where the state folder cannot be used.
    """
    metrics, runs = Metrics(), entries or Entries()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        try:
            with _service(settings, metrics, runs) as service:
                app.state.service = service
                async with _alive(service):
                    yield
        except GnomonError as error:
            # The server that starts it says only that it did not start.
            app.state.failure = error
            raise

    # Its pages of documentation load scripts from elsewhere.
    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, redirect_slashes=False)
    for routes in (routes_recommendations, routes_levels, routes_jobs, routes_meta, routes_page):
        app.include_router(routes.router)
    app.add_exception_handler(HTTPException, on_http_error)
    app.add_exception_handler(RequestValidationError, on_invalid)
    app.add_middleware(Guard, settings=settings, metrics=metrics)
    describe(app)
    return app


@contextmanager
def _service(settings: Settings, metrics: Metrics, runs: Entries) -> Iterator[Service]:
    with closing(JobFolders(settings.state)) as folders, JobStore(settings.state) as store:
        yield Service(
            settings,
            metrics,
            Adviser(settings),
            Reception(folders.incoming, settings.limits),
            ReadingPool(settings, runs.reading),
            JobDesk(settings, folders, store, runs.measuring),
        )


@asynccontextmanager
async def _alive(service: Service) -> AsyncIterator[None]:
    service.pool.start()
    service.desk.start()
    _show(service)
    try:
        yield
    finally:
        await service.desk.stop()
        await service.pool.stop()
        service.adviser.stop()


def _show(service: Service) -> None:
    """The numbers of this service among its metrics."""
    metrics, desk, pool = service.metrics, service.desk, service.pool
    metrics.counts("gnomon_lost_readers", "Reading processes that hung or died.", "cause", lambda: pool.lost)
    metrics.counts(
        "gnomon_lost_measurers", "Measuring processes that hung or died.", "cause", lambda: desk.lost
    )
    metrics.gauge("gnomon_jobs_queued", "Jobs that wait.", lambda: desk.counts()["queued"])
    metrics.gauge("gnomon_jobs_running", "Jobs that run.", lambda: desk.counts()["running"])
    metrics.gauge("gnomon_readers", "Reading processes that are up.", lambda: len(pool.pids))
