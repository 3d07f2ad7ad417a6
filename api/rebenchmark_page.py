"""The page of a re-benchmark job: its template filled from the same values as the JSON."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from math import exp, log
from pathlib import PurePath
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup, escape

from api.cli.terminal import printable
from api.wording import counted
from renderers.registry import TECHNIQUES, technique

Json = Mapping[str, Any]

PAGE_BEGINNING = b"<!doctype html>\n<!-- gnomon rebenchmark -->\n"
"""How such a page begins, and no other page does."""
WIDTH, HEIGHT = 440, 30
LEAST_REACH = log(1.3)
"""The plot shows at least ratios from 1/1.3 to 1.3, so that a calm night looks calm."""
MOST_REACH = log(4.0)
_TICKS = (0.25, 0.33, 0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 3.0, 4.0)
_LEAST_GAP = 44
_CODE = re.compile(r"`([^`]+)`")
REASONS = {
    "fresh": "fresh",
    "code": "code or shader changed",
    "device": "driver or device changed",
    "drift": "drifted before",
    "age": "too old",
}


@dataclass(frozen=True)
class Scale:
    """Where a ratio lies across the plot.

    Attributes:
        reach: Natural logarithm of the largest ratio that is shown.
    """

    reach: float

    @classmethod
    def of(cls, drift: Sequence[Json]) -> Scale:
        """A scale that shows all intervals and nearly all instances."""
        ends = [abs(log(end)) for row in drift for end in row["interval"]]
        ratios = sorted(abs(log(one)) for row in drift for one in row["ratios"])
        most = ratios[int(0.95 * (len(ratios) - 1))] if ratios else 0.0
        reach = 1.1 * max([LEAST_REACH, most, *ends])
        return cls(min(reach, MOST_REACH))

    def at(self, ratio: float) -> float:
        """In pixels; what is outside lies at the edge."""
        share = min(max(log(ratio) / self.reach, -1.0), 1.0)
        return round(WIDTH / 2 + share * (WIDTH / 2 - 6), 1)

    def ticks(self) -> list[tuple[float, str]]:
        """Places and words of ticks, none too close to another."""
        found: list[tuple[float, str]] = []
        inside = [one for one in _TICKS if abs(log(one)) < self.reach]
        for one in sorted(inside, key=lambda ratio: abs(log(ratio))):
            place = self.at(one)
            if all(abs(place - other) >= _LEAST_GAP for other, _ in found):
                found.append((place, f"{one:g}"))
        return sorted(found)


def page_bytes(values: Json) -> bytes:
    """The page as UTF-8; it needs no other file and no network.

    Args:
        values: The report as JSON values.
    """
    sample = values["sample"]
    scale = Scale.of(sample["drift"]) if sample else Scale(LEAST_REACH)
    text = _template().render(
        report=values,
        scale=scale,
        rows=[_row(one, scale, sample["floor"]) for one in sample["drift"]] if sample else [],
        band=_band(scale, sample["floor"]) if sample else (0, 0),
        reasons=REASONS,
        width=WIDTH,
        height=HEIGHT,
        version=version("gnomon"),
        labels={one.name: one.label for one in TECHNIQUES},
    )
    page = text.encode(errors="replace")
    assert page.startswith(PAGE_BEGINNING), "by this an earlier page is known"
    return page


def _row(one: Json, scale: Scale, floor: float) -> Json:
    low, high = one["interval"]
    if one["p_value"] is None:
        said = "too few instances"
    elif one["alarm"]:
        said = "slower" if one["ratio"] > 1 else "faster"
    elif low >= 1 / (1 + floor) and high <= 1 + floor:
        said = "holds"
    else:
        said = "no drift shown"
    return {
        **one,
        "index": _index(one["technique"]),
        "dots": [(scale.at(ratio), HEIGHT / 2 + _jitter(place)) for place, ratio in enumerate(one["ratios"])],
        "at": scale.at(one["ratio"]),
        "low_at": scale.at(low),
        "high_at": scale.at(high),
        "said": said,
        "percent": f"{100 * (one['ratio'] - 1):+.1f} %",
    }


def _band(scale: Scale, floor: float) -> tuple[float, float]:
    """Left end and width of the floor."""
    left, right = scale.at(exp(-log(1 + floor))), scale.at(1 + floor)
    return left, round(right - left, 1)


def _jitter(place: int) -> float:
    """Dots of one row lie on a few lines, so that they can be told apart; the same ones every time."""
    return round(((place * 5) % 9 - 4) * 2.1, 1)


def _index(name: str) -> int:
    return [one.name for one in TECHNIQUES].index(technique(name).name)


def _worded(text: str) -> Markup:
    """A sentence, with what stands between backticks as code."""
    return Markup(_CODE.sub(r"<code>\1</code>", str(escape(printable(text)))))  # noqa: S704  escaped before


@cache
def _template() -> Template:
    loader = PackageLoader("api", "templates")
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {
        "printable": printable,
        "counted": counted,
        "worded": _worded,
        "filename": lambda text: PurePath(text).name,
    }
    # The style is ours, and nothing in it comes from a level.
    environment.globals["source"] = lambda name: Markup(loader.get_source(environment, name)[0])  # noqa: S704
    return environment.get_template("rebenchmark.html")
