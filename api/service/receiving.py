"""Levels on their way in: from the network into files, piece by piece, never more than is allowed."""

from __future__ import annotations

import asyncio
import secrets
import shutil
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request

from api.service.level_folder import PARTS, Part
from api.service.level_names import SUFFIXES
from api.service.multipart_files import MultipartFiles
from api.service.problems import ProblemError, is_full, no_room
from api.service.settings import Limits
from api.service.state_folder import UPLOAD_NAME, remove_folders
from api.wording import shortened

MULTIPART = "multipart/form-data"
ACCEPTED = (*SUFFIXES, MULTIPART)

Json = dict[str, Any]


@dataclass(frozen=True)
class Upload:
    """What has come in.

    Attributes:
        folder: Where it lies.
        parts: Its files.
    """

    folder: Path
    parts: tuple[Part, ...]

    def request(self, task: str, options: Json, limits: Limits) -> Json:
        """What a process that reads levels is asked."""
        return {
            "task": task,
            "folder": str(self.folder),
            "parts": [asdict(part) for part in self.parts],
            "options": options,
            "limits": {"triangles": limits.triangles, "lights": limits.lights, "parts": limits.parts},
        }


class Reception:
    """Takes uploads, a few at a time.

    Args:
        folder: Where they lie while they are worked on; uploads that an earlier service left are removed.
        limits: Of the service.

    Raises:
        OSError: The folder cannot be made or read.
    """

    def __init__(self, folder: Path, limits: Limits) -> None:
        self._folder, self._limits = folder, limits
        self._taken = 0
        self._cleaning: set[asyncio.Task[None]] = set()
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        remove_folders(folder, UPLOAD_NAME)

    @asynccontextmanager
    async def upload(self, request: Request) -> AsyncIterator[Upload]:
        """The body of a request as files, for as long as it is worked on.

        Raises:
            ProblemError: It is no level, too large or too slow, or there is no room for it.
        """
        kind = media_type(request)
        if kind not in ACCEPTED:
            raise ProblemError(
                "bad-media-type",
                f"Levels come as {', '.join(ACCEPTED[:-1])} or {MULTIPART}.",
                known=f"This came as {shortened(kind, 100)}." if kind else "The request has no Content-Type.",
            )
        if (coding := request.headers.get("content-encoding", "identity")).lower() != "identity":
            raise ProblemError(
                "bad-media-type",
                "Bodies that are compressed on the way are not read.",
                known=f"This is {shortened(coding, 100)}.",
            )
        await self._slot()
        folder = self._folder / secrets.token_hex(16)
        try:
            yield await self._received(request, folder, kind)
        except OSError as error:
            if not is_full(error):
                raise
            raise no_room() from None
        finally:
            # The answer does not wait for it.
            task = asyncio.get_running_loop().create_task(self._removed(folder))
            self._cleaning.add(task)
            task.add_done_callback(self._cleaning.discard)

    async def stop(self) -> None:
        """Ends when nothing is being removed any more."""
        await asyncio.gather(*self._cleaning, return_exceptions=True)

    async def _slot(self) -> None:
        """Waits only for what is being removed: that has been answered already."""
        while self._taken >= self._limits.uploads:
            if not self._cleaning:
                raise ProblemError("busy", "Too many levels come in at once.", headers={"Retry-After": "5"})
            await asyncio.wait(self._cleaning, return_when=asyncio.FIRST_COMPLETED)
        self._taken += 1

    async def _removed(self, folder: Path) -> None:
        try:
            await run_in_threadpool(shutil.rmtree, folder, ignore_errors=True)
        finally:
            self._taken -= 1

    async def _received(self, request: Request, folder: Path, kind: str) -> Upload:
        (folder / PARTS).mkdir(parents=True, mode=0o700)
        if kind == MULTIPART:
            return Upload(folder, await self._files(request, folder))
        part = Part(f"{PARTS}/0", "", kind)
        size = 0
        with (folder / part.place).open("wb") as file:
            async for chunk in request.stream():
                size += len(chunk)
                file.write(chunk)
        if not size:
            raise ProblemError("bad-level", "The body is empty: there is no level in it.")
        return Upload(folder, (part,))

    async def _files(self, request: Request, folder: Path) -> tuple[Part, ...]:
        files = MultipartFiles(request.headers["content-type"], folder, self._limits.parts)
        with closing(files):
            async for chunk in request.stream():
                files.write(chunk)
        return files.finish()


def media_type(request: Request) -> str:
    """What a body is said to be, in lower case and without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()
