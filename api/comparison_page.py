"""The page of a comparison: its template filled, with style, script and pictures inside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from functools import cache
from importlib.metadata import version

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup

from api.cli.terminal import printable
from api.comparison_model import LightPart
from api.comparison_words import digits
from api.destinations import PAGE_BEGINNING
from api.error_map import FALSE_LIT, FALSE_SHADOW
from api.wording import counted
from renderers.clock import ClockKind
from renderers.context import Device
from renderers.registry import TECHNIQUES


@dataclass(frozen=True)
class PageFacts:
    """What holds for the whole page.

    Attributes:
        level: Name of its file.
        format: Of the file.
        digest: Of the scene.
        triangles: Of the scene.
        left_out: Lights of the level that are not on the page.
        techniques: Labels of those that were asked for; none where all are shown.
        width: Of each view, in pixels.
        height: Of each view, in pixels.
        rounds: How often every candidate was timed.
        limit_px: How far an edge may be off.
        device: Where all was measured.
        clock: How time was told.
        date: When.
    """

    level: str
    format: str
    digest: str
    triangles: int
    left_out: int
    techniques: tuple[str, ...]
    width: int
    height: int
    rounds: int
    limit_px: float
    device: Device
    clock: ClockKind
    date: date


def page_bytes(facts: PageFacts, lights: Sequence[LightPart]) -> bytes:
    """The page as UTF-8; it needs no other file and no network."""
    techniques = {row.technique for light in lights for row in light.rows}
    text = _template().render(
        facts=facts,
        lights=lights,
        techniques=[(index, known) for index, known in enumerate(TECHNIQUES) if index in techniques],
        version=version("gnomon"),
        false_lit=_css_color(FALSE_LIT),
        false_shadow=_css_color(FALSE_SHADOW),
    )
    page = text.encode(errors="replace")
    assert page.startswith(PAGE_BEGINNING), "by this an earlier page is known"
    return page


@cache
def _template() -> Template:
    loader = PackageLoader("api", "templates")
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"printable": printable, "digits": digits, "counted": counted}
    # Style and script are ours, and nothing in them comes from a level.
    environment.globals["source"] = lambda name: Markup(loader.get_source(environment, name)[0])  # noqa: S704
    return environment.get_template("compare.html")


def _css_color(color: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*color)
