"""Levels on their way in: from the network into files, piece by piece, never more than is allowed."""

from __future__ import annotations

import asyncio
import errno
import secrets
import shutil
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile
from starlette.formparsers import MultiPartException, MultiPartParser
from starlette.requests import Request

from api.service.level_folder import PARTS, Part
from api.service.level_names import SUFFIXES
from api.service.problems import ProblemError
from api.service.settings import Limits

MULTIPART = "multipart/form-data"
ACCEPTED = (*SUFFIXES, MULTIPART)
CHUNK_BYTES = 1 << 20

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
            "limits": {"triangles": limits.triangles, "lights": limits.lights},
        }


class Reception:
    """Takes uploads, a few at a time.

    Args:
        folder: Where they lie while they are worked on; what an earlier service left there is removed.
        limits: Of the service.
    """

    def __init__(self, folder: Path, limits: Limits) -> None:
        self._folder, self._limits = folder, limits
        self._taken = 0
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True, mode=0o700)

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
                known=f"This came as {kind[:100]}." if kind else "The request has no Content-Type.",
            )
        if self._taken >= self._limits.uploads:
            raise ProblemError("busy", "Too many levels come in at once.", headers={"Retry-After": "5"})
        self._taken += 1
        folder = self._folder / secrets.token_hex(16)
        try:
            yield await self._received(request, folder, kind)
        except OSError as error:
            if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
                raise
            raise no_room() from None
        finally:
            self._taken -= 1
            await asyncio.shield(run_in_threadpool(shutil.rmtree, folder, ignore_errors=True))

    async def _received(self, request: Request, folder: Path, kind: str) -> Upload:
        (folder / PARTS).mkdir(parents=True, mode=0o700)
        if kind == MULTIPART:
            return Upload(folder, await self._files(request, folder))
        part = Part(f"{PARTS}/0", "", kind)
        size = 0
        with (folder / part.place).open("wb") as file:
            async for chunk in request.stream():
                size += len(chunk)
                await run_in_threadpool(file.write, chunk) if len(chunk) >= CHUNK_BYTES else file.write(chunk)
        if not size:
            raise ProblemError("bad-level", "The body is empty: there is no level in it.")
        return Upload(folder, (part,))

    async def _files(self, request: Request, folder: Path) -> tuple[Part, ...]:
        most = self._limits.parts
        parser = MultiPartParser(request.headers, request.stream(), max_files=most, max_fields=0)
        try:
            form = await parser.parse()
        except MultiPartException as error:
            raise _malformed(error.message, most) from None
        except (KeyError, LookupError, UnicodeError, ValueError):
            raise _malformed("", most) from None
        parts = []
        try:
            for index, (_, value) in enumerate(form.multi_items()):
                assert isinstance(value, UploadFile), "no fields are let in"
                part = Part(f"{PARTS}/{index}", value.filename or "", _level_type(value))
                await run_in_threadpool(_copied, value, folder / part.place)
                parts.append(part)
        finally:
            await form.close()
        if not parts:
            raise ProblemError("bad-level", "The upload has no files: there is no level in it.")
        return tuple(parts)


def media_type(request: Request) -> str:
    """What a body is said to be, in lower case and without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


def no_room() -> ProblemError:
    """What is said where the disk is full."""
    return ProblemError(
        "storage", "The disk of the service is full.", remedy="Free some space, or ask who runs it."
    )


def _malformed(words: str, most: int) -> ProblemError:
    if words.startswith(("Too many", "Part exceeded")):
        known = f"At most {most} files are taken, and nothing that is not a file."
        return ProblemError(
            "too-large", "The upload has too many parts, or parts that are no files.", known=known
        )
    return ProblemError(
        "bad-request",
        "The body is no valid multipart/form-data.",
        known=words,
        remedy="Every part needs a file name, and the body the boundary that its Content-Type names.",
    )


def _level_type(value: UploadFile) -> str:
    found = (value.content_type or "").partition(";")[0].strip().lower()
    return found if found in SUFFIXES else ""


def _copied(value: UploadFile, target: Path) -> None:
    with target.open("wb") as file:
        shutil.copyfileobj(value.file, file, CHUNK_BYTES)
