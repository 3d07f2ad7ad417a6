"""Settings of a technique as users give them: read, checked, and completed with the usual ones."""

from __future__ import annotations

from collections.abc import Mapping
from math import log2

from api.wording import shortened
from renderers.context import DeviceLimits
from renderers.settings import Setting, Settings, check
from renderers.technique import Technique
from scenes.scene import Light, Scene

USUAL_MAP_SIZE, USUAL_FILTER = 1024, "2x2"
LONGEST_SHOWN = 60


def read_settings(method: Technique, texts: Mapping[str, str]) -> Settings:
    """The settings that names and texts stand for, in the technique's own order.

    Raises:
        SettingsError: The technique has no such setting, or it may not have this value; the message says
            which there are and what they may be.
    """
    options = method.options
    values: dict[str, Setting] = {}
    for name, text in texts.items():
        value = options[name].read(text) if name in options else None
        words = shortened(text, LONGEST_SHOWN)
        check(options, shortened(name, LONGEST_SHOWN), words if value is None else value, method.label)
        assert value is not None
        values[name] = value
    return {name: values[name] for name in options if name in values}


def with_usual(
    method: Technique, asked: Settings, light: Light, scene: Scene, limits: DeviceLimits
) -> Settings:
    """`asked`, and what is usual where nothing is asked: the candidate nearest to 1024 texels at 2x2.

    Its map has 1024 texels even where no candidate's has, so that techniques are drawn alike, unless the
    technique refuses them.
    """
    nearest: Settings = min(method.candidates(light.kind, limits), key=_unusual)
    usual = {**nearest, **asked}
    if "map_size" not in usual or "map_size" in asked:
        return usual
    alike = {**usual, "map_size": USUAL_MAP_SIZE}
    return usual if method.refuses(light, scene, limits, alike) else alike


def _unusual(settings: Settings) -> tuple[float, bool]:
    size = settings.get("map_size", USUAL_MAP_SIZE)
    return abs(log2(float(size) / USUAL_MAP_SIZE)), settings.get("filter", USUAL_FILTER) != USUAL_FILTER
