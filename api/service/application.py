"""The service as an ASGI application."""

from __future__ import annotations

import sqlite3
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from fastapi import Depends, FastAPI
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
from api.service.answering_errors import on_http_error, on_invalid, on_storage
from api.service.describing import describe
from api.service.guard import Guard
from api.service.job_desk import JobDesk
from api.service.job_folders import JobFolders
from api.service.job_store import JobStore, JobStoreError
from api.service.metrics import Metrics
from api.service.mistakes import check_query
from api.service.reading_pool import ReadingPool
from api.service.receiving import Reception
from api.service.settings import Settings
from api.service.state import Adviser, Service
from api.service.worker import Entry


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
            async with AsyncExitStack() as stack:
                with _told_of_the_folder(settings.state):
                    service = stack.enter_context(_service(settings, metrics, runs))
                    app.state.service = service
                    await stack.enter_async_context(_alive(service))
                yield
        except Exception as error:
            # The server that starts it says only that it did not start.
            app.state.failure = error
            raise

    # Its pages of documentation load scripts from elsewhere.
    app = FastAPI(
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        dependencies=[Depends(check_query)],
    )
    for routes in (routes_recommendations, routes_levels, routes_jobs, routes_meta, routes_page):
        app.include_router(routes.router)
    app.add_exception_handler(HTTPException, on_http_error)
    app.add_exception_handler(RequestValidationError, on_invalid)
    for kind in (sqlite3.Error, OSError):
        app.add_exception_handler(kind, on_storage)
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


@contextmanager
def _told_of_the_folder(state: Path) -> Iterator[None]:
    """In the block, what goes wrong is said to be so with the state folder: all that is read is there."""
    try:
        yield
    except (OSError, sqlite3.Error, ValueError) as error:
        raise JobStoreError(
            "The service's folder cannot be used.",
            where=str(state),
            known=f"The system says: {getattr(error, 'strerror', None) or error}.",
            remedy="Choose another with --state, or see that all in it is yours to read and write.",
        ) from error


@asynccontextmanager
async def _alive(service: Service) -> AsyncIterator[None]:
    try:
        service.pool.start()
        service.desk.start()
        _show(service)
        yield
    finally:
        await service.desk.stop()
        await service.pool.stop()
        await service.reception.stop()
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
