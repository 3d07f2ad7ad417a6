"""A technique with settings: one possible answer for a light."""

from __future__ import annotations

from dataclasses import dataclass

from renderers.context import DeviceLimits
from renderers.registry import TECHNIQUES, technique
from renderers.settings import Setting, Settings
from renderers.technique import Technique
from scenes.scene import LightKind

UNNAMED = ("map_size", "filter", "kernel")
"""Settings whose values speak for themselves."""


@dataclass(frozen=True)
class Candidate:
    """One possible answer.

    Attributes:
        technique: Its id, such as `shadow_map`.
        settings: Names and values, in the technique's own order.
    """

    technique: str
    settings: tuple[tuple[str, Setting], ...] = ()

    @classmethod
    def of(cls, known: Technique, settings: Settings) -> Candidate:
        """The candidate that is `known` with `settings`."""
        return cls(known.name, tuple(settings.items()))

    @property
    def method(self) -> Technique:
        """The technique itself."""
        return technique(self.technique)

    @property
    def label(self) -> str:
        """How people call it, such as `SM 1024 2x2` or `PSM 1024 2x2 depth=kozlov`.

        The focus is named where it is not the usual one.
        """
        values = dict(self.settings)
        focus = values.pop("focus", None)
        words = [self.method.label]
        words += [str(value) if name in UNNAMED else f"{name}={value}" for name, value in values.items()]
        return " ".join([*words, "view"] if focus == "view" else words)


def candidates(kind: LightKind, limits: DeviceLimits, labels: tuple[str, ...] = ()) -> tuple[Candidate, ...]:
    """Every candidate worth measuring for a kind of light; only those of the named techniques, if any."""
    wanted = {technique(label).name for label in labels} or {known.name for known in TECHNIQUES}
    return tuple(
        Candidate.of(known, settings)
        for known in TECHNIQUES
        if known.name in wanted
        for settings in known.candidates(kind, limits)
    )
