"""Measures all features of a light in a view, says what that took, and by which version of the code."""

from __future__ import annotations

import ast
import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

from features.level_survey import LevelSurvey
from features.light_view import LightView
from features.table import FEATURES
from scenes.scene import Light, View

OWN_PACKAGES = ("features", "scenes")


@dataclass(frozen=True)
class Features:
    """What was found out about one light in one view.

    Attributes:
        values: Name -> value, in the table's order; all finite.
        seconds: What it took, besides looking through the level once.
    """

    values: Mapping[str, float]
    seconds: float


def extract(level: LevelSurvey, light: Light, view: View) -> Features:
    """All features of one of the level's lights in a view."""
    start = perf_counter()
    one = LightView(level, light, view)
    values = {feature.name: float(feature.measure(one)) for feature in FEATURES}
    seconds = perf_counter() - start
    strange = [name for name, value in values.items() if not math.isfinite(value)]
    assert not strange, f"features must be finite: {strange} of {light} in {view}"
    return Features(values, seconds)


@cache
def extractor_version() -> str:
    """16 hexadecimal digits that change with any source that decides a feature.

    Over this package and every module of `scenes` that it imports, directly or not.
    """
    sha = hashlib.sha256()
    sources = _sources()
    for name in sorted(sources):
        sha.update(name.encode() + b"\0" + sources[name] + b"\0")
    return sha.hexdigest()[:16]


def _sources() -> dict[str, bytes]:
    """Module name -> source, of all modules that this one's imports lead to."""
    found: dict[str, bytes] = {}
    waiting = [__name__]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        spec = find_spec(name)
        assert spec is not None
        assert spec.origin is not None
        found[name] = Path(spec.origin).read_bytes()
        waiting += _imported(found[name])
    return found


def _imported(source: bytes) -> list[str]:
    """Our own modules that a source names in its imports."""
    nodes = ast.walk(ast.parse(source))
    names = [node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module]
    return [name for name in names if name.split(".")[0] in OWN_PACKAGES]
