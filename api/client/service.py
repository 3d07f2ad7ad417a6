"""The service, one method a route."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, cast
from urllib.parse import quote, unquote

from .address import DEFAULT_URL, Address
from .asking import Ask
from .cancellation import Cancellation
from .errors import AddressError, BadAnswerError, ProblemError
from .event_stream import events
from .reading import parsed, record
from .records import (
    Download,
    Features,
    Job,
    Kind,
    LevelAnswer,
    MeasuredLevel,
    Mobility,
    Policies,
    Recommendation,
    Techniques,
)
from .refusals import refusal, require_type, retry_after_s
from .transport import Reply, Request, Transport
from .upload import GLB, GLTF, Upload, json_upload, level_upload

Record = TypeVar("Record")
Answer = TypeVar("Answer")

JSON, HTML, EVENTS, TEXT = "application/json", "text/html", "text/event-stream", "text/plain"
MOST_JSON_BYTES = 1 << 26
MOST_FILE_BYTES = 1 << 31
LONGEST_EVENT_LINE = 1 << 20
EVENTS_IDLE_S = 60.0
LONGEST_NAME = 200
"""The service takes no longer ones; what is left of a file name says more at its end."""
DEFAULT_WAIT_S = 1.0
FILE_NAME = re.compile(r'filename="([^"]*)"')
FILE_NAME_UTF8 = re.compile(r"filename\*=UTF-8''([^;\s]*)", re.IGNORECASE)


class Service:
    """Gnomon's service at an address.

    Every method that asks it something raises `ProblemError` where the service says no,
    `ServiceUnreachableError` where nobody answers in time, `BadAnswerError` where something else answers,
    and `CancelledRequestError` where the request is cancelled. None waits longer than its time.

    Args:
        url: Where it is.
        token: What it was started with, where it was.
        timeout_s: How long a small request may take.
        level_timeout_s: How long one that sends a level or fetches a file may take.
        patience_s: How long to try again where the service is too busy (503 with `Retry-After`).
        cancellation: Ends whatever is being asked, from any thread.

    Raises:
        AddressError: The address is none, or the token cannot be sent.
    """

    def __init__(
        self,
        url: str = DEFAULT_URL,
        *,
        token: str = "",
        timeout_s: float = 30.0,
        level_timeout_s: float = 600.0,
        patience_s: float = 0.0,
        cancellation: Cancellation | None = None,
    ) -> None:
        if not token.isascii() or not token.isprintable() or " " in token:
            raise AddressError("The token holds characters that cannot be sent.")
        self.address = Address.of(url)
        self.cancellation = cancellation or Cancellation()
        self._transport = Transport(self.address, token)
        self._timeout_s, self._level_timeout_s, self._patience_s = timeout_s, level_timeout_s, patience_s

    def alive(self) -> None:
        """Returns if the service answers."""
        self._asked(self._request("GET", "/healthz", "*/*"), lambda reply: reply.all(MOST_JSON_BYTES))

    def ready(self) -> None:
        """Returns if the service can work: its model loads, its store can be written, its workers are up."""
        self._asked(self._request("GET", "/readyz", "*/*"), lambda reply: reply.all(MOST_JSON_BYTES))

    def metrics(self) -> str:
        """Counters and times in Prometheus' text form."""
        return self._file("/metrics", TEXT).data.decode(errors="replace")

    def openapi(self) -> dict[str, Any]:
        """The service's own description of its routes."""
        return cast("dict[str, Any]", self._json(dict, self._request("GET", "/openapi.json", JSON)))

    def techniques(self) -> Techniques:
        """The techniques that lights are served by."""
        return self._json(Techniques, self._request("GET", "/v1/techniques", JSON))

    def policies(self) -> Policies:
        """The policies that can be asked for, and the default."""
        return self._json(Policies, self._request("GET", "/v1/policies", JSON))

    def features(self) -> Features:
        """The numbers about a light in a view that `recommend` takes."""
        return self._json(Features, self._request("GET", "/v1/features", JSON))

    def recommend(
        self,
        kind: Kind,
        views: Sequence[Mapping[str, float]],
        *,
        policy: str | None = None,
        max_edge_error_px: float | None = None,
        mobility: Mobility | None = None,
        techniques: Sequence[str] = (),
    ) -> Recommendation:
        """What to use for a light with these features, one mapping a view; takes milliseconds."""
        wanted = {
            "kind": kind,
            "views": [dict(view) for view in views],
            "mobility": mobility,
            "policy": policy,
            "max_edge_error_px": max_edge_error_px,
            "techniques": list(techniques) or None,
        }
        body = json_upload({key: value for key, value in wanted.items() if value is not None})
        return self._json(Recommendation, self._request("POST", "/v1/recommendations", JSON, upload=body))

    def level(self, level: Path | bytes, ask: Ask | None = None) -> LevelAnswer:
        """Predictions for the lights of a .glb, of a .gltf with its files beside it, or of bytes of one."""
        return self._json(LevelAnswer, self._level_request("/v1/levels", level, ask, JSON))

    def annotated_level(self, level: Path | bytes, ask: Ask | None = None) -> Download:
        """The level with predicted annotations written into it."""
        request = self._level_request("/v1/levels/annotated", level, ask, f"{GLB}, {GLTF}")
        return self._asked(request, lambda reply: _download(reply, GLB, GLTF))

    def submit(self, level: Path | bytes, ask: Ask | None = None) -> Job:
        """A new job that measures the lights of a level."""
        return self._asked(self._level_request("/v1/jobs", level, ask, JSON), _job)

    def job(self, job_id: str) -> Job:
        """How far a job is."""
        return self._asked(self._request("GET", _job_path(job_id), JSON), _job)

    def cancel(self, job_id: str) -> Job:
        """Cancels a job; one that has ended stays as it is, which is a `ProblemError` of status 409."""
        return self._asked(self._request("DELETE", _job_path(job_id), JSON), _job)

    def result(self, job_id: str) -> MeasuredLevel:
        """What a job has measured."""
        return self._json(MeasuredLevel, self._request("GET", _job_path(job_id, "result"), JSON))

    def annotated(self, job_id: str) -> Download:
        """The level with a job's measured annotations written into it."""
        return self._file(_job_path(job_id, "annotated"), GLB, GLTF)

    def report(self, job_id: str) -> Download:
        """The page that shows what a job has measured. It is a stranger's HTML: show it in a sandbox."""
        return self._file(_job_path(job_id, "report"), HTML)

    def job_events(
        self, job_id: str, last_id: str = "", seconds: float = 3600.0
    ) -> Iterator[tuple[str, Job]]:
        """A job's record whenever it changes, with an id from which the stream can be taken up again."""
        request = Request(
            "GET",
            _job_path(job_id, "events"),
            EVENTS,
            seconds,
            EVENTS_IDLE_S,
            headers={"Last-Event-ID": last_id} if last_id else {},
        )
        with self._transport.sent(request, self.cancellation) as reply:
            if reply.status != 200:
                raise refusal(reply)
            require_type(reply, EVENTS)
            for event in events(reply.lines(LONGEST_EVENT_LINE)):
                if event.kind in ("state", "progress"):
                    yield event.id, record(Job, parsed(event.data.encode()), "event")

    def _level_request(self, target: str, level: Path | bytes, ask: Ask | None, accept: str) -> Request:
        name = level.name[-LONGEST_NAME:] if isinstance(level, Path) else ""
        query, upload = (ask or Ask()).query(name), level_upload(level)
        return self._request("POST", target + query, accept, upload=upload, seconds=self._level_timeout_s)

    def _request(
        self,
        method: str,
        target: str,
        accept: str,
        *,
        upload: Upload | None = None,
        seconds: float | None = None,
    ) -> Request:
        # The service may think for all of the time before it says the first word.
        allowed = seconds or self._timeout_s
        return Request(method, target, accept, allowed, allowed, upload)

    def _file(self, target: str, *media_types: str) -> Download:
        request = self._request("GET", target, ", ".join(media_types), seconds=self._level_timeout_s)
        return self._asked(request, lambda reply: _download(reply, *media_types))

    def _json(self, kind: type[Record], request: Request) -> Record:
        def read(reply: Reply) -> Record:
            require_type(reply, JSON)
            value = parsed(reply.all(MOST_JSON_BYTES))
            if kind is dict and isinstance(value, dict):
                return cast("Record", value)
            return record(kind, value)

        return self._asked(request, read)

    def _asked(self, request: Request, read: Callable[[Reply], Answer]) -> Answer:
        until = time.monotonic() + self._patience_s
        while True:
            try:
                with self._transport.sent(request, self.cancellation) as reply:
                    if not 200 <= reply.status < 300:
                        raise refusal(reply)
                    return read(reply)
            except ProblemError as problem:
                wait = problem.retry_after_s
                if problem.status != 503 or wait is None or time.monotonic() + wait > until:
                    raise
                self.cancellation.wait(max(wait, DEFAULT_WAIT_S))


def _job(reply: Reply) -> Job:
    require_type(reply, JSON)
    value = parsed(reply.all(MOST_JSON_BYTES))
    if isinstance(value, dict):
        value["retry_after_s"] = retry_after_s(reply)
    return record(Job, value, "job")


def _download(reply: Reply, *media_types: str) -> Download:
    require_type(reply, *media_types)
    disposition = reply.header("Content-Disposition") or ""
    in_utf8, plain = FILE_NAME_UTF8.search(disposition), FILE_NAME.search(disposition)
    name = unquote(in_utf8[1]) if in_utf8 else plain[1] if plain else ""
    # Only the last part, whatever the service says: it is joined to a folder of the user's.
    name = re.split(r"[/\\]", name)[-1]
    bare = "" if name.strip(".") == "" or not name.isprintable() else name
    return Download(reply.all(MOST_FILE_BYTES), reply.media_type, bare)


def _job_path(job_id: str, part: str = "") -> str:
    if not job_id or job_id.strip(".") == "":
        raise BadAnswerError("A job without an id cannot be asked for.")
    return f"/v1/jobs/{quote(job_id, safe='')}" + (f"/{part}" if part else "")
