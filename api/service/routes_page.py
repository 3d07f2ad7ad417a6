"""The page at /, and the files that it consists of."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from fastapi import APIRouter, Response

from api.service.problems import ProblemError

router = APIRouter()

INDEX = "index.html"
MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".ico": "image/x-icon",
    ".webp": "image/webp",
    ".glb": "model/gltf-binary",
}
# Everything comes from here; what a level or a report holds cannot run.
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; frame-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


@router.get("/", include_in_schema=False)
async def page() -> Response:
    """The page."""
    return _asset(INDEX)


@router.get("/page/{name}", include_in_schema=False)
async def asset(name: str) -> Response:
    """A file of the page."""
    return _asset(name)


def _asset(name: str) -> Response:
    data = _assets().get(name)
    if data is None:
        raise ProblemError("not-found", "The page has no such file.")
    suffix = name[name.rindex(".") :]
    headers = {"Content-Security-Policy": POLICY, "Cache-Control": "no-cache"}
    return Response(data, headers=headers, media_type=MEDIA_TYPES[suffix])


@cache
def _assets() -> dict[str, bytes]:
    """All of them by name: nothing is looked for by a name that a client gives."""
    folder = files("api.service") / "page"
    if not folder.is_dir():
        return {}
    return {
        one.name: one.read_bytes()
        for one in folder.iterdir()
        if one.is_file() and one.name[one.name.rfind(".") :] in MEDIA_TYPES
    }
